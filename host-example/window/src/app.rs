//! The window: its events, and when a frame is drawn.

mod access;
mod clicks;
mod desktop;
mod keys;
mod opening;
mod pace;

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui_winit::State;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoopProxy};
use winit::keyboard::ModifiersState;
use winit::window::{Window, WindowId};

use self::pace::Pace;
use crate::drawing::panel::Textures;
use crate::drawing::stage::{Drawn, Stage};
use crate::jobs::background::Background;
use crate::jobs::document::Document;
use crate::jobs::worker::Wake;
use crate::state::leaving::Leaving;
use crate::state::playback::Playback;
use crate::state::record::Hold;
use crate::state::session::Session;
use crate::state::work::Request;
use crate::widgets;
use isophote_example::kernels::Counts;
use isophote_files::error::{Error, Result};
use isophote_render::gpu::Gpu;

/// Time between two looks at whether what is to end with the window has ended.
const CLOSING: Duration = Duration::from_millis(20);
/// Way to mend a desktop that gives no window.
pub const FIX: &str =
    "start the viewer in a desktop session; without one `isophote apply` and `isophote render` make pictures";
/// Time between two updates of the title.
const TITLE: Duration = Duration::from_millis(250);

/// Events that arrive at the window besides its own.
#[derive(Debug)]
pub enum Event {
    /// Something was done beside the window.
    Done,
    /// The device has done what it was given.
    Landed,
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
    background: Background,
    pace: Pace,
    size: Option<(u32, u32)>,
    // Dropped in order: the device before the window.
    stage: Option<Stage>,
    /// Textures of the controls on the device.
    textures: Textures,
    input: Option<State>,
    window: Option<Arc<Window>>,
    proxy: EventLoopProxy<Event>,
    wake: Wake,
    landed: Wake,
    /// Ended the window, when something did.
    pub failure: Option<Error>,
    revivals: u32,
    devices: usize,
    /// Time at which a device is to be opened anew.
    revival: Option<Instant>,
    modifiers: ModifiersState,
    hidden: bool,
    /// Time at which the next frame is wanted, if nothing happens before.
    due: Option<Instant>,
    /// The title of the window, and since when it stands.
    titled: Option<(Instant, String)>,
    /// Events for the next frame.
    late: Vec<egui::Event>,
}

impl App {
    /// A window that opens once the event loop runs, with a size in pixels if it is to have a certain one.
    pub fn new(session: Session, size: Option<(u32, u32)>, proxy: EventLoopProxy<Event>) -> Result<Self> {
        let wake = waker(&proxy, || Event::Done);
        Ok(Self {
            background: Background::new(&session.library, &wake)?,
            pace: Pace::default(),
            session,
            size,
            stage: None,
            textures: Textures::default(),
            input: None,
            window: None,
            landed: waker(&proxy, || Event::Landed),
            proxy,
            wake,
            failure: None,
            revivals: 0,
            devices: 0,
            revival: None,
            modifiers: ModifiersState::empty(),
            hidden: false,
            due: Some(Instant::now()),
            titled: None,
            late: Vec::new(),
        })
    }

    /// The session that is shown, for whoever asked for a report.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The session that is shown, to be changed as the controls do. The window sees it with the next event.
    pub fn session_mut(&mut self) -> &mut Session {
        self.due = Some(Instant::now());
        &mut self.session
    }

    /// Reads frames of the document that the session shows from now on.
    pub fn read_frames(&mut self, document: Document) {
        self.background.read_frames(document);
    }

    /// The device, while there is one.
    pub fn gpu(&self) -> Option<&Gpu> {
        self.stage.as_ref().map(Stage::gpu)
    }

    /// Devices that have been opened so far: each but the first took the place of one that was lost.
    pub fn devices(&self) -> usize {
        self.devices
    }

    /// Numbers of things made and uploaded on the device for looks.
    pub fn counts(&self) -> Option<Counts> {
        self.stage.as_ref().map(Stage::counts)
    }

    /// True where nothing is left to be drawn, built, opened or uploaded.
    pub fn is_idle(&self) -> bool {
        let is_due = self.due.is_some_and(|due| due <= Instant::now());
        let is_at_work = self.stage.as_ref().is_none_or(|stage| stage.is_waiting() || stage.is_busy());
        !is_due && !is_at_work && self.background.busy().is_none()
    }

