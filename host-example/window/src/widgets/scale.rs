//! A slider with the field of its number: dragged, turned by the wheel, or typed.

use std::time::Instant;

use egui::{Response, Slider, Ui, vec2};

use super::keyboard;
use super::number::Number;
use super::wheel::Turned;

/// Width of the field in points.
const FIELD: f32 = 62.0;
/// Height of both.
const HEIGHT: f32 = 20.0;
/// Room of a label beside it.
const LABEL: egui::Vec2 = vec2(114.0, 22.0);
/// The shortest slider.
const SHORTEST: f32 = 40.0;

/// Shows a label, and beside it a slider; returns the number that was given.
pub fn row(
    ui: &mut Ui,
    (label, hint): (&str, &str),
    scale: &Scale<'_>,
    wheeled: &mut Option<Instant>,
) -> Option<f64> {
    let given = ui.horizontal(|ui| {
        ui.add_space(12.0);
        ui.spacing_mut().item_spacing.x = 4.0;
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(LABEL, layout, |ui| {
            ui.set_min_size(LABEL);
            ui.add(egui::Label::new(label).selectable(false)).on_hover_text(hint)
        });
        let label = label.inner;
        scale.show(ui, &label, wheeled)
    });
    given.inner
}

/// A number between the ends of a slider, or beyond them as far as its range goes.
pub struct Scale<'n> {
    /// The number.
    pub number: Number<'n>,
    /// Both ends of the slider.
    pub ends: [f64; 2],
}

impl Scale<'_> {
    /// Shows both in the room that is left; returns the number that was given. `wheeled` is when the wheel gave one last.
    pub fn show(&self, ui: &mut Ui, label: &Response, wheeled: &mut Option<Instant>) -> Option<f64> {
        let [least, most] = self.ends;
        let is_whole = self.number.decimals == 0;
        let mut slid = self.number.value;
        ui.spacing_mut().slider_width = (ui.available_width() - FIELD - 6.0).max(SHORTEST);
        let slider = Slider::new(&mut slid, least..=most).trailing_fill(true).show_value(false);
        let slider = slider.clamping(egui::SliderClamping::Never);
        let slider = if is_whole { slider.integer() } else { slider };
        let rail = ui.add(slider).labelled_by(label.id);
        let step = if is_whole { 1.0 } else { (most - least) / keyboard::STEPS };
        let keyed = keyboard::moved(ui, &rail, self.number.value, least..=most, (step, is_whole));
        let turned = Turned { value: self.number.value, ends: self.ends, is_whole }.by_wheel(ui, &rail);
        let (field, typed) = self.number.show(ui, vec2(FIELD, HEIGHT));
        field.labelled_by(label.id);
        if turned.is_some() {
            *wheeled = Some(Instant::now());
        }
        keyed.or(rail.changed().then_some(slid)).or(turned).or(typed)
    }
}
