//! The window ends when it is asked to, never by Escape or a letter, and asks before what would be lost is lost.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_scene::Scene;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::leaving::Leaving;
use isophote_window::state::look::EditedLook;
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::widgets;
use winit::keyboard::{Key, NamedKey};

use crate::support::others;
use crate::support::places::places;
use crate::support::window::{Display, Part, Window, screen, view};
use crate::support::{self, folder, listing, picture};

const SIZE: (u32, u32) = (700, 420);
/// The canvas of a window of that size, above what is said at its lower border.
const CANVAS: Part = [0, 60, 350, 290];
/// The middle, where dialogs are.
const MIDDLE: Part = [150, 150, 500, 300];
/// The menu, which is darker behind a dialog.
const MENU: Part = [0, 0, 60, 24];
/// Time in which a dialog that has begun to be shown is whole; one with a cursor never stays the same.
const PAUSE: Duration = Duration::from_millis(700);
/// More of it than anybody presses.
const STORM: [&str; 12] =
    ["key", "--delay", "8", "Escape", "Escape", "Escape", "q", "Escape", "Escape", "Escape", "q", "Escape"];

fn size() -> String {
    format!("{}x{}", SIZE.0, SIZE.1)
}

/// A session like that of a window that was opened with styles and a picture.
fn session(styles: &[&Path], file: &Path) -> Session {
    let library = Library::from_file(support::library()).unwrap();
    let looks = styles.iter().map(|style| EditedLook::open(&library, style).unwrap()).collect();
    let mut session = Session::new(library, looks, Settings::default()).unwrap();
    session.show_playback(Document::open(file, &Options::default()).unwrap().playback().unwrap());
    session
}

/// A picture and a look of one's own in a folder.
fn prepare(folder: &Path) {
    picture(96, 64).save(folder.join("photo.png")).unwrap();
    fs::write(folder.join("mine.json"), MINE).unwrap();
}

const MINE: &str = r#"{"style": "blueprint", "lengths": "pixels", "parameters": {"line_width": 4}}"#;

/// The window with both.
fn open<'d>(display: &'d Display, folder: &Path) -> Window<'d> {
    let mut command = view(folder, &size());
    command.arg("--style").arg(folder.join("mine.json")).args(["--style", "none"]);
    let mut window = Window::open(display, command.arg(folder.join("photo.png")));
    window.point([2, 200], &[]);
    window.shows("photo.png", "mine");
    window
}

#[test]
fn escape_closes_one_thing_at_a_time_and_a_storm_of_it_never_the_window() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = folder();
    prepare(folder.path());
    let mut window = open(&display, folder.path());
    let mut asking = session(&[&folder.path().join("mine.json")], &folder.path().join("photo.png"));
    asking.plan_export();
    let field = places(asking, SIZE)("File", Role::TextInput).center();
    let picture = window.settled(MIDDLE);
    let mut layer = |what: &str, open: &dyn Fn(&mut Window<'_>)| {
        open(&mut window);
        window.changes(what, MIDDLE, &picture);
        sleep(PAUSE);
        window.key("Escape");
        window.becomes("the picture after it", MIDDLE, &picture);
    };
    layer("the dialog for the look", &|window| window.key("ctrl+shift+s"));
    layer("the help", &|window| window.key("question"));
    layer("the grid", &|window| window.key("l"));
    layer("the menu", &|window| window.point([30, 18], &["sleep", "0.1", "click", "1"]));
    // While its field is typed in, too.
    layer("the dialog for an export", &|window| {
        window.key("ctrl+e");
        sleep(PAUSE);
        window.click([field.x as i32, field.y as i32]);
    });
    window.point([2, 200], &STORM);
    window.key("l");
    window.changes("the grid again", MIDDLE, &picture);
    window.key("ctrl+shift+s");
    sleep(PAUSE);
    window.point([2, 200], &STORM);
    // On a busy machine the dialog may have opened after it.
    sleep(PAUSE);
    window.point([2, 200], &STORM);
    window.becomes("the picture after all", MIDDLE, &picture);
    window.key("q");
    window.settled(MIDDLE);
    window.close();
    assert_eq!(window.said(), "");
}

