//! Looks from files of the user's, in the effect that shows looks.

use super::looks::{CONTEXTS, LOOK_EFFECT, OfFile, in_host, wanted};
use super::reference::*;
use super::render::SIZE;
use isophote::Graph;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::Wanted;
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::Layout;
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::Value;
use isophote_tests::ofx::state::Behaviour;

pub fn files_are_shown_and_faults_of_theirs_told(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[1]);
    let of_file = OfFile { instance: &instance, host: &host };
    let folder = tempfile::TempDir::new().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("it can be written");
        path
    };
    instance.edit("look", 0);
    assert!(instance.is_enabled("file") && instance.is_enabled("reload"));
    of_file.shows(None, "Choose a preset or a graph");
    let mut graph = Graph::single("cartoon").expect("a style");
    let node = graph.node(0).expect("a node");
    graph.set_text(node, "posterize", "5").expect("it has that");
    // A preset, a graph, and a preset that names the graph beside it.
    let preset = file("dusk.json", r#"{"style": "cartoon", "parameters": {"posterize": 5}}"#);
    of_file.choose(&preset);
    of_file.shows(Some(&graph), "");
    of_file.choose(&file("graph.json", &graph.to_json().expect("text")));
    of_file.shows(Some(&graph), "");
    of_file.choose(&file("names.json", r#"{"style": "graph.json", "parameters": {"posterize": 6}}"#));
    let mut six = graph.clone();
    six.set_text(node, "posterize", "6").expect("it has that");
    of_file.shows(Some(&six), "");
    // Faults, each in the place of the one before.
    let newer = graph.to_json().expect("text").replace("\"version\": 1", "\"version\": 2");
    assert!(newer.contains("\"version\": 2"));
    for (name, text, words) in [
        ("newer.json", newer.as_str(), "update Isophote"),
        ("broken.json", "{\"style\": ", "is no JSON"),
        (
            "unknown.json",
            r#"{"style": "cartoon", "parameters": {"posterise": 5}}"#,
            "did you mean 'posterize'?",
        ),
        ("alone.json", r#"{"style": "no/graph.json"}"#, "graph.json is missing"),
        ("tensor.json", r#"{"style": "structure_tensor"}"#, "makes no picture"),
    ] {
        of_file.choose(&file(name, text));
        of_file.shows(None, words);
    }
    of_file.choose(&folder.path().join("at 100 %s.json"));
    of_file.shows(None, "at 100 %s.json is missing");
    of_file.choose(&preset);
    of_file.shows(Some(&graph), "");
    // Keyframes of a preset are followed.
    of_file
        .choose(&file("keys.json", r#"{"style": "cartoon", "parameters": {"posterize": {"1": 5, "3": 7}}}"#));
    of_file.shows(Some(&graph), "");
    let layout = Layout::default();
    let wanted_at = Wanted { time: 2.0, ..Wanted::new([0, 0, WIDTH, HEIGHT]) };
    let (status, picture) = instance.try_render(layout, SIZE, &wanted_at);
    assert!(status == kOfxStatOK && picture.packed() == wanted(&six, layout));
    let answer = instance.args();
    instance.act(kOfxImageEffectActionGetClipPreferences, None, Some(&answer));
    assert_eq!(answer.int(kOfxImageEffectFrameVarying), Some(1), "frames of a still differ");
    host.no_faults();
}

pub fn files_are_read_again_when_they_change_or_the_user_asks(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[0]);
    let of_file = OfFile { instance: &instance, host: &host };
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("dusk.json");
    let graph = |posterize: u32| {
        let mut graph = Graph::single("cartoon").expect("a style");
        let node = graph.node(0).expect("a node");
        graph.set_text(node, "posterize", &posterize.to_string()).expect("it has that");
        graph
    };
    let then = std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1_700_000_000);
    let write = |posterize: u32, time| {
        let text = format!(r#"{{"style": "cartoon", "parameters": {{"posterize": {posterize}}}}}"#);
        std::fs::write(&path, text).expect("it can be written");
        let file = std::fs::File::options().write(true).open(&path).expect("it can be opened");
        file.set_modified(time).expect("its time can be set");
    };
    write(4, then);
    instance.edit("look", 0);
    of_file.choose(&path);
    of_file.shows(Some(&graph(4)), "");
    // The same size and time: kept, until the user asks.
    write(6, then);
    of_file.shows(Some(&graph(4)), "");
    instance.touch("reload");
    assert_eq!(instance.get("times_read"), [Value::Int(1)], "the host renders anew");
    of_file.shows(Some(&graph(6)), "");
    // Another time: a change.
    write(8, then + std::time::Duration::from_secs(1));
    of_file.shows(Some(&graph(8)), "");
    std::fs::remove_file(&path).expect("it can be removed");
    of_file.shows(None, "is missing");
    instance.touch("reload");
    of_file.shows(None, "is missing");
    write(4, then);
    instance.touch("reload");
    of_file.shows(Some(&graph(4)), "");
    host.no_faults();
}
