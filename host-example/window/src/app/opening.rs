//! The window and its device are opened, and the device anew when it is lost.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_winit::State;
use winit::dpi::PhysicalSize;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

use super::{App, FIX, desktop};
use crate::drawing::stage::Stage;
use crate::widgets;
use isophote_files::desktop::no_window;
use isophote_files::error::Result;

/// Number of times that a device is opened anew, in vain, before what is open is put away, and then before the window
/// gives up.
const REVIVALS: u32 = 3;
/// Time until the next attempt, where none can be opened: a driver that starts again takes a while.
const PAUSE: Duration = Duration::from_secs(1);
/// Size of the window in pixels where nobody says anything else.
const SIZE: (u32, u32) = (1440, 900);

impl App {
    /// Opens the device, and the window where there is none yet.
    pub(super) fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        let window = self.window(event_loop)?;
        let mut stage =
            Stage::new(&window, event_loop.owned_display_handle(), &self.session, &self.wake, &self.landed)?;
        if self.session.record.is_wanted {
            stage.measure();
        }
        if self.input.is_none() {
            self.input = Some(self.controls(event_loop, &window, stage.most_texels()));
        } else {
            self.session.previews.forget_textures();
        }
        // What letters look like was on the device that is gone.
        stage.panel.restore(&self.textures);
        if self.devices == 0 {
            window.set_visible(true);
        }
        self.session.record.adapter = stage.adapter();
        if self.session.open.has_picture() {
            // Nothing of it is on this device yet.
            self.session.work.busy = Some("Opening");
        }
        self.stage = Some(stage);
        self.devices += 1;
        self.due = Some(Instant::now());
        Ok(())
    }

    fn window(&mut self, event_loop: &ActiveEventLoop) -> Result<Arc<Window>> {
        if let Some(window) = &self.window {
            return Ok(Arc::clone(window));
        }
        let (width, height) = self.size.or(self.session.settings.window).unwrap_or(SIZE);
        self.session.takes_drops = desktop::takes_drops(event_loop);
        let attributes = desktop::named(Window::default_attributes())
            .with_window_icon(desktop::icon())
            .with_title(self.session.title())
            // What reads the window aloud must be there before it is seen.
            .with_visible(false)
            .with_inner_size(PhysicalSize::new(width, height));
        let window = event_loop.create_window(attributes).map_err(|e| no_window(e, FIX))?;
        Ok(Arc::clone(self.window.insert(Arc::new(window))))
    }

    /// State of the controls, by which they hear of events; their textures are at most so many texels across.
    fn controls(&self, event_loop: &ActiveEventLoop, window: &Window, texels: usize) -> State {
        let context = egui::Context::default();
        widgets::theme::apply(&context);
        // Where frames are slow, a click takes as long as two of them.
        context.options_mut(|options| {
            options.input_options.max_click_duration = f64::INFINITY;
            options.input_options.max_double_click_delay = 0.6;
        });
        let scale = Some(window.scale_factor() as f32);
        let mut input = State::new(context, egui::ViewportId::ROOT, event_loop, scale, None, Some(texels));
        input.init_accesskit(event_loop, window, self.proxy.clone());
        input
    }

    /// Goes on after an error with a new device, and with nothing open where that does not help. Ends the window where even
    /// that does not, and where there was no device yet.
    pub(super) fn handle(&mut self, event_loop: &ActiveEventLoop, result: Result<()>) {
        let Err(error) = result else { return };
        let was_open = self.stage.take().is_some() || self.revival.is_some();
        if self.revivals >= REVIVALS && self.session.open.has_picture() {
            self.session.close();
            self.revivals = 0;
        }
        if !was_open || self.revivals >= REVIVALS {
            self.failure = Some(error);
            return event_loop.exit();
        }
        self.session.notes.complain(&error);
        let pause = if self.revivals == 0 { Duration::ZERO } else { PAUSE };
        self.revivals += 1;
        self.revival = Some(Instant::now() + pause);
    }

    /// Opens a device in the place of the one that is gone, when it is time; says when that is otherwise.
    pub(super) fn revive(&mut self, event_loop: &ActiveEventLoop) -> Option<Instant> {
        let at = self.revival?;
        if at > Instant::now() {
            return Some(at);
        }
        let opened = self.open(event_loop);
        if opened.is_ok() {
            self.revival = None;
        }
        self.handle(event_loop, opened);
        self.revival
    }
}
