//! The controls of `isophote view`, without a window: every parameter of every style is found by its label, and what is done
//! to it changes the look.

use std::collections::HashMap;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use isophote_files::files::Existing;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_pictures::floats::{self, Layer, Picture, Precision};
use isophote_scene::Scene;
use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::look::EditedLook;
use isophote_window::state::outcome::{Opened, Outcome};
use isophote_window::state::progress::{Progress, State};
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::work::Request;
use isophote_window::widgets;

use crate::support;

/// A session of all styles with a scene.
fn session() -> Session {
    let library = Library::from_file(support::library()).unwrap();
    let mut names = vec!["none".to_owned()];
    let catalogue = library.catalogue().unwrap();
    names.extend(catalogue.nodes.iter().filter(|n| n.group == "styles").map(|n| n.id.to_owned()));
    let looks = names.iter().map(|name| EditedLook::open(&library, name.as_ref()).unwrap()).collect();
    let mut session = Session::new(library, looks, Settings::default()).unwrap();
    let folder = support::folder();
    let scene = Scene::load(&support::cube(folder.path()), None).unwrap();
    session.show_scene(Scenery::new(scene, Staging::default(), 1.5), None, "cube".into());
    session
}

/// The controls in a window large enough for all of them.
fn harness(session: Session) -> Harness<'static, Session> {
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 2400.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness
}

/// Opens headings that are not among those that were opened before: they stay open from style to style.
fn open_headings(harness: &mut Harness<'_, Session>, closed: &mut Vec<&str>) {
    closed.retain(|heading| {
        let found = harness.query_by_label(heading).map(|heading| heading.click());
        harness.run_ok();
        found.is_none()
    });
}

#[test]
fn every_parameter_of_every_style_is_found_by_its_label() {
    let mut harness = harness(session());
    let mut closed = vec!["Advanced", "Time", "Output", "Scene and light"];
    for index in 1..harness.state().looks.list().len() {
        harness.state_mut().choose(index);
        harness.run_ok();
        open_headings(&mut harness, &mut closed);
        let session = harness.state();
        let mut labels: HashMap<&str, usize> = HashMap::new();
        for parameter in session.looks.parameters().iter() {
            *labels.entry(parameter.param.label).or_default() += 1;
        }
        assert!(labels.len() > 10);
        let name = session.look().name.clone();
        for (label, count) in labels {
            let is_control = |role| role != Role::Label;
            let found =
                harness.query_all_by_label(label).filter(|node| is_control(node.accesskit_node().role()));
            let found = found.count();
            assert!(found >= count, "{name}: '{label}' is the name of {found} controls");
        }
    }
}

#[test]
fn a_value_of_a_type_is_set_as_its_words_are() {
    let session = session();
    let [mut tried, mut refused] = [0, 0];
    for look in session.looks.list().iter().filter(|look| !look.is_plain()) {
        let [typed, written] = [0; 2].map(|_| look.style(&session.library).unwrap().unwrap().graph);
        for parameter in look.parameters(&session.library).unwrap() {
            for value in parameter.default.others(&parameter.param.kind) {
                let (node, id) = (parameter.node, parameter.param.id);
                let of_words = written.set(node, id, &value.text());
                assert_eq!(value.put(&typed, node, id).is_ok(), of_words.is_ok(), "{id}: {value:?}");
                assert_eq!(typed.to_json().unwrap(), written.to_json().unwrap(), "{id}: {value:?}");
                tried += 1;
                refused += usize::from(of_words.is_err());
            }
        }
    }
    assert!(tried > 500 && refused < tried / 10, "{refused} of {tried}");
}

#[test]
fn a_value_is_undone_redone_and_set_back() {
    let mut harness = harness(session());
    harness.state_mut().choose(1);
    harness.run_ok();
    let session = harness.state_mut();
    let parameter = session
        .looks
        .parameters()
        .iter()
        .find(|parameter| matches!(parameter.default, Value::Float(_)))
        .unwrap()
        .clone();
    let Value::Float(before) = session.look().value(&parameter) else { unreachable!() };
    for step in 1..4 {
        session.set(&parameter, &Value::Float(before + 0.125 * step as f32));
    }
    session.let_go();
    let after = Value::Float(before + 0.375);
    assert_eq!(session.look().value(&parameter), after);
    assert!(session.look().differs(&parameter) && session.look().is_changed());
    session.undo();
    assert_eq!(session.look().value(&parameter), Value::Float(before), "a drag is one step");
    session.redo();
    assert_eq!(session.look().value(&parameter), after);
    harness.run_ok();
    harness.get_by_label("Reset to look").click();
    harness.run_ok();
    assert!(!harness.state().look().differs(&parameter));
    harness.get_by_label("Undo").click();
    harness.run_ok();
    assert_eq!(harness.state().look().value(&parameter), after);
}

