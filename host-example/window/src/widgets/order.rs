//! Order of controls: Tab and programs that read the window aloud go from one to the next as they are seen, from left to right
//! and from above to below.

use egui::{Id, Panel, Rect, Ui, UiBuilder, vec2};

/// Controls that end at the right of a row, in the order in which they are seen. Their width is that of the frame before, so
/// the first one is laid out twice.
pub fn at_right(ui: &mut Ui, salt: &str, content: impl FnOnce(&mut Ui)) {
    let known = known(ui, salt);
    let room = ui.available_rect_before_wrap();
    let left = (room.right() - known).max(room.left());
    let place = Rect::from_min_max(egui::pos2(left, room.top()), room.max);
    let row = UiBuilder::new()
        .id_salt(salt)
        .max_rect(place)
        .layout(egui::Layout::left_to_right(egui::Align::Center));
    let width = ui.scope_builder(row, |ui| {
        content(ui);
        ui.min_rect().width()
    });
    keep(ui, salt, known, width.inner);
}

/// Controls at the lower end of a column, below what scrolls in the height that is left to it.
pub fn at_bottom(ui: &mut Ui, salt: &str, content: impl FnOnce(&mut Ui)) {
    let height = ui.scope(content).response.rect.height();
    keep(ui, salt, known(ui, salt), height);
}

/// Height that is left above the controls at the lower end, whose own is that of the frame before.
pub fn height_above(ui: &Ui, salt: &str) -> f32 {
    (ui.available_height() - known(ui, salt) - ui.spacing().item_spacing.y).max(0.0)
}

/// Length of an end in the frame before: its width at the right of a row, its height below a column.
pub fn known(ui: &Ui, salt: &str) -> f32 {
    ui.data(|data| data.get_temp(id_of(salt))).unwrap_or(0.0)
}

/// Keeps the length of an end; what was laid out with another is laid out once more.
fn keep(ui: &Ui, salt: &str, known: f32, length: f32) {
    if (length - known).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(id_of(salt), length));
        ui.ctx().request_discard("controls at an end have another length");
    }
}

fn id_of(salt: &str) -> Id {
    Id::unique(("length of the end", salt))
}

/// Room of a panel.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Place of what is in it.
    pub inner: Rect,
    /// Place of all of it.
    pub outer: Rect,
}

/// Room that a panel takes from what surrounds it, all of its height where none is given, to be filled later: panels at the
/// borders are laid out before what is between them, and read after it.
pub fn reserve(ui: &mut Ui, panel: Panel, height: Option<f32>) -> Room {
    let reserved = panel.show(ui, |ui| {
        let size = vec2(ui.available_width(), height.unwrap_or_else(|| ui.available_height()));
        let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
        rect
    });
    Room { inner: reserved.inner, outer: reserved.response.rect }
}

/// Fills such a room.
pub fn fill(ui: &mut Ui, rect: Rect, name: &str, content: impl FnOnce(&mut Ui)) {
    let place = UiBuilder::new()
        .id_salt(name)
        .max_rect(rect)
        .layout(egui::Layout::top_down(egui::Align::Min))
        .accessibility_role(egui::accesskit::Role::Pane)
        .accessibility_label(name);
    let mut inner = ui.new_child(place);
    inner.set_clip_rect(rect.expand2(vec2(12.0, 6.0)).intersect(ui.clip_rect()));
    content(&mut inner);
}
