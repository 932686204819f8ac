//! Looks: as choices in the effects of styles, and in the effect that shows looks, styles and files.

use super::reference::*;
use super::render::{SIZE, through};
use isophote::graph::GraphInput;
use isophote::preset::{LOOKS, Look};
use isophote::{ColourSpace, Graph};
use isophote_abi::openfx::*;
use isophote_loader::Library;
use isophote_tests::library;
use isophote_tests::ofx::effect::{Described, Instance, Wanted};
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::objects::Effect;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::{Set, Value};
use isophote_tests::ofx::state::Behaviour;
use std::ffi::{CStr, CString};
use std::path::Path;
use std::sync::OnceLock;

pub const CONTEXTS: [&CStr; 2] = [kOfxImageEffectContextFilter, kOfxImageEffectContextGeneral];
pub const LOOK_EFFECT: &str = "org.isophote.look";

fn with_param<T>(effect: &Effect, name: &str, look: impl Fn(&CStr, &Set) -> T) -> Option<T> {
    let mut found = None;
    effect.each_param(|param| {
        if param.name.to_string_lossy() == name {
            found = Some(look(&param.kind, &param.set));
        }
    });
    found
}

fn page(effect: &Effect) -> Vec<String> {
    with_param(effect, "Controls", |_, set| set.texts(kOfxParamPropPageChild)).expect("a page")
}

/// The looks of a style, with their names for people.
fn looks_of(style: &str) -> Vec<(&'static Look, String)> {
    let named = LOOKS.iter().map(|look| (look, look.preset().expect("it can be read")));
    let own = named.filter(|(_, preset)| preset.style == style);
    own.map(|(look, preset)| (look, preset.title.name.expect("it has a name"))).collect()
}

/// The graph of a look or style by the C table.
fn graph_of(name: &str) -> Graph {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    let library = LIBRARY.get_or_init(|| Library::from_file(library::path()).expect("the library"));
    let style = library.style(name).expect("it opens");
    Graph::from_json(&style.graph().and_then(|graph| graph.to_json()).expect("a graph")).expect("it is whole")
}

/// Result of the C table for the picture of the tests.
pub fn wanted(graph: &Graph, layout: Layout) -> Vec<u8> {
    through(graph, &source(layout, false), layout, ColourSpace::Srgb)
}

/// The same for lengths that are meant at 1080 lines, as `apply` has them, of a picture that is a proxy of 1080.
fn wanted_at_1080(graph: &Graph, picture: &Picture) -> Vec<u8> {
    let through = Through { reference_height: 1080, ..Through::of(graph, LARGE) };
    through.c(&[("color", &picture.packed(), picture.layout)], picture.layout)
}

/// A picture that has something left of lengths at 1080 lines.
const LARGE: [i32; 2] = [96, 360];

pub fn in_host<'h>(host: &'h Host, binary: &Binary, id: &str, context: &CStr) -> Instance<'h> {
    let instance = Described::new(host, binary.plugin(id)).instance(context);
    plain(&instance);
    instance.connect("Source", source(Layout::default(), false));
    instance
}

pub fn looks_of_a_style_come_first_in_its_page(binary: &Binary, effect: Expected) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, effect.plugin(binary));
    let looks: Vec<String> = looks_of(effect.node.id).into_iter().map(|(_, name)| name).collect();
    assert!(effect.node.group != "styles" || !looks.is_empty(), "{}", effect.node.id);
    for context in CONTEXTS {
        let shown = described.in_context(context);
        let options = with_param(&shown, "look", |kind, set| {
            assert_eq!(kind, kOfxParamTypeChoice);
            assert_eq!(set.int(kOfxParamPropDefault), Some(0));
            // It decides about no pixel.
            assert_eq!(set.int(kOfxParamPropEvaluateOnChange), Some(0));
            assert_ne!(set.int(kOfxParamPropSecret), Some(1));
            set.texts(kOfxParamPropChoiceOption)
        });
        if looks.is_empty() {
            assert_eq!(options, None);
        } else {
            let options = options.expect("a choice");
            assert_eq!((options[0].as_str(), &options[1..]), ("Custom", &looks[..]));
            assert_eq!(page(&shown)[0], "look");
        }
    }
    host.no_faults();
}

