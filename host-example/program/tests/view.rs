//! `isophote view` in a real window, on a display without a screen: frames of each style, a resize,
//! a clean end.
#![cfg(target_os = "linux")]

use std::process::Command;
use std::time::Duration;

use crate::support;
use crate::support::window::{Display, Part, Window, screen, view};

const STYLES: [&str; 3] = ["none", "cartoon", "blueprint"];
/// Name of each, as titles have it, in small letters.
const NAMES: [&str; 3] = ["original", "cartoon", "blueprint"];
const FRAMES: u32 = 10;

/// Look, and frames since the last switch or resize, that a title tells where a report is wanted.
fn shown(title: &str) -> Option<(String, u32)> {
    let mut parts = title.split(" – ");
    let (_, look, frame) = (parts.next()?, parts.next()?, parts.next()?);
    Some((look.to_lowercase(), frame.strip_prefix("frame ")?.parse().ok()?))
}

#[test]
fn a_window_shows_every_style_resizes_and_closes() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = support::folder();
    let scene = support::turning_triangle(folder.path());
    let mut command = view(folder.path(), "200x120");
    command
        .args(["--report", "--backend", "gpu"])
        .arg(&scene)
        .args(STYLES.iter().flat_map(|s| ["--style", s]));
    let mut window = Window::open(&display, &mut command);
    for (number, name) in NAMES.iter().enumerate() {
        window.key(&format!("{}", number + 1));
        window.wait_for(&format!("{FRAMES} frames of {name}"), |window| {
            shown(&window.title()).is_some_and(|(s, n)| s == *name && n >= FRAMES)
        });
    }
    // The name by which desktops find its entry, and with that its icon.
    let of_application = display.xdotool(&["search", "--class", "org.isophote.Isophote"]).unwrap_or_default();
    assert!(of_application.lines().any(|id| id == window.id), "{of_application}");
    window.resize(300, 180);
    std::thread::sleep(Duration::from_secs(1));
    window.wait_for("frames of the new size", |window| {
        shown(&window.title()).is_some_and(|(_, n)| n >= FRAMES)
    });
    let report = window.close();
    for style in STYLES {
        assert!(report.contains(&format!("{style} 200x120: ")), "{report}");
    }
    for line in ["blueprint 300x180: ", "longest hold of the window: ", "controls on the device: "] {
        assert!(report.contains(line), "{report}");
    }
    let said = window.said();
    assert!(!said.contains("error:") && !said.contains("warning:"), "{said}");
}

/// The canvas of a window of 700x420 pixels, above what is said at its lower border.
const CANVAS: Part = [0, 60, 350, 300];
/// Its left half, without the line of the wipe.
const LEFT: Part = [0, 80, 160, 300];
/// Far along the first slider of its panel.
const SLIDER: [i32; 2] = [590, 146];
/// Place where the pointer shows nothing.
const ASIDE: [i32; 2] = [320, 408];

#[test]
fn a_slider_is_moved_and_taken_back_and_a_wipe_shows_the_original() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = support::folder();
    let scene = support::cube(folder.path());
    let settings = folder.path().join("view.json");
    std::fs::write(&settings, "{ no settings").unwrap();
    let mut command = view(folder.path(), "700x420");
    let mut window =
        Window::open(&display, command.args(["--style", "none", "--style", "blueprint"]).arg(&scene));
    let part = |part| screen(display.folder(), part);
    window.point(ASIDE, &[]);
    window.shows("cube.gltf", "none");
    let original = window.settled(LEFT);
    let before = part(CANVAS);
    window.key("2");
    window.wait_for("blueprint", |_| part(CANVAS) != before && is_blue(&part(CANVAS)));
    let blueprint = window.settled(CANVAS);
    window.point(SLIDER, &["sleep", "0.1", "click", "1"]);
    window.point(ASIDE, &[]);
    window.wait_for("wider lines", |_| part(CANVAS) != blueprint && is_blue(&part(CANVAS)));
    window.key("ctrl+z");
    window.wait_for("the lines of before", |_| part(CANVAS) == blueprint);
    window.key("w");
    window.wait_for("the original beside the look", |_| part(LEFT) == original);
    window.key("w");
    window.wait_for("the look alone", |_| part(CANVAS) == blueprint);
    window.close();
    let warnings = window.said();
    assert!(warnings.contains("warning:") && warnings.contains("is not usable"), "{warnings}");
    let remembered = std::fs::read_to_string(settings).unwrap();
    assert!(remembered.contains("cube.gltf") && remembered.contains("blueprint"), "{remembered}");
}

