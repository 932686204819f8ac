//! The window: its events, and when a frame is drawn.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_winit::State;
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, KeyEvent, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::keyboard::{Key, ModifiersState, NamedKey};
use winit::window::{Window, WindowId};

use super::desk::Desk;
use super::pace::Pace;
use super::reel::Reel;
use super::session::{Session, Wish};
use super::stage::{Drawn, Stage};
use super::ui;
use super::worker::Wake;
use crate::error::{Error, Result};

/// How often a lost device is opened anew before the window gives up.
const REVIVALS: u32 = 3;
/// Time between two updates of the title.
const TITLE: Duration = Duration::from_millis(250);
/// Size of the window in pixels where nobody says anything else.
const SIZE: (u32, u32) = (1440, 900);

/// What arrives at the window besides its own events.
#[derive(Debug)]
pub enum Event {
    /// Something was done beside the window.
    Done,
    /// A program for people with impairments asks for something.
    Access(egui_winit::accesskit_winit::Event),
}

impl From<egui_winit::accesskit_winit::Event> for Event {
    fn from(event: egui_winit::accesskit_winit::Event) -> Self {
        Self::Access(event)
    }
}

/// The window and what it shows.
pub struct App {
    session: Session,
    desk: Desk,
    pace: Pace,
    size: Option<(u32, u32)>,
    // Dropped in order: the device before the window.
    stage: Option<Stage>,
    input: Option<State>,
    window: Option<Arc<Window>>,
    proxy: EventLoopProxy<Event>,
    wake: Wake,
    /// Ended the window, when something did.
    pub failure: Option<Error>,
    revivals: u32,
    modifiers: ModifiersState,
    hidden: bool,
    /// When the next frame is wanted, if nothing happens before.
    due: Option<Instant>,
    titled: Option<Instant>,
    /// Events for the next frame.
    late: Vec<egui::Event>,
}

impl App {
    /// A window that opens once the event loop runs, with a size in pixels if it is to have a certain one.
    pub fn new(session: Session, size: Option<(u32, u32)>, proxy: EventLoopProxy<Event>) -> Result<Self> {
        let waker = proxy.clone();
        let wake: Wake = Arc::new(move || {
            // Nobody is to be woken once the window is closed.
            let _ = waker.send_event(Event::Done);
        });
        Ok(Self {
            desk: Desk::new(&wake)?,
            pace: Pace::default(),
            session,
            size,
            stage: None,
            input: None,
            window: None,
            proxy,
            wake,
            failure: None,
            revivals: 0,
            modifiers: ModifiersState::empty(),
            hidden: false,
            due: Some(Instant::now()),
            titled: None,
            late: Vec::new(),
        })
    }