    fn draw(&mut self) -> Result<()> {
        let Some(stage) = &self.stage else { return Ok(()) };
        if stage.is_waiting() {
            // It is drawn as soon as the device is there for it.
            self.due = Some(Instant::now());
            return Ok(());
        }
        let started = Instant::now();
        self.due = None;
        collect(&mut self.background, &mut self.session);
        let delay = self.show_controls();
        let controls = started.elapsed();
        let (Some(window), Some(stage)) = (&self.window, &mut self.stage) else { return Ok(()) };
        let session = &mut self.session;
        hand_over(&mut self.background, session);
        session.advance();
        if let Some(frames) = self.background.frames(session) {
            session.take_over(frames);
        }
        self.pace.is_slow = stage.takes_its_time(session);
        let scale = self.pace.scale(session);
        let (problems, news) = (stage.follow(session, scale)?, stage.news());
        problems.iter().for_each(|(subject, problem)| session.notes.complain_of(*subject, problem));
        let is_told = !problems.is_empty() || !news.is_empty();
        news.into_iter().for_each(|sentence| session.notes.say(sentence));
        let was_busy = session.work.busy;
        session.work.busy = stage.doing(session).or(self.background.busy());
        session.work.share = stage.progress();
        let looks = started.elapsed() - controls;
        let always =
            session.record.limit.is_some() || session.open.scenery().is_some_and(|scenery| scenery.playing);
        let drawn = stage.draw(window, session, always)?;
        let is_sampling = stage.is_sampling();
        session.record.hold(Hold { controls, looks, drawing: started.elapsed() - controls - looks });
        let delay = delay.filter(|delay| *delay < Duration::from_secs(3600));
        self.due = delay.map(|delay| Instant::now() + delay);
        if drawn == Drawn::Skipped {
            self.update_title();
            self.want(Duration::from_millis(10));
        }
        if self.session.open.playback().is_some_and(Playback::is_waiting) {
            self.want(Duration::from_millis(20));
        }
        if is_told || is_sampling || !self.late.is_empty() || self.session.work.busy != was_busy {
            self.want(Duration::ZERO);
        }
        Ok(())
    }

    /// Lets the controls see the events up to the next click, and change the session; returns the time after which they are to be
    /// shown again, or nothing where there is no window for them.
    fn show_controls(&mut self) -> Option<Duration> {
        let (window, stage, input) = (self.window.as_ref()?, self.stage.as_mut()?, self.input.as_mut()?);
        let context = input.egui_ctx().clone();
        let mut raw = input.take_egui_input(window);
        self.late = clicks::one_at_a_time(&mut raw.events, std::mem::take(&mut self.late));
        let session = &mut self.session;
        let output = context.run_ui(raw, |ui| widgets::show(ui, session));
        input.handle_platform_output(window, output.platform_output);
        let shapes = context.tessellate(output.shapes, output.pixels_per_point);
        self.textures.follow(&output.textures_delta);
        stage.panel.set(shapes, output.textures_delta, output.pixels_per_point);
        if !context.egui_is_using_pointer() && !context.text_edit_focused() && !session.is_wheeled() {
            session.let_go();
        }
        let shown = output.viewport_output.get(&egui::ViewportId::ROOT);
        Some(shown.map_or(Duration::MAX, |shown| shown.repaint_delay))
    }

    /// Draws so much later at the latest.
    fn want(&mut self, delay: Duration) {
        let at = Instant::now() + delay;
        self.due = Some(self.due.map_or(at, |due| due.min(at)));
    }

    /// Takes over what the device has done.
    fn land(&mut self) -> Result<()> {
        let (Some(window), Some(stage)) = (&self.window, &mut self.stage) else { return Ok(()) };
        let started = Instant::now();
        let Some((drawn, took)) = stage.land(window)? else { return Ok(()) };
        self.session.record.hold(Hold { drawing: started.elapsed(), ..Hold::default() });
        let session = &mut self.session;
        if matches!(drawn, Drawn::Part | Drawn::Begun) && stage.go_on(session)? {
            return Ok(());
        }
        if drawn == Drawn::Part {
            self.want(Duration::ZERO);
            return Ok(());
        }
        stage.panel_time.take().into_iter().for_each(|time| session.record.count_panel(time));
        let is_probed = session.probed != stage.probed;
        session.probed = stage.probed;
        if let Some(frame) = stage.snapshot(session)? {
            session.show_scene_frame(frame);
            self.due = Some(Instant::now());
        }
        if let Some(histograms) = stage.count(session)? {
            session.histograms = Some(histograms);
            self.due = Some(Instant::now());
        }
        if drawn == Drawn::Picture {
            let look = session.look().source.display().to_string();
            let size = window.inner_size();
            session.record.count(&look, (size.width, size.height), took);
        }
        self.update_title();
        self.revivals = 0;
        if let Some(delay) = self.pace.next(drawn, took) {
            self.want(delay);
        }
        if is_probed || drawn == Drawn::Begun {
            self.want(Duration::ZERO);
        }
        Ok(())
    }

    /// Does the window's work that is not seen: opens what was dropped on it, and has its title say so.
    fn attend(&mut self) {
        collect(&mut self.background, &mut self.session);
        hand_over(&mut self.background, &mut self.session);
        self.update_title();
    }