pub fn hosts_that_tell_of_no_edits_have_no_choice_of_looks(binary: &Binary) {
    let host = Host::new(Behaviour { name: c"mlt", ..Behaviour::default() });
    let shown = Described::new(&host, binary.plugin("org.isophote.ink")).in_context(CONTEXTS[0]);
    assert_eq!(with_param(&shown, "look", |_, set| set.int(kOfxParamPropSecret)), Some(Some(1)));
    let shown = Described::new(&host, binary.plugin(LOOK_EFFECT)).in_context(CONTEXTS[0]);
    assert_eq!(with_param(&shown, "look", |_, set| set.int(kOfxParamPropSecret)), Some(None));
}

pub fn choosing_a_look_sets_the_controls_in_one_step(binary: &Binary, effect: Expected) {
    let looks = looks_of(effect.node.id);
    if looks.is_empty() {
        return;
    }
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = in_host(&host, binary, &identifier(effect.node), CONTEXTS[0]);
    let render = || instance.render(layout, SIZE).packed();
    let before = render();
    let mut last = 0;
    for (at, (look, _)) in looks.iter().enumerate() {
        instance.set("reference_height", 0);
        let untouched = render();
        instance.set("look", at as i32 + 1);
        assert!(render() == untouched, "the choice itself is no setting");
        instance.touch("look");
        assert_eq!(instance.get("look"), [Value::Int(at as i32 + 1)], "{}", look.id);
        assert_eq!(instance.get("reference_height"), [Value::Int(1080)]);
        let steps = instance.steps();
        let [step] = &steps[..] else { panic!("{}: {} steps", look.id, steps.len()) };
        assert_eq!(step.label.as_deref(), Some(c"Look"));
        assert!(!step.names().contains(&"look".to_owned()));
        // Lengths as `through` has them.
        instance.set("reference_height", 0);
        assert!(render() == wanted(&graph_of(&look.name()), layout), "{}", look.id);
        instance.undo(step);
        instance.set("reference_height", 0);
        assert!(render() == untouched, "{} is undone at once", look.id);
        // Chosen once more, and nothing is left to do.
        instance.touch("look");
        instance.steps();
        instance.touch("look");
        assert_eq!(instance.steps().len(), 0, "{}", look.id);
        last = at as i32 + 1;
    }
    assert!(render() != before);
    // Mix and movement are the user's.
    instance.edit("mix", 0.5);
    instance.edit("steadiness", 0.25);
    assert_eq!((instance.get("look"), instance.steps().len()), (vec![Value::Int(last)], 0));
    instance.edit("look", 1);
    assert_eq!(instance.get("mix"), [Value::Double(0.5)]);
    assert_eq!(instance.get("steadiness"), [Value::Double(0.25)]);
    host.no_faults();
}

pub fn an_edit_makes_a_look_custom(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, "org.isophote.cartoon", CONTEXTS[1]);
    // Frames of one value hold at no time what a look has.
    instance.animate("posterize", vec![(0.0, 3.into()), (10.0, 9.into())]);
    instance.edit("look", 2);
    assert!(!instance.has_keys("posterize"));
    let step = instance.steps().pop().expect("a step");
    instance.undo(&step);
    assert!(instance.has_keys("posterize"));
    instance.touch("look");
    instance.steps();
    assert_eq!(instance.get("look"), [Value::Int(2)]);
    // What the plugin sets itself is no edit; what the user sets is, also the reference height.
    for (name, value) in
        [("posterize", Value::from(7)), ("line_width", 5.5.into()), ("reference_height", 500.into())]
    {
        instance.edit("look", 2);
        instance.steps();
        instance.edit(name, value.clone());
        assert_eq!((instance.get("look"), instance.get(name)), (vec![Value::Int(0)], vec![value]), "{name}");
        let steps = instance.steps();
        assert_eq!(
            steps.iter().map(|step| step.label.clone()).collect::<Vec<_>>(),
            [None],
            "no step of its own"
        );
    }
    // An edit that changes nothing leaves the look.
    instance.edit("look", 2);
    let width = instance.get("line_width").remove(0);
    instance.edit("line_width", width);
    assert_eq!(instance.get("look"), [Value::Int(2)]);
    host.no_faults();
    // A project holds values: those of another release are no look of this one, and stay.
    let described = Described::new(&host, binary.plugin("org.isophote.cartoon"));
    let saved = [("look", Value::from(2)), ("posterize", 11.into())];
    let instance = described.saved_instance(CONTEXTS[0], &saved);
    assert_eq!((instance.get("posterize"), instance.steps().len()), (vec![Value::Int(11)], 0));
    host.no_faults();
}

