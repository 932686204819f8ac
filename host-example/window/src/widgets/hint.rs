//! Short messages at fields, about what was typed there, and marks at headings.

use egui::{Response, RichText, Tooltip, Ui, vec2};

use super::theme;

/// Seconds that a message stays.
const STAYS: f64 = 6.0;

/// A message, and the time at which it goes.
#[derive(Clone)]
struct Said {
    text: String,
    until: f64,
}

/// Says something at a field from now on.
pub fn say(field: &Response, text: String) {
    let until = field.ctx.input(|input| input.time) + STAYS;
    field.ctx.data_mut(|data| data.insert_temp(key(field), Said { text, until }));
}

/// Shows what is said at a field, until a while has passed or its text is edited anew.
pub fn show(field: &Response) {
    let context = &field.ctx;
    let Some(Said { text, until }) = context.data(|data| data.get_temp(key(field))) else { return };
    let left = until - context.input(|input| input.time);
    if left <= 0.0 || field.gained_focus() {
        context.data_mut(|data| data.remove::<Said>(key(field)));
        return;
    }
    Tooltip::for_widget(field).show(|ui| ui.label(RichText::new(text).color(theme::BRIGHT)));
    context.request_repaint_after_secs(left as f32);
}

fn key(field: &Response) -> egui::Id {
    field.id.with("said")
}

/// A dot behind a heading below which something differs from the look that is not seen.
pub fn mark(ui: &Ui, heading: &Response, hint: &str) {
    let at = heading.rect.right_center() + vec2(6.0, 0.0);
    ui.painter().circle_filled(at, 2.5, theme::ACCENT);
    heading.clone().on_hover_text(hint);
}
