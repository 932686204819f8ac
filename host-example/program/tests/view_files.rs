//! Files that are dropped on the real window, as other programs drop them, and those that dialogs of the system choose.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use egui::accesskit::Role;
use isophote_loader::Library;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::batch::Batch;
use isophote_window::state::look::EditedLook;
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;

use crate::support::others::drop_files;
use crate::support::places::places;
use crate::support::window::{Display, Part, Window, program, view};
use crate::support::{self, folder, picture};

/// Size of the window.
const SIZE: &str = "1000x700";
/// Time in which a click has done what it does.
const PAUSE: Duration = Duration::from_millis(400);
/// The upper part of the canvas, above what is said at its lower border.
const CANVAS: Part = [0, 60, 650, 330];

fn drops(display: &Display, window: &Window<'_>, files: &[&Path]) {
    assert!(drop_files(&display.name, &window.id, files), "the window takes files");
}

#[test]
fn what_is_dropped_opens_and_what_cannot_be_opened_leaves_what_was_there() {
    let Some(display) = Display::open("1100x800") else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for name in ["a photo, größer.png", "second.png"] {
        picture(96, 64).save(at(name)).unwrap();
    }
    fs::write(at("broken.png"), &fs::read(at("second.png")).unwrap()[..600]).unwrap();
    fs::write(at("notes.txt"), "no picture").unwrap();
    fs::create_dir(at("empty")).unwrap();
    fs::create_dir(at("shot")).unwrap();
    for number in 1..4 {
        picture(48, 32).save(at("shot").join(format!("shot.000{number}.png"))).unwrap();
    }
    let look = r#"{"style": "blueprint", "parameters": {"line_width": 3}}"#;
    fs::write(at("mine.json"), look).unwrap();
    let later = r#"{"style": "hologram", "parameters": {"depth": 2}}"#;
    fs::write(at("later style.json"), later).unwrap();
    fs::write(at("later.json"), r#"{"style": "cartoon", "parameters": {"sparkle": 2}}"#).unwrap();

    let mut window = Window::open(&display, view(folder.path(), SIZE).args(["--style", "cartoon"]));
    window.wait_for("the start screen", |window| window.title() == "Isophote");
    drops(&display, &window, &[&at("a photo, größer.png")]);
    window.shows("a photo, größer.png", "cartoon");
    let before = window.settled(CANVAS);
    for (name, why) in [
        ("broken.png", "is damaged"),
        ("notes.txt", "is neither PNG"),
        ("empty", "is a folder without numbered pictures"),
        ("later style.json", "hologram"),
        ("later.json", "sparkle"),
    ] {
        drops(&display, &window, &[&at(name)]);
        window.wait_for(why, |window| window.said().contains(name) && window.said().contains(why));
        assert_eq!(window.title(), "a photo, größer.png – Cartoon – Isophote");
    }
    assert!(window.settled(CANVAS) == before, "the picture of before stays");
    drops(&display, &window, &[&at("mine.json")]);
    window.shows("a photo, größer.png", "mine");
    window.changes("the look that was dropped", CANVAS, &before);
    // Nothing is taken behind a dialog.
    let before = window.settled(CANVAS);
    window.key("F1");
    window.changes("the help", CANVAS, &before);
    drops(&display, &window, &[&at("second.png")]);
    std::thread::sleep(PAUSE);
    window.key("Escape");
    window.becomes("the picture without the help", CANVAS, &before);
    assert!(window.title().starts_with("a photo, größer.png"), "{}", window.title());
    // The first that opens is shown.
    drops(&display, &window, &[&at("broken.png"), &at("second.png"), &at("a photo, größer.png")]);
    window.shows("second.png", "mine");
    // Several offer the look for all of them, in a dialog.
    window.key("Escape");
    drops(&display, &window, &[&at("shot")]);
    window.shows("shot.####.png", "mine");
    window.close();
    assert!(!window.said().contains("panicked"), "{}", window.said());
}

/// Middle of the strip where messages appear.
const MESSAGE: Part = [250, 640, 400, 655];

#[test]
fn an_error_goes_away_when_another_file_is_opened() {
    let Some(display) = Display::open("1100x800") else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for name in ["first.png", "second.png"] {
        picture(96, 20).save(at(name)).unwrap();
    }
    fs::write(at("broken.png"), &fs::read(at("second.png")).unwrap()[..400]).unwrap();
    let mut window =
        Window::open(&display, view(folder.path(), SIZE).args(["--style", "none"]).arg(at("first.png")));
    window.shows("first.png", "none");
    let before = window.settled(MESSAGE);
    drops(&display, &window, &[&at("broken.png")]);
    window.changes("what is wrong", MESSAGE, &before);
    window.settled(MESSAGE);
    drops(&display, &window, &[&at("second.png")]);
    window.shows("second.png", "none");
    window.becomes("no message", MESSAGE, &before);
    window.close();
}

#[test]
fn keys_open_the_files_of_the_folder_as_people_count_and_the_look_stays() {
    let Some(display) = Display::open("1100x800") else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join("shown").join(name);
    fs::create_dir(folder.path().join("shown")).unwrap();
    for name in ["img10.png", "img2b.png", "shot.0001.png", "shot.0002.png", "shot.0003.png"] {
        picture(48, 32).save(at(name)).unwrap();
    }
    fs::write(at("notes.txt"), "no picture").unwrap();
    let mut window =
        Window::open(&display, view(folder.path(), SIZE).args(["--style", "blueprint"]).arg(at("img2b.png")));
    window.shows("img2b.png", "blueprint");
    for (key, name) in
        [("Next", "img10.png"), ("Next", "shot.####.png"), ("Prior", "img10.png"), ("Prior", "img2b.png")]
    {
        window.key(key);
        window.shows(name, "blueprint");
    }
    // Before the first there is none.
    window.key("Prior");
    window.settled(CANVAS);
    window.shows("img2b.png", "blueprint");
    window.close();
}

#[test]
fn dialogs_choose_files_and_where_there_are_none_the_window_says_what_to_do() {
    let Some(display) = Display::open("1100x800") else { return };
    let folder = folder();
    picture(96, 64).save(folder.path().join("chosen.png")).unwrap();
    // Where nothing is found, neither is a service of dialogs.
    let nowhere = folder.path().join("nowhere");
    let mut command = view(folder.path(), SIZE);
    command.env("PATH", &nowhere).env("XDG_RUNTIME_DIR", &nowhere);
    let mut window = Window::open(&display, &mut command);
    for _ in 0..2 {
        window.key("ctrl+o");
    }
    window.wait_for("what to do", |window| {
        window.said().contains("the system cannot show a dialog")
            && window.said().contains("drop the file on the window")
    });
    drops(&display, &window, &[&folder.path().join("chosen.png")]);
    window.wait_for("the file that was dropped", |window| window.title().starts_with("chosen.png"));
    window.close();

    let script = format!("#!/bin/sh\necho '{}'\n", folder.path().join("chosen.png").display());
    let programs = program(folder.path(), "zenity", &script);
    let mut command = view(folder.path(), SIZE);
    command.env("PATH", &programs).env("XDG_RUNTIME_DIR", &nowhere);
    let mut window = Window::open(&display, &mut command);
    window.key("ctrl+o");
    window.wait_for("the file that was chosen", |window| window.title().starts_with("chosen.png"));
    // One that is closed without an answer changes nothing and can be opened again.
    program(folder.path(), "zenity", "#!/bin/sh\nexit 1\n");
    window.key("ctrl+o");
    let again = folder.path().join("again");
    program(folder.path(), "zenity", &format!("#!/bin/sh\n: > '{}'\nexit 1\n", again.display()));
    window.wait_for("another dialog", |window| {
        window.key("ctrl+o");
        again.exists()
    });
    window.close();
    assert_eq!(window.said(), "");
}

#[test]
fn one_look_goes_on_all_pictures_that_are_dropped_and_their_folder_is_shown() {
    let Some(display) = Display::open("1100x800") else { return };
    let folder = folder();
    let photos = folder.path().join("holiday's, größer");
    fs::create_dir(&photos).unwrap();
    let files = ["beach.png", "dog.jpg", "tree.png"].map(|name| photos.join(name));
    files.iter().for_each(|file| picture(96, 64).save(file).unwrap());
    let mine = folder.path().join("mine.json");
    fs::write(&mine, r#"{"style": "cartoon", "lengths": "pixels"}"#).unwrap();
    let told = folder.path().join("told");
    let script = format!("#!/bin/sh\nprintf '%s|' \"$@\" > '{}'\n", told.display());
    let programs = program(folder.path(), "xdg-open", &script);
    let session = || {
        let library = Library::from_file(support::library()).unwrap();
        let look = EditedLook::open(&library, &mine).unwrap();
        let mut session = Session::new(library, vec![look], Settings::default()).unwrap();
        let document = Document::open(&files[0], &Options::default()).unwrap();
        session.show_playback(document.playback().unwrap());
        session
    };
    let mut asking = session();
    let batch = Batch::new(files.to_vec(), None);
    let results = PathBuf::from(&batch.folder);
    asking.dialogs.batch = Some(batch);
    let start = places(asking, (1000, 700))("Use the look on all", Role::Button).center();
    let mut command = view(folder.path(), SIZE);
    let path = std::env::var("PATH").unwrap_or_default();
    command.env("PATH", format!("{}:{path}", programs.display()));
    let mut window = Window::open(&display, command.arg("--style").arg(&mine));
    window.wait_for("the start screen", |window| window.title() == "Isophote");
    drops(&display, &window, &[&files[0], &files[1], &files[2]]);
    window.shows("beach.png", "mine");
    window.settled(CANVAS);
    window.click([start.x as i32, start.y as i32]);
    window.wait_for("the results", |_| {
        fs::read_dir(&results).is_ok_and(|found| {
            let names = found.flatten().map(|entry| entry.file_name());
            names.filter(|name| ["beach.png", "dog.jpg", "tree.png"].iter().any(|file| name == file)).count()
                == 3
        })
    });
    let mut apply = support::isophote();
    apply.arg("apply").arg("--preset").arg(&mine).arg(&files[0]).arg(folder.path().join("own.png"));
    support::succeeds(&mut apply);
    let same = [results.join("beach.png"), folder.path().join("own.png")].map(|file| fs::read(file).unwrap());
    assert!(same[0] == same[1], "it is what the command line makes");
    // The button follows the text of the message, in the middle above the lower border.
    let mut at = 200;
    window.wait_for("the folder", |window| {
        at += 24;
        window.click([at, 635]);
        std::thread::sleep(PAUSE);
        told.exists() && fs::read_to_string(&told).unwrap() == format!("{}|", results.display())
    });
    window.close();
    assert!(!window.said().contains("panicked"), "{}", window.said());
}