pub fn a_look_is_undone_by_its_choice_in_hosts_that_break_steps(binary: &Binary) {
    let host = Host::new(Behaviour { name: c"fr.inria.Natron", ..Behaviour::default() });
    let shown = Described::new(&host, binary.plugin("org.isophote.cartoon")).in_context(CONTEXTS[1]);
    let undone = with_param(&shown, "look", |_, set| set.int(kOfxParamPropEvaluateOnChange));
    assert_eq!(undone, Some(Some(1)), "the host undoes what it renders for");
    let instance = in_host(&host, binary, "org.isophote.cartoon", CONTEXTS[1]);
    let state =
        || ["look", "line_width", "posterize", "line_color", "reference_height"].map(|n| instance.get(n));
    instance.edit("line_width", 1.25);
    let first = state();
    instance.edit("look", 2);
    let clear = state();
    assert!(clear[1..] != first[1..]);
    // Chosen, and back over two looks.
    instance.edit("look", 3);
    assert!(state()[1..] != clear[1..]);
    instance.edit("look", 2);
    assert_eq!(state(), clear);
    instance.edit("look", 0);
    assert_eq!(state(), first);
    // An edit and the look before it, undone one after the other, and the look chosen again.
    instance.edit("look", 2);
    instance.edit("line_width", 5.5);
    assert_eq!(instance.get("look"), [Value::Int(0)]);
    instance.edit("line_width", clear[1][0].clone());
    assert_eq!(state(), clear);
    instance.edit("look", 0);
    assert_eq!(state(), first);
    // After an edit, the values of before the next look are those of the edit.
    instance.edit("look", 2);
    instance.edit("line_width", 5.5);
    let edited = state();
    instance.edit("look", 3);
    instance.edit("look", 0);
    assert_eq!(state(), edited);
    // A reset of all controls that is told of as it goes, undone without a word.
    instance.edit("look", 2);
    instance.steps();
    instance.edit("look", 0);
    instance.steps().iter().rev().for_each(|step| instance.undo(step));
    instance.set("look", 2);
    assert_eq!(state(), clear);
    instance.edit("look", 0);
    assert_eq!(state(), edited);
    // One that is told of afterwards, and undone.
    instance.edit("look", 2);
    instance.set("look", 0);
    instance.set("line_width", 2.0);
    let reset = state();
    instance.touch("look");
    assert_eq!(state(), reset);
    instance.set("line_width", clear[1][0].clone());
    instance.edit("look", 2);
    instance.edit("look", 0);
    assert_eq!(state(), edited);
    assert!(instance.steps().iter().all(|step| step.label.is_none()), "a step with a begin");
    host.no_faults();
}

fn sorted(labels: &[String]) -> Vec<&String> {
    let mut sorted: Vec<_> = labels.iter().collect();
    sorted.sort_unstable();
    sorted
}

/// Clips of the effect for looks in the general context.
const CLIPS: [&str; 18] = [
    "Source",
    "Output",
    "Mask",
    "Normal",
    "Depth",
    "Motion",
    "MotionForward",
    "RestPosition",
    "ObjectId",
    "Flow",
    "Albedo",
    "Diffuse",
    "Specular",
    "Control",
    "Paper",
    "Hatching",
    "LinePaint",
    "Cryptomatte",
];

