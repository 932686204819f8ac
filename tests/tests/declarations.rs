//! Declarations of nodes and kernels: complete, in range, and good for every graph file.

use isophote::kernels::KERNELS;
use isophote::preset::{LOOKS, Look};
use isophote::spec::{NodeSpec, Unit};
use isophote::{Graph, Planned, Request, Value};
use isophote_engine::Kernel;
use isophote_tests::trials::Trials;
use isophote_tests::{cases, uniforms};
use std::collections::{BTreeSet, HashMap};

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for spec in isophote::registry::nodes() {
        trials.add("declarations", spec.id, || faults_of(spec));
        trials.add("words", spec.id, || bad_words_of(spec));
        trials.add("finite_uniforms", spec.id, || no_parameters_make_numbers_that_are_none(spec));
        trials.add("graph_files", spec.id, || every_parameter_set_plans_and_goes_through_json(spec));
    }
    for look in LOOKS {
        trials.add("words", look.id, || bad_words_of_look(look));
    }
    for kernel in KERNELS {
        trials.add("tolerances", kernel.name, || the_tolerance_has_a_reason_and_is_small(kernel));
    }
}

fn is_identifier(id: &str) -> bool {
    id.starts_with(|c: char| c.is_ascii_lowercase())
        && id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

fn is_sentence(text: &str) -> bool {
    text.len() > 3 && text.trim() == text && text.ends_with('.')
}

/// Characters of a label, and of a hint with its unit, that hosts and panels show without cutting.
const LABEL: usize = 20;
const HINT: usize = 160;
/// The longest unit after a hint, "In pixels of a picture 1080 lines high."
const UNIT: usize = 40;
/// Names that keep their capitals within a label.
const NAMES: [&str; 11] = [
    "CIELAB",
    "RGB",
    "Kuwahara",
    "Canny",
    "Sobel",
    "Scharr",
    "Gaussian",
    "Harris",
    "Foerstner",
    "Tomasi",
    "Rohr",
];
/// Words of the theory, which belong into the documentation.
const THEORY: [&str; 14] = [
    "sigma",
    "tau",
    "rho",
    "phi",
    "epsilon",
    "lambda",
    "omega",
    "alpha",
    "thesis",
    "equation",
    "eigenvector",
    "deviation",
    "bilinear",
    "integral",
];

/// True for a label in artists' words: short, and with capitals at its beginning and in names alone.
fn is_label(label: &str) -> bool {
    let mut words = label.split(' ');
    let first = words.next().is_some_and(|word| word.starts_with(|c: char| c.is_ascii_uppercase()));
    let plain = |word: &str| NAMES.contains(&word) || !word.contains(|c: char| c.is_ascii_uppercase());
    first && words.all(plain) && label.is_ascii() && label.len() < LABEL && !label.contains('`')
}

/// True for sentences in artists' words: short, without marks of code, figures, sections and symbols of the thesis.
fn is_hint(hint: &str, unit: Unit) -> bool {
    let room = if unit == Unit::None { HINT } else { HINT - UNIT };
    let is_cited = hint.split('(').skip(1).any(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    let words = || hint.split(|c: char| !c.is_ascii_alphabetic());
    is_sentence(hint)
        && hint.is_ascii()
        && hint.len() < room
        && !hint.contains('`')
        && !is_cited
        && !words().any(|word| THEORY.contains(&&*word.to_lowercase()) || word == "Fig" || word == "Listing")
}

/// True where "color" is an id between marks of code, and "colour" everywhere else.
fn is_british(text: &str) -> bool {
    text.split('`').step_by(2).all(|words| !words.to_lowercase().contains("color"))
}

fn bad_words_of(spec: &'static NodeSpec) -> Vec<String> {
    let mut faults = Vec::new();
    let mut check = |good: bool, what: String| {
        if !good {
            faults.push(format!("{}: {what}", spec.id));
        }
    };
    check(is_label(spec.label), format!("label {:?}", spec.label));
    check(is_hint(spec.hint, Unit::None), format!("hint {:?}", spec.hint));
    check(is_british(&spec.text()), format!("spelling of {:?}", spec.text()));
    for port in spec.ports().chain([&spec.output]) {
        check(is_british(port.doc), format!("spelling of port {}", port.id));
    }
    let mut labels = BTreeSet::new();
    for param in spec.params() {
        let id = param.id;
        check(is_label(param.label), format!("{id}: label {:?}", param.label));
        check(labels.insert(param.label), format!("{id}: two controls are called {:?}", param.label));
        check(is_hint(param.hint, param.unit), format!("{id}: hint {:?}", param.hint));
        check(is_british(&param.text()) && is_british(param.label), format!("{id}: spelling"));
        check(
            param.group.len() < LABEL && !param.group.contains('_'),
            format!("{id}: group {}", param.group),
        );
        let mut labels = BTreeSet::new();
        for option in param.options {
            check(is_label(option.label), format!("{id}: label {:?} of {}", option.label, option.id));
            check(labels.insert(option.label), format!("{id}: two options are called {:?}", option.label));
            check(is_hint(option.doc, Unit::None), format!("{id}: {} says {:?}", option.id, option.doc));
            check(
                is_british(option.doc) && is_british(option.label),
                format!("{id}: spelling of {}", option.id),
            );
        }
    }
    faults
}

/// A look says in one sentence what is seen.
fn bad_words_of_look(look: &Look) -> Vec<String> {
    let title = look.preset().map(|preset| preset.title).unwrap_or_default();
    let [name, about] = [title.name, title.about].map(Option::unwrap_or_default);
    let mut faults = Vec::new();
    if !is_label(&name) {
        faults.push(format!("name {name:?}"));
    }
    let is_one = is_sentence(&about) && about.matches(['.', '!', '?']).count() == 1;
    let others = LOOKS.iter().filter(|other| other.json.contains(&about)).count();
    if !is_one || about.len() >= 100 || !is_british(&about) || others != 1 {
        faults.push(format!("about {about:?}"));
    }
    faults
}

fn faults_of(spec: &'static NodeSpec) -> Vec<String> {
    let mut faults = Vec::new();
    let mut check = |good: bool, what: String| {
        if !good {
            faults.push(format!("{}: {what}", spec.id));
        }
    };
    check(is_identifier(spec.id), "its id is not in lower case with underscores".into());
    check(
        !spec.label.is_empty() && is_sentence(spec.doc) && is_sentence(spec.hint),
        "label or document are missing".into(),
    );
    // The thesis knows of pictures alone.
    check(!spec.section.is_empty() || spec.group == "time", "no section of the thesis".into());
    for port in spec.ports().chain([&spec.output]) {
        check(is_identifier(port.id) && is_sentence(port.doc), format!("port {} lacks a document", port.id));
    }
    let mut ids = BTreeSet::new();
    for param in spec.params() {
        let id = param.id;
        check(is_identifier(id) && ids.insert(id), format!("{id} is no good id, or twice"));
        check(!param.label.is_empty() && is_sentence(param.hint), format!("{id} lacks a hint"));
        check(param.doc.is_empty() || is_sentence(param.doc), format!("{id}: its document is no sentence"));
        let ([low, high], [from, to], form) = (param.range, param.slider, param.default.form());
        let ordered = low <= from && from < to && to <= high;
        check(ordered, format!("{id}: slider {from}..{to} is not inside {low}..{high}"));
        let shown = form.numbers[..form.count].iter().all(|n| (from..=to).contains(&(*n as f32)));
        check(shown, format!("{id}: default {:?} is off its slider", param.default));
        let ids: BTreeSet<&str> = param.options.iter().map(|o| o.id).collect();
        check(ids.len() == param.options.len(), format!("{id}: two options of one id"));
        let is_choice = matches!(param.default, Value::Choice(_));
        check(is_choice != param.options.is_empty(), format!("{id}: options and type do not fit"));
        check(
            param.options.iter().all(|o| is_identifier(o.id) && !o.label.is_empty() && is_sentence(o.doc)),
            format!("{id}: an option's id, label or document"),
        );
    }
    faults
}

fn the_tolerance_has_a_reason_and_is_small(kernel: &Kernel) {
    let t = kernel.tolerance;
    assert!(t.reason.len() > 10, "why this tolerance?");
    assert!((0.0..=0.1).contains(&t.absolute), "absolute {}", t.absolute);
    assert!((0.0..=0.01).contains(&t.relative), "relative {}", t.relative);
    assert!((0.0..=0.03).contains(&t.outliers), "outliers {}", t.outliers);
}

/// Drivers may take either side of a comparison with what is not a number, so that none may reach a shader.
fn no_parameters_make_numbers_that_are_none(spec: &'static NodeSpec) -> Vec<String> {
    let mut floats = HashMap::new();
    let mut wrong = Vec::new();
    for setting in cases::settings(spec, 16).into_iter().chain(cases::mixed_ends(spec)) {
        let mut setup = cases::setup(spec, true);
        setting.apply(&mut setup.graph, setup.node);
        for scale in [0.37, 1.0] {
            let request = Request { scale, ..Request::new(19, 23) };
            let planned = Planned::new(&setup.graph, request).unwrap();
            for pass in planned.plan().passes() {
                let name = pass.kernel.name;
                let places = floats.entry(name).or_insert_with(|| uniforms::floats(pass.kernel));
                let found = uniforms::not_finite(pass, places);
                wrong.extend(
                    found.iter().map(|(at, value)| format!("({}) {name}: {value} at {at}", setting.label)),
                );
            }
        }
    }
    wrong
}

fn every_parameter_set_plans_and_goes_through_json(spec: &'static NodeSpec) {
    for setting in cases::settings(spec, 4) {
        let mut setup = cases::setup(spec, true);
        setting.apply(&mut setup.graph, setup.node);
        let text = setup.graph.to_json().unwrap();
        let read = Graph::from_json(&text).unwrap();
        assert_eq!(read.to_json().unwrap(), text, "{}", setting.label);
        let request = Request { scale: 0.37, ..Request::new(19, 23) };
        Planned::new(&read, request).unwrap();
    }
}
