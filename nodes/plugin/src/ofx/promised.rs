//! The list of what projects of users store of the effects: names of parameters, types, defaults, and options in their order.
//!
//! `parameters.txt` holds it as it was when it was last written. Whatever is gone from it, or is another, would break projects.

use super::effects::{Control, EFFECTS, Effect, Target, USUAL_REFERENCE};
use super::look_effect::DEFAULT;
use isophote::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Effects and their parameters, each with all that is stored of it.
type List = BTreeMap<String, BTreeMap<String, String>>;

/// What a project stores of a control. Options come last, since more may be added behind them.
fn stored(control: &Control) -> String {
    let options =
        control.options.iter().map(|option| option.to_string_lossy()).collect::<Vec<_>>().join(" | ");
    match control.target {
        Target::Param(_, param) => {
            let numbers = |count: usize| {
                param.default.decimals()[..count].iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
            };
            match param.default {
                Value::Float(_) => format!("number {}", numbers(1)),
                Value::Int(_) => format!("whole number {}", numbers(1)),
                Value::Bool(on) => format!("switch {}", if on { "on" } else { "off" }),
                Value::Color(_) => format!("colour {}", numbers(4)),
                Value::Choice(index) => format!("choice {index} of {options}"),
            }
        }
        Target::WorkingSpace => format!("choice by the host of {options}"),
        Target::Own(param) => format!("number {}", param.default.decimals()[0]),
        Target::Shown => format!("choice {DEFAULT} of {options}"),
        Target::File => "text".to_owned(),
        Target::Reload => "button".to_owned(),
        Target::TimesRead => "whole number 0".to_owned(),
        Target::Look
        | Target::LinesOutput
        | Target::MaskFrom
        | Target::MotionFrom
        | Target::MotionConvention => {
            format!("choice 0 of {options}")
        }
        Target::ReferenceHeight => format!("whole number {USUAL_REFERENCE}"),
        Target::ProcessAlpha | Target::MaskInvert => "switch off".to_owned(),
        Target::MaskApply => "switch by the host".to_owned(),
    }
}

fn present() -> List {
    let controls = |effect: &Effect| {
        let pairs = effect.controls.iter().map(|c| (c.name.to_string_lossy().into_owned(), stored(c)));
        pairs.collect()
    };
    EFFECTS.iter().map(|e| (e.identifier.to_string_lossy().into_owned(), controls(e))).collect()
}

fn read(text: &str) -> List {
    let mut list = List::new();
    let mut effect = String::new();
    for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        match line.strip_prefix("  ").and_then(|line| line.split_once(": ")) {
            Some((name, stored)) => {
                list.entry(effect.clone()).or_default().insert(name.to_owned(), stored.to_owned());
            }
            None => effect = line.to_owned(),
        }
    }
    list
}

fn written(list: &List) -> String {
    let mut text = String::from(HEAD);
    for (effect, controls) in list {
        text += &format!("\n{effect}\n");
        controls.iter().for_each(|(name, stored)| text += &format!("  {name}: {stored}\n"));
    }
    text
}

const HEAD: &str = "\
# What projects of users store of the OpenFX effects, written by `ISOPHOTE_BLESS=1 cargo test -p isophote-plugin promised`.
# That adds lines, and options at the end of lines. It changes and removes none.
";

/// Whatever of one list the other does not have as it is.
fn broken(old: &List, new: &List) -> Vec<String> {
    let mut broken = Vec::new();
    for (effect, controls) in old {
        for (name, stored) in controls {
            let now = new.get(effect).and_then(|controls| controls.get(name));
            let is_kept = |now: &String| {
                now == stored || now.strip_prefix(&**stored).is_some_and(|more| more.starts_with(" | "))
            };
            if !now.is_some_and(is_kept) {
                broken.push(format!("{effect}.{name} was '{stored}' and is {now:?}"));
            }
        }
    }
    broken
}

#[test]
fn projects_of_users_find_the_parameters_that_they_store() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("parameters.txt");
    let old = std::fs::read_to_string(&file).unwrap_or_default();
    let new = present();
    let broken = broken(&read(&old), &new);
    assert!(broken.is_empty(), "projects of users would break:\n{}", broken.join("\n"));
    if std::env::var_os("ISOPHOTE_BLESS").is_some() {
        std::fs::write(&file, written(&new)).unwrap();
    } else {
        assert_eq!(
            old,
            written(&new),
            "there is more than before: run with ISOPHOTE_BLESS=1, and commit {}",
            file.display()
        );
    }
}

#[test]
fn what_is_gone_or_changed_is_found_and_what_is_added_is_not() {
    let list = |text: &str| read(&format!("# about\n\na\n{text}"));
    let old = list("  k: number 1.6\n  style: choice 1 of Pencil | Ink\n");
    assert_eq!(read(&written(&old)), old);
    let more = list("  k: number 1.6\n  new: switch\n  style: choice 1 of Pencil | Ink | Chalk\n");
    assert!(broken(&old, &more).is_empty());
    for bad in [
        "  k: number 1.7\n  style: choice 1 of Pencil | Ink\n",
        "  style: choice 1 of Pencil | Ink\n",
        "  k: number 1.6\n  style: choice 1 of Ink | Pencil\n",
        "  k: number 1.6\n  style: choice 1 of Pencil | Inks\n",
        "  k: number 1.6\n  style: choice 0 of Pencil | Ink\n",
    ] {
        assert_eq!(broken(&old, &list(bad)).len(), 1, "{bad}");
    }
}
