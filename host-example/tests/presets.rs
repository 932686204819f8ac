//! Presets: saving, showing and checking them, and styles that change from frame to frame.

mod support;

use std::fs;
use std::path::Path;

use support::{cube, fails, folder, isophote, listing, picture, succeeds};

fn preset(folder: &Path, arguments: &[&str]) -> String {
    succeeds(isophote().current_dir(folder).arg("preset").args(arguments)).0
}

#[test]
fn a_saved_preset_gives_what_its_settings_give() {
    let folder = folder();
    let run = |arguments: &[&str]| succeeds(isophote().current_dir(folder.path()).args(arguments));
    picture(48, 32).save(folder.path().join("in.png")).expect("the picture can be written");
    preset(
        folder.path(),
        &["save", "cartoon", "a.json", "--set", "posterize=3", "--set", "line_color=#aa2200"],
    );
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
    let keys = r##"{"style": "gaussian", "parameters": {"sigma": {"1": 0, "3": 8}}}"##;
    fs::write(folder.path().join("keys.json"), keys).expect("a file can be written");
    let shown = preset(folder.path(), &["show", "keys.json", "--frame", "2"]);
    assert!(shown.contains("sigma = 4"), "{shown}");
    let render = |style: &str, out: &str, more: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).arg("render").arg(&scene).arg(out);
        succeeds(command.args(["--size", "64x48", "--style", style]).args(more));
    };
    render("keys.json", "keyed.####.png", &["--frames", "3"]);
    render("gaussian", "two.png", &["--set", "sigma=4"]);
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
