//! `isophote view` in a real window, on a display without a screen: frames of each style, a resize,
//! a clean end.

mod support;

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const STYLES: [&str; 3] = ["none", "cartoon", "blueprint"];
const FRAMES: u32 = 10;
/// Software rendering on a busy machine takes its time; this only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(300);

/// A child that does not outlive its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Xvfb on a display that it chooses itself, whose screen is a file in `folder`. It does not reset: it would whenever its only
/// client leaves, as each call of xdotool does, and turn down whoever connects in that moment.
fn display(folder: &Path) -> Option<(Running, String)> {
    let mut server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp", "-noreset", "-fbdir"])
        .arg(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    let mut number = String::new();
    BufReader::new(server.stdout.take()?).read_line(&mut number).ok()?;
    let display = format!(":{}", number.trim());
    xdotool(&display, &["version"])?;
    Some((Running(server), display))
}

/// Whether the test cannot be made here; on machines that test, it must be.
fn skipped() {
    assert!(std::env::var_os("CI").is_none(), "Xvfb and xdotool are needed: apt install xvfb xdotool");
    eprintln!("SKIPPED: no Xvfb or xdotool");
}

/// A part of the screen, from the file that Xvfb keeps it in (XWD).
fn screen(folder: &Path, [left, top, right, bottom]: [usize; 4]) -> Vec<u8> {
    let file = std::fs::read(folder.join("Xvfb_screen0")).unwrap();
    let number = |at: usize| u32::from_be_bytes(file[4 * at..][..4].try_into().unwrap()) as usize;
    let (header, row, colors) = (number(0), number(12), number(19));
    let pixels = &file[header + 12 * colors..];
    (top..bottom).flat_map(|y| pixels[y * row + 4 * left..y * row + 4 * right].iter().copied()).collect()
}

fn xdotool(display: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new("xdotool").env("DISPLAY", display).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// A triangle that turns for ever.
fn turning_triangle(folder: &Path) -> PathBuf {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let values: [f32; 24] = [
        -1.0, -0.6, 0.0, 1.0, -0.6, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 1.0, 2.0, // times
        0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half, 0.0, 1.0, 0.0, 0.0, // rotations
    ];
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(folder.join("triangle.bin"), &bytes).unwrap();
    let json = r#"{
      "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
      "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
      "materials": [{ "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [0.8, 0.3, 0.1, 1] } }],
      "animations": [{ "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }],
                       "samplers": [{ "input": 1, "output": 2 }] }],
      "buffers": [{ "uri": "triangle.bin", "byteLength": 96 }],
      "bufferViews": [{ "buffer": 0, "byteOffset": 0, "byteLength": 36 },
                      { "buffer": 0, "byteOffset": 36, "byteLength": 12 },
                      { "buffer": 0, "byteOffset": 48, "byteLength": 48 }],
      "accessors": [
        { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -0.6, 0], "max": [1, 1, 0] },
        { "bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR", "min": [0], "max": [2] },
        { "bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4" }]
    }"#;
    let path = folder.join("triangle.gltf");
    std::fs::write(&path, json).unwrap();
    path
}

/// Style, and frames since the last switch or resize, that a title tells.
fn shown(title: &str) -> Option<(String, u32)> {
    let mut parts = title.split(" - ");
    let (_, style, frame) = (parts.next()?, parts.next()?, parts.next()?);
    Some((style.to_owned(), frame.strip_prefix("frame ")?.parse().ok()?))
}

#[test]
fn a_window_shows_every_style_resizes_and_closes() {
    let folder = tempfile::tempdir().unwrap();
    let Some((_server, display)) = display(folder.path()) else { return skipped() };
    let scene = turning_triangle(folder.path());
    let mut command = support::isophote();
    command
        .env("DISPLAY", &display)
        .env("ISOPHOTE_SETTINGS", folder.path().join("view.json"))
        .env_remove("WAYLAND_DISPLAY")
        .args(["view", "--size", "200x120", "--report"]);
    command.arg(&scene).args(STYLES.iter().flat_map(|s| ["--style", s]));
    let mut viewer = Running(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());

    let started = Instant::now();
    let mut wait_for = |what: &str, done: &dyn Fn() -> bool| {
        while !done() {
            assert!(started.elapsed() < PATIENCE, "waited too long for {what}");
            if let Some(status) = viewer.0.try_wait().unwrap() {
                panic!(
                    "the viewer ended ({status}) before {what}: {}",
                    text(viewer.0.stderr.as_mut().unwrap())
                );
            }
            std::thread::sleep(Duration::from_millis(100));
        }
    };
    let window = || xdotool(&display, &["search", "--name", "triangle.gltf"]).filter(|w| !w.is_empty());
    wait_for("a window", &|| window().is_some());
    let id = window().unwrap();
    let title = || xdotool(&display, &["getwindowname", &id]).unwrap_or_default();
    let key = |key: &str| xdotool(&display, &["windowfocus", "--sync", &id, "key", key]);
    for (number, style) in STYLES.iter().enumerate() {
        wait_for("focus", &|| key(&format!("{}", number + 1)).is_some());
        let enough = || shown(&title()).is_some_and(|(s, n)| s == *style && n >= FRAMES);
        wait_for(&format!("{FRAMES} frames of {style}"), &enough);
    }
    wait_for("the resize", &|| xdotool(&display, &["windowsize", "--sync", &id, "300", "180"]).is_some());
    std::thread::sleep(Duration::from_secs(1));
    wait_for("frames of the new size", &|| shown(&title()).is_some_and(|(_, n)| n >= FRAMES));
    let _ = key("q");
    while viewer.0.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < PATIENCE, "the viewer does not close");
        std::thread::sleep(Duration::from_millis(100));
    }
    let status = viewer.0.wait().unwrap();
    let report = text(viewer.0.stdout.as_mut().unwrap());
    let errors = text(viewer.0.stderr.as_mut().unwrap());
    assert!(status.success(), "{status}: {errors}");
    for style in STYLES {
        assert!(report.contains(&format!("{style} 200x120: ")), "{report}");
    }
    assert!(report.contains("blueprint 300x180: "), "{report}");
    assert!(!errors.contains("error:") && !errors.contains("warning:"), "{errors}");
}

