//! Labels, hints and names of the effects' controls are such that every host can show them.

use super::clips::{MASK, OUTPUT, SOURCE, guide_label};
use super::effects::{EFFECTS, Form};
use std::collections::BTreeSet;
use std::ffi::{CStr, CString};

/// Hosts cut longer ones, or show them badly.
#[test]
fn labels_and_hints_are_short_and_no_two_controls_have_one_label() {
    for effect in EFFECTS.iter() {
        let id = effect.identifier.to_string_lossy();
        let short = |text: &CStr| {
            let shown = text.to_string_lossy();
            let good = shown.chars().count() < 20 && shown.starts_with(|c: char| c.is_uppercase());
            assert!(good, "{id}: label {shown:?}");
            shown.into_owned()
        };
        short(&effect.label);
        let description = effect.description.to_string_lossy();
        assert!(!description.contains(['`', '§']) && !description.contains("Fig."), "{id}: {description}");
        effect.groups.iter().for_each(|group| drop(short(&group.label)));
        let mut known: BTreeSet<String> =
            effect.guides.iter().filter_map(|guide| guide_label(*guide)).map(short).collect();
        known.extend([SOURCE, OUTPUT, MASK].map(short));
        for control in &effect.controls {
            assert!(known.insert(short(&control.label)), "{id}: two controls are called {:?}", control.label);
            let hint = control.hint.to_string_lossy();
            let fits = (10..160).contains(&hint.chars().count()) && hint.ends_with('.');
            assert!(fits && !hint.contains('`'), "{id}: {:?} says {hint:?}", control.label);
            let fits = |option: &CString| option.to_string_lossy().chars().count() < 20;
            assert!(control.options.iter().all(fits), "{id}: options {:?}", control.options);
        }
        let last = effect.controls.last().unwrap();
        let has_mix = effect.form == Form::Look || effect.nodes.iter().any(|node| node.has_mix());
        assert_eq!(last.label.as_c_str() == c"Mix", has_mix, "{id}: {:?} is last", last.label);
    }
}

#[test]
fn names_are_unique_and_fit_for_scripts() {
    for effect in EFFECTS.iter() {
        let names = effect.controls.iter().map(|c| &c.name).chain(effect.groups.iter().map(|g| &g.name));
        let mut known = BTreeSet::new();
        for name in names {
            let shown = name.to_string_lossy();
            let fit = shown.starts_with(|c: char| c.is_ascii_lowercase())
                && shown.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
            assert!(fit && known.insert(name), "{:?}: {shown}", effect.identifier);
        }
        for control in &effect.controls {
            let distinct: BTreeSet<_> = control.options.iter().collect();
            assert_eq!(distinct.len(), control.options.len(), "{:?}", control.name);
        }
    }
}