    /// What was shown, for whoever asked for a report.
    pub fn session(&self) -> &Session {
        &self.session
    }

    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        let window = match &self.window {
            Some(window) => Arc::clone(window),
            None => {
                let (width, height) = self.size.or(self.session.settings.window).unwrap_or(SIZE);
                let attributes = Window::default_attributes()
                    .with_title(self.session.title())
                    // What reads the window aloud must be there before it is seen.
                    .with_visible(false)
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
        let stage = Stage::new(&window, event_loop.owned_display_handle(), &self.wake)?;
        if self.input.is_none() {
            let context = egui::Context::default();
            ui::theme::apply(&context);
            // Where frames are slow, a click takes as long as two of them.
            context.options_mut(|options| {
                options.input_options.max_click_duration = f64::INFINITY;
                options.input_options.max_double_click_delay = 0.6;
            });
            let scale = Some(window.scale_factor() as f32);
            let side = Some(stage.most_texels());
            let mut input = State::new(context, egui::ViewportId::ROOT, event_loop, scale, None, side);
            input.init_accesskit(event_loop, &window, self.proxy.clone());
            self.input = Some(input);
        } else if let Some(input) = &self.input {
            // The letters lived on the device that is gone.
            input.egui_ctx().set_fonts(egui::FontDefinitions::default());
            self.session.previews.forget_textures();
        }
        window.set_visible(true);
        self.session.record.adapter = stage.adapter();
        self.pace.is_software = stage.is_software();
        self.stage = Some(stage);
        self.due = Some(Instant::now());
        Ok(())
    }

    /// Ends the window on an error, unless a new device may help.
    fn handle(&mut self, event_loop: &ActiveEventLoop, result: Result<()>) {
        let Err(error) = result else { return };
        let lost = self.stage.as_ref().is_some_and(Stage::is_lost);
        self.stage = None;
        if lost && self.revivals < REVIVALS {
            self.revivals += 1;
            self.session.notes.complain(&error);
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
        let (Some(window), Some(stage), Some(input)) = (&self.window, &mut self.stage, &mut self.input)
        else {
            return Ok(());
        };
        self.due = None;
        let session = &mut self.session;
        self.desk.collect(session);
        let context = input.egui_ctx().clone();
        let mut raw = input.take_egui_input(window);
        self.late = one_click(&mut raw.events, std::mem::take(&mut self.late));
        let output = context.run_ui(raw, |ui| ui::show(ui, session));
        input.handle_platform_output(window, output.platform_output);
        let delay =
            output.viewport_output.get(&egui::ViewportId::ROOT).map(|viewport| viewport.repaint_delay);
        let shapes = context.tessellate(output.shapes, output.pixels_per_point);
        stage.panel.set(shapes, output.textures_delta, output.pixels_per_point);
        if !context.egui_is_using_pointer() && !context.text_edit_focused() {
            session.let_go();
        }
        let copied = self.desk.grant(session);
        copied.into_iter().for_each(|text| input.set_clipboard_text(text));
        session.frame_first();
        if let Some(scenery) = &mut session.scenery {
            scenery.advance();
        }
        if let Some(Err(error)) = session.reel.as_mut().map(Reel::advance) {
            session.notes.complain(&error);
        }
        let scale = self.pace.scale(session);
        let problems = stage.follow(session, scale)?;
        problems.iter().for_each(|problem| session.notes.complain(problem));
        let was_busy = session.busy;
        session.busy = stage.is_busy().then_some("Preparing the look").or(self.desk.busy());
        let started = Instant::now();
        let always =
            session.record.limit.is_some() || session.scenery.as_ref().is_some_and(|scenery| scenery.playing);
        let drawn = stage.draw(window, session, always)?;
        let is_probed = session.probed != stage.probed;
        session.probed = stage.probed;
        let again = self.pace.next(drawn, started.elapsed());
        let delay = delay.filter(|delay| *delay < Duration::from_secs(3600));
        let delay = delay.into_iter().chain(again).min();
        self.due = delay.map(|delay| Instant::now() + delay);
        match drawn {
            Drawn::Skipped => self.due = Some(Instant::now() + Duration::from_millis(10)),
            Drawn::Picture => {
                let look = session.look().source.display().to_string();
                let size = window.inner_size();
                session.record.count(&look, (size.width, size.height), started.elapsed());
            }
            Drawn::Begun => self.due = Some(Instant::now()),
            Drawn::Controls => {}
        }
        if let Some(frame) = stage.snapshot(session)? {
            session.show_scene_frame(frame);
            self.due = Some(Instant::now());
        }
        if session.reel.as_ref().is_some_and(Reel::is_waiting) {
            let soon = Instant::now() + Duration::from_millis(20);
            self.due = Some(self.due.map_or(soon, |due| due.min(soon)));
        }
        if !problems.is_empty() || is_probed || !self.late.is_empty() || session.busy != was_busy {
            self.due = Some(Instant::now());
        }
        if drawn != Drawn::Skipped {
            self.revivals = 0;
        }
        if self.titled.is_none_or(|at| at.elapsed() > TITLE) {
            self.titled = Some(Instant::now());
            window.set_title(&session.title());
        }
        Ok(())
    }

    /// What a key does, unless something is being typed.
    fn key(&mut self, event: &KeyEvent) {
        let session = &mut self.session;
        let pressed = event.state == ElementState::Pressed;
        if event.logical_key.as_ref() == Key::Character("\\") {
            session.easel.peek = pressed;
            return;
        }
        if !pressed {
            return;
        }
        if self.modifiers.control_key() || self.modifiers.super_key() {
            match event.logical_key.as_ref() {
                Key::Character("z") if !self.modifiers.shift_key() => session.undo(),
                Key::Character("z" | "Z" | "y") => session.redo(),
                Key::Character("e") => session.plan_export(),
                Key::Character("o") => session.wishes.push(Wish::ChooseFile),
                Key::Character("s") => session.save_look(self.modifiers.shift_key()),
                Key::Character("S") => session.save_look(true),
                Key::Character("q") => session.wishes.push(Wish::Quit),
                _ => {}
            }
            return;
        }
        ui::keys::press(session, &event.logical_key);
    }

    /// Whether something is being typed or a menu is open, which keys belong to then.
    fn is_typing(&self) -> bool {
        let context = self.input.as_ref().map(State::egui_ctx);
        context.is_some_and(|context| context.text_edit_focused() || egui::Popup::is_any_open(context))
    }

    /// Lets the controls see an event first.
    fn pass_on(&mut self, event: &WindowEvent) {
        let (Some(window), Some(input)) = (&self.window, &mut self.input) else { return };
        let tab = matches!(event, WindowEvent::KeyboardInput { event, .. }
            if event.logical_key == Key::Named(NamedKey::Tab));
        // Tab goes from style to style, unless something is being typed or chosen.
        if tab && !input.egui_ctx().text_edit_focused() && !self.session.is_covered() {
            return;
        }
        if input.on_window_event(window, event).repaint && !matches!(event, WindowEvent::RedrawRequested) {
            self.due = Some(Instant::now());
        }
    }
}

impl ApplicationHandler<Event> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.stage.is_none() {
            let opened = self.open(event_loop);
            self.handle(event_loop, opened);
        }
    }

