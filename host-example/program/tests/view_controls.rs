//! Single controls of `isophote view`, without a window but by real input: what differs from the look is marked and taken back,
//! numbers and colours are typed, sliders turned by the wheel, the panel made wider, pixels told.

use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_loader::catalogue::ParamKind;
use isophote_scene::Scene;
use isophote_window::state::look::{EditedLook, Parameter};
use isophote_window::state::probed::Probed;
use isophote_window::state::scenery::{Scenery, Staging};
use isophote_window::state::session::Session;
use isophote_window::state::settings::Settings;
use isophote_window::state::viewport::Overlay;
use isophote_window::widgets;

use crate::support;

/// The controls of one look in a window of a size, whose clock goes on by so many seconds a frame.
fn controls_of(look: &Path, size: [f32; 2], seconds: f32) -> Harness<'static, Session> {
    let library = Library::from_file(support::library()).unwrap();
    let look = EditedLook::open(&library, look).unwrap();
    let mut session = Session::new(library, vec![look], Settings::default()).unwrap();
    let folder = support::folder();
    let scene = Scene::load(&support::cube(folder.path()), None).unwrap();
    session.show_scene(Scenery::new(scene, Staging::default(), 1.5), None, "cube".into());
    let mut harness = Harness::builder()
        .with_size(egui::Vec2::from(size))
        .with_step_dt(seconds)
        .build_ui_state(|ui, session: &mut Session| widgets::show(ui, session), session);
    widgets::theme::apply(&harness.ctx);
    harness.run_ok();
    harness
}

fn double_click(harness: &mut Harness<'_, Session>, at: egui::Pos2) {
    // Clicks of before do not count.
    harness.run_steps(30);
    harness.hover_at(at);
    for _ in 0..2 {
        harness.drag_at(at);
        harness.drop_at(at);
    }
    harness.run_ok();
}

