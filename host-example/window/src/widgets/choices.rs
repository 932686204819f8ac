//! Controls for files that are written: size, quality and bit depth, and the question whether files may be replaced.

use egui::{Button, ComboBox, DragValue, Grid, RichText, Ui};

use super::{keyboard, theme};
use crate::state::formats::{FileChoices, Replaced, Scaling};
use isophote_finishing::writing::Depth;
use isophote_pictures::write::Format;

/// Answer to the question whether files may be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// They may.
    Replace,
    /// They stay.
    Cancel,
}

/// Size in relation to the pictures.
pub fn scaling(ui: &mut Ui, choices: &mut FileChoices) {
    let label = ui.label("Size");
    ui.horizontal(|ui| {
        let name =
            Scaling::ALL.iter().find(|(scaling, _)| *scaling == choices.scaling).map_or("", |(_, name)| name);
        let shown = ComboBox::from_id_salt("scaling").selected_text(name).show_ui(ui, |ui| {
            for (scaling, name) in Scaling::ALL {
                ui.selectable_value(&mut choices.scaling, scaling, name);
            }
        });
        keyboard::tell(&shown.response, name);
        shown.response.labelled_by(label.id);
        if matches!(choices.scaling, Scaling::Width | Scaling::Height) {
            let side = DragValue::new(&mut choices.side).range(1..=16384);
            ui.add(side).labelled_by(label.id).on_hover_text("Pixels of this side; the shape stays");
            ui.label(RichText::new("pixels").color(theme::FAINT));
        }
    });
    ui.end_row();
}

/// Quality and bit depth, as far as files of a kind have them.
pub fn samples(ui: &mut Ui, choices: &mut FileChoices, format: Format) {
    if format == Format::Jpeg {
        let label = ui.label("Quality");
        let slider = keyboard::slider(ui, &mut choices.quality, 1..=100, |slider| slider);
        slider
            .labelled_by(label.id)
            .on_hover_text("Higher is better and larger; 95 looks as the picture does");
        ui.end_row();
    }
    if format.depths().len() < 2 {
        return;
    }
    let label = ui.label("Bit depth");
    let is_had = |depth: &Depth| Depth::of(format).any(|known| known == *depth);
    let name = choices.depth.filter(is_had).map_or("As the picture", Depth::name);
    let shown = ComboBox::from_id_salt("depth").selected_text(name).show_ui(ui, |ui| {
        ui.selectable_value(&mut choices.depth, None, "As the picture");
        for depth in Depth::of(format) {
            ui.selectable_value(&mut choices.depth, Some(depth), depth.name());
        }
    });
    keyboard::tell(&shown.response, name);
    shown.response.labelled_by(label.id);
    ui.end_row();
}

/// A table of two columns.
pub fn table(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui)) {
    Grid::new(name).num_columns(2).spacing([18.0, 8.0]).show(ui, content);
}

/// The question in its place. Return keeps what is there unless Tab has gone to the other button.
pub fn question(ui: &mut Ui, text: &str, replaced: Replaced) -> Option<Answer> {
    ui.add(egui::Label::new(RichText::new(text).color(theme::ACCENT)).wrap());
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        let cancel = ui.add(Button::new("Cancel").fill(theme::CHOSEN));
        let word = if replaced == Replaced::Original { "Replace the original" } else { "Replace" };
        let replace = ui.add(Button::new(RichText::new(word).color(theme::BAD)));
        if !cancel.has_focus() && !replace.has_focus() {
            cancel.request_focus();
        }
        match (cancel.clicked(), replace.clicked()) {
            (true, _) => Some(Answer::Cancel),
            (_, true) => Some(Answer::Replace),
            _ => None,
        }
    })
    .inner
}