#[test]
fn controls_can_be_used_by_programs_that_read_windows_aloud() {
    let mut harness = harness(session());
    let index = harness.state().looks.list().iter().position(|look| look.name == "Cartoon").unwrap();
    harness.state_mut().choose(index);
    harness.run_ok();
    let parameter = harness
        .state()
        .looks
        .parameters()
        .iter()
        .find(|parameter| parameter.param.label == "Posterize")
        .unwrap()
        .clone();
    let slider =
        harness.query_all_by_label("Posterize").find(|node| node.accesskit_node().role() == Role::Slider);
    slider.unwrap().click();
    harness.run_ok();
    assert!(harness.state().look().differs(&parameter), "a click in the middle of a slider sets it");
    harness.get_by_label("Wipe").click();
    harness.run_ok();
    assert_eq!(harness.query_all_by_label("Wipe").count(), 2, "the line of the wipe has a name, too");
    harness.get_by_role_and_label(Role::Button, "Keys and mouse").click();
    harness.run_ok();
    assert!(harness.query_by_label_contains("original while it is held").is_some());
}

#[test]
fn a_saved_look_is_the_same_look_and_its_command_is_short() {
    let folder = support::folder();
    let file = folder.path().join("mine.json");
    let mut session = session();
    session.choose(1);
    let parameters = session.looks.parameters().clone();
    let changed = parameters.iter().filter(|parameter| !matches!(parameter.default, Value::Choice(_)));
    for parameter in changed.take(4) {
        let other = parameter.default.others(&parameter.param.kind).swap_remove(0);
        session.set(parameter, &other);
    }
    let mut look = session.look().clone();
    assert_eq!(look.settings(&parameters).len(), 4);
    look.save(&file, look.preset.title.clone()).unwrap();
    assert!(!look.is_changed() && look.settings(&parameters).is_empty());
    let opened = EditedLook::open(&session.library, &file).unwrap();
    assert_eq!(opened, look);
    std::fs::write(&file, r#"{"style": "cartoon", "parameters": {"later": 1}}"#).unwrap();
    let error = EditedLook::open(&session.library, &file).unwrap_err().to_string();
    assert!(error.contains("later"), "{error}");
}

#[test]
fn an_export_is_asked_for_in_a_window_of_its_own() {
    let folder = support::folder();
    let mut session = session();
    let scene = Scene::load(&support::cube(folder.path()), None).unwrap();
    let file = folder.path().join("cube.gltf");
    session.show_scene(Scenery::new(scene, Staging::default(), 1.5), Some(file), "cube".into());
    session.plan_export();
    let mut harness = harness(session);
    harness.get_by_label("A turntable").click();
    harness.run_ok();
    let plan = harness.state().dialogs.plan.clone().expect("a plan");
    assert!(plan.path.ends_with("cube-look.####.png"), "{}", plan.path);
    assert_eq!(plan.frames().as_deref(), Some("96"));
    harness.get_by_label("Start the export").click();
    harness.run_ok();
    assert_eq!(harness.state().work.requests(), [Request::Export]);
}

/// A session of all styles with a photograph in a folder, the first style chosen.
fn with_photo(folder: &std::path::Path) -> Session {
    let file = folder.join("photo.png");
    support::picture(40, 30).save(&file).unwrap();
    let mut session = session();
    session.choose(1);
    session.show_playback(Document::open(&file, &Options::default()).unwrap().playback().unwrap());
    session
}

#[test]
fn an_export_offers_what_files_have_and_asks_before_it_replaces_the_photograph() {
    let folder = support::folder();
    let mut harness = harness(with_photo(folder.path()));
    harness.get_by_role_and_label(Role::Button, "Export").click();
    harness.run_ok();
    let choose = |harness: &mut Harness<'_, Session>, list: &str, entry: &str| {
        harness.get_by_role_and_label(Role::ComboBox, list).click();
        harness.run_ok();
        harness.get_by_label(entry).click();
        harness.run_ok();
    };
    assert!(harness.query_by_label("Quality").is_none(), "it is for JPEG");
    choose(&mut harness, "Bit depth", "16 bits");
    choose(&mut harness, "Size", "Half");
    let plan = harness.state().dialogs.plan.clone().expect("a plan");
    assert_eq!(plan.options().words().join(" "), "--depth 16 --resize 50%");
    choose(&mut harness, "Format", "JPEG");
    assert!(
        harness.query_by_label("Bit depth").is_none() && harness.query_all_by_label("Quality").count() > 0
    );
    let plan = harness.state_mut().dialogs.plan.as_mut().expect("a plan");
    assert!(plan.path.ends_with("photo-look.jpg"), "{}", plan.path);
    plan.place(&folder.path().join("photo.png"));
    harness.run_ok();
    harness.get_by_label("Start the export").click();
    harness.run_ok();
    harness.get_by_label_contains("This replaces the photograph you opened, photo.png.");
    assert!(harness.get_by_label("Cancel").accesskit_node().is_focused(), "Return replaces nothing");
    harness.get_by_label("Cancel").click();
    harness.run_ok();
    assert!(harness.state().work.requests().is_empty());
    harness.get_by_label("Start the export").click();
    harness.run_ok();
    harness.get_by_label("Replace the original").click();
    harness.run_ok();
    assert_eq!(harness.state().work.requests(), [Request::Export]);
}

