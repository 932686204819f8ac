//! The viewer's window: what keys and mouse do, and when a frame is drawn.

use std::sync::Arc;
use std::time::Instant;

use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

use super::stage::{Drawn, Stage};
use super::viewer::Viewer;
use crate::error::{Error, Result};

/// Radians per pixel of dragging.
const TURN: f32 = 0.008;
/// Factor on the distance per notch of the wheel.
const ZOOM: f32 = 0.88;
/// How often a lost device is opened anew before the viewer gives up.
const REVIVALS: u32 = 3;
/// Seconds between two updates of the title.
const TITLE_SECONDS: f32 = 0.25;

/// The window and what it shows.
pub struct App {
    viewer: Viewer,
    window: Option<Arc<Window>>,
    stage: Option<Stage>,
    /// Ended the viewer, when something did.
    pub failure: Option<Error>,
    revivals: u32,
    dragging: Option<Drag>,
    cursor: (f64, f64),
    shift: bool,
    hidden: bool,
    dirty: bool,
    titled: Instant,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Drag {
    Orbit,
    Pan,
}

impl App {
    /// A viewer whose window opens once the event loop runs.
    pub fn new(viewer: Viewer) -> Self {
        Self {
            viewer,
            window: None,
            stage: None,
            failure: None,
            revivals: 0,
            dragging: None,
            cursor: (0.0, 0.0),
            shift: false,
            hidden: false,
            dirty: true,
            titled: Instant::now(),
        }
    }

    /// What was shown, for whoever asked for a report.
    pub fn viewer(&self) -> &Viewer {
        &self.viewer
    }

    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        let window = match &self.window {
            Some(window) => Arc::clone(window),
            None => {
                let (width, height) = self.viewer.size;
                let attributes = Window::default_attributes()
                    .with_title(self.viewer.title(None))
                    .with_inner_size(PhysicalSize::new(width, height));
                let window = event_loop.create_window(attributes).map_err(|e| {
                    Error::failure(
                        format!("no window can be opened: {e}"),
                        "start the viewer in a desktop session",
                    )
                })?;
                Arc::clone(self.window.insert(Arc::new(window)))
            }
        };
        let mut stage = Stage::new(&window, event_loop.owned_display_handle(), &self.viewer)?;
        stage.set_style(&self.viewer.library, self.viewer.load(self.viewer.style())?)?;
        self.viewer.adapter = stage.adapter();
        self.stage = Some(stage);
        self.dirty = true;
        Ok(())
    }

    /// Ends the viewer on an error, unless a new device may help.
    fn handle(&mut self, event_loop: &ActiveEventLoop, result: Result<()>) {
        let Err(error) = result else { return };
        let lost = self.stage.as_ref().is_some_and(Stage::is_lost);
        self.stage = None;
        if lost && self.revivals < REVIVALS {
            self.revivals += 1;
            eprintln!("warning: {error}; opening the device again");
            match self.open(event_loop) {
                Ok(()) => return,
                Err(error) => self.failure = Some(error),
            }
        } else {
            self.failure = Some(error);
        }
        event_loop.exit();
    }

    fn draw(&mut self) -> Result<()> {
        let (Some(window), Some(stage)) = (&self.window, &mut self.stage) else { return Ok(()) };
        self.dirty = false;
        let started = Instant::now();
        let view = self.viewer.advance();
        let drawn = stage.draw(window, &self.viewer.scene, &self.viewer.pose, &view, &self.viewer.look)?;
        if drawn == Drawn::Skipped {
            self.dirty = true;
            return Ok(());
        }
        self.revivals = 0;
        self.viewer.count(started.elapsed());
        if self.titled.elapsed().as_secs_f32() > TITLE_SECONDS {
            self.titled = Instant::now();
            window.set_title(&self.viewer.title(Some(started.elapsed())));
        }
        Ok(())
    }