    /// Follows the export that the window waits for before it closes; says whether it closes now.
    fn is_leaving(&mut self) -> bool {
        if self.session.dialogs.leaving == Leaving::Waits {
            collect(&mut self.background, &mut self.session);
            if self.session.dialogs.leaving != Leaving::Waits {
                self.due = Some(Instant::now());
            }
        }
        self.session.dialogs.leaving == Leaving::Closes && self.background.end_export()
    }

    /// Lets the title tell what is shown: at once, or with a later frame where it did so a moment ago.
    fn update_title(&mut self) {
        let (Some(window), title) = (&self.window, self.session.title()) else { return };
        let pause = self.titled.as_ref().map(|(at, _)| TITLE.saturating_sub(at.elapsed()));
        match pause {
            _ if self.titled.as_ref().is_some_and(|(_, told)| *told == title) => {}
            Some(pause) if !pause.is_zero() => self.want(pause),
            _ => {
                window.set_title(&title);
                self.titled = Some((Instant::now(), title));
            }
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

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        if matches!(event, Event::Landed) {
            let landed = self.land();
            return self.handle(event_loop, landed);
        }
        self.due = Some(Instant::now());
        if let Event::Access(event) = event {
            self.access(event.window_event);
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if Self::is_held_escape(&event) {
            return;
        }
        if matches!(event, WindowEvent::KeyboardInput { .. }) {
            self.catch_up();
        }
        if !self.is_taken(&event) {
            self.pass_on(&event);
        }
        let result = match event {
            WindowEvent::CloseRequested => {
                self.leave();
                Ok(())
            }
            WindowEvent::Resized(size) => {
                self.hidden = size.width == 0 || size.height == 0;
                self.due = Some(Instant::now());
                self.session.record.begin();
                if !self.hidden {
                    self.session.settings.window = Some((size.width, size.height));
                }
                Ok(())
            }
            WindowEvent::Occluded(hidden) => {
                self.hidden = hidden;
                self.due = Some(Instant::now());
                Ok(())
            }
            WindowEvent::KeyboardInput { event, is_synthetic, .. } => {
                let is_real = !is_synthetic || event.state == ElementState::Released;
                if is_real {
                    self.key(&event);
                }
                Ok(())
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.modifiers = modifiers.state();
                Ok(())
            }
            WindowEvent::Focused(false) => {
                self.session.viewport.peek = false;
                Ok(())
            }
            WindowEvent::DroppedFile(path) => {
                if self.session.takes_files() {
                    self.session.work.ask(Request::Open(path));
                }
                Ok(())
            }
            WindowEvent::RedrawRequested => self.draw(),
            _ => Ok(()),
        };
        self.handle(event_loop, result);
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        if self.session.record.is_finished() || self.is_leaving() {
            event_loop.exit();
            return;
        }
        if self.hidden && self.due.is_some_and(|due| due <= Instant::now()) {
            self.due = None;
            self.attend();
        }
        let revival = self.revive(event_loop);
        let always = self.session.open.is_playing() || self.session.record.limit.is_some();
        let soonest = self.stage.as_ref().map(|stage| stage.next_window(&self.session));
        let due = if always { self.due.into_iter().chain(soonest).min() } else { self.due };
        // The device tells when it is there for the next frame.
        let is_ready = self.stage.as_ref().is_some_and(|stage| !stage.is_waiting());
        let due = due.filter(|_| is_ready && !self.hidden);
        if due.is_some_and(|due| due <= Instant::now()) {
            event_loop.set_control_flow(ControlFlow::Poll);
            if let Some(window) = &self.window {
                window.request_redraw();
            }
            return;
        }
        let waits = matches!(self.session.dialogs.leaving, Leaving::Waits | Leaving::Closes);
        let closing = waits.then(|| Instant::now() + CLOSING);
        // A picture that stands still costs nothing.
        let unseen = self.due.filter(|_| self.hidden);
        let next = [due, unseen, revival, closing].into_iter().flatten().min();
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
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

/// Takes over what was done beside the window since the last call.
fn collect(background: &mut Background, session: &mut Session) {
    for outcome in background.collect() {
        session.take_over(outcome);
    }
    session.follow_picture();
    background.follow(session);
}

/// Has done beside the window what the controls have asked for.
fn hand_over(background: &mut Background, session: &mut Session) {
    let (requests, previews) = (session.take_requests(), session.previews.tasks());
    for outcome in background.carry_out(session, requests, previews) {
        session.take_over(outcome);
    }
}

/// Sends an event to the window.
fn waker(proxy: &EventLoopProxy<Event>, event: fn() -> Event) -> Wake {
    let proxy = proxy.clone();
    Arc::new(move || {
        // Nobody is to be woken once the window is closed.
        let _ = proxy.send_event(event());
    })
}
