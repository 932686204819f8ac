//! The controls of the window: what surrounds the picture and what is drawn on it. They read and change the session and ask
//! for the rest by requests; nothing here knows a device.

mod act;
mod batch;
mod browser;
mod brush;
mod canvas;
mod card;
mod chain;
mod choices;
mod comparison;
mod control;
mod details;
mod dialog;
mod dialogs;
mod drop;
mod ends;
mod export;
mod help;
mod hex;
mod hint;
mod histogram;
pub mod keyboard;
pub mod keys;
mod layers;
mod leaving;
mod lighting;
mod materials;
mod notes;
mod number;
mod order;
mod panel;
mod probe;
mod scale;
mod side;
mod star;
mod start;
mod status;
pub mod theme;
mod top;
mod wheel;

use egui::{Context, Margin, Panel, Ui};

use self::order::Room;
use crate::state::session::Session;
use crate::state::viewport::Area;

/// Height of what is in the bar at the bottom, in points.
const BOTTOM: f32 = 22.0;
/// The narrowest window, in points, that has room for more about a look beside all of them.
const DETAILS: f32 = 940.0;
/// The smallest window, in points, that has room for the panel and the bars.
const ROOM: [f32; 2] = [620.0, 300.0];

/// Points of the window's height that lists leave free.
const LIST: f32 = 90.0;

/// Shows everything.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let title = if session.open.has_picture() { session.open.name() } else { "Isophote" };
    ui.ctx().accesskit_node_builder(egui::accesskit_root_id(), |node| node.set_label(title));
    let size = ui.available_size();
    // Lists that open are no higher than the window.
    let most = ui.spacing().combo_height.min(size.y - LIST);
    ui.spacing_mut().combo_height = most.max(60.0);
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
    if let Some(room) = side {
        let name = if session.browser.is_open { "The selected look" } else { "The look" };
        order::fill(ui, room.inner, name, |ui| match session.browser.is_open {
            true => details::show(ui, session),
            false => panel::show(ui, session),
        });
        side::edge(ui, session, room.outer);
    }
    if let Some(room) = below {
        order::fill(ui, room.inner, "Time and view", |ui| status::show(ui, session));
    }
    notes::show(ui.ctx(), rect, session);
    in_front(ui.ctx(), session);
}

/// Shows the bar at the top; returns the room of the bar at the bottom and of the panel, which are read after the picture.
fn bars(ui: &mut Ui, session: &mut Session, width: f32) -> [Option<Room>; 2] {
    bar(Panel::top("top")).show(ui, |ui| top::show(ui, session));
    let below = order::reserve(ui, bar(Panel::bottom("bottom")), Some(BOTTOM));
    let has_panel = match session.browser.is_open {
        true => width >= DETAILS,
        false => !session.settings.panel_hidden && session.browser.comparison.is_none(),
    };
    let side = (session.open.has_picture() && has_panel).then(|| side::reserve(ui, session));
    [Some(below), side]
}

/// Shows dialogs, the last in front, and where the focus is.
fn in_front(context: &Context, session: &mut Session) {
    export::show(context, session);
    batch::show(context, session);
    dialogs::show(context, session);
    help::show(context, session);
    session.follow_saving();
    leaving::show(context, session);
    // Looking for the control of the ring takes the focus from it where the pointer was pressed elsewhere in this pass: what gets
    // the focus back comes after it.
    keyboard::ring(context);
    dialog::end(context);
    drop::show(context, session);
}

fn bar(panel: Panel) -> Panel {
    let frame = egui::Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(12, 6));
    panel.frame(frame).resizable(false)
}
