//! Presets: saving, showing and checking them, and styles that change from frame to frame.

use std::fs;
use std::path::Path;

use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;
use serde_json::Value;

use crate::support::{self, cube, fails, folder, isophote, listing, picture, succeeds};

fn preset(folder: &Path, arguments: &[&str]) -> String {
    succeeds(isophote().current_dir(folder).arg("preset").args(arguments)).0
}

#[test]
fn a_saved_preset_gives_what_its_settings_give() {
    let folder = folder();
    let run = |arguments: &[&str]| succeeds(isophote().current_dir(folder.path()).args(arguments));
    picture(48, 32).save(folder.path().join("in.png")).expect("the picture can be written");
    let said = preset(
        folder.path(),
        &["save", "cartoon", "a.json", "--set", "posterize=3", "--set", "line_color=#aa2200"],
    );
    assert_eq!(said, "a.json: cartoon with 2 parameters\n");
    assert_eq!(preset(folder.path(), &["save", "cartoon", "quiet.json", "--quiet"]), "");
    // A preset is the start of another, and everything may be written out.
    preset(folder.path(), &["save", "a.json", "b.json", "--all", "--set", "sigma_d=2"]);
    run(&["apply", "b.json", "in.png", "by_preset.png", "--backend", "cpu"]);
    let settings = ["--set", "posterize=3", "--set", "line_color=#aa2200", "--set", "sigma_d=2"];
    run(&[&["apply", "cartoon", "in.png", "by_hand.png", "--backend", "cpu"], &settings[..]].concat());
    run(&["apply", "cartoon", "in.png", "plain.png", "--backend", "cpu"]);
    let read = |name: &str| fs::read(folder.path().join(name)).expect("a picture was written");
    assert_eq!(read("by_preset.png"), read("by_hand.png"));
    assert_ne!(read("by_preset.png"), read("plain.png"));
    // What is set on the command line comes last.
    run(&["apply", "b.json", "in.png", "over.png", "--backend", "cpu", "--set", "posterize=9"]);
    assert_ne!(read("over.png"), read("by_hand.png"));

    let shown = preset(folder.path(), &["show", "a.json"]);
    assert!(shown.starts_with("cartoon\n") && shown.contains("line_color = #aa2200"), "{shown}");
    assert!(
        preset(folder.path(), &["check", "a.json", "b.json"]).contains("a.json: cartoon with 2 parameters")
    );
    let mut again = isophote();
    again.current_dir(folder.path()).args(["preset", "save", "ink", "a.json"]);
    fails(&mut again, 2, &["a.json", "--force"]);
    assert!(shown == preset(folder.path(), &["show", "a.json"]), "a preset was replaced");
}

#[test]
fn graphs_are_named_from_where_the_preset_is() {
    let folder = folder();
    fs::create_dir(folder.path().join("looks")).expect("a folder can be made");
    let graph = r#"{"format": "isophote-graph", "version": 1, "output": "soft",
        "nodes": [{"name": "soft", "node": "gaussian", "inputs": {"color": "@color"}}]}"#;
    fs::write(folder.path().join("looks/soft.json"), graph).expect("a file can be written");
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    preset(folder.path(), &["save", "looks/soft.json", "looks/softer.json", "--set", "soft.sigma=4"]);
    assert!(preset(folder.path(), &["show", "looks/softer.json"]).starts_with("soft.json\n"));
    succeeds(isophote().current_dir(folder.path()).args(["apply", "looks/softer.json", "in.png", "out.png"]));
}

#[test]
fn keyframes_change_a_style_from_frame_to_frame() {
    let folder = folder();
    let scene = cube(folder.path());
    let keys = r##"{"style": "gaussian", "lengths": "pixels", "parameters": {"sigma": {"1": 0, "3": 8}}}"##;
    fs::write(folder.path().join("keys.json"), keys).expect("a file can be written");
    let shown = preset(folder.path(), &["show", "keys.json", "--frame", "2"]);
    assert!(shown.contains("sigma = 4"), "{shown}");
    let render = |style: &str, out: &str, more: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).arg("render").arg(&scene).arg(out);
        succeeds(command.args(["--size", "64x48", "--style", style]).args(more));
    };
    render("keys.json", "keyed.####.png", &["--frames", "3"]);
    render("gaussian", "two.png", &["--set", "sigma=4", "--lengths", "pixels"]);
    let read = |name: &str| image::open(folder.path().join(name)).expect("a picture was written").to_rgb8();
    let [first, second, third] = ["keyed.0001.png", "keyed.0002.png", "keyed.0003.png"].map(read);
    assert_eq!(second, read("two.png"));
    assert!(first != second && second != third, "the frames are alike");
}

