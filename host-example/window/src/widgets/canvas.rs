//! The pointer on the picture, and what is drawn there: the line of the wipe, names, what is being done.

use egui::{
    Align2, Color32, CursorIcon, FontId, Id, PointerButton, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2,
};

use super::{brush, keyboard, theme};
use crate::state::session::{Session, Which};
use crate::state::viewport::Compare;

/// Radians per point of dragging.
const TURN: f32 = 0.008;
/// Factor on the distance per notch of the wheel.
const NEARER: f32 = 0.88;
/// Factor of magnification per notch.
const LARGER: f32 = 1.25;
/// Points to a notch for devices that scroll smoothly.
const NOTCH: f32 = 40.0;

/// Lets the pointer at the picture and draws on it.
pub fn show(ui: &mut Ui, rect: Rect, session: &mut Session) {
    // There is nothing in it that keys do.
    let response = ui.interact(rect, Id::unique("canvas"), Sense::CLICK | Sense::DRAG);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, described(session)));
    let pointer = response.hover_pos().or_else(|| response.interact_pointer_pos());
    brush::paint(ui, &response, session);
    if !(session.is_painting() && response.dragged_by(PointerButton::Primary)) {
        drag(ui, &response, session);
    }
    if response.hovered() {
        scroll(ui, pointer, session);
    }
    session.viewport.pointer = pointer.filter(|_| response.hovered()).map(|at| pixels(ui, at));
    brush::draw(ui, rect, pointer, session);
    if session.viewport.compare == Compare::Wipe && !session.viewport.peek {
        wipe(ui, rect, session);
    }
    names(ui, rect, session);
    if let Some(doing) = session.work.busy {
        let at = rect.center_bottom() + vec2(0.0, -26.0);
        tag(ui, at, Align2::CENTER_CENTER, &busy(doing, session.work.share));
        // How much is done would be read aloud at every turn.
        let doing = busy(doing, None);
        let state = ui.interact(rect, Id::unique("state"), Sense::hover());
        state.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Status, true, &doing));
        ui.ctx().accesskit_node_builder(state.id, |node| node.set_live(egui::accesskit::Live::Polite));
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(200));
    }
}

/// Name of the picture for people who do not see it.
fn described(session: &Session) -> String {
    let (name, look) = (session.open.name(), session.look());
    if look.is_plain() { format!("{name}, as it is") } else { format!("{name} in the look {}", look.name) }
}

/// A place in pixels of the window.
fn pixels(ui: &Ui, at: Pos2) -> [f32; 2] {
    [at.x * ui.pixels_per_point(), at.y * ui.pixels_per_point()]
}

/// Turns the scene or moves the picture, by what was dragged.
pub fn drag(ui: &Ui, response: &egui::Response, session: &mut Session) {
    let by = response.drag_delta();
    if by == egui::Vec2::ZERO {
        return;
    }
    let (shift, magnified) = ui.input(|i| (i.modifiers.shift, i.modifiers.command));
    let size = session.nominal_size();
    match session.open.scenery_mut() {
        Some(scenery) if !magnified => {
            let height = response.rect.height().max(1.0);
            if response.dragged_by(PointerButton::Primary) && !shift {
                scenery.orbit().rotate(-by.x * TURN, by.y * TURN);
            } else {
                scenery.orbit().pan(-by.x / height, by.y / height);
            }
        }
        _ => {
            let scale = ui.pixels_per_point();
            session.viewport.pan(size, [by.x * scale, by.y * scale]);
        }
    }
}

/// Goes nearer or magnifies about a place, by the wheel.
pub fn scroll(ui: &Ui, pointer: Option<Pos2>, session: &mut Session) {
    let mut notches = 0.0;
    let mut magnifies = session.open.scenery().is_none();
    ui.input(|input| {
        for event in &input.events {
            if let egui::Event::MouseWheel { unit, delta, modifiers, .. } = event {
                notches += match unit {
                    egui::MouseWheelUnit::Point => delta.y / NOTCH,
                    egui::MouseWheelUnit::Line => delta.y,
                    egui::MouseWheelUnit::Page => delta.y * 4.0,
                };
                magnifies |= modifiers.command;
            }
        }
    });
    if notches == 0.0 {
        return;
    }
    let size = session.nominal_size();
    match (session.open.scenery_mut(), pointer) {
        (Some(scenery), _) if !magnifies => scenery.orbit().zoom(NEARER.powf(notches)),
        (_, Some(at)) => session.viewport.zoom_about(size, pixels(ui, at), LARGER.powf(notches)),
        _ => {}
    }
}

