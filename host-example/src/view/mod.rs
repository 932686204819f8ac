//! The viewer: a window that renders a scene and stylizes every frame. [`KEYS`] says what can be done in it.

mod app;
pub mod document;
pub mod export;
mod present;
mod stage;
pub mod viewer;

use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

use crate::error::{Error, Result};
use crate::output;
use app::App;
use viewer::Viewer;

/// What keys and mouse do, for the help of the program.
pub const KEYS: &str = "\
Keys and mouse:
  drag         orbits; with Shift or another button, pans
  wheel        zooms
  1, 2, ...    show the style of that number; Tab the next one
  Space        plays and pauses the animation
  f            frames the scene
  c            looks through the file's camera
  q, Escape    close the window";

/// Opens the window, returns when it is closed, and prints a report of what was shown if asked to.
///
/// # Errors
/// [`Error::Failure`] without a display or a graphics device; [`Error::Input`] for scenes and styles that
/// cannot be shown.
pub fn show(viewer: Viewer, with_report: bool) -> Result<()> {
    let failed = |e: &EventLoopError| {
        let problem = reason(&e.to_string()).to_owned();
        Error::failure(format!("no window can be opened: {problem}"), "start the viewer in a desktop session")
    };
    let event_loop = EventLoop::new().map_err(|e| failed(&e))?;
    let mut app = App::new(viewer);
    event_loop.run_app(&mut app).map_err(|e| failed(&e))?;
    if with_report {
        report(app.viewer())?;
    }
    app.failure.map_or(Ok(()), Err)
}

/// Why the system refuses a window, without the line of winit's source that the text begins with.
fn reason(problem: &str) -> &str {
    problem.split_once(".rs:").and_then(|(_, place)| place.split_once(": ")).map_or(problem, |(_, why)| why)
}

fn report(viewer: &Viewer) -> Result<()> {
    let mut text = format!("{}\n", viewer.adapter);
    for stretch in viewer.stretches() {
        let mut times = stretch.times.clone();
        times.sort_unstable();
        let median = times.get(times.len() / 2).map_or(0.0, |t| t.as_secs_f64() * 1e3);
        let (width, height) = stretch.size;
        let style = &stretch.style;
        text += &format!("{style} {width}x{height}: {} frames, {median:.1} ms each\n", times.len());
    }
    output::print(&text)
}
