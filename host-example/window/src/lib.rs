//! The artist's window: a scene or a picture, and the look that is put on it, edited while it is watched.
//!
//! | what | where |
//! |---|---|
//! | the window's events, and when a frame is drawn | `app`, `clicks`, `pace` |
//! | all that is known of what is shown, steps back, and the window's end | `session`, `leaving`, `history`, `file_steps`, `look`, `chain`, `value`, `scenery`, `playback`, `viewport` |
//! | what comes with the program to try looks on | `demo`, `samples` |
//! | looks to choose from | `browser`, `preview`, `comparison`, `saving` |
//! | work beside the window | `worker`, `background`, `dialogs`, `look_work`, `watch`, `idle`, `document`, `export` |
//! | what lives on the device | `stage`, `shown`, `screen`, `sources`, `source`, `pictures`, `snapshot`, `live_look`, `canvas`, `probe`, `panel` |
//! | the controls | `ui` |

#![forbid(unsafe_code)]

pub mod app;
mod background;
pub mod browser;
mod canvas;
pub mod chain;
mod clicks;
pub mod command;
pub mod comparison;
mod demo;
mod dialogs;
pub mod document;
pub mod export;
mod file_steps;
mod history;
mod idle;
pub mod leaving;
mod live_look;
pub mod look;
mod look_work;
mod made;
mod notes;
mod pace;
mod panel;
mod pictures;
pub mod plan;
pub mod playback;
pub mod preview;
mod probe;
pub mod record;
pub mod samples;
pub mod saving;
pub mod scenery;
mod screen;
pub mod session;
pub mod settings;
mod shown;
mod snapshot;
mod source;
mod sources;
mod stage;
pub mod ui;
pub mod value;
mod viewport;
mod watch;
mod worker;

use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

use app::{App, Event, FIX};
use isophote_example::desktop;
use isophote_files::error::Result;
use session::Session;

/// Keys and the mouse and what they do, for the help of the program.
pub fn keys() -> String {
    let mut text = "Keys and mouse:".to_owned();
    for (key, what) in ui::keys::KEYS {
        text += &format!("\n  {key:<16}{what}");
    }
    text
}

/// Opens the window, returns when it is closed, and prints a report of what was shown if asked to. Without `size` in pixels
/// it is as large as it was last.
///
/// # Errors
/// [`isophote_files::error::Error::Failure`] without a display or a graphics device.
pub fn show(mut session: Session, size: Option<(u32, u32)>, with_report: bool) -> Result<()> {
    let failed = |e: EventLoopError| desktop::no_window(e, FIX);
    let event_loop = EventLoop::<Event>::with_user_event().build().map_err(failed)?;
    session.record.is_wanted = with_report;
    let mut app = App::new(session, size, event_loop.create_proxy())?;
    event_loop.run_app(&mut app).map_err(failed)?;
    if with_report {
        app.session().record.report(app.session().precision)?;
    }
    app.failure.map_or(Ok(()), Err)
}
