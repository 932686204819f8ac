//! The artist's window: a scene or a picture, and the look that is put on it, edited while it is watched.
//!
//! Its code stands on four floors, each a folder that imports only those below it; a test holds that. Below, the lowest is
//! the last.
//!
//! | floor | what | where |
//! |---|---|---|
//! | `app` | the window's events, and when a frame is drawn | `keys`, `opening`, `clicks`, `desktop`, `pace`, `access` |
//! | `widgets` | the controls | one file each |
//! | `drawing` | what lives on the device | `stage`, `shown`, `made`, `screen`, `sources`, `source`, `pictures`, `snapshot`, `origin`, `scene_frames`, `live_look`, `processed`, `canvas`, `counter`, `probe`, `panel` |
//! | `jobs` | work beside the window | `background`, `worker`, `opening`, `dialogs`, `document`, `reader`, `exporting`, `export`, `reveal`, `look_work`, `folder`, `listing`, `preview`, `stylizing`, `ruled`, `watch`, `idle` |
//! | `state` | all that is known of what is shown, steps back, and the window's end | `session`, `open`, `folder`, `histogram`, `scenery`, `document`, `playback`, `looks`, `look`, `resetting`, `chain`, `values`, `expression`, `viewport`, `probed`, `dialogs`, `leaving`, `plan`, `formats`, `batch`, `running`, `work`, `outcome`, `progress`, `history`, `file_steps`, `command`, `rules`, `things`, `notes`, `record`, `settings` |
//! | | what comes with the program to try looks on | `demo`, `samples` |
//! | | looks to choose from | `browser`, `preview`, `comparison`, `saving` |

#![forbid(unsafe_code)]

pub mod app;
mod drawing;
pub mod jobs;
pub mod state;
pub mod widgets;

use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

use self::app::{App, Event, FIX};
use self::jobs::document::Document;
use self::state::session::Session;
use isophote_files::desktop;
use isophote_files::error::Result;

/// Keys and the mouse and what they do, for the help of the program.
pub fn keys() -> String {
    let mut text = "Keys and mouse:".to_owned();
    for (key, what) in widgets::keys::KEYS {
        text += &format!("\n  {key:<16}{what}");
    }
    text
}

/// Opens the window, returns when it is closed, and prints a report of what was shown if asked to. `document` is what the
/// session shows, if that is pictures; its frames are read from then on. Without `size` in pixels the window is as large as it
/// was last.
///
/// # Errors
/// [`isophote_files::error::Error::Failure`] without a display or a graphics device.
pub fn show(
    mut session: Session,
    document: Option<Document>,
    size: Option<(u32, u32)>,
    with_report: bool,
) -> Result<()> {
    let failed = |e: EventLoopError| desktop::no_window(e, FIX);
    let event_loop = EventLoop::<Event>::with_user_event().build().map_err(failed)?;
    session.record.is_wanted = with_report;
    let mut app = App::new(session, size, event_loop.create_proxy())?;
    document.into_iter().for_each(|document| app.read_frames(document));
    event_loop.run_app(&mut app).map_err(failed)?;
    if with_report {
        app.session().record.report(app.session().precision)?;
    }
    app.failure.map_or(Ok(()), Err)
}
