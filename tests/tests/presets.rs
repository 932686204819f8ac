//! Presets: the Rust library and the C face read them alike, by the table that the program, Python and the page read, too.

use isophote::graph::GraphInput;
use isophote::preset;
use isophote_loader::{Library, StyleText};
use isophote_tests::library;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// A preset with what comes of it.
struct Case {
    why: String,
    json: String,
    frame: i64,
    /// Parameters that are not defaults by the names of the nodes, or words of the message.
    wanted: Result<BTreeMap<String, Value>, String>,
}

fn cases() -> Vec<Case> {
    let text =
        fs::read_to_string(library::root().join("tests/data/presets.json")).expect("the table is there");
    let table: Vec<Value> = serde_json::from_str(&text).expect("it is a list");
    let case = |entry: Value| Case {
        why: entry["why"].as_str().expect("it says why").to_owned(),
        json: entry["preset"].to_string(),
        frame: entry["frame"].as_i64().unwrap_or_default(),
        wanted: match entry["error"].as_str() {
            Some(words) => Err(words.to_owned()),
            None => Ok(by_node(entry["values"].as_object().expect("values or an error"))),
        },
    };
    table.into_iter().map(case).collect()
}

fn by_node(object: &serde_json::Map<String, Value>) -> BTreeMap<String, Value> {
    object.iter().map(|(name, params)| (name.clone(), params.clone())).collect()
}

/// Parameters of a graph that are not defaults.
fn values(graph: &str) -> BTreeMap<String, Value> {
    let graph: Value = serde_json::from_str(graph).expect("a graph is JSON");
    let nodes = graph["nodes"].as_array().expect("it has nodes").iter();
    let params =
        nodes.map(|node| (node["name"].as_str().unwrap_or_default().to_owned(), node["params"].clone()));
    params.filter(|(_, params)| !params.is_null()).collect()
}

fn compare(case: &Case, face: &str, found: Result<BTreeMap<String, Value>, String>) {
    match (&case.wanted, found) {
        (Ok(wanted), found) => assert_eq!(found.as_ref(), Ok(wanted), "{face}: {}", case.why),
        (Err(words), Err(message)) => assert!(message.contains(words), "{face}: {}: {message}", case.why),
        (Err(words), Ok(found)) => panic!("{face}: {}: {found:?} instead of '{words}'", case.why),
    }
}

#[test]
fn the_library_and_the_c_face_read_the_same() {
    let library = Library::from_file(library::path()).expect("the library");
    for case in &cases() {
        let in_rust = || {
            let (mut graph, settings) = preset::open_json("p.json", &case.json, None)?;
            settings.at_frame(&mut graph, case.frame)?;
            graph.to_json()
        };
        let in_rust = in_rust().map(|graph| values(&graph)).map_err(|error| error.to_string());
        let in_c = || {
            let style = library.style_from_json("p.json", &case.json, None)?;
            let graph = style.graph()?;
            style.at_frame(graph.handle(), case.frame)?;
            graph.to_json()
        };
        let in_c = in_c().map(|graph| values(&graph)).map_err(|error| error.to_string());
        if let (Err(a), Err(b)) = (&in_rust, &in_c) {
            assert_eq!(a, b, "{}", case.why);
        }
        compare(case, "library", in_rust);
        compare(case, "C face", in_c);
        // All faults are found at once, and the first of them is the message.
        let faults = library.check_preset("p.json", &case.json, None).expect("it can be checked");
        assert_eq!(faults.is_empty(), case.wanted.is_ok(), "{}: {faults:?}", case.why);
    }
}

#[test]
fn presets_are_read_and_written_by_the_c_face() {
    let library = Library::from_file(library::path()).expect("the library");
    for look in library.looks().expect("the looks") {
        let read = library.read_style(&look.name(), look.json).expect("it can be read");
        let StyleText::Preset(preset, faults) = read else { panic!("{} is a graph", look.id) };
        assert_eq!(faults, [], "{}", look.id);
        assert_eq!(library.write_preset(&preset).expect("it can be written"), look.json);
        assert_eq!(library.style(&look.name()).expect("it opens").reference_height(), 1080);
    }
    let graph = r#"{"format": "isophote-graph"}"#;
    assert_eq!(library.read_style("g.json", graph).expect("it can be told"), StyleText::Graph);
    let shipped: Vec<&str> = library.looks().expect("the looks").iter().map(|look| look.id).collect();
    assert_eq!(shipped, preset::LOOKS.iter().map(|look| look.id).collect::<Vec<_>>());
}

#[test]
fn a_style_follows_its_keys_until_a_parameter_is_set() {
    let library = Library::from_file(library::path()).expect("the library");
    let json = r#"{"style": "cartoon", "lengths": "pixels", "parameters": {"posterize": {"7": 4, "9": 8}, "sigma_d": {"8": 2}}}"#;
    let style = library.style_from_json("p.json", json, None).expect("it opens");
    let graph = style.graph().expect("a graph");
    let posterize = || values(&graph.to_json().expect("it is whole"))["cartoon"]["posterize"].clone();
    assert_eq!((style.reference_height(), style.frames()), (0, vec![7, 8, 9]));
    assert_eq!(style.value("posterize", 8).as_deref(), Some("6"));
    assert_eq!(style.value("detail", 8), None);
    assert!(style.at_frame(graph.handle(), 8).expect("it follows") && posterize() == 6);
    assert_eq!(style.set(graph.handle(), "posterize", "5").ok(), Some(0));
    style.at_frame(graph.handle(), 9).expect("it follows");
    assert_eq!((posterize(), style.frames()), (5.into(), vec![8]));
    let error =
        style.set(graph.handle(), "posterise", "5").expect_err("it has no such parameter").to_string();
    assert!(error.contains("did you mean 'posterize'?"), "{error}");
}

#[test]
fn the_c_face_lists_every_guide() {
    let library = Library::from_file(library::path()).expect("the library");
    let guides = library.guides().expect("the guides");
    assert_eq!(
        guides.iter().map(|guide| guide.id).collect::<Vec<_>>(),
        GraphInput::GUIDES.map(GraphInput::id)
    );
    for (guide, input) in guides.iter().zip(GraphInput::GUIDES) {
        assert_eq!((guide.channels, guide.label), (input.kind().channels(), input.label()));
    }
    let all =
        library.guide_bits(guides.iter().map(|guide| guide.id).chain(["color"])).expect("all are known");
    assert_eq!(all, (1 << guides.len()) - 1);
    let unknown = library.guide_bits(["normals"]).expect_err("there is none").to_string();
    assert!(unknown.contains("normal, depth"), "{unknown}");
}

#[test]
fn colours_are_those_of_the_library() {
    let library = Library::from_file(library::path()).expect("the library");
    assert_eq!(library.color("#ff000033").ok(), Some([1.0, 0.0, 0.0, 0.2]));
    let error = library.color("red").expect_err("it is a word").to_string();
    assert!(error.contains("'red'") && error.contains("#12407b"), "{error}");
}
