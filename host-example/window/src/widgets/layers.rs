//! Parts of an EXR file that are shown: its layer, its view, and the guides that were found in it.

use egui::{ComboBox, RichText, Ui};

use super::{keyboard, theme};
use crate::state::session::Session;
use crate::state::work::Request;
use isophote_pictures::exr::{Guide, Layer};

/// True where there is anything to choose or to tell.
pub fn has_any(session: &Session) -> bool {
    session.open.playback().is_some_and(|playback| {
        let offers = &playback.info().offers;
        offers.layers.len() > 1
            || !views(&offers.layers, &offers.layer).is_empty()
            || !offers.guides.is_empty()
    })
}

/// Shows the controls.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let Some(playback) = session.open.playback() else { return };
    let offers = &playback.info().offers;
    let selection = &playback.info().selection;
    let mut request = None;
    if offers.layers.len() > 1 {
        row(ui, "Layer", "layer", name(&offers.layer), |ui| {
            for layer in &offers.layers {
                let mark = if layer.is_data { " (data)" } else { "" };
                let text = format!("{}{mark}", name(&layer.name));
                if ui.selectable_label(layer.name == offers.layer, text).clicked() {
                    let view = selection.view.clone().filter(|view| layer.views.contains(view));
                    request = Some(Request::ChooseLayer(layer.clone(), view));
                }
            }
        });
    }
    let views = views(&offers.layers, &offers.layer);
    if let Some(layer) = offers.layers.iter().find(|layer| layer.name == offers.layer)
        && !views.is_empty()
    {
        row(ui, "View", "view", offers.view.as_deref().unwrap_or("The first"), |ui| {
            for view in views {
                if ui.selectable_label(offers.view.as_ref() == Some(view), view).clicked() {
                    request = Some(Request::ChooseLayer(layer.clone(), Some(view.clone())));
                }
            }
        });
    }
    for (guide, channels) in &offers.guides {
        ui.horizontal(|ui| {
            ui.add_space(12.0);
            ui.label(title(*guide));
            ui.add(egui::Label::new(RichText::new(channels.join(", ")).color(theme::FAINT)).truncate());
        })
        .response
        .on_hover_text("Looks follow it. It was found by its name");
    }
    request.into_iter().for_each(|request| session.work.ask(request));
}

/// The views of a layer, if there are several.
fn views<'l>(layers: &'l [Layer], layer: &str) -> &'l [String] {
    let found = layers.iter().find(|known| known.name == layer);
    found.map(|layer| layer.views.as_slice()).filter(|views| views.len() > 1).unwrap_or(&[])
}

/// A labelled list.
fn row(ui: &mut Ui, label: &str, id: &str, chosen: &str, list: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.add_space(12.0);
        let label = ui.label(label);
        let shown =
            ComboBox::from_id_salt(id).selected_text(chosen).width(200.0).truncate().show_ui(ui, list);
        keyboard::tell(&shown.response, chosen);
        shown.response.labelled_by(label.id);
    });
}

/// Name of a layer for people.
fn name(layer: &str) -> &str {
    if layer.is_empty() { "The main layer" } else { layer }
}

/// Name of a guide for people.
fn title(guide: Guide) -> &'static str {
    match guide {
        Guide::Normal => "Normals",
        Guide::ObjectId => "Objects",
        Guide::RestPosition => "Rest positions",
        Guide::Flow => "Flow map",
        Guide::Control => "Control map",
        other => other.label(),
    }
}