#[test]
fn presets_that_cannot_be_used_say_why() {
    let folder = folder();
    for (text, words) in [
        (r#"{"styl": "ink"}"#, &["bad.json", "'styl'", "'style'"][..]),
        (r#"{"style": "cartoo"}"#, &["bad.json", "cartoo", "cartoon"]),
        (r#"{"style": "ink", "parameters": {"tonee": 1}}"#, &["bad.json", "'tonee'", "'tone'"]),
        (r#"{"style": "ink", "parameters": {"tone": 7}}"#, &["bad.json", "tone", "7"]),
        (r#"{"style": "ink", "parameters": {"tone": {"1": 0, "9": 7}}}"#, &["bad.json", "frame 9", "7"]),
        (
            r#"{"style": "ink", "parameters": {"cover": {"1": false, "between": "linear"}}}"#,
            &["cover", "step"],
        ),
        (r#"{"style": "bad.json"}"#, &["bad.json", "no graph"]),
    ] {
        fs::write(folder.path().join("bad.json"), text).expect("a file can be written");
        for verb in [&["preset", "show", "bad.json"][..], &["apply", "bad.json", "in.png", "out.png"]] {
            let mut command = isophote();
            command.current_dir(folder.path()).args(verb);
            fails(&mut command, 2, words);
        }
        let output = isophote().current_dir(folder.path()).args(["preset", "check", "bad.json"]).output();
        let output = output.expect("the program starts");
        assert!(output.status.code() == Some(2) && support::errors(&output).contains("1 of 1"));
    }
    assert_eq!(listing(folder.path()), ["bad.json"]);
}

#[test]
fn every_fault_of_a_preset_is_named_at_once() {
    let folder = folder();
    let text = r##"{"styl": "x", "look": 1, "style": "ink", "parameters": {"tonee": 1, "tone": 7, "grain": null,
        "cover": {"1": false, "between": "linear"}, "a": {"x": 1, "2": [], "3": 0, "03": 1},
        "line_color": {"1": "red", "5": "#ffffff", "9": "#ggg"}}}"##;
    fs::write(folder.path().join("bad.json"), text).expect("a file can be written");
    fs::write(folder.path().join("worse.json"), r#"{"parameters": {"a": {}, "b": {"1": {}}}}"#)
        .expect("as above");
    let mut command = isophote();
    command.current_dir(folder.path()).args(["preset", "check", "bad.json", "worse.json"]);
    let output = command.output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    let said = support::errors(&output);
    let lines: Vec<&str> = said.lines().collect();
    let wanted = [
        "unknown key 'styl'",
        "unknown key 'look'",
        "'grain': cannot be null",
        "'a': 'x' is no number of a frame",
        "'a' at frame 2: cannot be []",
        "'a': has frame 3 twice",
        "'tonee'",
        "'tone'",
        "'cover': cannot change evenly",
        "'line_color' at frame 1",
        "'line_color' at frame 9",
        "worse.json: names no style",
        "'a': has no keyframe",
        "'b' at frame 1: cannot be {}",
        "2 of 2 cannot be used",
    ];
    assert_eq!(lines.len(), wanted.len(), "{said}");
    for (line, words) in lines.iter().zip(wanted) {
        assert!(line.starts_with("error: ") && line.contains(words), "'{line}' does not say {words}");
    }
}

#[test]
fn keyframes_beyond_the_frames_are_warned_of() {
    let folder = folder();
    let scene = cube(folder.path());
    for frame in 3..=5 {
        picture(24, 16).save(folder.path().join(format!("in.{frame:04}.png"))).expect("as below");
    }
    let keys = r##"{"style": "gaussian", "parameters": {"sigma": {"1": 0, "4": 8, "9": 1}}}"##;
    fs::write(folder.path().join("keys.json"), keys).expect("a file can be written");
    let mut render = isophote();
    render.current_dir(folder.path()).arg("render").arg(&scene);
    render.args(["out.####.png", "--size", "64x48", "--style", "keys.json", "--frames"]);
    let mut apply = isophote();
    apply.current_dir(folder.path()).args(["apply", "keys.json", "in.####.png", "out.####.png", "--force"]);
    for (said, warning) in [
        (succeeds(render.arg("2-4")).1, "keys.json: the keyframes 1,9 are outside the frames 2 to 4"),
        (succeeds(&mut apply).1, "keys.json: the keyframes 1,9 are outside the frames 3 to 5"),
        (succeeds(apply.args(["--set", "sigma=2"])).1, ""),
    ] {
        let warnings: Vec<&str> = said.lines().filter(|line| line.starts_with("warning: ")).collect();
        match warning {
            "" => assert!(warnings.is_empty(), "{said}"),
            _ => assert!(warnings.len() == 1 && warnings[0].contains(warning), "{said}"),
        }
    }
}

#[test]
fn a_title_is_written_kept_and_shown() {
    let folder = folder();
    let title = ["--name", "Dusk", "--about", "Soft violet lines.", "--tag", "soft", "--tag", "evening"];
    preset(folder.path(), &[&["save", "cartoon", "a.json", "--set", "posterize=3"], &title[..]].concat());
    let shown = preset(folder.path(), &["show", "a.json"]);
    assert_eq!(shown, "Dusk\nSoft violet lines.\ntags: soft, evening\ncartoon\n  posterize = 3\n");
    // What is not said anew is kept.
    preset(folder.path(), &["save", "a.json", "b.json", "--name", "Dawn", "--set", "posterize=5"]);
    let shown = preset(folder.path(), &["show", "b.json"]);
    assert_eq!(shown, "Dawn\nSoft violet lines.\ntags: soft, evening\ncartoon\n  posterize = 5\n");
    for wrong in [["--name", ""], ["--about", "two\nlines"], ["--tag", " "]] {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["preset", "save", "ink", "c.json"]).args(wrong);
        fails(&mut command, 2, &[wrong[0], "on one line"]);
    }
    assert_eq!(listing(folder.path()), ["a.json", "b.json"]);
}

#[test]
fn presets_are_read_as_by_the_other_faces() {
    let folder = folder();
    let library = Library::from_file(support::library()).expect("the library");
    let table =
        fs::read_to_string(support::root().join("tests/data/presets.json")).expect("the table is there");
    let table: Vec<Value> = serde_json::from_str(&table).expect("it is a list");
    let file = folder.path().join("preset.json");
    for case in &table {
        fs::write(&file, case["preset"].to_string()).expect("a file can be written");
        let why = &case["why"];
        let opened = Style::any(&library, &file, &[]).and_then(|style| {
            style.at_frame(case["frame"].as_i64().unwrap_or_default())?;
            Ok(style.graph.to_json().expect("the graph is whole"))
        });
        let mut check = isophote();
        check.args(["preset", "check"]).arg(&file);
        if let Some(words) = case["error"].as_str() {
            let error = opened.expect_err("it cannot be used").to_string();
            assert!(error.contains(words), "{why}: {error}");
            let output = check.output().expect("the program starts");
            assert_eq!(output.status.code(), Some(2), "{why}");
            assert!(support::errors(&output).contains(words), "{why}");
            continue;
        }
        succeeds(&mut check);
        let graph: Value = serde_json::from_str(&opened.expect("it can be used")).expect("a graph is JSON");
        let nodes = graph["nodes"].as_array().expect("it has nodes").iter();
        let values: serde_json::Map<String, Value> = nodes
            .filter(|node| node["params"].is_object())
            .map(|node| (node["name"].as_str().unwrap_or_default().to_owned(), node["params"].clone()))
            .collect();
        assert_eq!(Value::Object(values), case["values"], "{why}");
    }
}