/// The slider's handle, and the number beside it.
const HANDLE: Part = [500, 136, 612, 156];
const NUMBER: Part = [624, 138, 682, 154];
/// A place in that field.
const FIELD: [i32; 2] = [645, 146];
/// The edge of the panel, and what is beside it.
const EDGE: [i32; 2] = [352, 300];
const BESIDE: Part = [318, 60, 350, 300];

#[test]
fn a_slider_is_turned_by_the_wheel_its_number_typed_and_the_panel_made_wider() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = support::folder();
    let scene = support::cube(folder.path());
    let mut command = view(folder.path(), "700x420");
    let mut window = Window::open(&display, command.args(["--style", "blueprint"]).arg(&scene));
    let part = |part| screen(display.folder(), part);
    window.point(ASIDE, &[]);
    window.wait_for("blueprint", |_| is_blue(&part(CANVAS)));
    let (number, handle) = (window.settled(NUMBER), part(HANDLE));
    window.point(SLIDER, &[]);
    window.changes("the slider under the pointer", HANDLE, &handle);
    window.point(SLIDER, &["sleep", "1", "click", "--repeat", "8", "--delay", "30", "4"]);
    window.changes("another number", NUMBER, &number);
    window.point(ASIDE, &[]);
    window.settled(NUMBER);
    window.key("ctrl+z");
    window.becomes("the number before all that was turned at once", NUMBER, &number);
    window.point(FIELD, &["sleep", "0.1", "click", "1"]);
    // The colour of text that is selected, in whichever order the screen has it.
    let is_selected = |pixel: &[u8]| [[62, 88, 116], [116, 88, 62]].iter().any(|color| pixel[..3] == *color);
    let is_edited = |number: &[u8]| number.chunks_exact(4).any(is_selected);
    window.wait_for("the number to be typed over", |_| is_edited(&part(NUMBER)));
    window.point(FIELD, &["type", "2*1,5"]);
    window.key("Return");
    window.point(ASIDE, &[]);
    let typed = window.settled(NUMBER);
    assert!(typed != number && !is_edited(&typed));
    window.key("ctrl+z");
    window.becomes("the number before it", NUMBER, &number);
    window.drag(EDGE, [EDGE[0] - 40, EDGE[1]]);
    window.wait_for("a wider panel", |_| !is_blue(&part(BESIDE)));
    window.close();
    let remembered = std::fs::read_to_string(folder.path().join("view.json")).unwrap();
    assert!(remembered.contains(r#""panel_width": 388"#), "{remembered}");
}

#[test]
fn half_precision_shows_all_but_the_same_and_says_so() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = support::folder();
    let photo = folder.path().join("photo.png");
    support::picture(240, 160).save(&photo).unwrap();
    let [exact, half] = ["exact", "half"].map(|precision| {
        let mut command = view(folder.path(), "700x420");
        command.args(["--report", "--backend", "gpu", "--precision", precision]);
        command.args(["--style", "gaussian", "--set", "sigma=3"]);
        let mut window = Window::open(&display, command.arg(&photo));
        window.point(ASIDE, &[]);
        window.shows("photo.png", "gaussian");
        let says = |window: &mut Window<'_>| window.title().ends_with(" – half precision – Isophote");
        match precision {
            "half" => window.wait_for("the precision", says),
            _ => assert!(!says(&mut window), "{}", window.title()),
        }
        let picture = window.settled(CANVAS);
        let report = window.close();
        assert!(report.contains(&format!(", {precision} precision\n")), "{report}");
        picture
    });
    let differences = exact.iter().zip(&half).map(|(a, b)| a.abs_diff(*b));
    let (largest, count) =
        differences.fold((0, 0), |(most, count), d| (most.max(d), count + usize::from(d > 0)));
    eprintln!("half precision: {count} of {} bytes differ by at most {largest}", exact.len());
    assert!((1..=2).contains(&largest), "colours are rounded to 16 bits, which is seen in last bits alone");
}

#[test]
fn both_processors_show_the_same_scene() {
    let (Some(one), Some(other)) = (Display::open("800x600"), Display::open("800x600")) else { return };
    let folder = support::folder();
    let scene = support::cube(folder.path());
    let open = |display, backend| {
        let mut command = view(folder.path(), "700x420");
        let mut window =
            Window::open(display, command.args(["--backend", backend, "--style", "blueprint"]).arg(&scene));
        window.point(ASIDE, &[]);
        window
    };
    let mut windows = [open(&one, "gpu"), open(&other, "cpu")];
    let are_same = || {
        let [gpu, cpu] = [&one, &other].map(|display| screen(display.folder(), CANVAS));
        let far = gpu.iter().zip(&cpu).filter(|(a, b)| a.abs_diff(**b) > 8).count();
        is_blue(&gpu) && is_blue(&cpu) && far * 1000 <= gpu.len()
    };
    windows[0].wait_for("the same picture in both", |_| are_same());
    for window in &mut windows {
        window.close();
        assert_eq!(window.said(), "");
    }
}

