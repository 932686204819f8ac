//! The example beside the program: its frames are those of `isophote render`, and its window shows them.

use std::path::Path;
use std::process::Command;

use crate::support::{self, cube, fails, folder, isophote, library, listing, succeeds};

/// The example, which is built beside the program and finds the library.
fn example() -> Command {
    let program = Path::new(env!("CARGO_BIN_EXE_isophote"));
    let file = program.with_file_name(format!("isophote-example{}", std::env::consts::EXE_SUFFIX));
    assert!(file.is_file(), "{} is not built; run `cargo build --workspace`", file.display());
    let mut command = Command::new(file);
    command.env("ISOPHOTE_LIBRARY", library());
    command
}

#[test]
fn frames_are_those_of_the_program() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let scene = cube(folder.path());
    let graph = support::root().join("host-example/graphs/poster.json");
    for style in ["none", "cartoon", "edge_detector", graph.to_str().expect("a path of text")] {
        let frames = at("frames");
        let options = ["--style", style, "--size", "96x64"];
        succeeds(example().arg(&scene).args(options).arg("--frames").arg(&frames));
        assert_eq!(listing(&frames), ["frame.0001.png"], "{style}");
        // The example stylizes on the device; on the processor the last bit of a colour may be another.
        let render = ["--force", "--backend", "gpu"];
        succeeds(isophote().arg("render").arg(&scene).arg(at("frame.png")).args(options).args(render));
        let read = |file: &Path| image::open(file).expect("a picture").into_rgba8();
        assert!(read(&frames.join("frame.0001.png")) == read(&at("frame.png")), "{style}");
    }
    // Of several the camera goes around the scene, and a style that is steady looks at the frames before.
    let inputs = r#"{"color": "@color", "normal": "@normal", "depth": "@depth", "object_id": "@object_id", "motion": "@motion"}"#;
    let node =
        format!(r#"{{"name": "c", "node": "cartoon", "params": {{"steadiness": 0.6}}, "inputs": {inputs}}}"#);
    let steady = format!(r#"{{"format": "isophote-graph", "version": 1, "nodes": [{node}], "output": "c"}}"#);
    std::fs::write(at("steady.json"), steady).expect("the folder is writable");
    let options = [std::ffi::OsStr::new("--style"), at("steady.json").as_os_str()].map(ToOwned::to_owned);
    let size = ["--size", "96x64"];
    succeeds(
        example().arg(&scene).args(&options).args(size).args(["--count", "3", "--frames"]).arg(at("turn")),
    );
    let pattern = at("whole").join("frame.####.png");
    std::fs::create_dir(at("whole")).expect("the folder is writable");
    let turning = ["--turntable", "--frames", "3", "--backend", "gpu"];
    succeeds(isophote().arg("render").arg(&scene).arg(&pattern).args(&options).args(size).args(turning));
    for name in ["frame.0001.png", "frame.0002.png", "frame.0003.png"] {
        let bytes = |place: &str| std::fs::read(at(place).join(name)).expect("a frame");
        assert!(bytes("turn") == bytes("whole"), "{name}");
        assert!(
            name.ends_with("1.png")
                || bytes("turn") != std::fs::read(at("turn/frame.0001.png")).expect("a frame")
        );
    }
}

#[test]
fn bad_input_says_what_is_wrong() {
    let folder = folder();
    let scene = cube(folder.path());
    let with = |style: &str| {
        let mut command = example();
        command
            .arg(&scene)
            .args(["--size", "32x32", "--style", style, "--frames"])
            .arg(folder.path().join("out"));
        command
    };
    fails(&mut with("cartoom"), 2, &["cartoom", "cartoon"]);
    fails(&mut with("structure_tensor"), 2, &["structure_tensor", "is no picture"]);
    fails(&mut with("missing.json"), 2, &["missing.json", "cannot be read"]);
    std::fs::write(folder.path().join("file"), "").expect("the folder is writable");
    let mut command = example();
    fails(
        command.arg(&scene).arg("--frames").arg(folder.path().join("file")),
        2,
        &["file", "cannot be made"],
    );
    let mut command = example();
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    if cfg!(target_os = "linux") {
        fails(command.arg(&scene), 1, &["no window can be opened", "--frames DIR"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_window_shows_the_scene_and_goes_around_it() {
    use crate::support::window::{Display, Window};

    let Some(display) = Display::open("320x240") else { return };
    let folder = folder();
    let scene = cube(folder.path());
    let mut command = example();
    command.arg(&scene).args(["--style", "cartoon", "--size", "160x120"]);
    let mut window = Window::open(&display, &mut command);
    assert_eq!(window.title(), "Isophote - cartoon");
    let all = [0, 0, 160, 120];
    let frames = folder.path().join("frames");
    let options = ["--style", "cartoon", "--size", "160x120", "--frames"];
    succeeds(example().arg(&scene).args(options).arg(&frames));
    let frame = image::open(frames.join("frame.0001.png")).expect("a frame").into_rgb8();
    let screen = display.folder().to_owned();
    window.wait_for("the frame that is written without a window", |_| {
        let seen = support::window::screen(&screen, all);
        // Of a pixel of the screen blue comes first.
        let differs =
            |(seen, frame): (&[u8; 4], &image::Rgb<u8>)| (0..3).any(|c| seen[2 - c].abs_diff(frame[c]) > 2);
        !seen.as_chunks::<4>().0.iter().zip(frame.pixels()).any(differs)
    });
    let before = window.settled(all);
    window.drag([80, 60], [40, 50]);
    window.changes("the cube from another side", all, &before);
    let turned = window.settled(all);
    window.resize(200, 150);
    window.changes("a larger cube", all, &turned);
    assert!(window.said().is_empty(), "{}", window.said());
}
