//! The controls of the window: what surrounds the picture and what is drawn on it. They read and change the session and ask
//! for the rest by requests; nothing here knows a device.

mod act;
mod batch;
mod browser;
mod canvas;
mod card;
mod chain;
mod choices;
mod comparison;
mod control;
mod details;
mod dialogs;
mod drop;
mod ends;
mod export;
mod help;
mod hex;
mod hint;
mod histogram;
pub mod keys;
mod layers;
mod leaving;
mod lighting;
mod notes;
mod number;
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

use egui::{Margin, Panel, Ui};

use crate::state::session::Session;
use crate::state::viewport::Area;

/// The narrowest window, in points, that has room for more about a look beside all of them.
const DETAILS: f32 = 940.0;
/// The smallest window, in points, that has room for the panel and the bars.
const ROOM: [f32; 2] = [620.0, 300.0];

/// Points of the window's height that lists leave free.
const LIST: f32 = 90.0;

/// Shows everything.
pub fn show(ui: &mut Ui, session: &mut Session) {
    let size = ui.available_size();
    // Lists that open are no higher than the window.
    let most = ui.spacing().combo_height.min(size.y - LIST);
    ui.spacing_mut().combo_height = most.max(60.0);
    let has_room = size.x >= ROOM[0] && size.y >= ROOM[1];
    let mut beside = None;
    if has_room {
        bar(Panel::top("top")).show(ui, |ui| top::show(ui, session));
        bar(Panel::bottom("bottom")).show(ui, |ui| status::show(ui, session));
        let has_panel = match session.browser.is_open {
            true => size.x >= DETAILS,
            false => !session.settings.panel_hidden && session.browser.comparison.is_none(),
        };
        if session.open.has_picture() && has_panel {
            beside = Some(side::show(ui, session, |ui, session| match session.browser.is_open {
                true => details::show(ui, session),
                false => panel::show(ui, session),
            }));
        }
    }
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
    if let Some((panel, most)) = beside {
        side::edge(ui, session, panel, most);
    }
    notes::show(ui.ctx(), rect, session);
    export::show(ui.ctx(), session);
    batch::show(ui.ctx(), session);
    dialogs::show(ui.ctx(), session);
    help::show(ui.ctx(), session);
    session.follow_saving();
    leaving::show(ui.ctx(), session);
    drop::show(ui.ctx(), session);
}

fn bar(panel: Panel) -> Panel {
    let frame = egui::Frame::new().fill(theme::PANEL).inner_margin(Margin::symmetric(12, 6));
    panel.frame(frame).resizable(false)
}
