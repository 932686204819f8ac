//! Bars with two ends: what is at the left one scrolls where there is no room for it beside what is at the right one.

use egui::{Align, Label, Layout, RichText, ScrollArea, Ui, vec2};

use super::order;
use crate::state::session::Session;

/// Content of the right end.
pub type End = fn(&mut Ui, &mut Session);

/// Shows a bar of a name and a height in points, with its right end.
pub fn show(
    ui: &mut Ui,
    session: &mut Session,
    (name, height, right): (&'static str, f32, End),
    left: impl FnOnce(&mut Ui, &mut Session),
) {
    ui.horizontal(|ui| {
        ui.set_min_height(height);
        // Both ends are laid out in the order in which they are read.
        let taken = order::known(ui, name) + ui.spacing().item_spacing.x;
        let room = ui.available_width() - taken;
        ScrollArea::horizontal().id_salt(name).max_width(room.max(0.0)).show(ui, |ui| {
            let size = vec2(ui.available_width(), height);
            let row = Layout::left_to_right(Align::Center);
            ui.allocate_ui_with_layout(size, row, |ui| left(ui, session));
        });
        order::at_right(ui, name, |ui| right(ui, session));
    });
}

/// A menu, which scrolls where it is higher than the window.
pub fn menu(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui)) {
    ui.menu_button(name, |ui| {
        let height = ui.ctx().content_rect().height() - 70.0;
        ScrollArea::vertical().max_height(height.max(60.0)).show(ui, content);
    });
}

/// A label that is cut off where it is wider than so many points.
pub fn cut(ui: &mut Ui, text: RichText, width: f32) {
    ui.scope(|ui| {
        ui.set_max_width(width);
        ui.add(Label::new(text).truncate());
    });
}
