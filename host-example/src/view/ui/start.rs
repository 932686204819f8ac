//! What is shown while nothing is open: where to begin.

use egui::{Align2, Button, RichText, Ui, vec2};

use super::theme;
use crate::view::session::{Session, Wish};

/// Shows the start.
pub fn show(ui: &mut Ui, session: &mut Session, has_room: bool) {
    if !has_room || session.busy.is_some() && session.file.is_some() {
        return;
    }
    let middle = ui.available_rect_before_wrap().center();
    egui::Area::new(egui::Id::unique("start")).pivot(Align2::CENTER_CENTER).fixed_pos(middle).show(
        ui.ctx(),
        |ui| {
            ui.set_width(420.0);
            ui.vertical_centered(|ui| {
                ui.label(RichText::new("Isophote").size(34.0).color(egui::Color32::from_gray(232)));
                ui.label(RichText::new("Drawings and paintings of scenes and pictures").color(theme::FAINT));
                ui.add_space(22.0);
                ui.spacing_mut().item_spacing.y = 10.0;
                let large = |text: &str| {
                    Button::new(RichText::new(text.to_owned()).size(15.0)).min_size(vec2(260.0, 38.0))
                };
                let demo = large("Open the demo scene").fill(ui.visuals().selection.bg_fill);
                if ui.add_enabled(session.busy.is_none(), demo).clicked() {
                    session.wishes.push(Wish::OpenDemo);
                }
                if ui.add(large("Open a file…")).on_hover_text("Ctrl+O").clicked() {
                    session.wishes.push(Wish::ChooseFile);
                }
                ui.add_space(4.0);
                let hint = session
                    .busy
                    .map_or_else(|| "or drop a file on this window".to_owned(), |what| format!("{what}…"));
                ui.label(RichText::new(hint).color(theme::FAINT));
            });
            recent(ui, session);
        },
    );
}

fn recent(ui: &mut Ui, session: &mut Session) {
    if session.settings.recent.is_empty() {
        return;
    }
    ui.add_space(22.0);
    ui.label(RichText::new("Recent").small().color(theme::FAINT));
    for path in session.settings.recent.iter().take(6) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let folder = path.parent().map(|folder| folder.display().to_string()).unwrap_or_default();
        ui.horizontal(|ui| {
            if ui.link(RichText::new(name).color(theme::TEXT)).clicked() {
                session.wishes.push(Wish::Open(path.clone()));
            }
            ui.add(egui::Label::new(RichText::new(folder).small().color(theme::FAINT)).truncate());
        });
    }
}
