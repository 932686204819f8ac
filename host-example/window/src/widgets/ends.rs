//! Bars with two ends: what is at the left one scrolls where there is no room for it beside what is at the right one.

use egui::{Align, Id, Label, Layout, RichText, ScrollArea, Ui, vec2};

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
    let id = Id::unique(("ends", name));
    // Both ends are laid out in the order in which they are read; the width of the right one is that of the frame before.
    let known = ui.data(|data| data.get_temp::<f32>(id));
    ui.horizontal(|ui| {
        ui.set_min_height(height);
        let room = ui.available_width() - known.unwrap_or_default() - ui.spacing().item_spacing.x;
        ScrollArea::horizontal().id_salt(id).max_width(room.max(0.0)).show(ui, |ui| {
            let size = vec2(ui.available_width(), height);
            let row = Layout::left_to_right(Align::Center);
            ui.allocate_ui_with_layout(size, row, |ui| left(ui, session));
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            right(ui, session);
            let width = ui.min_rect().width();
            if known != Some(width) {
                ui.data_mut(|data| data.insert_temp(id, width));
                ui.ctx().request_repaint();
            }
        });
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
