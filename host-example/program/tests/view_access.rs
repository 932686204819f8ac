//! The window without eyes and without a mouse: what it tells programs that read it aloud, asked from outside, and what real
//! keys do in it.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;

use crate::support::access::{Bus, Control};
use crate::support::window::{Display, Part, Window, view};
use crate::support::{folder, picture};

const SIZE: (u32, u32) = (1000, 640);
/// A part of the picture.
const CANVAS: Part = [100, 100, 500, 500];
/// Roles of what keys go to and programs act on.
const ACTIVE: [&str; 8] =
    ["button", "toggle button", "check box", "combo box", "slider", "spin button", "entry", "link"];

const BUTTON: &str = "button";
/// Controls of the start, in the order in which they are seen.
const START: [&str; 8] = [
    "button 'File'",
    "button 'Keys and mouse'",
    "button 'Open the demo scene'",
    "button 'Open a file…'",
    "button 'A statue'",
    "button 'A fountain'",
    "button 'Roofs'",
    "link 'photo.png'",
];
/// Controls while a picture is edited.
const EDITING: [&str; 27] = [
    "button 'File'",
    "button 'Undo'",
    "button 'Redo'",
    "toggle button 'Browse looks'",
    "toggle button 'Look'",
    "toggle button 'Wipe'",
    "toggle button 'Side by side'",
    "toggle button 'Difference'",
    "combo box 'Show'",
    "button 'Save look'",
    "button 'Copy command'",
    "button 'Export'",
    "button 'Keys and mouse'",
    "combo box 'Look'",
    "button 'Looks'",
    "button 'Reset to look'",
    "toggle button 'Nodes'",
    "toggle button 'Look'",
    "slider 'Blur'",
    "spin button 'Blur'",
    "toggle button 'Output'",
    "toggle button 'Brush'",
    "toggle button 'Histogram'",
    "slider 'Width of the panel'",
    "spin button 'Exposure'",
    "toggle button 'Fit'",
    "button 'Magnification 272 %'",
];
/// Controls of the dialog for exports.
const EXPORT: [&str; 8] = [
    "combo box 'Format'",
    "combo box 'Size'",
    "combo box 'Bit depth'",
    "entry 'File'",
    "button 'Choose…'",
    "button 'Start the export'",
    "button 'Cancel'",
    "button 'Close'",
];

/// A window of a size on a bus, with what else is asked for.
fn open<'d>(display: &'d Display, bus: &Bus, folder: &Path, arguments: &[&str]) -> Window<'d> {
    let mut command = view(folder, &format!("{}x{}", SIZE.0, SIZE.1));
    command.env("DBUS_SESSION_BUS_ADDRESS", &bus.address).args(arguments);
    Window::open_beside(display, &mut command)
}

/// Controls that people act on, as one line each.
fn active(bus: &Bus) -> Vec<String> {
    let controls = bus.controls();
    controls.iter().filter(|control| is_active(control)).map(Control::line).collect()
}

fn is_active(control: &Control) -> bool {
    ACTIVE.contains(&control.role.as_str())
}

/// Controls follow each other as they are seen: none stands above the one before it, unless it begins to the right of it.
fn is_in_order(bus: &Bus) {
    let controls: Vec<Control> = bus.controls().into_iter().filter(is_active).collect();
    for pair in controls.windows(2) {
        let [before, after] = [0, 1].map(|index| bus.place(&pair[index]));
        assert!(after[3] > before[1] || after[0] >= before[2], "{:?} {before:?} {after:?}", pair);
    }
}

/// Controls that Tab goes to, until it comes back to the first one.
fn walk(window: &mut Window<'_>, bus: &Bus, key: &str) -> Vec<String> {
    let mut seen: Vec<(Control, String)> = Vec::new();
    let place = |control: &Control| bus.place(control);
    loop {
        let before = bus.focused().map(|control| place(&control));
        window.key(key);
        window.wait_for("the focus elsewhere", |_| {
            bus.focused().is_some_and(|control| Some(place(&control)) != before)
        });
        let now = bus.focused().expect("it was waited for");
        if seen.iter().any(|(control, _)| place(control) == place(&now)) {
            return seen.into_iter().map(|(_, line)| line).collect();
        }
        let line = now.line();
        seen.push((now, line));
    }
}

/// Waits until a control is in a state.
fn becomes(window: &mut Window<'_>, bus: &Bus, (role, name): (&str, &str), state: &str) {
    let mut last = None;
    window.wait_for(&format!("{role} '{name}' to be {state}"), |_| {
        last = bus.controls().into_iter().find(|control| control.role == role && control.name == name);
        last.as_ref().is_some_and(|control| control.is(state))
    });
}

