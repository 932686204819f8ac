//! The keyboard among the controls: which one has the focus is seen, scrolled to, and moved by keys where it is a slider.

use std::ops::RangeInclusive;

use egui::emath::Numeric;
use egui::{
    Context, Event, EventFilter, FocusDirection, Id, Key, Response, Role, Slider, Stroke, StrokeKind, Ui,
    WidgetInfo,
};

use super::theme;

/// Steps from one end of a slider to the other.
pub const STEPS: f64 = 100.0;
/// Steps by Page Up and Page Down.
const LEAP: f64 = 10.0;
/// Part of a step that is taken with Shift.
const FINE: f64 = 0.1;
/// Points between a control and the ring around it.
const GAP: f32 = 2.0;

/// Keys that belong to the control that has the focus, in the words of the window.
pub fn belongs_to_controls(key: &winit::keyboard::Key) -> bool {
    use winit::keyboard::{Key, NamedKey as Named};
    matches!(
        key,
        Key::Named(
            Named::Space
                | Named::Enter
                | Named::ArrowLeft
                | Named::ArrowRight
                | Named::ArrowUp
                | Named::ArrowDown
                | Named::Home
                | Named::End
                | Named::PageUp
                | Named::PageDown
        )
    )
}

/// Keeps arrows from taking the focus to another control.
pub fn keep_arrows(ui: &Ui, id: Id) {
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
}

/// Takes an arrow that was pressed in this frame away from the search for another control.
pub fn stay(ui: &Ui) {
    ui.memory_mut(|memory| memory.move_focus(FocusDirection::None));
}

/// A slider that takes all keys by which sliders are moved.
pub fn slider<N: Numeric>(
    ui: &mut Ui,
    value: &mut N,
    range: RangeInclusive<N>,
    form: impl for<'v> FnOnce(Slider<'v>) -> Slider<'v>,
) -> Response {
    let before = value.to_f64();
    let mut response = ui.add(form(Slider::new(value, range.clone())));
    let step = if N::INTEGRAL { 1.0 } else { (range.end().to_f64() - range.start().to_f64()) / STEPS };
    let range = range.start().to_f64()..=range.end().to_f64();
    if let Some(moved) = moved(ui, &response, before, range, (step, N::INTEGRAL)) {
        *value = N::from_f64(moved);
        response.mark_changed();
    }
    response
}

/// Value that keys give a slider with the focus, if any was pressed. Arrows move it by a step, which is whole or not; with
/// Shift by a tenth of it. A value beside the rail, which was typed, can be moved back but not further away.
pub fn moved(
    ui: &Ui,
    slider: &Response,
    before: f64,
    range: RangeInclusive<f64>,
    (step, is_whole): (f64, bool),
) -> Option<f64> {
    if !slider.has_focus() || ui.ctx().text_edit_focused() {
        return None;
    }
    keep_arrows(ui, slider.id);
    let (least, most) = (range.start().min(before), range.end().max(before));
    let mut now = None;
    ui.input(|input| {
        for event in &input.events {
            let Event::Key { key, pressed: true, modifiers, .. } = event else { continue };
            let fine = if modifiers.shift && !is_whole { FINE } else { 1.0 };
            let value = now.unwrap_or(before);
            let to = match key {
                _ if modifiers.command || modifiers.alt => continue,
                Key::ArrowRight | Key::ArrowUp => value + step * fine,
                Key::ArrowLeft | Key::ArrowDown => value - step * fine,
                Key::PageUp => value + step * LEAP,
                Key::PageDown => value - step * LEAP,
                Key::Home => *range.start(),
                Key::End => *range.end(),
                _ => continue,
            };
            // Sums of steps end on what can be read.
            let unit = step * if is_whole { 1.0 } else { FINE };
            now = Some(((to / unit).round() * unit).clamp(least, most));
        }
    });
    if let Some(value) = now {
        stay(ui);
        // The slider has told where its own keys would have moved it.
        slider.widget_info(|| WidgetInfo { value: Some(value), ..WidgetInfo::new(Role::Slider) });
    }
    now
}

/// Tells programs that read the window aloud what is chosen in a list. On Linux values of lists are not passed on, descriptions
/// are.
pub fn tell(list: &Response, chosen: &str) {
    if cfg!(target_os = "linux") {
        list.ctx.accesskit_node_builder(list.id, |node| node.set_description(chosen));
    }
}

/// Scrolls to the control that has just been given the focus, where it is cut off; called within what scrolls.
pub fn follow(ui: &Ui) {
    let Some(id) = ui.memory(|memory| memory.focused()) else { return };
    if ui.memory(|memory| memory.had_focus_last_frame(id)) {
        return;
    }
    if let Some(control) = ui.ctx().read_response(id)
        && control.layer_id == ui.layer_id()
        && control.interact_rect != control.rect
        && ui.min_rect().x_range().contains(control.rect.center().x)
    {
        ui.scroll_to_rect_animation(
            control.rect.expand(GAP * 4.0),
            None,
            egui::style::ScrollAnimation::none(),
        );
        ui.ctx().request_repaint();
    }
}

/// Draws a ring around the control that has the focus. Fields of text have one of their own, and a cursor.
pub fn ring(context: &Context) {
    let Some(id) = context.memory(|memory| memory.focused()) else { return };
    let Some(control) = context.read_response(id).filter(|control| control.interact_rect.is_positive())
    else {
        return;
    };
    if context.text_edit_focused() {
        return;
    }
    let painter = context.layer_painter(control.layer_id);
    let painter = painter.with_clip_rect(control.interact_rect.expand(GAP + 2.0));
    let stroke = Stroke::new(2.0, theme::FOCUS);
    painter.rect_stroke(control.rect.expand(GAP), 5.0, stroke, StrokeKind::Middle);
}
