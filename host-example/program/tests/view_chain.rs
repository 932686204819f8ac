//! Looks that are lists of nodes: as graphs, as files, and in the window's panel.

use std::path::PathBuf;
use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_scene::Scene;
use isophote_window::jobs::listing::{self, ListingRequest};
use isophote_window::state::chain::{self, Chain, Watched};
use isophote_window::state::command;
use isophote_window::state::look::EditedLook;
use isophote_window::state::resetting::Goal;
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::widgets;

use crate::support;

fn library() -> Library {
    Library::from_file(support::library()).unwrap()
}

fn session(look: &str) -> Session {
    let library = library();
    let look = EditedLook::open(&library, look.as_ref()).unwrap();
    Session::new(library, vec![look], Settings::default()).unwrap()
}

fn names(session: &Session) -> Vec<String> {
    session.looks.chain().unwrap().links.iter().map(|link| link.name.clone()).collect()
}

fn add(session: &mut Session, node: &str) {
    session.relink(|chain, library| chain.add(library, node, chain.end()).map(drop));
}

#[test]
fn graphs_that_are_lists_are_read_as_such_and_others_are_not() {
    let library = library();
    let graph = |name: &str| support::root().join(format!("host-example/graphs/{name}.json"));
    let look = EditedLook::open(&library, &graph("ink")).unwrap();
    let chain = look.chain(&library).unwrap().unwrap();
    let names: Vec<&str> = chain.links.iter().map(|link| link.name.as_str()).collect();
    assert_eq!(names, ["smooth", "lines"]);
    assert!(chain.has("tensor"));
    assert_eq!(Chain::read(&library, &chain.json()).unwrap(), chain);
    for other in ["poster", "flow"] {
        assert!(
            EditedLook::open(&library, &graph(other)).unwrap().chain(&library).unwrap().is_none(),
            "{other}"
        );
    }
    for broken in
        ["", "{}", r#"{"nodes": [], "output": "a"}"#, r#"{"nodes": [{"name": "a"}], "output": "a"}"#]
    {
        assert!(Chain::read(&library, broken).is_none(), "{broken}");
    }
}

#[test]
fn every_node_that_fits_can_follow_every_look() {
    let library = library();
    let fitting = chain::fitting(&library);
    assert!(fitting.len() > 15);
    let mut chain = EditedLook::open(&library, "cartoon".as_ref()).unwrap().chain(&library).unwrap().unwrap();
    for node in &fitting {
        chain.add(&library, node.id, chain.end()).unwrap();
    }
    let json = chain.json();
    library.graph_from_json(&json).unwrap();
    assert_eq!(Chain::read(&library, &json).unwrap().json(), json);
}

#[test]
fn nodes_are_added_moved_passed_by_and_removed_step_by_step() {
    let mut session = session("cartoon");
    let parameter = session
        .looks
        .parameters()
        .iter()
        .find(|parameter| matches!(parameter.default, Value::Float(_)))
        .unwrap()
        .clone();
    let value = parameter.default.others(&parameter.param.kind).swap_remove(0);
    session.set(&parameter, &value);
    session.let_go();
    add(&mut session, "bilateral");
    add(&mut session, "bilateral");
    assert_eq!(names(&session), ["cartoon", "bilateral", "bilateral_2"]);
    let kept = session
        .looks
        .parameters()
        .iter()
        .find(|own| own.name == format!("cartoon.{}", parameter.name))
        .unwrap();
    assert_eq!(session.look().value(kept), value);

    session.relink(|chain, _| {
        chain.shift(0, 2);
        Ok(())
    });
    assert_eq!(names(&session), ["bilateral", "bilateral_2", "cartoon"]);
    session.relink(|chain, _| {
        assert!(chain.toggle(1));
        Ok(())
    });
    let chain = session.looks.chain().unwrap();
    assert!(chain.links[1].bypassed);
    assert_eq!(Chain::read(&session.library, &chain.json()).unwrap(), *chain);
    session.looks.watch(Some(Watched::After("bilateral".into())));
    assert!(session.looks.seen().preset.style.contains(r#""output":"bilateral""#));
    session.looks.watch(Some(Watched::Alone("cartoon".into())));
    assert_ne!(*session.looks.seen(), *session.look());

    session.relink(|chain, _| {
        assert!(chain.remove(2), "one is left");
        assert!(!chain.remove(0) && !chain.toggle(0), "the last one stays");
        Ok(())
    });
    assert_eq!(names(&session), ["bilateral", "bilateral_2"]);
    assert_eq!(session.looks.watched(), None, "its node is gone");
    assert!(session.look().preset.params.is_empty());
    for _ in 0..5 {
        session.undo();
    }
    assert_eq!(session.look().preset.style, "cartoon");
    assert_eq!(session.look().value(&parameter), value);
}

#[test]
fn reset_brings_back_the_nodes_of_the_look_and_knows_its_values_under_their_new_names() {
    let folder = support::folder();
    let file = folder.path().join("mine.json");
    std::fs::write(&file, r#"{"style": "cartoon", "parameters": {"posterize": 4}}"#).unwrap();
    let mut session = session(file.to_str().unwrap());
    add(&mut session, "bilateral");
    let find = |session: &Session, name: &str| {
        session.looks.parameters().iter().find(|parameter| parameter.name == name).unwrap().clone()
    };
    let parameters = session.looks.parameters().clone();
    assert!(parameters.iter().all(|parameter| !session.look().strays(parameter)));
    assert_eq!(session.look().way_back(&parameters), Some(Goal::Look), "the nodes are others");
    let posterize = find(&session, "cartoon.posterize");
    session.set(&posterize, &Value::Int(7));
    assert!(session.look().strays(&posterize));
    session.reset(&posterize);
    assert_eq!(session.look().value(&posterize), Value::Int(4));
    session.reset_all();
    assert_eq!(names(&session), ["cartoon"]);
    assert!(!session.look().is_changed());
    let parameters = session.looks.parameters().clone();
    assert_eq!(session.look().way_back(&parameters), Some(Goal::Style));
    session.reset_all();
    assert_eq!(session.look().value(&find(&session, "posterize")), posterize.default);
    for expected in [1, 2] {
        session.undo();
        assert_eq!(names(&session).len(), expected);
    }
}

#[test]
fn what_the_window_saves_and_copies_is_what_apply_reads() {
    let folder = support::folder();
    let picture = folder.path().join("photo.png");
    support::picture(64, 48).save(&picture).unwrap();
    let mut session = session("cartoon");
    add(&mut session, "bilateral");
    session.relink(|chain, library| chain.add(library, "kuwahara", 0).map(drop));
    let parameter = session
        .looks
        .parameters()
        .iter()
        .find(|parameter| parameter.name.starts_with("kuwahara."))
        .unwrap()
        .clone();
    let value = parameter.default.others(&parameter.param.kind).swap_remove(0);
    session.set(&parameter, &value);
    let line = command::line(&session);
    assert!(line.contains("isophote-graph") && line.contains("kuwahara."), "{line}");

    let file = folder.path().join("mine.json");
    let mut look = session.look().clone();
    look.save(&file, look.preset.title.clone()).unwrap();
    let opened = EditedLook::open(&session.library, &file).unwrap();
    assert_eq!(opened, look);
    assert_eq!(
        opened.chain(&session.library).unwrap().unwrap().json(),
        session.looks.chain().unwrap().json()
    );

    let apply = |style: &std::ffi::OsStr, settings: &[String], name: &str| {
        let output = folder.path().join(name);
        let mut command = support::isophote();
        command.arg("apply").arg(style).arg(&picture).arg(&output);
        command.args(settings.iter().flat_map(|setting| ["--set", setting]));
        let done = command.output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        std::fs::read(output).unwrap()
    };
    let saved = apply(file.as_os_str(), &[], "saved.png");
    let live = session.look();
    let written =
        apply(live.preset.style.as_ref(), &live.settings(session.looks.parameters()), "written.png");
    assert!(saved == written);
    assert!(saved != apply("cartoon".as_ref(), &[], "plain.png"));
}

#[test]
fn the_panel_adds_and_removes_nodes() {
    let mut session = session("cartoon");
    let folder = support::folder();
    let scene = Scene::load(&support::cube(folder.path()), None).unwrap();
    session.show_scene(Scenery::new(scene, Staging::default(), 1.5), None, "cube".into());
    let mut harness = Harness::builder()
        .with_size(egui::vec2(1200.0, 1600.0))
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    for label in ["Nodes", "Add a node", "Smoothing", "Bilateral"] {
        harness.get_by_label(label).click();
        harness.run_ok();
    }
    assert_eq!(names(harness.state()), ["cartoon", "bilateral"]);
    harness.get_by_label("Earlier bilateral").click();
    harness.run_ok();
    assert_eq!(names(harness.state()), ["bilateral", "cartoon"]);
    harness.get_by_label("Bypass cartoon").click();
    harness.run_ok();
    assert!(harness.state().looks.chain().unwrap().links[1].bypassed);
    harness.get_by_label("Solo cartoon").click();
    harness.run_ok();
    assert_eq!(harness.state().looks.watched(), Some(&Watched::Alone("cartoon".into())));
    harness.get_by_label("Remove cartoon").click();
    harness.run_ok();
    assert_eq!(names(harness.state()), ["bilateral"]);
    harness.get_by_label("Undo").click();
    harness.run_ok();
    assert_eq!(names(harness.state()).len(), 2);
}

#[test]
fn files_that_change_are_read_again_and_broken_ones_leave_the_look() {
    let folder = support::folder();
    let file = folder.path().join("mine.json");
    std::fs::write(&file, r#"{"style": "cartoon", "parameters": {"posterize": 4}}"#).unwrap();
    let mut session = session(file.to_str().unwrap());
    let read = |session: &Session| EditedLook::open(&session.library, &file);
    let (look, steps) = (session.look().clone(), session.can());
    session.reload(&file, read(&session));
    assert_eq!((session.look(), session.can()), (&look, steps), "nothing has changed");

    let parameter =
        session.looks.parameters().iter().find(|parameter| parameter.name == "posterize").unwrap().clone();
    session.set(&parameter, &Value::parse(&parameter.param.kind, "7").unwrap());
    session.let_go();
    let edited = session.look().clone();
    std::fs::write(&file, r#"{"style": "cartoon", "parameters": {"posterize": "#).unwrap();
    session.reload(&file, read(&session));
    assert_eq!(session.look(), &edited);
    std::fs::write(&file, r#"{"style": "cartoon", "parameters": {"posterize": 9}}"#).unwrap();
    session.reload(&file, read(&session));
    assert_eq!(session.look().value(&parameter).text(), "9");
    assert!(!session.look().is_changed());
    session.undo();
    assert_eq!(session.look(), &edited, "what was not saved comes back");
}

#[test]
fn a_graph_file_that_changes_beside_its_preset_is_another_look() {
    let folder = support::folder();
    let (graph, file) = (folder.path().join("graph.json"), folder.path().join("mine.json"));
    let ink = std::fs::read_to_string(support::root().join("host-example/graphs/ink.json")).unwrap();
    std::fs::write(&graph, &ink).unwrap();
    std::fs::write(&file, r#"{"style": "graph.json"}"#).unwrap();
    let mut session = session(file.to_str().unwrap());
    assert_eq!(session.look().files(), [file.clone(), graph.clone()]);
    std::fs::write(&graph, ink.replace("2.5", "4.5")).unwrap();
    let read = EditedLook::open(&session.library, &file);
    session.reload(&file, read);
    let parameter =
        session.looks.parameters().iter().find(|parameter| parameter.name == "tensor.rho").unwrap();
    assert_eq!(session.look().value(parameter).text(), "4.5");
}

#[test]
fn what_a_style_draws_with_is_chosen_like_a_style() {
    let library = Library::from_file(support::library()).unwrap();
    let listing = listing::read(ListingRequest { library: library.clone(), folders: Vec::new() });
    let node = library.find_node("ink").unwrap();
    let media: Vec<&str> = node.media().map(|(_, medium)| medium.id).collect();
    assert_eq!(media, ["pencil", "charcoal", "woodcut", "pastel"]);
    for (param, medium) in node.media() {
        let source = PathBuf::from(format!("ink:{}", medium.id));
        let found = listing.found.iter().find(|found| found.source == source).unwrap();
        assert_eq!((found.name().as_str(), found.style.as_str()), (medium.label, node.label));
        let mut session = session("cartoon");
        let look = EditedLook::open(&session.library, &source).unwrap();
        assert!(!look.is_changed());
        session.take(Arc::new(look));
        let value = session.look().preset.params.get(param.id).unwrap();
        assert_eq!(value.first(&param.kind), Some(Value::Choice(medium.id.to_owned())));
        let line = command::line(&session);
        assert!(line.contains(" ink ") || line.contains("--style ink"), "{line}");
        assert!(line.contains(&format!("--set style={}", medium.id)), "{line}");
    }
}