/// Waits until there is no dialog.
fn is_closed(window: &mut Window<'_>, bus: &Bus) {
    window.wait_for("no dialog", |_| bus.controls().iter().all(|control| control.role != "dialog"));
}

/// Names of the dialogs that are open.
fn dialogs(bus: &Bus) -> Vec<String> {
    let controls = bus.controls().into_iter();
    controls.filter(|control| control.role == "dialog").map(|control| control.name).collect()
}

#[test]
fn every_control_is_told_with_name_role_and_value_and_can_be_acted_on() {
    let Some(display) = Display::open("1100x700") else { return };
    let folder = folder();
    let Some(bus) = Bus::open(&display, folder.path()) else { return };
    let photo = folder.path().join("photo.png");
    picture(240, 160).save(&photo).unwrap();
    fs::write(folder.path().join("view.json"), format!(r#"{{"recent": [{photo:?}]}}"#)).unwrap();
    let mut window = open(&display, &bus, folder.path(), &["--style", "gaussian"]);
    bus.find(&mut window, BUTTON, "Open the demo scene");
    assert_eq!(active(&bus), START);
    is_in_order(&bus);
    let recent = bus.find(&mut window, "link", "photo.png");
    bus.press(&recent);
    window.shows("photo.png", "gaussian");
    bus.find(&mut window, "image", "photo.png in the look Gaussian blur");
    assert_eq!(active(&bus), EDITING);
    is_in_order(&bus);
    // What is set from outside is seen.
    let before = window.settled(CANVAS);
    let sigma = bus.find(&mut window, "slider", "Blur");
    let [least, now, most] = bus.value(&sigma);
    assert!(least < now && now < most, "{least} {now} {most}");
    bus.set_value(&sigma, most);
    window.changes("a softer picture", CANVAS, &before);
    assert_eq!(bus.value(&sigma), [least, most, most]);
    let undo = bus.find(&mut window, BUTTON, "Undo");
    bus.press(&undo);
    window.becomes("the picture of before", CANVAS, &before);
    // Cards of looks.
    let browse = bus.find(&mut window, "toggle button", "Browse looks");
    bus.press(&browse);
    let card = bus.find(&mut window, BUTTON, "Clear line");
    is_in_order(&bus);
    bus.press(&card);
    becomes(&mut window, &bus, (BUTTON, "Clear line"), "selected");
    let back = bus.find(&mut window, BUTTON, "Back to the picture");
    bus.press(&back);
    bus.find(&mut window, "image", "photo.png in the look Clear line");
    // A dialog, which is over what is behind it.
    window.key("ctrl+e");
    becomes(&mut window, &bus, ("dialog", "Export"), "modal");
    bus.find(&mut window, "entry", "File");
    let within = bus.controls();
    let at = within.iter().position(|control| control.role == "dialog").unwrap();
    let within: Vec<String> = within[at..].iter().filter(|c| is_active(c)).map(Control::line).collect();
    assert_eq!(within, EXPORT);
    window.key("Escape");
    is_closed(&mut window, &bus);
    window.close();
    assert_eq!(window.said(), "");
}

/// A slider is moved by keys, at last to its end.
fn moves(window: &mut Window<'_>, bus: &Bus, sigma: &Control) {
    bus.focus(sigma);
    becomes(window, bus, ("slider", "Blur"), "focused");
    let [least, _, most] = bus.value(sigma);
    let mut moved = |key: &str, by: f64| {
        let before = bus.value(sigma)[1];
        window.key(key);
        // The number is told as it is kept, with the digits of a float, a frame after it was given.
        window.wait_for(key, |_| (bus.value(sigma)[1] - before).abs() > by.abs() * 0.01);
        let changed = bus.value(sigma)[1] - before;
        assert!((changed - by).abs() < by.abs() * 0.51 + 1e-6, "{key}: {changed}, not {by}");
    };
    let step = (most - least) / 100.0;
    for (key, by) in [("Right", step), ("Up", step), ("shift+Left", -step / 10.0), ("Down", -step)] {
        moved(key, by);
    }
    for (key, end) in [("Home", least), ("End", most)] {
        window.key(key);
        window.wait_for(key, |_| bus.value(sigma)[1] == end);
    }
}

#[test]
fn keys_walk_the_controls_move_sliders_and_stay_within_dialogs() {
    let Some(display) = Display::open("1100x700") else { return };
    let folder = folder();
    let Some(bus) = Bus::open(&display, folder.path()) else { return };
    let photo = folder.path().join("photo.png");
    picture(240, 160).save(&photo).unwrap();
    let photo = photo.to_str().unwrap();
    let mut window = open(&display, &bus, folder.path(), &["--style", "gaussian", "--style", "none", photo]);
    window.shows("photo.png", "gaussian");
    let sigma = bus.find(&mut window, "slider", "Blur");
    // Tab goes through all controls and comes back, Shift+Tab goes the other way.
    let there = walk(&mut window, &bus, "Tab");
    let can_be: Vec<String> =
        bus.controls().iter().filter(|c| c.is("focusable") && c.is("enabled")).map(Control::line).collect();
    assert_eq!(there, can_be);
    let mut back = walk(&mut window, &bus, "shift+Tab");
    back.reverse();
    assert_eq!(there, back);
    moves(&mut window, &bus, &sigma);
    let most = bus.value(&sigma)[1];
    // The focus goes into a dialog, does not leave it, and returns; other keys do nothing behind it.
    window.key("ctrl+e");
    becomes(&mut window, &bus, (BUTTON, "Start the export"), "focused");
    let within = walk(&mut window, &bus, "Tab");
    assert_eq!(within.len(), EXPORT.len(), "{within:?}");
    for key in ["n", "l", "r", "ctrl+s", "ctrl+e", "question", "2"] {
        window.key(key);
    }
    window.point([30, 18], &["sleep", "0.1", "click", "1"]);
    assert_eq!(dialogs(&bus), ["Export"]);
    // Also where the window hears of a click behind the dialog and of the key that closes it at once.
    for _ in 0..3 {
        window.point([30, 18], &["click", "1", "key", "Escape"]);
        is_closed(&mut window, &bus);
        becomes(&mut window, &bus, ("slider", "Blur"), "focused");
        window.key("ctrl+e");
        becomes(&mut window, &bus, (BUTTON, "Start the export"), "focused");
    }
    // However long it is held: keys come again after two thirds of a second.
    window.hold("Escape", "1.5");
    is_closed(&mut window, &bus);
    becomes(&mut window, &bus, ("slider", "Blur"), "focused");
    assert!(window.title().contains("– Gaussian blur") && bus.value(&sigma)[1] == most, "{}", window.title());
    // Enter does what a dialog is for.
    window.key("ctrl+e");
    becomes(&mut window, &bus, (BUTTON, "Start the export"), "focused");
    window.key("Return");
    let exported = folder.path().join("photo-look.png");
    window.wait_for("the export", |_| exported.exists());
    window.discard();
    assert_eq!(window.said(), "");
}

#[test]
fn letters_among_the_looks_search_and_arrows_walk() {
    let Some(display) = Display::open("1100x700") else { return };
    let folder = folder();
    let Some(bus) = Bus::open(&display, folder.path()) else { return };
    let photo = folder.path().join("photo.png");
    picture(96, 64).save(&photo).unwrap();
    let photo = photo.to_str().unwrap();
    let styles = ["--style", "none", "--style", "gaussian", "--set", "sigma=2", photo];
    let mut window = open(&display, &bus, folder.path(), &styles);
    window.shows("photo.png", "none");
    window.key("n");
    window.shows("photo.png", "gaussian");
    window.key("shift+n");
    window.shows("photo.png", "none");
    window.key("l");
    let field = bus.find(&mut window, "entry", "Search looks");
    bus.find(&mut window, BUTTON, "Saturday comic");
    let mut card = String::new();
    for key in ["Right", "Left"] {
        window.key(key);
        window.wait_for("another card", |_| {
            let focused = bus.focused().filter(|now| now.is("selected") && now.name != card);
            card = focused.map_or(card.clone(), |now| now.name);
            bus.focused().is_some_and(|now| now.name == card)
        });
    }
    // With a delay between them, as people type, and fast.
    let id = window.id.clone();
    for word in ["water", "color q"] {
        let delay = if word == "water" { "120" } else { "1" };
        window.wait_for("what is typed", |_| {
            display.xdotool(&["windowfocus", "--sync", &id, "type", "--delay", delay, word]).is_some()
        });
    }
    window.wait_for("what was typed", |_| bus.text(&field) == "watercolor q");
    window.key("ctrl+a");
    window.wait_for("what is typed", |_| {
        display.xdotool(&["windowfocus", "--sync", &id, "type", "copperplate"]).is_some()
    });
    window.wait_for("what was typed", |_| bus.text(&field) == "copperplate");
    window.key("Down");
    becomes(&mut window, &bus, (BUTTON, "Copperplate"), "focused");
    window.key("Return");
    window.shows("photo.png", "Copperplate");
    window.close();
    assert_eq!(window.said(), "");
}