/// A look of `cartoon` with settings of its own, in a file.
fn noir(folder: &Path) -> PathBuf {
    let file = folder.join("noir.json");
    std::fs::write(&file, r#"{"style": "cartoon", "parameters": {"posterize": 4, "line_amount": 0.25}}"#)
        .unwrap();
    file
}

fn parameter(harness: &Harness<'_, Session>, name: &str) -> Parameter {
    harness.state().looks.parameters().iter().find(|parameter| parameter.name == name).unwrap().clone()
}

fn value(harness: &Harness<'_, Session>, name: &str) -> String {
    harness.state().look().value(&parameter(harness, name)).text()
}

fn set(harness: &mut Harness<'_, Session>, name: &str, text: &str) {
    let parameter = parameter(harness, name);
    let value = Value::parse(&parameter.param.kind, text).unwrap();
    harness.state_mut().set(&parameter, &value);
    harness.state_mut().let_go();
    harness.run_ok();
}

#[test]
fn reset_goes_back_to_the_look_and_from_there_to_its_style() {
    let folder = support::folder();
    let mut harness = controls_of(&noir(folder.path()), [1200.0, 1600.0], 0.05);
    let default = parameter(&harness, "posterize").default.text();
    assert_ne!(default, "4");
    assert!(harness.query_by_label_contains("Take back").is_none());
    for (name, text) in [("posterize", "9"), ("line_width", "3")] {
        set(&mut harness, name, text);
    }
    harness.get_by_label("Reset to look").click();
    harness.run_ok();
    assert!(!harness.state().look().is_changed());
    assert_eq!(value(&harness, "posterize"), "4");
    assert!(harness.query_by_label_contains("Take back").is_none());
    harness.get_by_label("Reset to style").click();
    harness.run_ok();
    assert_eq!(value(&harness, "posterize"), default);
    assert!(harness.query_by_label("Take back Posterize").is_some());
    harness.get_by_label("Undo").click();
    harness.run_ok();
    assert_eq!(value(&harness, "posterize"), "4");
    harness.get_by_label("Undo").click();
    harness.run_ok();
    assert_eq!([value(&harness, "posterize"), value(&harness, "line_width")], ["9", "3"]);

    harness.get_by_label("Take back Posterize").click();
    harness.run_ok();
    assert_eq!([value(&harness, "posterize"), value(&harness, "line_width")], ["4", "3"]);
    for expected in [default.as_str(), "4"] {
        let name = harness.get_by_role_and_label(Role::Slider, "Posterize").rect().left_center();
        double_click(&mut harness, name - egui::vec2(60.0, 0.0));
        assert_eq!(value(&harness, "posterize"), expected, "a double click on the name");
    }
    set(&mut harness, "posterize", "7");
    set(&mut harness, "posterize", "4");
    let width = parameter(&harness, "line_width").default.text();
    set(&mut harness, "line_width", &width);
    assert!(!harness.state().look().is_changed(), "what is set to what it was differs in nothing");
}

#[test]
fn closed_headings_show_that_something_below_them_differs() {
    let mut harness = controls_of("cartoon".as_ref(), [1200.0, 1600.0], 0.2);
    let advanced = harness.state().looks.parameters().iter().find(|own| own.param.group == "advanced");
    let advanced = advanced.unwrap().clone();
    let other = advanced.default.others(&advanced.param.kind).swap_remove(0);
    for differs in [false, true] {
        if differs {
            harness.state_mut().set(&advanced, &other);
            harness.state_mut().let_go();
        }
        harness.get_by_label("Advanced").hover();
        harness.run_steps(8);
        assert_eq!(harness.query_by_label("One control differs from the look").is_some(), differs);
    }
}

/// Types into the field of a control, and presses Enter, as a step of its own.
fn type_into(harness: &mut Harness<'_, Session>, role: Role, label: &str, text: &str) {
    harness.get_by_role_and_label(role, label).click();
    harness.run_ok();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.event(egui::Event::Text(text.into()));
    harness.run_ok();
    harness.key_press(egui::Key::Enter);
    harness.run_ok();
    harness.state_mut().let_go();
}

#[test]
fn numbers_are_typed_as_calculations_and_what_is_none_is_said_at_the_field() {
    let mut harness = controls_of("cartoon".as_ref(), [1200.0, 1600.0], 0.05);
    let label = parameter(&harness, "line_width").param.label;
    for (text, expected) in [("2*1.5", "3"), ("1,5 px", "1.5"), ("(2+1)*0.5 + 1", "2.5")] {
        type_into(&mut harness, Role::SpinButton, label, text);
        assert_eq!(value(&harness, "line_width"), expected, "{text}");
        assert!(harness.query_by_label_contains("no number").is_none());
    }
    type_into(&mut harness, Role::SpinButton, label, "2*wide");
    assert_eq!(value(&harness, "line_width"), "2.5");
    let said = harness.query_by_label_contains("'wide' is no number. It stays 2.5 px");
    assert!(said.is_some());
    type_into(&mut harness, Role::SpinButton, label, "1e9");
    assert!(harness.query_by_label_contains("The most is").is_some());
    let most = value(&harness, "line_width");
    assert!(most.parse::<f32>().unwrap() < 1e6);
    harness.state_mut().undo();
    assert_eq!(value(&harness, "line_width"), "2.5", "what is typed is one step");
}

#[test]
fn colours_are_typed_as_the_web_writes_them() {
    let library = Library::from_file(support::library()).unwrap();
    let look =
        |id: &'static str| EditedLook::open(&library, id.as_ref()).unwrap().parameters(&library).unwrap();
    let color = |own: &Parameter| matches!(own.default, Value::Color(_));
    let catalogue = library.catalogue().unwrap();
    let mut styles = catalogue.nodes.iter().filter(|node| node.group == "styles");
    let found = styles.find_map(|node| Some((node.id, look(node.id).into_iter().find(color)?)));
    let (look, own) = found.expect("a style with a colour");
    let (name, label) = (own.name.clone(), own.param.label);
    let mut harness = controls_of(look.as_ref(), [1200.0, 1600.0], 0.05);
    if harness.query_by_role_and_label(Role::TextInput, label).is_none() {
        let heading = widgets::theme::capital(own.param.group);
        harness.get_by_label(&heading).click();
        harness.run_ok();
    }
    let byte = |value: u8| f32::from(value) / 255.0;
    let color = |harness: &Harness<'_, Session>| harness.state().look().value(&parameter(harness, &name));
    for (text, [r, g, b]) in [("#a52", [0xaa, 0x55, 0x22]), ("a0522d", [0xa0, 0x52, 0x2d])] {
        type_into(&mut harness, Role::TextInput, label, text);
        let Value::Color([red, green, blue, _]) = color(&harness) else { unreachable!() };
        assert_eq!([red, green, blue], [r, g, b].map(byte), "{text}");
    }
    let before = color(&harness);
    type_into(&mut harness, Role::TextInput, label, "sienna");
    assert_eq!(color(&harness), before);
    assert!(harness.query_by_label_contains("'sienna' is no colour such as #a0522d").is_some());
}

#[test]
fn the_wheel_changes_a_slider_only_where_the_pointer_has_rested() {
    let mut harness = controls_of("cartoon".as_ref(), [1200.0, 500.0], 0.05);
    let at = |harness: &Harness<'_, Session>, label: &str| {
        let sliders = harness.query_all_by_role_and_label(Role::Slider, label);
        sliders.last().unwrap().rect().center()
    };
    let wheel = |harness: &mut Harness<'_, Session>, notches: f32, modifiers: egui::Modifiers| {
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: egui::vec2(0.0, notches),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
            modifiers,
        });
        harness.run_steps(12);
    };
    let label = parameter(&harness, "line_width").param.label;
    let before: f32 = value(&harness, "line_width").parse().unwrap();
    let place = at(&harness, label);
    harness.hover_at(place);
    wheel(&mut harness, -1.0, egui::Modifiers::NONE);
    let scrolled = at(&harness, label);
    assert!(scrolled.y < place.y, "the list is scrolled");
    // Whatever lies below the pointer now has been scrolled there.
    harness.run_steps(20);
    wheel(&mut harness, 1.0, egui::Modifiers::NONE);
    assert_eq!(at(&harness, label), place);
    assert!(!harness.state().look().is_changed());

    harness.hover_at(place + egui::vec2(1.0, 0.0));
    harness.run_steps(20);
    let ParamKind::Float { slider: [least, most], .. } = parameter(&harness, "line_width").param.kind else {
        unreachable!()
    };
    let step = (most - least) / 100.0;
    let now = |harness: &Harness<'_, Session>| value(harness, "line_width").parse::<f32>().unwrap();
    wheel(&mut harness, 3.0, egui::Modifiers::NONE);
    assert!((now(&harness) - before - 3.0 * step).abs() < 1e-3 * step, "{} of {before}", now(&harness));
    wheel(&mut harness, -1.0, egui::Modifiers::SHIFT);
    assert!((now(&harness) - before - 2.9 * step).abs() < 1e-3 * step, "{} of {before}", now(&harness));
    assert_eq!(at(&harness, label), place, "the list stays where it is");
}