pub fn the_effect_for_looks_shows_all_that_ships(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let described = Described::new(&host, binary.plugin(LOOK_EFFECT));
    let styles = isophote::registry::nodes().iter().filter(|node| node.group == "styles");
    let named = |look: &Look| look.preset().ok()?.title.name;
    let mut labels: Vec<String> = LOOKS.iter().map(|look| named(look).expect("it has a name")).collect();
    labels.extend(styles.clone().map(|node| node.label.to_owned()));
    let mut names: Vec<String> = LOOKS.iter().map(Look::name).collect();
    names.extend(styles.map(|node| node.id.to_owned()));
    for context in CONTEXTS {
        let shown = described.in_context(context);
        let options = with_param(&shown, "look", |_, set| set.texts(kOfxParamPropChoiceOption));
        let options = options.expect("a choice");
        assert_eq!(options[0], "From file");
        // What came later stands last: the order is what projects of users store.
        assert_eq!(sorted(&options[1..]), sorted(&labels));
        let first = ["look", "file", "reload", "times_read"];
        assert_eq!(page(&shown)[..4], first);
        assert_eq!(page(&shown).last().map(String::as_str), Some("mix"));
        let mode = with_param(&shown, "file", |kind, set| {
            (kind == kOfxParamTypeString, set.text(kOfxParamPropStringMode))
        });
        assert_eq!(mode, Some((true, Some("OfxParamStringIsFilePath".to_owned()))));
        assert_eq!(with_param(&shown, "reload", |kind, _| kind == kOfxParamTypePushButton), Some(true));
        assert_eq!(with_param(&shown, "times_read", |_, set| set.int(kOfxParamPropSecret)), Some(Some(1)));
    }
    assert_eq!(described.in_context(CONTEXTS[1]).clip_names(), CLIPS);
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[0]);
    let shown = described.in_context(CONTEXTS[0]);
    let options =
        with_param(&shown, "look", |_, set| set.texts(kOfxParamPropChoiceOption)).expect("a choice");
    for (label, name) in labels.iter().zip(&names) {
        let at = options.iter().position(|option| option == label).expect("it is shown");
        instance.edit("look", at as i32);
        let graph = graph_of(name);
        assert!(instance.render(layout, SIZE).packed() == wanted(&graph, layout), "{name}");
    }
    assert!(!instance.is_enabled("file") && !instance.is_enabled("reload"));
    host.no_faults();
}

pub fn tiles_are_supported_as_the_look_allows(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[0]);
    let is_of =
        |style: &str| LOOKS.iter().position(|look| look.preset().is_ok_and(|preset| preset.style == style));
    for (style, tiles) in [("cartoon", 1), ("coherent", 0), ("ink", 1)] {
        instance.edit("look", is_of(style).expect("a look of the style") as i32 + 1);
        assert_eq!(instance.effect.set.int(kOfxImageEffectPropSupportsTiles), Some(tiles), "{style}");
        let whole = instance.render(layout, SIZE);
        let part = [7, 3, 29, 20];
        let (status, tile) = instance.try_render(layout, SIZE, &Wanted::new(part));
        assert_eq!(status, kOfxStatOK);
        assert!(tile.crop(part).packed() == whole.crop(part).packed(), "{style}");
    }
    host.no_faults();
}

pub fn lengths_of_looks_are_those_of_apply(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let picture =
        Picture::packed_in(layout, LARGE[0], LARGE[1], &packed(&scene(LARGE[0], LARGE[1], true), &layout));
    let graph = graph_of(&LOOKS[0].name());
    let wanted = wanted_at_1080(&graph, &picture);
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[0]);
    let style = in_host(&host, binary, "org.isophote.cartoon", CONTEXTS[0]);
    instance.set("reference_height", 1080);
    style.edit("look", 1);
    for instance in [&instance, &style] {
        instance.connect("Source", picture.clone());
        assert!(instance.render(layout, LARGE).packed() == wanted);
    }
    // Lengths in pixels stay so.
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("pixels.json");
    let pixels = LOOKS[0].json.replace("\"relative\"", "\"pixels\"");
    assert_ne!(pixels, LOOKS[0].json);
    std::fs::write(&path, pixels).expect("it can be written");
    instance.edit("look", 0);
    OfFile { instance: &instance, host: &host }.choose(&path);
    let in_pixels = instance.render(layout, LARGE).packed();
    instance.edit("look", 1);
    instance.set("reference_height", 0);
    assert!(in_pixels != wanted && in_pixels == instance.render(layout, LARGE).packed());
    host.no_faults();
}