#[test]
fn one_look_is_used_on_many_pictures_and_what_failed_is_named() {
    let folder = support::folder();
    let mut session = with_photo(folder.path());
    session.choose(0);
    let files = ["photo.png", "other.png"].map(|name| folder.path().join(name));
    let shown = Document::open(&files[0], &Options::default()).unwrap().playback().unwrap();
    let first = Box::new(Opened::Pictures(Box::new(shown)));
    session.take_over(Outcome::Opened(Opened::OfSeveral(first, files.to_vec(), None)));
    let mut harness = harness(session);
    assert!(harness.query_all_by_label("Use this look on 2 pictures").count() > 0, "no dialog");
    harness.get_by_label("Choose a look first.");
    harness.state_mut().choose(1);
    harness.run_ok();
    harness.get_by_label("Use the look on all").click();
    harness.run_ok();
    assert_eq!(harness.state_mut().work.take_requests(), [Request::UseOnSeveral]);
    let place = std::path::PathBuf::from(&harness.state().dialogs.batch.as_ref().expect("a batch").folder);
    let come = |harness: &mut Harness<'_, Session>, done, state| {
        harness.state_mut().take_over(Outcome::Export(Progress { done, total: 2.0, state }));
        harness.run_ok();
    };
    harness.state_mut().take_over(Outcome::ExportBegun(Ok(())));
    come(&mut harness, 1.0, State::Running);
    assert!(harness.state().dialogs.batch.is_none() && harness.state().work.exported == Some(0.5));
    assert!(harness.state().work.running.as_ref().expect("an export").words().starts_with("1 of 2 pictures"));
    come(&mut harness, 2.0, State::Partly(vec!["other.png: is damaged".into()]));
    harness.get_by_label_contains("1 of 2 could not be done; the others are there.");
    harness.get_by_label_contains("other.png: is damaged");
    harness.get_by_label("Show in folder").click();
    harness.run_ok();
    assert_eq!(harness.state_mut().work.take_requests(), [Request::Reveal(place)]);
}

#[test]
fn layers_are_chosen_from_a_list() {
    let folder = support::folder();
    let file = folder.path().join("layers.exr");
    write_layers(&file);
    let mut session = session();
    let document = Document::open(&file, &Options::default()).unwrap();
    session.show_playback(document.playback().unwrap());
    let mut harness = harness(session);
    harness.get_by_role_and_label(Role::ComboBox, "Layer").click();
    harness.run_ok();
    harness.get_by_label("beauty").click();
    harness.run_ok();
    let requests = harness.state().work.requests();
    assert!(
        matches!(requests, [Request::ChooseLayer(layer, None)] if layer.name == "beauty"),
        "{requests:?}"
    );
}

/// Writes a picture with a layer beside the main one.
fn write_layers(file: &std::path::Path) {
    let data: Vec<f32> = (0..8 * 4 * 6).map(|n| n as f32 / 192.0).collect();
    let picture = |at: usize| Picture { width: 8, height: 4, channels: 3, data: data[at..at + 96].to_vec() };
    let (main, beauty) = (picture(0), picture(96));
    let precision = Precision::Half;
    let layers = [
        Layer { picture: &main, names: &["R", "G", "B"], precision },
        Layer { picture: &beauty, names: &["beauty.R", "beauty.G", "beauty.B"], precision },
    ];
    floats::save_layers(file, Existing::Replace, &layers, floats::Header::default()).unwrap();
}