/// The line between before and after, with its handle.
fn wipe(ui: &Ui, rect: Rect, session: &mut Session) {
    let x = session.viewport.split() / ui.pixels_per_point();
    let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(18.0, rect.height()));
    let response = ui.interact(grip.intersect(rect), Id::unique("wipe"), Sense::drag());
    if response.dragged()
        && let Some(at) = response.interact_pointer_pos()
    {
        session.viewport.wipe = ((at.x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
    }
    let response = response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    let place = f64::from(session.viewport.wipe);
    response.widget_info(|| egui::WidgetInfo::slider(true, place, "Wipe"));
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(1.0);
    });
    if let Some(moved) = keyboard::moved(ui, &response, place, 0.0..=1.0, (0.02, false)) {
        session.viewport.wipe = moved as f32;
    }
    let painter = ui.painter_at(rect);
    let light = Color32::from_white_alpha(if response.hovered() || response.dragged() { 255 } else { 200 });
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(90)));
    painter.vline(x, rect.y_range(), Stroke::new(1.0, light));
    let middle = pos2(x, rect.center().y);
    painter.circle(middle, 11.0, Color32::from_black_alpha(150), Stroke::new(1.5, light));
    for side in [-1.0, 1.0] {
        let tip = middle + vec2(side * 6.5, 0.0);
        let tail = middle + vec2(side * 3.0, 0.0);
        painter.add(egui::Shape::convex_polygon(
            vec![tip, tail + vec2(0.0, -3.5), tail + vec2(0.0, 3.5)],
            light,
            Stroke::NONE,
        ));
    }
}

/// Names of the pictures, where there are two.
fn names(ui: &Ui, rect: Rect, session: &Session) {
    let name = |which: Which| match which {
        Which::Original => "Original".to_owned(),
        Which::Look | Which::Overlay => session.look().name.clone(),
        Which::Compared => session.looks.compared.as_ref().map_or_else(String::new, |look| look.name.clone()),
    };
    let [left, right] = session.shown();
    if session.viewport.peek {
        tag(ui, rect.left_top() + vec2(12.0, 12.0), Align2::LEFT_TOP, "Original");
    } else if session.viewport.is_difference() {
        let factor = session.viewport.amplification;
        let text = format!("Difference of {} and {}, times {factor}", name(left), name(right));
        tag(ui, rect.left_top() + vec2(12.0, 12.0), Align2::LEFT_TOP, &text);
    } else if session.viewport.compare != Compare::Off {
        let split = session.viewport.split() / ui.pixels_per_point();
        tag(ui, rect.left_top() + vec2(12.0, 12.0), Align2::LEFT_TOP, &name(left));
        let place = match session.viewport.compare {
            Compare::Side => (pos2(split + 12.0, rect.top() + 12.0), Align2::LEFT_TOP),
            _ => (rect.right_top() + vec2(-12.0, 12.0), Align2::RIGHT_TOP),
        };
        tag(ui, place.0, place.1, &name(right));
    }
}

/// Words for work that is being done, with the share of it that is.
fn busy(doing: &str, share: Option<f32>) -> String {
    share.map_or_else(|| format!("{doing}…"), |share| format!("{doing}… {:.0} %", share * 100.0))
}

/// A few words on the picture.
pub fn tag(ui: &Ui, at: Pos2, align: Align2, text: &str) {
    let font = FontId::proportional(12.0);
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, theme::TEXT);
    let rect = align.anchor_size(at, galley.size() + vec2(16.0, 8.0));
    ui.painter().rect_filled(rect, 4.0, theme::VEIL);
    ui.painter().galley(rect.min + vec2(8.0, 4.0), galley, theme::TEXT);
}
