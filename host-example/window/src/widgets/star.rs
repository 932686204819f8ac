//! Stars of favourite looks: on cards, and the way to see favourites alone.

use egui::{Align2, Button, FontId, Id, Rect, Response, RichText, Sense, Ui, pos2, vec2};

use super::theme;
use crate::state::browser::entry::Entry;
use crate::state::session::Session;

/// Side of a star in points.
const SIDE: f32 = 20.0;

/// The star of a card at the upper right of its picture; says whether it was clicked.
pub fn show(ui: &Ui, place: Rect, session: &Session, entry: &Entry, card: &Response) -> bool {
    if entry.look().is_none() {
        return false;
    }
    let is_favourite = session.browser.is_favourite(entry);
    let corner = pos2(place.right() - SIDE - 6.0, place.top() + 6.0);
    let rect = Rect::from_min_size(corner, vec2(SIDE, SIDE));
    let response = ui.interact(rect, Id::unique(("star", entry.id)), Sense::click());
    response.widget_info(|| {
        let name = format!("Favourite {}", entry.name);
        egui::WidgetInfo::selected(egui::Role::CheckBox, true, is_favourite, name)
    });
    let response = response.on_hover_text("A favourite comes first among the looks (*)");
    let is_near = response.hovered() || response.has_focus();
    if is_favourite || is_near || card.hovered() {
        ui.painter().rect_filled(rect, 4.0, theme::VEIL);
        let (text, color) = match (is_favourite, is_near) {
            (true, _) => ("★", theme::STAR),
            (false, true) => ("☆", theme::BRIGHT),
            (false, false) => ("☆", theme::TEXT),
        };
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, FontId::proportional(15.0), color);
    }
    response.clicked()
}

/// The button that shows favourites alone.
pub fn filter(ui: &mut Ui, session: &mut Session) {
    let is_wanted = session.browser.filter.favourites;
    if session.browser.favourites.is_empty() && !is_wanted {
        return;
    }
    let text = RichText::new("★ Favourites").size(12.0);
    let chip = Button::selectable(is_wanted, text).corner_radius(10.0).frame_when_inactive(true);
    let chip = ui.add(chip).on_hover_text("Favourites alone");
    chip.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_wanted, "Favourites alone"));
    if chip.clicked() {
        session.browser.filter.favourites = !is_wanted;
    }
}
