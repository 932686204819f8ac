//! Words on the window while files are held over it: what happens where they are let go of.

use std::path::{Path, PathBuf};

use egui::{Align2, Area, Context, Frame, Id, Margin, Order, RichText};

use super::theme;
use crate::state::session::Session;

/// Shows the words while files are held over the window.
pub fn show(context: &Context, session: &Session) {
    let files: Vec<PathBuf> =
        context.input(|input| input.raw.hovered_files.iter().filter_map(|file| file.path.clone()).collect());
    if files.is_empty() || !session.takes_files() {
        return;
    }
    let window = context.content_rect();
    let area = Area::new(Id::unique("drop")).order(Order::Tooltip).interactable(false);
    area.pivot(Align2::CENTER_CENTER).fixed_pos(window.center()).show(context, |ui| {
        ui.set_clip_rect(window);
        ui.painter().rect_filled(window, 0.0, theme::VEIL);
        let frame = Frame::popup(ui.style()).inner_margin(Margin::symmetric(26, 18));
        frame.stroke((2.0, theme::ACCENT)).show(ui, |ui| {
            ui.set_max_width((window.width() - 80.0).clamp(60.0, 560.0));
            let text = RichText::new(words(&files, session)).size(17.0).color(theme::BRIGHT);
            ui.add(egui::Label::new(text).wrap());
        });
    });
}

/// Words on what becomes of files that are dropped.
fn words(files: &[PathBuf], session: &Session) -> String {
    let (looks, others): (Vec<&PathBuf>, Vec<&PathBuf>) = files.iter().partition(|file| is_look(file));
    match (others.as_slice(), looks.as_slice()) {
        ([], [look]) => format!("Add {} as a look", name(look)),
        ([], looks) => format!("Add one of {} looks", looks.len()),
        ([file], _) => format!("Open {}", name(file)),
        (files, _) if session.look().is_plain() => format!("Open one of {} files", files.len()),
        (files, _) => format!("Use this look on {} pictures", files.len()),
    }
}

fn is_look(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
