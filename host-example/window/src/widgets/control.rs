//! One parameter: a dot where it differs from its default, its label, its control, and a button that sets it back.

use std::ops::RangeInclusive;

use egui::emath::Numeric;
use egui::{Align, Button, Color32, DragValue, Layout, Response, RichText, Sense, Ui, vec2};

use super::{keyboard, theme};
use crate::state::look::Parameter;
use crate::state::session::Session;
use isophote_finishing::stylize::value::Value;
use isophote_loader::catalogue::{Choice, ParamKind};

/// Width of the label in points.
const LABEL: f32 = 118.0;
/// Width of the value.
const VALUE: f32 = 62.0;
/// Width of the button that sets it back.
const RESET: f32 = 18.0;
/// Height of a row.
const ROW: f32 = 22.0;

/// Shows a parameter of the present look.
pub fn show(ui: &mut Ui, session: &mut Session, parameter: &Parameter) {
    let differs = session.look().differs(parameter);
    let animated = session.look().is_animated(parameter);
    let is_idle = session.looks.is_idle(parameter);
    let mut changed = None;
    let mut reset = false;
    ui.push_id(&parameter.name, |ui| {
        ui.allocate_ui_with_layout(
            vec2(ui.available_width(), ROW),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                dot(ui, differs);
                let label = label(ui, parameter, is_idle, animated);
                let width = ui.available_width() - RESET - 4.0;
                let value = session.look().value(parameter);
                ui.add_enabled_ui(!is_idle, |ui| {
                    ui.allocate_ui_with_layout(
                        vec2(width, ROW),
                        Layout::left_to_right(Align::Center),
                        |ui| {
                            ui.set_min_width(width);
                            changed = control(ui, parameter, &value, &label);
                        },
                    );
                });
                if differs {
                    let button =
                        Button::new(RichText::new("⟲").size(12.0)).frame(false).min_size(vec2(RESET, ROW));
                    let hint = format!(
                        "Set {} back to {}",
                        parameter.param.label,
                        shown(parameter, &parameter.default)
                    );
                    let button = ui.add(button).accessible_name(&hint).on_hover_text(hint);
                    reset = button.clicked();
                }
            },
        );
    });
    if reset {
        session.reset(parameter);
    } else if let Some(value) = changed {
        session.set(parameter, &value);
    }
}

fn dot(ui: &mut Ui, differs: bool) {
    let (rect, _) = ui.allocate_exact_size(vec2(8.0, ROW), Sense::hover());
    if differs {
        ui.painter().circle_filled(rect.center(), 2.5, theme::ACCENT);
    }
}

fn label(ui: &mut Ui, parameter: &Parameter, is_idle: bool, animated: bool) -> Response {
    let text = RichText::new(parameter.param.label);
    let text = if is_idle { text.color(theme::FAINT.gamma_multiply(0.7)) } else { text };
    let (rect, _) = ui.allocate_exact_size(vec2(LABEL, ROW), Sense::hover());
    let mut hint = parameter.param.doc.to_owned();
    if is_idle {
        hint += "\n\nIt has no effect with the other values as they are.";
    }
    if animated {
        hint += "\n\nIt changes from frame to frame; this is its value at the first. To change it here gives it one value.";
    }
    let mut place =
        ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
    place.add(egui::Label::new(text).truncate().selectable(false)).on_hover_text(hint)
}

/// A value as people read it.
fn shown(parameter: &Parameter, value: &Value) -> String {
    match (value, &parameter.param.kind) {
        (Value::Choice(id), ParamKind::Choice { options, .. }) => option_label(options, id).to_owned(),
        (Value::Bool(on), _) => if *on { "on" } else { "off" }.to_owned(),
        _ => format!("{}{}", value.text(), unit(parameter)),
    }
}

fn option_label<'o>(options: &'o [Choice], id: &'o str) -> &'o str {
    options.iter().find(|option| option.id == id).map_or(id, |option| option.label)
}

fn unit(parameter: &Parameter) -> &'static str {
    match parameter.param.unit {
        "px" => " px",
        "%" => " %",
        "deg" => "°",
        _ => "",
    }
}

