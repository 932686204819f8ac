//! Paper and hatching in the window: they are chosen from lists or files, lie on what is shown, and are part of its command.

use std::path::PathBuf;
use std::sync::Arc;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use isophote_loader::Library;
use isophote_pictures::exr::Guide;
use isophote_pictures::material::{Material, MaterialKind, tiled};
use isophote_pictures::meaning::Meaning;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::command;
use isophote_window::state::demo;
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::{Dialog, Opened, Outcome};
use isophote_window::state::scenery::{OnScene, Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::work::Request;
use isophote_window::widgets;

use crate::support::{self, picture};

/// A hundredth of 1080 lines, rounded.
const SIZE: (u32, u32) = (16, 11);

#[test]
fn materials_are_chosen_and_lie_on_the_picture() {
    let folder = support::folder();
    let file = folder.path().join("in.png");
    picture(SIZE.0, SIZE.1).save(&file).expect("it can be written");
    let library = Library::from_file(support::library()).expect("the library");
    let looks = vec![EditedLook::open(&library, "ink".as_ref()).expect("the style")];
    let session = Session::new(library, looks, Settings::default()).expect("a session");
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 3000.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    let open = |options: &Options| {
        Document::open(&file, options).expect("a picture").playback().expect("it is read")
    };
    harness.state_mut().show_playback(open(&Options::default()));
    harness.run_ok();
    harness.get_by_label("Materials").click();
    harness.run_ok();
    let choose = |harness: &mut Harness<'_, Session>, list: &str, name: &str| {
        harness.get_by_role_and_label(Role::ComboBox, list).click();
        harness.run_ok();
        harness.get_by_label(name).click();
        harness.run_ok();
        harness.state_mut().work.take_requests()
    };
    let pen = (MaterialKind::Hatching, PathBuf::from("pen"));
    let chosen = choose(&mut harness, "Hatching", "Pen");
    assert_eq!(chosen, [Request::ChooseMaterial(pen.0, Some(pen.1.clone()))]);
    let dialog = Dialog::Material(MaterialKind::Paper);
    assert_eq!(choose(&mut harness, "Paper", "From a file…"), [Request::Choose(dialog)]);
    let own = folder.path().join("own paper.png");
    harness.state_mut().take_over(Outcome::Chosen(dialog, vec![own.clone()]));
    let wanted = [Request::ChooseMaterial(MaterialKind::Paper, Some(own.clone()))];
    assert_eq!(harness.state_mut().work.take_requests(), wanted);
    // Opened once more, the picture has them.
    picture(200, 100).save(&own).expect("it can be written");
    let materials = vec![pen, (MaterialKind::Paper, own)];
    let playback = open(&Options { materials, ..Options::default() });
    let (frame, _) = playback.frame(false).expect("it is read");
    let frame = Arc::clone(frame);
    let hatching = frame.guide(Guide::Hatching).expect("it is laid");
    let shipped =
        MaterialKind::Hatching.shipped().iter().find(|shipped| shipped.name == "pen").expect("it ships");
    let scale = f64::from(SIZE.1) / 1080.0;
    let tile =
        Material::of(MaterialKind::Hatching, shipped).scaled([scale; 2], &Meaning::display(), [i64::MAX; 2]);
    assert_eq!((hatching.channels, &hatching.data), (4, &tiled(&tile, SIZE, [0; 2]).to_f32()));
    assert_eq!(frame.guide(Guide::Paper).map(|paper| paper.data.len()), Some(16 * 11 * 4));
    harness.state_mut().take_over(Outcome::Opened(Opened::Again(Box::new(playback))));
    harness.run_ok();
    let line = command::line(harness.state());
    assert!(line.contains("--hatching pen") && line.contains("own paper.png"), "{line}");
    let chosen = choose(&mut harness, "Hatching", "The look's own");
    assert_eq!(chosen, [Request::ChooseMaterial(MaterialKind::Hatching, None)]);
}

#[test]
fn scenes_lie_on_materials_too() {
    let library = Library::from_file(support::library()).expect("the library");
    let looks = vec![EditedLook::open(&library, "ink".as_ref()).expect("the style")];
    let mut session = Session::new(library, looks, Settings::default()).expect("a session");
    let scene = Scenery::new(demo::scene().expect("the scene"), Staging::default(), 1.5);
    session.show_scene(scene, None, "Demo".into());
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 3000.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness.get_by_label("Materials").click();
    harness.run_ok();
    harness.get_by_role_and_label(Role::ComboBox, "Hatching").click();
    harness.run_ok();
    harness.get_by_label("Pen").click();
    harness.run_ok();
    let (kind, name) = (MaterialKind::Hatching, PathBuf::from("pen"));
    let chosen = harness.state_mut().work.take_requests();
    assert_eq!(chosen, [Request::ChooseMaterial(kind, Some(name.clone()))]);
    let material = Arc::new(kind.open(&name).expect("it ships"));
    let pen = Opened::Material(kind, Some(OnScene { name, material }));
    harness.state_mut().take_over(Outcome::Opened(pen));
    harness.run_ok();
    let line = command::line(harness.state());
    assert!(line.contains("isophote render") && line.contains("--hatching pen"), "{line}");
    // What is of another kind stays.
    harness.state_mut().take_over(Outcome::Opened(Opened::Material(MaterialKind::Paper, None)));
    assert!(command::line(harness.state()).contains("--hatching pen"));
    harness.state_mut().take_over(Outcome::Opened(Opened::Material(kind, None)));
    assert!(!command::line(harness.state()).contains("--hatching"));
}