#[test]
fn a_look_that_is_not_saved_is_asked_about_and_kept_saved_or_discarded() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = folder();
    let mine = folder.path().join("mine.json");
    prepare(folder.path());
    for ends in ["discarded", "saved"] {
        let mut window = open(&display, folder.path());
        let before = window.settled(CANVAS);
        window.key("r");
        window.changes("the look without its settings", CANVAS, &before);
        let reset = window.settled(CANVAS);
        let bright = window.asks(|window| window.key("ctrl+q"));
        // Other keys, clicks and files wait for the answer.
        for key in ["2", "l", "ctrl+z", "ctrl+q", "q", "r"] {
            window.key(key);
        }
        window.point([30, 18], &["sleep", "0.1", "click", "1"]);
        assert!(others::drop_files(&display.name, &window.id, &[&mine]));
        window.point([2, 200], &[]);
        window.key("Escape");
        window.goes_on(&bright);
        assert!(window.settled(CANVAS) == reset && window.title().contains("– mine –"), "{}", window.title());
        let id = window.id.clone();
        window.asks(|_| others::close(&display.name, &id));
        others::close(&display.name, &id);
        if ends == "saved" {
            window.key("Return");
            window.closed();
            assert!(!fs::read_to_string(&mine).unwrap().contains("line_width"));
        } else {
            window.key("Tab");
            window.key("Return");
            window.closed();
            assert_eq!(fs::read_to_string(&mine).unwrap(), MINE);
        }
        assert_eq!(window.said(), "");
    }
    assert_eq!(listing(folder.path()), ["mine.json", "photo.png", "view.json"]);
}

#[test]
fn a_window_that_nothing_was_changed_in_closes_at_once() {
    let Some(display) = Display::open("800x600") else { return };
    let folder = folder();
    prepare(folder.path());
    let mut command = view(folder.path(), &size());
    command.args(["--style", "blueprint", "--set", "line_width=2"]).arg(folder.path().join("photo.png"));
    let mut window = Window::open(&display, &mut command);
    window.shows("photo.png", "blueprint");
    let id = window.id.clone();
    others::close(&display.name, &id);
    window.closed();
    assert_eq!(window.said(), "");
}

/// Numbers of processes that export to a folder.
fn processes(folder: &Path) -> Vec<String> {
    let folder = folder.to_str().unwrap();
    let numbers = fs::read_dir("/proc").unwrap().flatten().filter_map(|process| {
        let line = fs::read(process.path().join("cmdline")).ok()?;
        let line = String::from_utf8_lossy(&line);
        (line.contains("--json") && line.contains(folder)).then(|| process.file_name().into_string().unwrap())
    });
    numbers.collect()
}

/// Lets the export of a folder wait (`-STOP`) or go on (`-CONT`), so that it takes as long as the test does.
fn signal(folder: &Path, signal: &str) {
    let processes = processes(folder);
    assert_eq!(processes.len(), 1, "there is an export");
    assert!(Command::new("kill").arg(signal).args(processes).status().unwrap().success());
}

/// A window at work on an export that waits for a signal.
fn exporting<'d>(display: &'d Display, folder: &Path) -> Window<'d> {
    let at = |name: &str| folder.join(name);
    picture(2400, 1800).save(at("photo.png")).unwrap();
    fs::write(at("mine.json"), r#"{"style": "gaussian", "lengths": "pixels"}"#).unwrap();
    let mut command = view(folder, &size());
    let mut window = Window::open(display, command.arg("--style").arg(at("mine.json")).arg(at("photo.png")));
    window.shows("photo.png", "mine");
    let mut asking = session(&[&at("mine.json")], &at("photo.png"));
    asking.plan_export();
    let start = places(asking, SIZE)("Start the export", Role::Button).center();
    let before = window.settled(MIDDLE);
    let bright = screen(display.folder(), MENU);
    window.key("ctrl+e");
    window.changes("the question what to export", MIDDLE, &before);
    sleep(PAUSE);
    window.click([start.x as i32, start.y as i32]);
    window.wait_for("the export", |_| !processes(folder).is_empty());
    signal(folder, "-STOP");
    window.becomes("the window without the question", MENU, &bright);
    window
}