    fn key(&mut self, event_loop: &ActiveEventLoop, event: &KeyEvent) -> Result<()> {
        if event.state != ElementState::Pressed {
            return Ok(());
        }
        match event.logical_key.as_ref() {
            Key::Named(NamedKey::Escape) | Key::Character("q") => event_loop.exit(),
            Key::Named(NamedKey::Space) => self.viewer.toggle_playing(),
            Key::Named(NamedKey::Tab) => return self.switch(self.viewer.next_style()),
            Key::Character("f") => self.viewer.frame_all(),
            Key::Character("c") => self.viewer.use_file_camera(),
            Key::Character(text) => {
                if let Some(number) =
                    text.parse::<usize>().ok().filter(|n| (1..=self.viewer.styles.len()).contains(n))
                {
                    return self.switch(number - 1);
                }
                return Ok(());
            }
            _ => return Ok(()),
        }
        self.dirty = true;
        Ok(())
    }

    fn switch(&mut self, index: usize) -> Result<()> {
        let Some(stage) = &mut self.stage else { return Ok(()) };
        let loaded = self.viewer.load(&self.viewer.styles[index]);
        match loaded.and_then(|style| stage.set_style(&self.viewer.library, style)) {
            // A graph file that was edited meanwhile, say: the style before stays.
            Err(error @ Error::Input { .. }) => eprintln!("warning: {error}"),
            result => {
                result?;
                self.viewer.switched(index);
            }
        }
        self.dirty = true;
        Ok(())
    }

    fn moved(&mut self, x: f64, y: f64) {
        let (dx, dy) = ((x - self.cursor.0) as f32, (y - self.cursor.1) as f32);
        self.cursor = (x, y);
        let height = self.window.as_ref().map_or(1, |w| w.inner_size().height).max(1) as f32;
        match self.dragging {
            Some(Drag::Orbit) => self.viewer.orbit().rotate(-dx * TURN, dy * TURN),
            Some(Drag::Pan) => self.viewer.orbit().pan(-dx / height, dy / height),
            None => return,
        }
        self.dirty = true;
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.stage.is_none() {
            let opened = self.open(event_loop);
            self.handle(event_loop, opened);
        }
    }

    fn suspended(&mut self, _: &ActiveEventLoop) {
        self.stage = None;
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let result = match event {
            WindowEvent::CloseRequested => {
                event_loop.exit();
                Ok(())
            }
            WindowEvent::Resized(size) => {
                self.hidden = size.width == 0 || size.height == 0;
                self.dirty = true;
                match &mut self.stage {
                    Some(stage) if !self.hidden => {
                        self.viewer.resized((size.width, size.height));
                        stage.resize(size)
                    }
                    _ => Ok(()),
                }
            }
            WindowEvent::Occluded(hidden) => {
                self.hidden = hidden;
                self.dirty = true;
                Ok(())
            }
            WindowEvent::KeyboardInput { event, .. } => self.key(event_loop, &event),
            WindowEvent::ModifiersChanged(modifiers) => {
                self.shift = modifiers.state().shift_key();
                Ok(())
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let drag = match button {
                    MouseButton::Left if self.shift => Drag::Pan,
                    MouseButton::Left => Drag::Orbit,
                    _ => Drag::Pan,
                };
                self.dragging = (state == ElementState::Pressed).then_some(drag);
                Ok(())
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.moved(position.x, position.y);
                Ok(())
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, y) => y,
                    MouseScrollDelta::PixelDelta(p) => p.y as f32 / 40.0,
                };
                self.viewer.orbit().zoom(ZOOM.powf(notches));
                self.dirty = true;
                Ok(())
            }
            WindowEvent::RedrawRequested => self.draw(),
            _ => Ok(()),
        };
        self.handle(event_loop, result);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.viewer.finished() {
            event_loop.exit();
            return;
        }
        let wanted = !self.hidden && (self.dirty || self.viewer.playing);
        // A picture that stands still costs nothing.
        event_loop.set_control_flow(if wanted { ControlFlow::Poll } else { ControlFlow::Wait });
        if let Some(window) = self.window.as_ref().filter(|_| wanted) {
            window.request_redraw();
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        // The device goes before the window that its surface belongs to.
        self.stage = None;
        self.window = None;
    }
}