/// The canvas of a window of 700x420 pixels, above what is said at its lower border.
const CANVAS: [usize; 4] = [0, 60, 350, 300];
/// Its left half, without the line of the wipe.
const LEFT: [usize; 4] = [0, 80, 160, 300];
/// Far along the first slider of its panel.
const SLIDER: [&str; 2] = ["590", "146"];
/// Where the pointer shows nothing.
const ASIDE: [&str; 2] = ["320", "408"];

#[test]
fn a_slider_is_moved_and_taken_back_and_a_wipe_shows_the_original() {
    let folder = tempfile::tempdir().unwrap();
    let Some((_server, display)) = display(folder.path()) else { return skipped() };
    let scene = support::cube(folder.path());
    let settings = folder.path().join("view.json");
    std::fs::write(&settings, "{ no settings").unwrap();
    let mut command = support::isophote();
    command.env("DISPLAY", &display).env("ISOPHOTE_SETTINGS", &settings).env_remove("WAYLAND_DISPLAY");
    command.args(["view", "--size", "700x420", "--style", "none", "--style", "blueprint"]).arg(&scene);
    let mut viewer = Running(command.stderr(Stdio::piped()).spawn().unwrap());
    let started = Instant::now();
    let mut wait_for = |what: &str, done: &mut dyn FnMut() -> bool| {
        while !done() {
            assert!(started.elapsed() < PATIENCE, "waited too long for {what}");
            assert!(viewer.0.try_wait().unwrap().is_none(), "the window was closed before {what}");
            std::thread::sleep(Duration::from_millis(100));
        }
    };
    let window = || xdotool(&display, &["search", "--name", "cube.gltf"]).filter(|w| !w.is_empty());
    wait_for("a window", &mut || window().is_some());
    let id = window().unwrap();
    let see = || screen(folder.path(), CANVAS);
    let press = |key: &str| xdotool(&display, &["windowfocus", "--sync", &id, "key", key]).is_some();
    let point = |[x, y]: [&str; 2], then: &[&str]| {
        xdotool(&display, &[&["mousemove", "--window", &id, x, y], then].concat()).is_some()
    };
    let title = || xdotool(&display, &["getwindowname", &id]).unwrap_or_default();
    wait_for("the pointer", &mut || point(ASIDE, &[]));
    wait_for("the original", &mut || shown(&title()).is_some_and(|(style, _)| style == "none"));
    let original = settled(&|| screen(folder.path(), LEFT), Duration::from_secs(3));
    let before = see();
    wait_for("a key", &mut || press("2"));
    wait_for("blueprint", &mut || see() != before && is_blue(&see()));
    let blueprint = settled(&see, Duration::from_secs(3));
    wait_for("the slider", &mut || point(SLIDER, &["sleep", "0.1", "click", "1"]) && point(ASIDE, &[]));
    wait_for("wider lines", &mut || see() != blueprint && is_blue(&see()));
    wait_for("undo", &mut || press("ctrl+z"));
    wait_for("the lines of before", &mut || see() == blueprint);
    wait_for("a wipe", &mut || press("w"));
    wait_for("the original beside the look", &mut || screen(folder.path(), LEFT) == original);
    wait_for("the end of the wipe", &mut || press("w"));
    wait_for("the look alone", &mut || see() == blueprint);
    assert!(press("q"));
    while viewer.0.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < PATIENCE, "the window does not close");
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(viewer.0.wait().unwrap().success());
    let warnings = text(viewer.0.stderr.as_mut().unwrap());
    assert!(warnings.contains("warning:") && warnings.contains("is not usable"), "{warnings}");
    let remembered = std::fs::read_to_string(settings).unwrap();
    assert!(remembered.contains("cube.gltf") && remembered.contains("blueprint"), "{remembered}");
}

