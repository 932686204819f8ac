//! Details of the selected look, at the side of the browser, and what can be done with it.

use std::sync::Arc;

use egui::{Color32, Label, RichText, ScrollArea, Sense, Ui, vec2};

use super::act::perform;
use super::{card, keyboard, theme};
use crate::state::browser::entry::Content;
use crate::state::look::EditedLook;
use crate::state::preview::Place;
use crate::state::preview::order::{FINENESS, Order};
use crate::state::session::Session;

/// Shows the selected look.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let entry = session.browser.selected.and_then(|id| session.browser.entry(id)).cloned();
    let Some(entry) = entry else {
        ui.label(RichText::new("Choose a look to see more of it.").color(theme::FAINT));
        return;
    };
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.set_width(ui.available_width() - 10.0);
        large(ui, session, entry.look());
        ui.add_space(10.0);
        ui.label(RichText::new(&entry.name).size(17.0).color(theme::BRIGHT));
        let line = card::line(&entry);
        if !line.is_empty() {
            ui.label(RichText::new(line).color(theme::FAINT));
        }
        ui.add_space(6.0);
        match (&entry.content, &entry.title.about) {
            (Content::Broken(problem), _) => drop(ui.label(RichText::new(problem).color(theme::BAD))),
            (_, Some(about)) => drop(ui.label(about)),
            _ => {}
        }
        ui.add_space(10.0);
        let act = ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
            card::actions(ui, session, &entry)
        });
        if let Some(act) = act.inner {
            perform(ui, session, act);
        }
        if let Some(file) = entry.file() {
            ui.add_space(10.0);
            ui.label(RichText::new("File").small().color(theme::FAINT));
            ui.add(Label::new(RichText::new(file.display().to_string()).small()).wrap());
        }
        ui.add_space(16.0);
        keyboard::follow(ui);
    });
}

/// The preview, as wide as the panel.
fn large(ui: &mut Ui, session: &mut Session, look: Option<&Arc<EditedLook>>) {
    let (Some(look), Some(picture)) = (look, session.previews.picture()) else { return };
    let width = ui.available_width();
    let scale = ui.pixels_per_point();
    let size = picture.fitting([width * scale, width * scale]);
    let order = Order::whole(Arc::clone(look), size, FINENESS);
    let room = vec2(width, width * size.1 as f32 / size.0 as f32);
    session.previews.want(Place::Large, order);
    let (rect, _) = ui.allocate_exact_size(room, Sense::hover());
    let context = ui.ctx().clone();
    match session.previews.get(&context, Place::Large, false) {
        Some(preview) if preview.is_current => card::image(ui, rect, &preview, Color32::WHITE),
        _ => match session.previews.get(&context, Place::Plain, false) {
            Some(plain) if plain.is_current => card::draw(ui, plain.texture, rect, Color32::from_gray(72)),
            _ => drop(ui.painter().rect_filled(rect, 3.0, theme::EMPTY)),
        },
    }
}
