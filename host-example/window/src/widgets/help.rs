//! Keys and mouse, on demand.

use egui::{Grid, RichText, ScrollArea, Ui};

use super::{dialog, keys, theme};
use crate::state::session::Session;

/// Margin of the list from top to bottom, in points.
const MARGIN: f32 = 150.0;

/// Shows the help while it is wanted.
pub fn show(context: &egui::Context, session: &mut Session) {
    if !session.dialogs.shows_help {
        return;
    }
    dialog::show(context, "Keys and mouse", Some(&mut session.dialogs.shows_help), |ui| {
        // Windows may be lower than the list.
        let height = (ui.ctx().content_rect().height() - MARGIN).max(60.0);
        ScrollArea::vertical().max_height(height).show(ui, list);
        ui.add_space(6.0);
        ui.label(
            RichText::new("Every label in the panel tells more where the pointer rests on it.")
                .color(theme::FAINT),
        );
    });
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