/// Within the picture of the first card of the browser in a window of 700x420 pixels.
const CARD: [usize; 4] = [50, 215, 190, 285];
/// The canvas without what is said at its lower border.
const WHOLE: [usize; 4] = [10, 60, 340, 280];

#[test]
fn a_look_is_taken_from_the_grid_where_it_was_seen_on_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let Some((_server, display)) = display(folder.path()) else { return skipped() };
    let looks = folder.path().join("looks");
    std::fs::create_dir(&looks).unwrap();
    std::fs::write(looks.join("plan.json"), r#"{"style": "blueprint", "lengths": "pixels"}"#).unwrap();
    let settings = folder.path().join("view.json");
    std::fs::write(&settings, format!(r#"{{"look_folders": [{looks:?}]}}"#)).unwrap();
    let photo = folder.path().join("photo.png");
    support::picture(240, 160).save(&photo).unwrap();
    let mut command = support::isophote();
    command.env("DISPLAY", &display).env("ISOPHOTE_SETTINGS", &settings).env_remove("WAYLAND_DISPLAY");
    command.args(["view", "--size", "700x420", "--style", "none"]).arg(&photo);
    let mut viewer = Running(command.stderr(Stdio::piped()).spawn().unwrap());
    let started = Instant::now();
    let mut wait_for = |what: &str, done: &mut dyn FnMut() -> bool| {
        while !done() {
            assert!(started.elapsed() < PATIENCE, "waited too long for {what}");
            assert!(viewer.0.try_wait().unwrap().is_none(), "the window was closed before {what}");
            std::thread::sleep(Duration::from_millis(100));
        }
    };
    let window = || xdotool(&display, &["search", "--name", "photo.png"]).filter(|w| !w.is_empty());
    wait_for("a window", &mut || window().is_some());
    let id = window().unwrap();
    let press = |key: &str| xdotool(&display, &["windowfocus", "--sync", &id, "key", key]).is_some();
    let title = || xdotool(&display, &["getwindowname", &id]).unwrap_or_default();
    let see = |part| screen(folder.path(), part);
    wait_for("the picture", &mut || shown(&title()).is_some_and(|(style, _)| style == "none"));
    let original = settled(&|| see(WHOLE), Duration::from_secs(2));
    assert!(!is_blue(&original));
    wait_for("a key", &mut || press("l"));
    wait_for("the preview on the first card", &mut || is_blue(&see(CARD)));
    let middle = ["mousemove", "--window", &id, "120", "250", "sleep", "0.2", "click", "1"];
    wait_for("the pointer", &mut || xdotool(&display, &middle).is_some());
    wait_for("the look", &mut || title().contains("- plan"));
    wait_for("a key", &mut || press("Return"));
    wait_for("the picture with the look", &mut || is_blue(&see(WHOLE)) && title().contains("- plan - frame"));
    wait_for("undo", &mut || press("ctrl+z"));
    wait_for("the picture of before", &mut || see(WHOLE) == original);
    assert!(press("q"));
    while viewer.0.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < PATIENCE, "the window does not close");
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(viewer.0.wait().unwrap().success());
    let errors = text(viewer.0.stderr.as_mut().unwrap());
    assert!(!errors.contains("error:") && !errors.contains("warning:"), "{errors}");
}

/// What is seen when it has stayed the same for so long.
fn settled(see: &dyn Fn() -> Vec<u8>, long: Duration) -> Vec<u8> {
    let (mut seen, mut since) = (see(), Instant::now());
    while since.elapsed() < long {
        std::thread::sleep(Duration::from_millis(50));
        let now = see();
        if now != seen {
            (seen, since) = (now, Instant::now());
        }
    }
    seen
}

/// Whether most pixels are more blue than red, in whichever order the screen has its colours.
fn is_blue(pixels: &[u8]) -> bool {
    let blue = pixels.chunks_exact(4).filter(|pixel| pixel[0].abs_diff(pixel[2]) > 60).count();
    blue * 4 > pixels.len() / 2
}

#[test]
fn the_help_names_the_keys() {
    let output = Command::new(env!("CARGO_BIN_EXE_isophote")).args(["view", "--help"]).output().unwrap();
    let help = String::from_utf8(output.stdout).unwrap();
    for key in [
        "drag",
        "Shift",
        "wheel",
        "1, 2, ...",
        "Tab",
        "Space",
        "  f  ",
        "  c  ",
        "  l  ",
        "  w  ",
        "hold",
        "q, Escape",
    ] {
        assert!(help.contains(key), "'{key}' is not in the help:\n{help}");
    }
}

fn text(pipe: &mut impl Read) -> String {
    let mut text = String::new();
    pipe.read_to_string(&mut text).unwrap();
    text
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_reason_is_the_system_s_own() {
    let folder = support::folder();
    let mut command = support::isophote();
    command.arg("view").arg(support::cube(folder.path()));
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let problem = "error: no window can be opened: neither WAYLAND_DISPLAY";
    support::fails(&mut command, 1, &[problem, "start the viewer in a desktop session"]);
}