#[test]
fn the_edge_of_the_panel_is_dragged_and_set_back_by_a_double_click() {
    let mut harness = controls_of("cartoon".as_ref(), [1000.0, 600.0], 0.05);
    let edge = |harness: &Harness<'_, Session>| harness.get_by_label("Width of the panel").rect().center();
    let usual = edge(&harness);
    for (to, expected) in [(usual.x - 60.0, 60.0), (10.0, 292.0), (990.0, -48.0)] {
        let from = edge(&harness);
        harness.hover_at(from);
        harness.drag_at(from);
        harness.run_ok();
        harness.hover_at(egui::pos2(to, from.y));
        harness.run_ok();
        harness.drop_at(egui::pos2(to, from.y));
        harness.run_ok();
        let wider = usual.x - edge(&harness).x;
        assert!((wider - expected).abs() < 1.5, "{wider} points wider by a drag to {to}");
        let (least, right) = (edge(&harness).x, 1000.0);
        for label in ["Reset to look", "Looks"] {
            let rect = harness.get_by_label(label).rect();
            assert!(rect.left() > least && rect.right() <= right, "{label} lies at {rect}");
        }
        for slider in harness.query_all_by_role(Role::SpinButton) {
            let rect = slider.rect();
            assert!(rect.right() <= right, "a field lies at {rect}");
        }
    }
    assert_eq!(harness.state().settings.panel_width, Some(300.0));
    let at = edge(&harness);
    double_click(&mut harness, at);
    assert_eq!(harness.state().settings.panel_width, None);
    assert!((edge(&harness).x - usual.x).abs() < 1.0);
}

#[test]
fn the_pixel_under_the_pointer_is_told_in_the_room_that_the_bar_has() {
    let probed = Probed {
        at: [1203, 884],
        original: [0.123_456_79, 0.5, 0.25, 1.0],
        shown: Some([0.25, 0.5, 0.765_432_1, 1.0]),
        overlay: Overlay::None,
    };
    for (width, starts) in
        [(1900.0, "1203, 884   original 0.12345679 0.5 0.25   look"), (1000.0, "1203, 884   ")]
    {
        let mut harness = controls_of("cartoon".as_ref(), [width, 600.0], 0.05);
        assert!(harness.query_by_label_contains("1203, 884").is_none());
        harness.state_mut().probed = Some(probed);
        harness.run_ok();
        let told = harness.get_by_label_contains("1203, 884");
        let text = told.accesskit_node().label().or(told.value()).unwrap_or_default();
        assert!(text.starts_with(starts), "{text}");
        let next = harness.get_all_by_label("Exposure").last().unwrap().rect();
        assert!(told.rect().right() < next.left(), "{} runs into {next}", told.rect());
    }
}
