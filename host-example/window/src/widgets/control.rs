//! One parameter: a dot where it differs from the look as that was chosen, its label, and its control.

use std::time::Instant;

use egui::{Align, Layout, Response, RichText, Sense, Ui, vec2};

use super::number::Number;
use super::scale::Scale;
use super::{hex, keyboard, theme};
use crate::state::look::Parameter;
use crate::state::resetting::Goal;
use crate::state::session::Session;
use isophote_finishing::stylize::value::Value;
use isophote_loader::catalogue::{Choice, ParamKind};

/// Least and greatest width of the label in points.
const LABEL: [f32; 2] = [118.0, 220.0];
/// Share of the row that is the label's.
const SHARE: f32 = 0.36;
/// Height of a row.
const ROW: f32 = 22.0;

/// Shows a parameter of the present look.
pub fn show(ui: &mut Ui, session: &mut Session, parameter: &Parameter) {
    let is_idle = session.looks.is_idle(parameter);
    let mut changed = None;
    let [mut takes_back, mut resets] = [false; 2];
    let mut wheeled = session.wheeled;
    ui.push_id(&parameter.name, |ui| {
        ui.allocate_ui_with_layout(
            vec2(ui.available_width(), ROW),
            Layout::left_to_right(Align::Center),
            |ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                takes_back = dot(ui, session, parameter);
                let label = label(ui, session, parameter);
                resets = label.double_clicked();
                let width = ui.available_width();
                let value = session.look().value(parameter);
                ui.add_enabled_ui(!is_idle, |ui| {
                    ui.allocate_ui_with_layout(
                        vec2(width, ROW),
                        Layout::left_to_right(Align::Center),
                        |ui| {
                            ui.set_min_width(width);
                            changed = control(ui, parameter, &value, &label, &mut wheeled);
                        },
                    );
                });
            },
        );
    });
    session.wheeled = wheeled;
    if takes_back || resets {
        session.reset(parameter);
    } else if let Some(value) = changed {
        session.set(parameter, &value);
    }
}

/// Marks what differs from the look; says whether the mark was clicked, which takes it back.
fn dot(ui: &mut Ui, session: &Session, parameter: &Parameter) -> bool {
    let (rect, _) = ui.allocate_exact_size(vec2(8.0, ROW), Sense::hover());
    if !session.look().strays(parameter) {
        return false;
    }
    let response = ui.interact(rect.expand2(vec2(3.0, 0.0)), ui.scope_id().with("dot"), Sense::click());
    let is_near = response.hovered() || response.has_focus();
    ui.painter().circle_filled(rect.center(), if is_near { 4.5 } else { 2.5 }, theme::ACCENT);
    let name = format!("Take back {}", parameter.param.label);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let value = shown(parameter, &session.look().chosen(parameter));
    response.on_hover_text(format!("As in the look: {value}")).clicked()
}

fn label(ui: &mut Ui, session: &Session, parameter: &Parameter) -> Response {
    let look = session.look();
    let is_idle = session.looks.is_idle(parameter);
    let text = RichText::new(parameter.param.label);
    let text = if is_idle { text.color(theme::FAINT.gamma_multiply(0.7)) } else { text };
    let width = (ui.available_width() * SHARE).clamp(LABEL[0], LABEL[1]);
    // It is no stop for the focus.
    let (rect, room) = ui.allocate_exact_size(vec2(width, ROW), Sense::CLICK);
    let mut hint = parameter.param.hint.to_owned();
    hint += match parameter.param.unit {
        "px" => " In pixels of a picture 1080 lines high.",
        "%" => " In per cent.",
        "deg" => " In degrees.",
        _ => "",
    };
    if is_idle {
        hint += "\n\nIt does nothing while the other settings are as they are.";
    }
    if look.is_animated(parameter) {
        hint += "\n\nIt is animated; this is its value in the first frame. Changing it here makes it the same in all frames.";
    }
    match look.way_back_of(parameter) {
        Some(Goal::Look) => {
            hint += &format!(
                "\n\nA double click sets it back to the look: {}",
                shown(parameter, &look.chosen(parameter))
            );
        }
        Some(Goal::Style) => {
            hint += &format!(
                "\n\nIt is as in the look. A double click sets it to the style's own default: {}",
                shown(parameter, &parameter.default)
            );
        }
        None => {}
    }
    let mut place =
        ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
    let label = egui::Label::new(text).truncate().selectable(false);
    place.add(label).union(room).on_hover_text(hint)
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
fn control(
    ui: &mut Ui,
    parameter: &Parameter,
    value: &Value,
    label: &Response,
    wheeled: &mut Option<Instant>,
) -> Option<Value> {
    let unit = unit(parameter);
    match (value, &parameter.param.kind) {
        (Value::Float(now), ParamKind::Float { range, slider, .. }) => {
            let speed = f64::from(slider[1] - slider[0]) / 240.0;
            let (range, ends) = (range.map(f64::from), slider.map(f64::from));
            let number = Number { value: f64::from(*now), range, speed, decimals: 3, unit };
            let given = Scale { number, ends }.show(ui, label, wheeled);
            given.map(|value| Value::Float(value as f32))
        }
        (Value::Int(now), ParamKind::Int { range, slider, .. }) => {
            let (range, ends) = (range.map(|end| end as f64), slider.map(|end| end as f64));
            let number = Number { value: *now as f64, range, speed: 0.1, decimals: 0, unit };
            let given = Scale { number, ends }.show(ui, label, wheeled);
            given.map(|value| Value::Int(value.round() as i64))
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
        (Value::Color(now), _) => hex::show(ui, *now, label).map(Value::Color),
        _ => None,
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
