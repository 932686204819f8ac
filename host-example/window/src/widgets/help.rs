//! Keys and mouse, on demand.

use egui::{Frame, Grid, Key, Margin, RichText, ScrollArea, Ui, vec2};

use super::{dialog, keys, theme};
use crate::state::session::Session;

/// Margin of the list from top to bottom, in points.
const MARGIN: f32 = 150.0;

/// Points that an arrow scrolls by, and more than the list is long.
const LINE: f32 = 50.0;
const END: f32 = 10_000.0;

/// Shows the help while it is wanted.
pub fn show(context: &egui::Context, session: &mut Session) {
    if !session.dialogs.shows_help {
        return;
    }
    dialog::show(context, "Keys and mouse", Some(&mut session.dialogs.shows_help), |ui| {
        // Windows may be lower than the list.
        let height = (ui.ctx().content_rect().height() - MARGIN).max(60.0);
        ScrollArea::vertical().max_height(height).show(ui, |ui| {
            scroll(ui, height);
            // The bar at the side stands on what it scrolls.
            Frame::new().inner_margin(Margin { right: 14, ..Margin::ZERO }).show(ui, list);
        });
        ui.add_space(6.0);
        ui.label(
            RichText::new("Every label in the panel tells more where the pointer rests on it.")
                .color(theme::FAINT),
        );
    });
}

/// Scrolls by keys.
fn scroll(ui: &Ui, page: f32) {
    let presses = |key| ui.input(|input| input.num_presses(key)) as f32;
    let lines = presses(Key::ArrowUp) - presses(Key::ArrowDown);
    let pages = presses(Key::PageUp) - presses(Key::PageDown);
    let ends = presses(Key::Home) - presses(Key::End);
    let by = lines * LINE + pages * page + ends * END;
    if by != 0.0 {
        ui.scroll_with_delta_animation(vec2(0.0, by), egui::style::ScrollAnimation::none());
    }
}

fn list(ui: &mut Ui) {
    Grid::new("keys").num_columns(2).spacing([24.0, 5.0]).show(ui, |ui| {
        for (key, what) in keys::KEYS {
            ui.label(RichText::new(key).color(theme::ACCENT));
            ui.label(what);
            ui.end_row();
        }
    });
}
