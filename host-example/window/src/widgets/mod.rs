//! The controls of the window: what surrounds the picture and what is drawn on it. They read and change the session and ask
//! for the rest by requests; nothing here knows a device.

mod act;
mod browser;
mod canvas;
mod card;
mod chain;
mod comparison;
mod control;
mod details;
mod dialog;
mod dialogs;
mod export;
mod help;
pub mod keyboard;
pub mod keys;
mod layers;
mod leaving;
mod lighting;
mod notes;
mod order;
mod panel;
mod start;
mod status;
pub mod theme;
mod top;

use egui::{Context, Margin, Panel, Rect, Ui};

use crate::state::session::Session;
use crate::state::viewport::Area;

/// Width of the panel in points.
const PANEL: f32 = 348.0;
/// Height of what is in the bar at the bottom, in points.
const BOTTOM: f32 = 22.0;
/// The narrowest window, in points, that has room for more about a look beside all of them.
const DETAILS: f32 = 940.0;
/// The smallest window, in points, that has room for the panel and the bars.
const ROOM: [f32; 2] = [620.0, 300.0];

/// Shows everything.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let title = if session.open.has_picture() { session.open.name() } else { "Isophote" };
    ui.ctx().accesskit_node_builder(egui::accesskit_root_id(), |node| node.set_label(title));
    let size = ui.available_size();
    let has_room = size.x >= ROOM[0] && size.y >= ROOM[1];
    let [below, side] = if has_room { bars(ui, session, size.x) } else { [None; 2] };
    let rect = ui.available_rect_before_wrap();
    let scale = ui.pixels_per_point();
    let [x, y] = [rect.min.x, rect.min.y].map(|v| (v * scale).round());
    let [right, bottom] = [rect.max.x, rect.max.y].map(|v| (v * scale).round());
    session.viewport.area = Area { x, y, width: (right - x).max(1.0), height: (bottom - y).max(1.0) };
    if session.is_covered() {
        session.viewport.pointer = None;
    }
    if session.browser.comparison.is_some() {
        comparison::show(ui, rect, session);
    } else if session.browser.is_open {
        browser::show(ui, rect, session);
    } else if session.open.has_picture() {
        canvas::show(ui, rect, session);
    } else {
        start::show(ui, session, has_room);
    }
    if let Some(rect) = side {
        let name = if session.browser.is_open { "The selected look" } else { "The look" };
        order::fill(ui, rect, name, |ui| match session.browser.is_open {
            true => details::show(ui, session),
            false => panel::show(ui, session),
        });
    }
    if let Some(rect) = below {
        order::fill(ui, rect, "Time and view", |ui| status::show(ui, session));
    }
    notes::show(ui.ctx(), rect, session);
    in_front(ui.ctx(), session);
}

/// Shows the bar at the top; returns the room of the bar at the bottom and of the panel, which are read after the picture.
fn bars(ui: &mut Ui, session: &mut Session, width: f32) -> [Option<Rect>; 2] {
    bar(Panel::top("top")).show(ui, |ui| top::show(ui, session));
    let below = order::reserve(ui, bar(Panel::bottom("bottom")), Some(BOTTOM));
    let has_panel = match session.browser.is_open {
        true => width >= DETAILS,
        false => !session.settings.panel_hidden && session.browser.comparison.is_none(),
    };
    let side = (session.open.has_picture() && has_panel).then(|| {
        let margin = Margin { left: 12, right: 4, top: 10, bottom: 0 };
        let frame = egui::Frame::new().fill(theme::PANEL).inner_margin(margin);
        let panel = Panel::right("look").frame(frame).resizable(false).exact_size(PANEL);
        order::reserve(ui, panel, None)
    });
    [Some(below), side]
}

/// Shows dialogs, the last in front, and where the focus is.
fn in_front(context: &Context, session: &mut Session) {
    export::show(context, session);
    dialogs::show(context, session);
    help::show(context, session);
    session.follow_saving();
    leaving::show(context, session);
    dialog::end(context);
    keyboard::ring(context);
}

fn bar(panel: Panel) -> Panel {
    let frame = egui::Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(12, 6));
    panel.frame(frame).resizable(false)
}
