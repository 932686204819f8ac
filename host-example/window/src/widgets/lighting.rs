//! The scene's camera and light.

use egui::{Button, RichText, Ui};

use super::number::Number;
use super::scale::{self, Scale};
use super::{keyboard, theme};
use crate::state::outcome::Dialog;
use crate::state::session::Session;
use crate::state::work::Request;
use isophote_render::background::Background;
use isophote_scene::camera::Direction;

/// Shows the controls.
pub fn show(ui: &mut Ui, session: &mut Session) {
    camera(ui, session);
    let Some(scenery) = session.open.scenery() else { return };
    let sun = scenery.sun();
    let mut degrees = [sun.azimuth.to_degrees(), sun.elevation.to_degrees()];
    for (index, label, range, doc) in [
        (
            0,
            "Sun around",
            [-180.0, 180.0],
            "Where the sun is, to the right of the camera as it stood at first; 0 is behind it.",
        ),
        (1, "Sun height", [-10.0, 90.0], "How high the sun is above the horizon."),
    ] {
        let number = Number {
            value: f64::from(degrees[index]),
            range,
            speed: (range[1] - range[0]) / 240.0,
            decimals: 1,
            unit: "°",
        };
        if let Some(given) = scale::row(ui, (label, doc), &whole(number), &mut session.wheeled) {
            degrees[index] = given as f32;
            let [azimuth, elevation] = degrees.map(f32::to_radians);
            session.relight(label, |light| light.sun = Some(Direction { azimuth, elevation }));
        }
    }
    let exposure = session.open.scenery().map_or(0.0, |scenery| scenery.lighting.exposure);
    let number =
        Number { value: f64::from(exposure), range: [-4.0, 4.0], speed: 0.02, decimals: 2, unit: "" };
    let doc = "Brightness of the scene in stops, before looks are put on it.";
    if let Some(exposure) = scale::row(ui, ("Exposure", doc), &whole(number), &mut session.wheeled) {
        session.relight("exposure", |light| light.exposure = exposure as f32);
    }
    background(ui, session);
    let changed = session.open.scenery().is_some_and(|scenery| scenery.lighting != Default::default());
    if ui.add_enabled(changed, Button::new("Reset light")).clicked() {
        session.let_go();
        session.relight("light", |light| *light = Default::default());
        session.let_go();
    }
}

/// A slider over all of a number's range.
fn whole(number: Number<'_>) -> Scale<'_> {
    Scale { ends: number.range, number }
}

fn camera(ui: &mut Ui, session: &mut Session) {
    let Some(scenery) = session.open.scenery_mut() else { return };
    let cameras = scenery.cameras();
    if cameras.is_empty() {
        return;
    }
    let now = scenery.camera();
    let name = cameras.iter().find(|(node, _)| Some(*node) == now).map_or("By mouse", |(_, name)| name);
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let label = ui.label("Camera");
        let list = egui::ComboBox::from_id_salt("camera").width(200.0).truncate();
        let shown = list.selected_text(name).show_ui(ui, |ui| {
            if ui.selectable_label(now.is_none(), "By mouse").clicked() {
                scenery.look_through(None);
            }
            for (node, name) in &cameras {
                if ui.selectable_label(now == Some(*node), name).clicked() {
                    scenery.look_through(Some(*node));
                }
            }
        });
        keyboard::tell(&shown.response, name);
        shown.response.labelled_by(label.id);
    });
}

fn background(ui: &mut Ui, session: &mut Session) {
    let Some(scenery) = session.open.scenery() else { return };
    let name = match scenery.lighting.background {
        Background::Sky => "Sky",
        Background::Transparent => "Nothing",
        Background::Color(_) => "One colour",
        Background::Environment(_) => "Picture of the surroundings",
    };
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let label = ui.label("Behind it");
        let list = egui::ComboBox::from_id_salt("background").width(200.0).truncate();
        let shown = list.selected_text(name).show_ui(ui, |ui| {
            for (name, background) in [
                ("Sky", Background::Sky),
                ("Nothing", Background::Transparent),
                ("White", Background::Color(glam::Vec3::ONE)),
                ("Grey", Background::Color(glam::Vec3::splat(0.18))),
            ] {
                if ui.button(name).clicked() {
                    session.relight("background", |light| light.background = background);
                }
            }
            if ui.button("A picture of the surroundings…").clicked() {
                session.work.ask(Request::Choose(Dialog::Surroundings));
            }
        });
        keyboard::tell(&shown.response, name);
        shown.response.labelled_by(label.id);
    });
    if matches!(session.open.scenery().map(|s| &s.lighting.background), Some(Background::Environment(_))) {
        ui.label(RichText::new("It lights the scene, too.").small().color(theme::FAINT));
    }
}
