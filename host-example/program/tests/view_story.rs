//! An artist's afternoon in the real window, by mouse, keys and dropped files: the picture that is exported is the one that
//! the command line makes with the preset that was saved.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use isophote_loader::Library;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::look::EditedLook;
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;

use crate::support::others::drop_files;
use crate::support::places::places;
use crate::support::window::{Display, Part, Window, screen, view};
use crate::support::{self, folder, isophote, picture, succeeds};

/// Size of the window.
const SIZE: (u32, u32) = (1000, 640);
/// The canvas, above what is said at its lower border and beside the pointer.
const CANVAS: Part = [40, 60, 650, 520];
/// The left of the bar at the bottom, where an export tells how far it is.
const BAR: Part = [4, 616, 160, 636];
/// Time after which a drag that has changed nothing is made once more.
const AGAIN: Duration = Duration::from_secs(15);
/// A part of its left half.
const LEFT: Part = [60, 150, 250, 450];

#[test]
fn a_photograph_is_dropped_looked_at_saved_reopened_and_exported() {
    let Some(display) = Display::open("1100x700") else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(240, 160).save(at("photo.png")).unwrap();
    fs::write(at("mine.json"), r#"{"style": "cartoon", "lengths": "pixels"}"#).unwrap();
    let command = || view(folder.path(), &format!("{}x{}", SIZE.0, SIZE.1));
    let session = || {
        let library = Library::from_file(support::library()).unwrap();
        let look = EditedLook::open(&library, &at("mine.json")).unwrap();
        let mut session = Session::new(library, vec![look], Settings::default()).unwrap();
        let document = Document::open(&at("photo.png"), &Options::default()).unwrap();
        session.show_playback(document.playback().unwrap());
        session
    };

    let mut window = Window::open(&display, command().arg("--style").arg(at("mine.json")));
    assert!(drop_files(&display.name, &window.id, &[&at("photo.png")]));
    window.shows("photo.png", "mine");
    let mut place = places(session(), SIZE);
    let mut seen = window.settled(CANVAS);
    for (label, share) in [("Line width", 0.4), ("Detail", 0.9), ("Posterize", 0.3)] {
        let slider = place(label, Role::Slider);
        let x = |share: f32| (slider.left() + slider.width() * share) as i32;
        let y = slider.center().y as i32;
        drag_until_seen(&mut window, &display, ([x(0.5), y], [x(share), y]), &seen);
        seen = window.settled(CANVAS);
    }
    wipe(&mut window);
    window.becomes("the look alone", CANVAS, &seen);
    window.key("ctrl+s");
    window.wait_for("the preset", |_| {
        let text = fs::read_to_string(at("mine.json")).unwrap_or_default();
        ["line_width", "detail", "posterize"].iter().all(|name| text.contains(&format!("\"{name}\"")))
    });
    window.close();

    let mut again =
        Window::open(&display, command().arg("--style").arg(at("mine.json")).arg(at("photo.png")));
    again.shows("photo.png", "mine");
    again.point([2, 200], &[]);
    again.becomes("the picture of the preset", CANVAS, &seen);
    let mut session = session();
    session.plan_export();
    let start = places(session, SIZE)("Start the export", Role::Button).center();
    let bar = again.settled(BAR);
    again.key("ctrl+e");
    again.changes("the question what to export", CANVAS, &seen);
    again.click([start.x as i32, start.y as i32]);
    again.wait_for("the picture that is exported", |_| at("photo-look.png").exists());
    again.becomes("the end of the export", BAR, &bar);
    again.close();
    assert_eq!(again.said(), "");

    is_what_the_command_line_makes(folder.path());
}

/// Compares what was exported with what `apply` makes of the preset.
fn is_what_the_command_line_makes(folder: &Path) {
    let at = |name: &str| folder.join(name);
    let mut apply = isophote();
    apply.arg("apply").arg("--preset").arg(at("mine.json")).arg(at("photo.png")).arg(at("apply.png"));
    succeeds(&mut apply);
    let [exported, applied] = ["photo-look.png", "apply.png"].map(|name| fs::read(at(name)).unwrap());
    assert!(exported == applied, "the export is what the command line makes with the preset");
    let plain = image::open(at("photo.png")).unwrap();
    assert!(image::open(at("apply.png")).unwrap() != plain);
}

/// Drags until the canvas is another: on a machine that is busy a drag may come to nothing, and a person would drag once more.
fn drag_until_seen(
    window: &mut Window<'_>,
    display: &Display,
    (from, to): ([i32; 2], [i32; 2]),
    seen: &[u8],
) {
    let mut tried = Instant::now();
    window.drag(from, to);
    window.wait_for("another picture", |window| {
        if tried.elapsed() > AGAIN {
            window.drag(from, to);
            tried = Instant::now();
        }
        screen(display.folder(), CANVAS) != seen
    });
}

/// Wipes the look over the original from the middle to the left, and away.
fn wipe(window: &mut Window<'_>) {
    let look = window.settled(LEFT);
    window.key("w");
    window.changes("the original on the left of the wipe", LEFT, &look);
    let wiped = window.settled(LEFT);
    let middle = 326;
    window.drag([middle, 330], [20, 330]);
    window.changes("the look on the right of it", LEFT, &wiped);
    window.becomes("what is right of the wipe", LEFT, &look);
    window.key("w");
}