pub fn projects_are_told_of_files_and_clips_that_are_gone(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let described = Described::new(&host, binary.plugin(LOOK_EFFECT));
    let said = || host.inner.messages.lock().expect("messages").clone();
    let saved = [("look", Value::from(0)), ("file", c"/no/such/dusk.json".into())];
    let instance = described.saved_instance(CONTEXTS[1], &saved);
    assert!(said().len() == 1 && said()[0].contains("dusk.json is missing"), "{:?}", said());
    instance.edit("look", 1);
    assert!(said().is_empty(), "{:?}", said());
    // A look of a later release.
    instance.edit("look", 1000);
    assert!(said().len() == 1 && said()[0].contains("Update Isophote"), "{:?}", said());
    instance.edit("look", 0);
    // A graph that cannot do without a clip.
    let mut graph = Graph::new();
    let map = graph.add("map", "flow_map").expect("a node");
    let style = graph.add("style", "painting").expect("a style");
    graph.connect_input(GraphInput::Flow, map, "color").expect("a port");
    graph.connect_input(GraphInput::Color, style, "color").expect("a port");
    graph.connect(map, style, "tensor").expect("a port");
    graph.set_output(style).expect("an output");
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("painted.json");
    std::fs::write(&path, graph.to_json().expect("text")).expect("it can be written");
    OfFile { instance: &instance, host: &host }.choose(&path);
    assert!(said().len() == 1 && said()[0].contains("needs the clip Flow"), "{:?}", said());
    let layout = Layout::default();
    plain(&instance);
    instance.connect("Source", source(layout, false));
    let untouched = instance.render(layout, SIZE).packed();
    assert!(untouched == source(layout, false).packed());
    instance.connect("Flow", source(layout, true));
    assert!(instance.render(layout, SIZE).packed() != untouched);
    assert!(said().is_empty(), "{:?}", said());
    host.no_faults();
}

pub fn the_effect_for_looks_is_mixed_and_steadied(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let layout = Layout::default();
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[1]);
    let render = || values(&instance.render(layout, SIZE).packed(), &layout);
    let full = render();
    let plain = values(&source(layout, false).packed(), &layout);
    instance.edit("mix", 0.25);
    let quarter = render();
    for ((got, full), plain) in quarter.iter().zip(&full).zip(&plain) {
        assert!((got - (full * 0.25 + plain * 0.75)).abs() < 1e-6);
    }
    instance.edit("mix", 0.0);
    assert!(instance.is_identity());
    assert_eq!(render(), plain);
    // Steadiness is that of the style's own effect: its neighbours are asked for.
    instance.edit("mix", 1.0);
    assert!(!instance.is_identity() && instance.frames_needed(5.0).is_empty());
    instance.edit("steadiness", 0.5);
    let cartoon = in_host(&host, binary, "org.isophote.cartoon", CONTEXTS[1]);
    cartoon.edit("look", 1);
    cartoon.set("reference_height", 0);
    cartoon.edit("steadiness", 0.5);
    let [own, other] = [&instance, &cartoon].map(|instance| {
        instance.connect_film("Source", 4, vec![source(layout, false); 3]);
        let wanted = Wanted { time: 5.0, ..Wanted::new([0, 0, WIDTH, HEIGHT]) };
        let (status, picture) = instance.try_render(layout, SIZE, &wanted);
        assert_eq!(status, kOfxStatOK);
        let needed = instance.frames_needed(5.0).into_iter().find(|(clip, _)| clip == "Source");
        (needed.map(|(_, range)| range), picture.packed())
    });
    assert_eq!(own.0, Some(vec![4.0, 6.0]));
    assert!(own == other);
    host.no_faults();
}

/// A picture of the effect for looks with a file, and the message on it.
pub struct OfFile<'a> {
    pub instance: &'a Instance<'a>,
    pub host: &'a Host,
}

impl OfFile<'_> {
    pub fn choose(&self, path: &Path) {
        let path = CString::new(path.to_str().expect("a path")).expect("a text");
        self.instance.edit("file", path.as_c_str());
    }

    pub fn shows(&self, graph: Option<&Graph>, words: &str) {
        let layout = Layout::default();
        let wanted = graph.map_or_else(|| source(layout, false).packed(), |graph| wanted(graph, layout));
        // Twice, since messages are said once.
        for _ in 0..2 {
            assert!(self.instance.render(layout, SIZE).packed() == wanted, "{words}");
        }
        let messages = self.host.inner.messages.lock().expect("messages").clone();
        assert_eq!(messages.len(), usize::from(graph.is_none()), "{messages:?}");
        assert!(messages.iter().all(|message| message.contains(words)), "{messages:?}: {words}");
        assert!(!self.instance.is_identity(), "the fault would not be told");
    }
}