#[test]
fn an_export_goes_on_until_the_question_whether_to_end_it_is_answered() {
    let Some(display) = Display::open("1000x700") else { return };
    let folder = folder();
    let mut window = exporting(&display, folder.path());
    let id = window.id.clone();
    let bright = window.asks(|_| others::close(&display.name, &id));
    window.key("Escape");
    window.goes_on(&bright);
    window.point([2, 200], &STORM);
    window.discard();
    assert_eq!(processes(folder.path()), [""; 0], "no process outlives it");
    assert_eq!(listing(folder.path()), ["mine.json", "photo.png", "view.json"]);
}

#[test]
fn a_window_closes_when_its_export_is_done_if_that_was_answered() {
    let Some(display) = Display::open("1000x700") else { return };
    let folder = folder();
    let mut window = exporting(&display, folder.path());
    window.asks(|window| window.key("ctrl+q"));
    window.key("Return");
    sleep(PAUSE);
    signal(folder.path(), "-CONT");
    window.closed();
    assert_eq!(window.said(), "");
    assert_eq!(listing(folder.path()), ["mine.json", "photo-look.png", "photo.png", "view.json"]);
    let exported = image::open(folder.path().join("photo-look.png")).unwrap();
    assert_eq!((exported.width(), exported.height()), (2400, 1800), "it is whole");
}

/// Gives the first parameter of a look another value.
fn change(session: &mut Session) {
    let number = |value: &Value| matches!(value, Value::Float(_));
    let parameter =
        session.looks.parameters().iter().find(|parameter| number(&parameter.default)).unwrap().clone();
    session.set(&parameter, &parameter.default.others(&parameter.param.kind)[0]);
    session.let_go();
}

fn shown(session: Session) -> Harness<'static, Session> {
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1000.0, 640.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness
}

fn click(harness: &mut Harness<'static, Session>, label: &str) {
    harness.get_by_role_and_label(Role::Button, label).click();
    harness.run_ok();
}

#[test]
fn every_look_that_would_be_lost_is_named_and_can_be_saved_in_turn() {
    let folder = folder();
    prepare(folder.path());
    let mine = folder.path().join("mine.json");
    let mut session = session(&[&mine, "cartoon".as_ref(), "ink".as_ref()], &folder.path().join("photo.png"));
    session.settings.look_folder = Some(folder.path().to_owned());
    session.leave();
    assert_eq!(session.dialogs.leaving, Leaving::Closes, "nothing was changed");
    session.dialogs.leaving = Leaving::Stays;
    change(&mut session);
    session.choose(1);
    change(&mut session);
    session.choose(2);
    session.leave();
    let mut harness = shown(session);
    assert!(harness.query_by_label_contains("2 looks are not saved: “mine”, “Cartoon”.").is_some());
    // One has a file, the other must be given one; whoever changes his mind there stays.
    click(&mut harness, "Save the look…");
    assert_eq!((harness.state().dialogs.leaving, harness.state().looks.unsaved()), (Leaving::Asks, vec![1]));
    assert_ne!(fs::read_to_string(&mine).unwrap(), MINE);
    harness.run_ok();
    click(&mut harness, "Save the look…");
    assert_eq!(
        (harness.state().dialogs.leaving, harness.state().look().name.as_str()),
        (Leaving::Saves, "Cartoon")
    );
    widgets::keys::press(harness.state_mut(), &Key::Named(NamedKey::Escape));
    harness.run_ok();
    assert_eq!((harness.state().dialogs.leaving, harness.state().looks.unsaved()), (Leaving::Stays, vec![1]));
    harness.state_mut().leave();
    harness.run_ok();
    click(&mut harness, "Save the look…");
    click(&mut harness, "Save");
    assert_eq!(harness.state().dialogs.leaving, Leaving::Closes);
    assert_eq!(listing(folder.path()), ["cartoon.json", "mine.json", "photo.png"]);
}

