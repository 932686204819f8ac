//! Panels for editors that are built on MLT: every effect has one, and it sets what the plugin has, as MLT names it.

use super::{Unpacked, files};
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::Described;
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::Set;
use isophote_tests::ofx::state::Behaviour;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

/// Controls that panels leave at their defaults: those that need more than one frame and one clip at a time, and those of
/// the graphics card, for which editors render too many frames at once.
const LEFT_OUT: [&str; 9] = [
    "working_space",
    "process_alpha",
    "reference_height",
    "steadiness",
    "window",
    "renewal",
    "compute_on",
    "card",
    "precision",
];

/// The effect of all looks. In others the choice of a look needs hosts that tell of edits.
const LOOKS: &str = "org.isophote.look";

/// What panels of that effect lack: its file, for which editors have no control.
const OF_FILES: [&str; 3] = ["file", "reload", "times_read"];

/// A control of the plugin, as MLT takes it.
#[derive(Clone, Debug, PartialEq)]
struct Control {
    label: String,
    /// `Double`, `Integer`, `Boolean`, `Choice` or `RGBA`.
    kind: String,
    /// As MLT writes it; of choices the text of the option.
    default: String,
    /// Ends of the slider; of whole numbers the lower one is the least that there is.
    slider: Option<[f32; 2]>,
    options: Vec<String>,
}

/// Controls of an effect by their names.
type Controls = BTreeMap<String, Control>;

/// The controls of all effects in single-input hosts, by the names that MLT gives the effects: "openfx." before the
/// identifier, with a circumflex for every colon.
fn plugin() -> &'static BTreeMap<String, Controls> {
    static PLUGIN: OnceLock<BTreeMap<String, Controls>> = OnceLock::new();
    PLUGIN.get_or_init(|| {
        let architecture = if cfg!(target_arch = "aarch64") { "Linux-aarch64" } else { "Linux-x86-64" };
        let bundle = Unpacked::get().of("openfx").join("Isophote.ofx.bundle/Contents");
        let binary = Binary::open(&bundle.join(architecture).join("Isophote.ofx"));
        let host = Host::new(Behaviour::default());
        let effect = |identifier: String| {
            let described = Described::new(&host, binary.plugin(&identifier));
            let mut controls = BTreeMap::new();
            described.in_context(kOfxImageEffectContextFilter).each_param(|param| {
                let name = param.name.to_string_lossy().into_owned();
                let kind = param.kind.to_string_lossy().replace("OfxParamType", "");
                let left_out = LEFT_OUT.contains(&name.as_str())
                    || match identifier.as_str() {
                        LOOKS => OF_FILES.contains(&name.as_str()),
                        _ => name == "look",
                    };
                if !matches!(kind.as_str(), "Group" | "Page") && !left_out {
                    let mut control = control(&param.set, kind);
                    control.options.retain(|option| option != "From file");
                    controls.insert(name, control);
                }
            });
            (format!("openfx.{}", identifier.replace(':', "^")), controls)
        };
        let ids = binary.plugins().iter().map(|plugin| plugin.identifier());
        ids.map(effect).collect()
    })
}

fn control(set: &Set, kind: String) -> Control {
    let numbers = set.numbers(kOfxParamPropDefault);
    let options = set.texts(kOfxParamPropChoiceOption);
    let least = if kind == "Integer" { kOfxParamPropMin } else { kOfxParamPropDisplayMin };
    let ends = [least, kOfxParamPropDisplayMax];
    let byte = |index: usize| (numbers[index] * 255.0).round() as u8;
    let default = match kind.as_str() {
        "Choice" => options[numbers[0] as usize].clone(),
        "RGBA" => format!("#{:02x}{:02x}{:02x}{:02x}", byte(3), byte(0), byte(1), byte(2)),
        _ => (numbers[0] as f32).to_string(),
    };
    let has_slider = matches!(kind.as_str(), "Double" | "Integer");
    let slider = has_slider.then(|| ends.map(|end| set.numbers(end)[0] as f32));
    Control { label: set.text(kOfxPropLabel).unwrap(), kind, default, slider, options }
}

#[test]
fn kdenlive_descriptions_are_those_of_the_plugin() {
    let folder = Unpacked::get().of("openfx").join("kdenlive");
    let mut described: BTreeMap<String, Controls> = BTreeMap::new();
    for name in files(&folder) {
        let text = std::fs::read_to_string(folder.join(&name)).unwrap();
        let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
        let document = Document::parse_with_options(&text, options).unwrap_or_else(|e| panic!("{name}: {e}"));
        let effect = document.root_element();
        assert_eq!(
            effect.attribute("tag"),
            effect.attribute("id"),
            "{name} overrides what is made of the plugin"
        );
        for child in ["name", "description", "author"] {
            assert!(!inner(effect, child).is_empty(), "{name}: {child}");
        }
        let controls = effect.children().filter(|node| node.has_tag_name("parameter")).map(parameter);
        described.insert(effect.attribute("tag").unwrap().to_owned(), controls.collect());
    }
    let mut plugin = plugin().clone();
    for all in [&mut described, &mut plugin] {
        // Editors keep names of looks, hosts their places, for which those that came later stand last.
        let look = all.get_mut("openfx.org.isophote.look").and_then(|effect| effect.get_mut("look"));
        look.expect("there is a choice of looks").options.sort_unstable();
    }
    assert_eq!(described, plugin);
}

fn inner(node: Node<'_, '_>, name: &str) -> String {
    let child = node.children().find(|child| child.has_tag_name(name));
    child.and_then(|child| child.text()).unwrap_or_default().to_owned()
}

