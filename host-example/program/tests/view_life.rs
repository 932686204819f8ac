//! Life of a window: being hidden, of any size, closed at work, and pictures as large as they come.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::time::Duration;

use egui::accesskit::Role;
use isophote_loader::Library;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::look::EditedLook;
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;

use crate::support::others::{Cover, drop_files};
use crate::support::places::{places, tabs_to};
use crate::support::window::{Display, Part, Window, screen, view};
use crate::support::{self, folder, listing, picture};

const SIZE: (u32, u32) = (700, 420);
/// The canvas of a window of that size, above what is said at its lower border.
const CANVAS: Part = [0, 60, 350, 290];

/// A window that has room for all of the start.
const START: (u32, u32) = (900, 560);

fn size() -> String {
    format!("{}x{}", SIZE.0, SIZE.1)
}

/// A session like that of a window that was opened with a style and a picture.
fn session(style: &Path, file: &Path) -> Session {
    let library = Library::from_file(support::library()).unwrap();
    let look = EditedLook::open(&library, style).unwrap();
    let mut session = Session::new(library, vec![look], Settings::default()).unwrap();
    session.show_playback(Document::open(file, &Options::default()).unwrap().playback().unwrap());
    session
}

#[test]
fn pictures_that_come_with_the_program_are_opened_by_mouse_and_by_keys() {
    let Some(display) = Display::open("1000x700") else { return };
    let start = || {
        let library = Library::from_file(support::library()).unwrap();
        let look = EditedLook::open(&library, "none".as_ref()).unwrap();
        Session::new(library, vec![look], Settings::default()).unwrap()
    };
    let folders = [folder(), folder()];
    let open = |folder: &Path, name: &str, ask: &dyn Fn(&mut Window<'_>)| {
        let mut command = view(folder, &format!("{}x{}", START.0, START.1));
        let mut window = Window::open(&display, command.args(["--style", "none"]));
        window.wait_for("the start", |window| window.title() == "Isophote");
        let before = window.settled(CANVAS);
        ask(&mut window);
        window.shows(name, "none");
        window.changes("the picture", CANVAS, &before);
        let written = image::open(folder.join("pictures").join(name)).unwrap();
        assert!(written.width() >= START.0, "it is opened as a file");
        window.close();
        assert_eq!(window.said(), "");
        assert_eq!(listing(folder), ["pictures", "view.json"]);
    };
    let statue = places(start(), START)("A statue", Role::Button).center();
    open(folders[0].path(), "statue.jpg", &|window| window.click([statue.x as i32, statue.y as i32]));
    let steps = tabs_to(start(), START, "Roofs");
    open(folders[1].path(), "roofs.jpg", &|window| {
        (0..steps).for_each(|_| window.key("Tab"));
        window.key("Return");
    });
}

#[test]
fn a_window_lives_on_when_it_is_hidden_covered_and_as_small_as_a_pixel() {
    let Some(display) = Display::open("1000x700") else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(96, 64).save(at("first.png")).unwrap();
    image::imageops::rotate180(&picture(96, 64)).save(at("second.png")).unwrap();
    let mut command = view(folder.path(), &size());
    command.args(["--style", "none", "--style", "blueprint"]).arg(at("first.png"));
    let mut window = Window::open(&display, &mut command);
    let is_bright = || screen(display.folder(), CANVAS).iter().any(|byte| *byte > 60);
    window.wait_for("the first picture", |window| window.title().starts_with("first.png") && is_bright());
    let first = window.settled(CANVAS);
    let id = window.id.clone();

    // As a window manager minimises it.
    window.wait_for("nothing on the screen", |_| display.xdotool(&["windowunmap", "--sync", &id]).is_some());
    assert!(drop_files(&display.name, &id, &[&at("second.png")]));
    window.wait_for("the second picture", |window| window.title().starts_with("second.png"));
    window.wait_for("the window again", |_| display.xdotool(&["windowmap", "--sync", &id]).is_some());
    window.wait_for("the second picture", |_| is_bright() && screen(display.folder(), CANVAS) != first);
    let second = window.settled(CANVAS);

    let cover = Cover::open(&display.name);
    window.changes("the cover", CANVAS, &second);
    window.key("2");
    std::thread::sleep(Duration::from_millis(500));
    drop(cover);
    window.shows("second.png", "blueprint");
    window.changes("the other look", CANVAS, &second);
    let blueprint = window.settled(CANVAS);

    for (width, height) in [(1, 1), (2, 400), (640, 1), (1, 1), (300, 200)] {
        window.resize(width, height);
        std::thread::sleep(Duration::from_millis(300));
    }
    let mut storm: Vec<String> = Vec::new();
    for step in 0..60_u32 {
        let (width, height) = (1 + step * 97 % 900, 1 + step * 61 % 600);
        storm.extend(["windowsize".into(), id.clone(), width.to_string(), height.to_string()]);
    }
    let storm: Vec<&str> = storm.iter().map(String::as_str).collect();
    window.wait_for("many sizes", |_| display.xdotool(&storm).is_some());
    window.resize(SIZE.0, SIZE.1);
    window.becomes("the picture of before", CANVAS, &blueprint);
    window.close();
    assert_eq!(window.said(), "");
}

/// The most memory that a process has held, in bytes.
fn peak(process: u32) -> u64 {
    let text = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = text.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() << 10
}

/// A picture of that size is 0.5 GiB of floats. The window has it in memory, on the device and, while it is uploaded, in part
/// in between; a Gaussian filter has it twice more, as passes read one and write another.
const MOST: u64 = 7 << 29;

#[test]
fn a_picture_in_8k_opens_and_its_sliders_answer_within_a_bound_of_memory() {
    let Some(display) = Display::open("1000x700") else { return };
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let small = picture(480, 270);
    let large = image::RgbImage::from_fn(7680, 4320, |x, y| *small.get_pixel(x / 16, y / 16));
    large.save(at("large.png")).unwrap();
    fs::write(at("mine.json"), r#"{"style": "gaussian", "parameters": {"sigma": 4}}"#).unwrap();
    let mut command = view(folder.path(), &size());
    command.args(["--report", "--backend", "gpu", "--style"]).arg(at("mine.json")).arg(at("large.png"));
    let mut window = Window::open(&display, &mut command);
    window.shows("large.png", "mine");
    let before = window.settled(CANVAS);
    picture(96, 64).save(at("small.png")).unwrap();
    let slider = places(session(&at("mine.json"), &at("small.png")), SIZE)("Blur", Role::Slider);
    let x = |share: f32| (slider.left() + slider.width() * share) as i32;
    let y = slider.center().y as i32;
    // Not far, since a driver on the CPU takes long for wide windows.
    window.drag([x(0.2), y], [x(0.35), y]);
    window.changes("a smoother picture", CANVAS, &before);
    window.settled(CANVAS);
    let most = peak(window.process());
    eprintln!("8K: {} MiB", most >> 20);
    eprintln!("{}", window.discard());
    assert!(most < MOST, "{} MiB", most >> 20);
    assert_eq!(window.said(), "");
}