#[test]
fn what_is_taken_back_is_lost_no_more_and_what_was_saved_before_is_again() {
    let folder = folder();
    prepare(folder.path());
    let mine = folder.path().join("mine.json");
    let mut session = session(&[&mine], &folder.path().join("photo.png"));
    change(&mut session);
    assert_eq!(session.looks.unsaved(), [0]);
    session.undo();
    assert!(session.looks.unsaved().is_empty());
    session.redo();
    session.save_look(false);
    assert!(session.looks.unsaved().is_empty());
    // The file has what was saved, not what the window shows now.
    session.undo();
    assert_eq!(session.looks.unsaved(), [0]);
    session.redo();
    assert!(session.looks.unsaved().is_empty());
    // Somebody else writes the file, and the look of before is brought back.
    fs::write(&mine, r#"{"style": "blueprint", "parameters": {"line_width": 5}}"#).unwrap();
    let read = EditedLook::open(&session.library, &mine);
    session.reload(&mine, read);
    assert!(session.looks.unsaved().is_empty());
    session.undo();
    assert_eq!(session.looks.unsaved(), [0]);
}

#[test]
fn the_camera_and_the_light_of_a_scene_are_asked_about_until_their_command_line_is_copied() {
    let folder = folder();
    prepare(folder.path());
    let mut session = session(&["cartoon".as_ref()], &folder.path().join("photo.png"));
    let file = support::cube(folder.path());
    let scene = Scene::load(&file, None).unwrap();
    session.show_scene(Scenery::new(scene, Staging::default(), 1.5), Some(file), "cube".into());
    session.advance();
    session.leave();
    assert_eq!(session.dialogs.leaving, Leaving::Closes, "nothing was changed");
    session.dialogs.leaving = Leaving::Stays;
    session.open.scenery_mut().unwrap().orbit().rotate(0.4, 0.1);
    session.leave();
    let mut harness = shown(session);
    assert!(harness.query_by_label_contains("The camera or the light of the scene was changed.").is_some());
    click(&mut harness, "Copy the command line");
    assert_eq!(harness.state().dialogs.leaving, Leaving::Stays);
    let session = harness.state_mut();
    session.leave();
    assert_eq!(session.dialogs.leaving, Leaving::Closes, "it is kept");
    session.dialogs.leaving = Leaving::Stays;
    session.relight("exposure", |light| light.exposure = 1.0);
    session.leave();
    assert_eq!(session.dialogs.leaving, Leaving::Asks);
}

/// Frames of large pictures take seconds where the processor draws them.
#[test]
fn a_click_counts_however_long_a_frame_takes() {
    let folder = folder();
    prepare(folder.path());
    let mut session = session(&["cartoon".as_ref()], &folder.path().join("photo.png"));
    session.work.exported = Some(0.5);
    session.leave();
    let mut harness = shown(session);
    let pos = harness.get_by_role_and_label(Role::Button, "Close when it is done").rect().center();
    harness.event(egui::Event::PointerMoved(pos));
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        // A quarter of a second each.
        (0..8).for_each(|_| harness.step());
    }
    assert_eq!(harness.state().dialogs.leaving, Leaving::Waits);
}

#[test]
fn a_question_about_an_export_alone_offers_to_wait_and_what_fails_meanwhile_is_seen() {
    let folder = folder();
    prepare(folder.path());
    let mut session = session(&["cartoon".as_ref()], &folder.path().join("photo.png"));
    session.work.exported = Some(0.347);
    session.leave();
    let mut harness = shown(session);
    assert!(harness.query_by_label_contains("An export is running, 34 % of it done.").is_some());
    click(&mut harness, "Close when it is done");
    assert_eq!(harness.state().dialogs.leaving, Leaving::Waits);
    harness.run_ok();
    // The bar at the bottom has one for the export.
    harness.get_all_by_role_and_label(Role::Button, "Cancel").last().unwrap().click();
    harness.run_ok();
    assert_eq!(harness.state().dialogs.leaving, Leaving::Stays);
    for (is_done, then) in [(false, Leaving::Stays), (true, Leaving::Closes)] {
        let session = harness.state_mut();
        (session.work.exported, session.dialogs.leaving) = (Some(0.9), Leaving::Waits);
        session.end_export(is_done);
        assert_eq!((session.dialogs.leaving, session.work.exported), (then, None));
    }
}