/// A parameter of Kdenlive's as the control that it is for.
fn parameter(node: Node<'_, '_>) -> (String, Control) {
    let text = |name: &str| node.attribute(name).unwrap_or_default().to_owned();
    let number = |name: &str| text(name).parse::<f32>().unwrap();
    let (kind, options) = match text("type").as_str() {
        "animated" => ("Double", vec![]),
        "constant" => ("Integer", vec![]),
        "bool" => ("Boolean", vec![]),
        "color" => ("RGBA", vec![]),
        "list" => ("Choice", text("paramlist").split(';').map(str::to_owned).collect::<Vec<_>>()),
        other => panic!("{other} is no type of Kdenlive's"),
    };
    assert!(!inner(node, "comment").is_empty());
    if kind == "Choice" {
        // Names must not be cut where they are listed.
        assert_eq!(inner(node, "paramlistdisplay").split(',').count(), options.len(), "{options:?}");
    }
    let slider = matches!(kind, "Double" | "Integer").then(|| [number("min"), number("max")]);
    let (kind, default) = (kind.to_owned(), text("default"));
    (text("name"), Control { label: inner(node, "name"), kind, default, slider, options })
}

#[test]
fn shotcut_panels_set_what_the_plugin_has() {
    let folder = Unpacked::get().of("openfx").join("shotcut");
    let mut services = BTreeSet::new();
    for name in files(&folder) {
        let read = |file: &str| std::fs::read_to_string(folder.join(&name).join(file)).unwrap();
        let (meta, ui) = (read("meta.qml"), read("ui.qml"));
        for text in [&meta, &ui] {
            balanced(text).unwrap_or_else(|problem| panic!("{name}: {problem}"));
        }
        let service = between(&meta, "mlt_service: '", "'").unwrap();
        assert!(meta.contains("qml: 'ui.qml'") && meta.contains("icon: 'icon.png'"));
        image::open(folder.join(&name).join("icon.png")).unwrap();
        let controls = plugin().get(service).unwrap_or_else(|| panic!("MLT knows no {service}"));
        let fresh = between(&ui, "filter.isNew) {\n", "filter.savePreset").unwrap();
        let set: BTreeMap<&str, &str> = fresh
            .lines()
            .filter_map(|line| between(line, "filter.set('", ");")?.split_once("', "))
            .map(|(name, value)| (name, value.trim_matches('\'')))
            .collect();
        let wanted: BTreeMap<&str, &str> =
            controls.iter().map(|(name, control)| (name.as_str(), control.default.as_str())).collect();
        assert_eq!(set, wanted, "{service}");
        for (name, control) in controls {
            form_of(&ui, name, control);
        }
        services.insert(service.to_owned());
    }
    assert_eq!(services, plugin().keys().cloned().collect());
}

/// The part of the form that sets a control.
fn form_of(ui: &str, name: &str, control: &Control) {
    let form = between(ui, &format!("id: {name}_control\n"), "Shotcut.UndoButton").unwrap();
    assert!(form.contains(&format!("filter.set('{name}', ")), "{name}: {form}");
    assert_eq!(
        ui.matches(&format!("            {name}_control.")).count(),
        0,
        "{name} is set where it is not shown"
    );
    if let Some([low, high]) = control.slider {
        let ends = ["minimumValue: ", "maximumValue: "].map(|end| between(form, end, "\n").unwrap().parse());
        assert_eq!(ends, [Ok(low), Ok(high)], "{name}");
    }
    for option in &control.options {
        assert!(form.contains(&format!("'{}'", option.replace('\'', "\\'"))), "{name}: {option}");
    }
    assert!(ui.contains(&format!("qsTr('{}')", control.label.replace('\'', "\\'"))), "{name}");
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    Some(text.split_once(before)?.1.split_once(after)?.0)
}

/// Checks that brackets and quotes of QML close in order.
fn balanced(text: &str) -> Result<(), String> {
    let mut open = Vec::new();
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '(' => open.push(')'),
            '[' => open.push(']'),
            '{' => open.push('}'),
            ')' | ']' | '}' if open.pop() != Some(letter) => return Err(format!("a {letter} too many")),
            '\'' => loop {
                match letters.next() {
                    Some('\\') => drop(letters.next()),
                    Some('\'') => break,
                    Some('\n') | None => return Err("a text does not end on its line".into()),
                    Some(_) => {}
                }
            },
            _ => {}
        }
    }
    if open.is_empty() { Ok(()) } else { Err(format!("{open:?} is missing at the end")) }
}

#[test]
fn what_does_not_close_is_found() {
    assert!(balanced("Item { a: f(['it\\'s (', 2]) }\n").is_ok());
    for wrong in ["Item { a: 1", "Item { a: (1] }", "Item { a: 'b\n' }", "}"] {
        assert!(balanced(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn panels_are_installed_for_the_user() {
    let unpacked = Unpacked::get();
    let folder = unpacked.of("openfx");
    let home = unpacked.folder.path();
    for (editor, place) in [
        ("shotcut", ".local/share/Meltytech/Shotcut/extensions/filters"),
        ("kdenlive", ".local/share/kdenlive/effects"),
    ] {
        unpacked.run_in(&folder, &format!("./install.sh --{editor}"));
        assert_eq!(files(&home.join(place)), files(&folder.join(editor)));
        assert_eq!(files(&home.join(place)).len(), plugin().len());
        unpacked.run_in(&folder, &format!("./install.sh --{editor} --remove"));
        assert!(files(&home.join(place)).is_empty());
    }
}
