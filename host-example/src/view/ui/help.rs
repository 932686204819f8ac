//! Keys and mouse, on demand.

use egui::{Align2, Grid, RichText};

use super::{keys, theme};
use crate::view::session::Session;

/// Shows the help while it is wanted.
pub fn show(context: &egui::Context, session: &mut Session) {
    let mut open = session.shows_help;
    egui::Window::new("Keys and mouse")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(context, |ui| {
            ui.add_space(4.0);
            Grid::new("keys").num_columns(2).spacing([24.0, 5.0]).show(ui, |ui| {
                for (key, what) in keys::KEYS {
                    ui.label(RichText::new(key).color(theme::ACCENT));
                    ui.label(what);
                    ui.end_row();
                }
            });
            ui.add_space(6.0);
            ui.label(
                RichText::new("Every label in the panel tells more where the pointer rests on it.")
                    .color(theme::FAINT),
            );
        });
    session.shows_help = open;
}
