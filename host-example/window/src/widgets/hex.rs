//! A colour: its picker, and a field where it is typed as the web writes it.

use egui::{FontSelection, Id, Key, Response, RichText, TextEdit, TextStyle, Ui};

use super::{hint, theme};
use crate::state::expression;

/// Width of the field in points.
const FIELD: f32 = 66.0;

/// Shows a colour; returns that which it has been given, if any.
pub fn show(ui: &mut Ui, now: [f32; 4], label: &Response) -> Option<[f32; 4]> {
    let before = now.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    let mut bytes = before;
    let picker = ui.color_edit_button_srgba_unmultiplied(&mut bytes).labelled_by(label.id);
    let [r, g, b, a] = before;
    let picked = (picker.changed() && bytes != before).then_some(bytes);
    let typed = field(ui, format!("#{r:02x}{g:02x}{b:02x}"), label);
    if a < 255 {
        let opacity = format!("{:.0} %", f32::from(a) / 2.55);
        ui.label(RichText::new(opacity).color(theme::FAINT)).on_hover_text("Opacity");
    }
    let typed = typed.map(|([r, g, b], opacity)| [r, g, b, opacity.unwrap_or(a)]);
    let given = picked.or(typed).filter(|given| *given != before)?;
    Some(given.map(|byte| f32::from(byte) / 255.0))
}

/// The field; returns the colour, and its opacity, that were typed.
fn field(ui: &mut Ui, shown: String, label: &Response) -> Option<([u8; 3], Option<u8>)> {
    let id: Id = ui.scope_id().with("hex");
    let mut text = ui.data(|data| data.get_temp(id)).unwrap_or(shown);
    let font = FontSelection::Style(TextStyle::Monospace);
    let field = TextEdit::singleline(&mut text).id(id).font(font).desired_width(FIELD);
    let response = ui.add(field).labelled_by(label.id);
    let mut given = None;
    if response.lost_focus() && !ui.input(|input| input.key_pressed(Key::Escape)) {
        match expression::color(&text) {
            Ok(color) => given = Some(color),
            Err(problem) => hint::say(&response, problem),
        }
    }
    if response.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, text));
    } else {
        ui.data_mut(|data| data.remove::<String>(id));
    }
    hint::show(&response);
    given
}