/// The control itself, and the value that it has been given, if any.
fn control(ui: &mut Ui, parameter: &Parameter, value: &Value, label: &Response) -> Option<Value> {
    match (value, &parameter.param.kind) {
        (Value::Float(now), ParamKind::Float { range, slider, .. }) => {
            let (mut value, mut typed) = (*now, *now);
            let slid = rail_of(ui, &mut value, slider[0]..=slider[1], label);
            let speed = f64::from(slider[1] - slider[0]) / 240.0;
            let field = DragValue::new(&mut typed).range(range[0]..=range[1]).speed(speed).max_decimals(3);
            let written = field_of(ui, field.suffix(unit(parameter)), label);
            chosen(slid, value, written, typed).map(Value::Float)
        }
        (Value::Int(now), ParamKind::Int { range, slider, .. }) => {
            let (mut value, mut typed) = (*now, *now);
            let slid = rail_of(ui, &mut value, slider[0]..=slider[1], label);
            let field = DragValue::new(&mut typed).range(range[0]..=range[1]).speed(0.1);
            let written = field_of(ui, field.suffix(unit(parameter)), label);
            chosen(slid, value, written, typed).map(Value::Int)
        }
        (Value::Bool(now), _) => {
            let mut on = *now;
            let response = ui.checkbox(&mut on, "").labelled_by(label.id);
            let name = parameter.param.label;
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, *now, name));
            response.changed().then_some(Value::Bool(on))
        }
        (Value::Choice(now), ParamKind::Choice { options, .. }) => {
            choice(ui, options, now, label, parameter.param.label)
        }
        (Value::Color(now), _) => color(ui, *now, label),
        _ => None,
    }
}

fn rail_of<N: Numeric>(ui: &mut Ui, value: &mut N, range: RangeInclusive<N>, label: &Response) -> bool {
    ui.spacing_mut().slider_width = (ui.available_width() - VALUE - 6.0).max(40.0);
    let rail = keyboard::slider(ui, value, range, |slider| {
        slider.trailing_fill(true).show_value(false).clamping(egui::SliderClamping::Never)
    });
    rail.labelled_by(label.id).changed()
}

fn field_of(ui: &mut Ui, field: DragValue<'_>, label: &Response) -> bool {
    ui.add_sized([VALUE, ROW - 2.0], field).labelled_by(label.id).changed()
}

/// Value that was slid, or typed.
fn chosen<N>(slid: bool, value: N, written: bool, typed: N) -> Option<N> {
    match (slid, written) {
        (true, _) => Some(value),
        (false, true) => Some(typed),
        (false, false) => None,
    }
}

fn choice(ui: &mut Ui, options: &[Choice], now: &str, label: &Response, name: &str) -> Option<Value> {
    let mut chosen = None;
    let combo = egui::ComboBox::from_id_salt("choice").width(ui.available_width() - 4.0);
    let shown = combo.selected_text(option_label(options, now)).show_ui(ui, |ui| {
        for option in options {
            if ui.selectable_label(option.id == now, option.label).clicked() && option.id != now {
                chosen = Some(Value::Choice(option.id.to_owned()));
            }
        }
    });
    let now = option_label(options, now).to_owned();
    keyboard::tell(&shown.response, &now);
    shown.response.labelled_by(label.id).widget_info(|| {
        let mut info = egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name);
        info.current_text_value = Some(now.clone());
        info
    });
    chosen
}

fn color(ui: &mut Ui, now: [f32; 4], label: &Response) -> Option<Value> {
    let before = now.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    let mut bytes = before;
    let response = ui.color_edit_button_srgba_unmultiplied(&mut bytes).labelled_by(label.id);
    let [r, g, b, a] = before;
    let opacity = if a < 255 { format!(", {:.0} %", f32::from(a) / 2.55) } else { String::new() };
    ui.label(
        RichText::new(format!("#{r:02x}{g:02x}{b:02x}{opacity}")).monospace().color(Color32::from_gray(150)),
    );
    (response.changed() && bytes != before).then(|| Value::Color(bytes.map(|byte| f32::from(byte) / 255.0)))
}
