//! Start screen, while nothing is open.

use egui::{Align2, Button, FontId, Id, Rect, RichText, Sense, Stroke, StrokeKind, Ui, vec2};

use super::{card, theme};
use crate::state::outcome::Dialog;
use crate::state::samples::SAMPLES;
use crate::state::session::Session;
use crate::state::work::Request;

/// Width of everything in points, and where there is room for larger pictures, which is in windows of this height.
const WIDTHS: [f32; 2] = [420.0, 560.0];
const LARGE: f32 = 560.0;
/// Points between the pictures.
const GAP: f32 = 12.0;
/// Height of a picture's name in points.
const NAME: f32 = 22.0;
/// Height in points of the room that buttons need, of the pictures' with what is above them, and of a recent file's line.
const HEIGHTS: [f32; 3] = [220.0, 150.0, 24.0];

/// Shows the start.
pub fn show(ui: &mut Ui, session: &mut Session, has_room: bool) {
    if !has_room || session.work.busy.is_some() && session.open.file().is_some() {
        return;
    }
    let room = ui.available_rect_before_wrap();
    let has_samples = room.height() >= HEIGHTS[0] + HEIGHTS[1];
    let width = WIDTHS[usize::from(room.height() >= LARGE && room.width() >= LARGE)];
    let left = room.height() - HEIGHTS[0] - if has_samples { HEIGHTS[1] } else { 0.0 };
    let area = egui::Area::new(Id::unique("start")).pivot(Align2::CENTER_CENTER).fixed_pos(room.center());
    area.show(ui.ctx(), |ui| {
        ui.set_width(width);
        ui.vertical_centered(|ui| {
            ui.label(RichText::new("Isophote").size(34.0).color(theme::BRIGHT));
            ui.label(RichText::new("Drawings and paintings of scenes and pictures").color(theme::FAINT));
            ui.add_space(22.0);
            ui.spacing_mut().item_spacing.y = 10.0;
            let large = |text: &str| {
                Button::new(RichText::new(text.to_owned()).size(15.0)).min_size(vec2(260.0, 38.0))
            };
            let demo = large("Open the demo scene").fill(ui.visuals().selection.bg_fill);
            if ui.add_enabled(session.work.busy.is_none(), demo).clicked() {
                session.work.ask(Request::OpenDemo);
            }
            if ui.add(large("Open a file…")).on_hover_text("Ctrl+O").clicked() {
                session.work.ask(Request::Choose(Dialog::File));
            }
            ui.add_space(4.0);
            let hint = session
                .work
                .busy
                .map_or_else(|| otherwise(session.takes_drops).to_owned(), |what| format!("{what}…"));
            ui.label(RichText::new(hint).color(theme::FAINT));
        });
        if has_samples {
            samples(ui, session, width);
        }
        recent(ui, session, (left / HEIGHTS[2]) as usize);
    });
}

/// Other ways to open something.
const fn otherwise(takes_drops: bool) -> &'static str {
    if takes_drops {
        "or drop a file on this window"
    } else {
        "or open a file with Isophote in a file manager"
    }
}

/// Pictures to try looks on.
fn samples(ui: &mut Ui, session: &mut Session, width: f32) {
    ui.add_space(10.0);
    ui.label(RichText::new("Pictures to try looks on").small().color(theme::FAINT));
    let count = SAMPLES.len() as f32;
    let width = ((width - GAP * (count - 1.0)) / count).floor();
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        for index in 0..SAMPLES.len() {
            ui.add_enabled_ui(session.work.busy.is_none(), |ui| {
                if sample(ui, session, index, width) {
                    session.work.ask(Request::OpenSample(index));
                }
            });
        }
    });
}

/// Shows a picture; says whether it is to be opened.
fn sample(ui: &mut Ui, session: &mut Session, index: usize, width: f32) -> bool {
    let name = SAMPLES[index].name;
    let (rect, response) = ui.allocate_exact_size(vec2(width, (width / 1.5).round() + NAME), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, ui.is_enabled(), name));
    let picture = Rect::from_min_max(rect.min, rect.max - vec2(0.0, NAME));
    let is_chosen = response.hovered() || response.has_focus();
    match session.previews.samples.texture(ui.ctx(), index) {
        Some(texture) => card::draw(ui, texture, picture, egui::Color32::WHITE),
        None => drop(ui.painter().rect_filled(picture, 0.0, theme::EMPTY)),
    }
    if is_chosen {
        ui.painter().rect_stroke(picture, 0.0, Stroke::new(2.0, theme::ACCENT), StrokeKind::Outside);
    }
    let color = if is_chosen { theme::BRIGHT } else { theme::FAINT };
    let at = rect.left_bottom() - vec2(0.0, 1.0);
    ui.painter().text(at, Align2::LEFT_BOTTOM, name, FontId::proportional(12.0), color);
    response.clicked()
}

/// The first of the files that were open, as many as there is room for; the menu has all.
fn recent(ui: &mut Ui, session: &mut Session, rows: usize) {
    let rows = rows.saturating_sub(1).min(6);
    if session.settings.recent.is_empty() || rows == 0 {
        return;
    }
    ui.add_space(14.0);
    ui.label(RichText::new("Recent").small().color(theme::FAINT));
    for path in session.settings.recent.iter().take(rows) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let folder = path.parent().map(|folder| folder.display().to_string()).unwrap_or_default();
        ui.horizontal(|ui| {
            if ui.link(RichText::new(name).color(theme::TEXT)).clicked() {
                session.work.ask(Request::Open(path.clone()));
            }
            ui.add(egui::Label::new(RichText::new(folder).small().color(theme::FAINT)).truncate());
        });
    }
}