#[test]
fn the_difference_to_the_original_is_shown_and_is_nothing_where_there_is_no_look() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = support::folder();
    let photo = folder.path().join("photo.png");
    support::picture(240, 160).save(&photo).unwrap();
    let mut command = view(folder.path(), "700x420");
    let mut window =
        Window::open(&display, command.args(["--style", "none", "--style", "blueprint"]).arg(&photo));
    window.point(ASIDE, &[]);
    window.shows("photo.png", "none");
    // The middle of the picture, below the words on it.
    let middle: Part = [60, 180, 290, 260];
    let original = window.settled(middle);
    window.key("d");
    window.changes("the difference of equal pictures", middle, &original);
    let none = window.settled(middle);
    assert!(none.chunks_exact(4).all(|pixel| pixel[..3] == [0; 3]), "equal pictures are nowhere apart");
    window.key("2");
    window.shows("photo.png", "blueprint");
    window.changes("the difference", middle, &none);
    let weak = window.settled(middle);
    let light =
        |pixels: &[u8]| pixels.chunks_exact(4).filter(|pixel| pixel[..3].iter().any(|v| *v > 40)).count();
    assert!(light(&weak) * 4 > weak.len() / 4, "a blueprint is another picture nearly everywhere");
    window.key("d");
    window.changes("the look", middle, &weak);
    assert!(is_blue(&window.settled(middle)));
    window.close();
}

/// Within the picture of the first card of the browser in a window of 700x420 pixels.
const CARD: Part = [50, 215, 190, 285];
/// The middle of that card.
const MIDDLE: [i32; 2] = [120, 250];
/// The canvas without what is said at its lower border.
const WHOLE: Part = [10, 60, 340, 280];

#[test]
fn a_look_is_taken_from_the_grid_where_it_was_seen_on_the_picture() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = support::folder();
    let looks = folder.path().join("looks");
    std::fs::create_dir(&looks).unwrap();
    std::fs::write(looks.join("plan.json"), r#"{"style": "blueprint", "lengths": "pixels"}"#).unwrap();
    std::fs::write(folder.path().join("view.json"), format!(r#"{{"look_folders": [{looks:?}]}}"#)).unwrap();
    let photo = folder.path().join("photo.png");
    support::picture(240, 160).save(&photo).unwrap();
    let mut command = view(folder.path(), "700x420");
    let mut window = Window::open(&display, command.args(["--style", "none"]).arg(&photo));
    let part = |part| screen(display.folder(), part);
    window.point(ASIDE, &[]);
    window.shows("photo.png", "none");
    let original = window.settled(WHOLE);
    assert!(!is_blue(&original));
    window.key("l");
    window.wait_for("the preview on the first card", |_| is_blue(&part(CARD)));
    window.point(MIDDLE, &["sleep", "0.2", "click", "1"]);
    window.wait_for("the look", |window| !window.title().contains("Original"));
    window.key("Return");
    window.point(ASIDE, &[]);
    window.wait_for("the picture with the look", |window| {
        is_blue(&part(WHOLE)) && window.title() == "photo.png – plan – Isophote"
    });
    window.key("ctrl+z");
    window.wait_for("the picture of before", |_| part(WHOLE) == original);
    window.close();
    let said = window.said();
    assert!(!said.contains("error:") && !said.contains("warning:"), "{said}");
}

/// True where most pixels are more blue than red, in whichever order the screen has its colours.
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
        "Tab, Shift+Tab",
        "n, Shift+n",
        "Home, End",
        "Space",
        "  f  ",
        "  c  ",
        "  l  ",
        "  w  ",
        "hold",
        "Escape",
        "Ctrl+Q",
    ] {
        assert!(help.contains(key), "'{key}' is not in the help:\n{help}");
    }
}

#[test]
fn without_a_display_the_reason_is_the_system_s_own() {
    let folder = support::folder();
    let mut command = support::isophote();
    command.arg("view").arg(support::cube(folder.path()));
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let problem = "error: no window can be opened: neither WAYLAND_DISPLAY";
    support::fails(&mut command, 1, &[problem, "is set; start the viewer in a desktop session"]);
}
