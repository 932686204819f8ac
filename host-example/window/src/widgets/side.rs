//! The panel's place at the side, and its edge, by which it is made wider.

use egui::{
    Context, CursorIcon, EventFilter, Frame, Id, Key, Margin, Modifiers, Panel, Rect, Sense, Stroke, Ui,
};

use super::order::{self, Room};
use super::theme;
use crate::state::session::Session;

/// Usual width in points.
const USUAL: f32 = 348.0;
/// Least width, which has room for every control, and the most.
const WIDTHS: [f32; 2] = [300.0, 640.0];
/// Width that stays for the picture.
const PICTURE: f32 = 272.0;
/// Width by which a key changes it.
const STEP: f32 = 16.0;
/// Width on both sides of the edge where it can be grasped.
const GRIP: f32 = 4.0;

/// The most of the panel's width in a window as wide as its content.
fn most(context: &Context) -> f32 {
    (context.content_rect().width() - PICTURE).clamp(WIDTHS[0], WIDTHS[1])
}

/// Room of the panel, to be filled later.
pub fn reserve(ui: &mut Ui, session: &Session) -> Room {
    let width = session.settings.panel_width.unwrap_or(USUAL).clamp(WIDTHS[0], most(ui.ctx()));
    let margin = Margin { left: 12, right: 4, top: 10, bottom: 0 };
    let frame = Frame::new().fill(theme::PANEL).inner_margin(margin);
    order::reserve(ui, Panel::right("look").frame(frame).resizable(false).exact_size(width), None)
}

/// Lets the edge of the panel be dragged, or moved by keys; a double click sets it back. It lies above what is beside it.
pub fn edge(ui: &mut Ui, session: &mut Session, panel: Rect) {
    let most = most(ui.ctx());
    let id = Id::unique("edge of the panel");
    let x = panel.left();
    let grip = Rect::from_x_y_ranges(x - GRIP..=x + GRIP, panel.y_range());
    let response = ui.interact(grip, id, Sense::click_and_drag());
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    let mut width = panel.width();
    if response.drag_started()
        && let Some(origin) = ui.input(|input| input.pointer.press_origin())
    {
        ui.data_mut(|data| data.insert_temp(id, origin.x - x));
    }
    if response.dragged()
        && let Some(at) = response.interact_pointer_pos()
    {
        let grasped: f32 = ui.data(|data| data.get_temp(id)).unwrap_or_default();
        width = panel.right() - at.x + grasped;
    }
    if response.has_focus() {
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        let pressed = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as f32;
        width += STEP * (pressed(Key::ArrowLeft) - pressed(Key::ArrowRight));
    }
    if width != panel.width() {
        session.settings.panel_width = Some(width.clamp(WIDTHS[0], most).round());
    }
    if response.double_clicked() {
        session.settings.panel_width = None;
    }
    let width = f64::from(panel.width());
    response.widget_info(|| egui::WidgetInfo::slider(true, width, "Width of the panel"));
    if response.hovered() || response.dragged() || response.has_focus() {
        ui.painter().vline(x, panel.y_range(), Stroke::new(2.0, theme::ACCENT));
    }
}
