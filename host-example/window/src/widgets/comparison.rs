//! Looks beside each other: one pan and one zoom for all, and a click takes a look.

use std::sync::Arc;

use egui::{Align2, Color32, Id, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use super::{canvas, card, theme};
use crate::state::comparison;
use crate::state::look::EditedLook;
use crate::state::preview::order::Order;
use crate::state::preview::picture::Picture;
use crate::state::preview::{Place, Preview};
use crate::state::session::Session;
use crate::state::viewport::Area;

/// Times that panes are computed finer than they are seen, where the picture is made smaller.
const FINENESS: u32 = 2;

/// Shows the panes.
pub fn show(ui: &mut Ui, rect: Rect, session: &mut Session) {
    let Some(comparison) = &session.browser.comparison else { return };
    let looks = comparison.panes.clone();
    let scale = ui.pixels_per_point();
    ui.painter().rect_filled(rect, 0.0, theme::SURROUND);
    let aspect = match (session.open.playback(), session.previews.picture()) {
        (Some(playback), _) => playback.size().0 as f32 / playback.size().1.max(1) as f32,
        _ => rect.width() / rect.height().max(1.0),
    };
    let areas = comparison::areas(looks.len(), session.viewport.area, aspect);
    let Some(first) = areas.first().copied() else { return };
    // Pan and zoom are those of the first pane.
    session.viewport.area = first;
    let mut taken = None;
    for (index, (look, area)) in looks.iter().zip(&areas).enumerate() {
        let points = Rect::from_min_size(pos2(area.x, area.y) / scale, vec2(area.width, area.height) / scale);
        if pane(ui, points, session, index, look, [area.x - first.x, area.y - first.y]) {
            taken = Some(index);
        }
    }
    if let Some(index) = taken {
        session.take_pane(index);
        ui.ctx().request_repaint();
    }
}

/// One pane, `by` pixels of the window from the first; says whether its look is taken.
fn pane(
    ui: &mut Ui,
    rect: Rect,
    session: &mut Session,
    index: usize,
    look: &Arc<EditedLook>,
    by: [f32; 2],
) -> bool {
    let response = ui.interact(rect, Id::unique(("pane", index)), Sense::click_and_drag());
    let name = format!("Take {}", look.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    canvas::drag(ui, &response, session);
    if response.hovered() {
        let from_first = |at: egui::Pos2| at - vec2(by[0], by[1]) / ui.pixels_per_point();
        canvas::scroll(ui, response.hover_pos().map(from_first), session);
    }
    let [_, place] = session.viewport.places(session.nominal_size());
    let place = Area { x: place.x + by[0], y: place.y + by[1], ..place };
    if let Some(picture) = session.previews.picture().cloned() {
        ask(ui, rect, session, index, look, place, &picture);
    }
    let clip = rect.intersect(ui.clip_rect());
    let mut inner = ui.new_child(egui::UiBuilder::new().max_rect(rect));
    inner.set_clip_rect(clip);
    let context = ui.ctx().clone();
    let mut is_current = false;
    // Single pixels are seen from twice their size on, as on the canvas.
    let is_large = session.viewport.scale(session.nominal_size()) >= 2.0;
    for (of, crisp) in [(Place::Pane(index), false), (Place::Detail(index), is_large)] {
        if let Some(preview) = session.previews.get(&context, of, crisp) {
            is_current = preview.is_current;
            draw(&inner, &preview, place);
        }
    }
    let problem = session.previews.problem(Place::Pane(index)).map(str::to_owned);
    let waits = if is_current || problem.is_some() { "" } else { " …" };
    canvas::tag(
        &inner,
        rect.left_top() + vec2(12.0, 12.0),
        Align2::LEFT_TOP,
        &format!("{}{waits}", look.name),
    );
    if let Some(problem) = problem {
        canvas::tag(&inner, rect.center(), Align2::CENTER_CENTER, &problem);
    }
    if response.hovered() {
        let stroke = Stroke::new(2.0, theme::ACCENT);
        inner.painter().rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);
    }
    response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked()
}

/// Asks for all of the picture as it fits the pane, and for the part that is seen where it is magnified.
fn ask(
    ui: &Ui,
    rect: Rect,
    session: &mut Session,
    index: usize,
    look: &Arc<EditedLook>,
    place: Area,
    picture: &Picture,
) {
    let scale = ui.pixels_per_point();
    let whole = picture.fitting([rect.width() * scale, rect.height() * scale]);
    session.previews.want(Place::Pane(index), Order::whole(Arc::clone(look), whole, FINENESS));
    let seen = picture.fitting([place.width, place.height]);
    if seen.0 <= whole.0 {
        return;
    }
    // The part of the picture within the pane, in the pixels that it has at this size.
    let factor = [seen.0 as f32 / place.width, seen.1 as f32 / place.height];
    let corner = |at: egui::Pos2, most: (u32, u32), up: bool| {
        let at = [(at.x * scale - place.x) * factor[0], (at.y * scale - place.y) * factor[1]];
        let [x, y] = at.map(|v| if up { v.ceil() } else { v.floor() } as i32);
        [x.clamp(0, most.0 as i32), y.clamp(0, most.1 as i32)]
    };
    let part = [corner(rect.min, seen, false), corner(rect.max, seen, true)];
    if part[0][0] < part[1][0] && part[0][1] < part[1][1] {
        let order = Order { look: Arc::clone(look), size: seen, part, fineness: 1 };
        session.previews.want(Place::Detail(index), order);
    }
}

/// Puts a preview where the picture lies in the window, of which `place` is the whole.
fn draw(ui: &Ui, preview: &Preview, place: Area) {
    let scale = ui.pixels_per_point();
    let [x, y] = [place.width / preview.size.0 as f32, place.height / preview.size.1 as f32];
    let [from, to] =
        preview.part.map(|[column, row]| pos2(place.x + column as f32 * x, place.y + row as f32 * y) / scale);
    card::draw(ui, preview.texture, Rect::from_min_max(from, to), Color32::WHITE);
}