    fn suspended(&mut self, _: &ActiveEventLoop) {
        self.stage = None;
    }

    fn user_event(&mut self, _: &ActiveEventLoop, event: Event) {
        self.due = Some(Instant::now());
        if let (Event::Access(event), Some(input)) = (event, &mut self.input)
            && let egui_winit::accesskit_winit::WindowEvent::ActionRequested(request) = event.window_event
        {
            input.on_accesskit_action_request(request);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let typing = self.is_typing();
        self.pass_on(&event);
        let result = match event {
            WindowEvent::CloseRequested => {
                event_loop.exit();
                Ok(())
            }
            WindowEvent::Resized(size) => {
                self.hidden = size.width == 0 || size.height == 0;
                self.due = Some(Instant::now());
                self.session.record.begin();
                match &mut self.stage {
                    Some(stage) if !self.hidden => {
                        self.session.settings.window = Some((size.width, size.height));
                        stage.resize(size)
                    }
                    _ => Ok(()),
                }
            }
            WindowEvent::Occluded(hidden) => {
                self.hidden = hidden;
                self.due = Some(Instant::now());
                Ok(())
            }
            WindowEvent::KeyboardInput { event, is_synthetic, .. } => {
                let is_real = !is_synthetic || event.state == ElementState::Released;
                if is_real && !typing {
                    self.key(&event);
                    self.due = Some(Instant::now());
                }
                Ok(())
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.modifiers = modifiers.state();
                Ok(())
            }
            WindowEvent::Focused(false) => {
                self.session.easel.peek = false;
                Ok(())
            }
            WindowEvent::DroppedFile(path) => {
                self.session.wishes.push(Wish::Open(path));
                Ok(())
            }
            WindowEvent::RedrawRequested => self.draw(),
            _ => Ok(()),
        };
        self.handle(event_loop, result);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.session.record.is_finished() || self.desk.is_over() {
            event_loop.exit();
            return;
        }
        let always = self.session.is_playing() || self.session.record.limit.is_some();
        let due = if always { Some(Instant::now()) } else { self.due };
        let Some(due) = due.filter(|_| !self.hidden) else {
            // A picture that stands still costs nothing.
            event_loop.set_control_flow(ControlFlow::Wait);
            return;
        };
        if due > Instant::now() {
            event_loop.set_control_flow(ControlFlow::WaitUntil(due));
            return;
        }
        event_loop.set_control_flow(ControlFlow::Poll);
        if let Some(window) = &self.window {
            window.request_redraw();
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.session.settings.look = Some(self.session.look().source.clone());
        if let Err(error) = self.session.settings.write() {
            self.session.notes.complain(&error);
        }
        // The device goes before the window that its surface belongs to.
        self.stage = None;
        self.input = None;
        self.window = None;
    }
}

/// Leaves at most one press or release of a button among the events, those of before first, and returns the rest: controls
/// do not see a click that begins and ends within one frame, as clicks do where frames are slow.
fn one_click(events: &mut Vec<egui::Event>, before: Vec<egui::Event>) -> Vec<egui::Event> {
    events.splice(..0, before);
    let is_button = |event: &egui::Event| matches!(event, egui::Event::PointerButton { .. });
    let second = events.iter().enumerate().filter(|(_, event)| is_button(event)).nth(1);
    second.map(|(at, _)| at).map_or_else(Vec::new, |at| events.split_off(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fast_click_lasts_two_frames() {
        let button = |pressed| egui::Event::PointerButton {
            pos: egui::pos2(1.0, 2.0),
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        let moved = egui::Event::PointerMoved(egui::pos2(1.0, 2.0));
        let mut events = vec![moved.clone(), button(true), button(false), moved.clone()];
        let late = one_click(&mut events, Vec::new());
        assert_eq!(events, [moved.clone(), button(true)]);
        let mut next = vec![moved.clone()];
        assert!(one_click(&mut next, late).is_empty());
        assert_eq!(next, [button(false), moved.clone(), moved]);
    }
}
