//! Everything of the window that lives on the graphics device: surface, picture, looks, canvas and panel.
//!
//! When the device is lost, the stage is thrown away and made anew; what is shown and how is kept outside.

mod counted;
mod on_cpu;
mod painting;

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::canvas::Canvas;
use super::counter::Counter;
use super::live_look::{LiveLook, Part};
use super::made::{FrameState, Made};
use super::panel::Panel;
use super::probe::Probe;
use super::processed::Processed;
use super::scene_frames::{Needs, SceneFrames};
use super::screen::{self, Screen};
use super::snapshot::Snapshots;
use super::source::LookInput;
use super::sources::Sources;
use crate::jobs::worker::{Wake, Worker};
use crate::state::document::frame::Frame;
use crate::state::look::EditedLook;
use crate::state::notes::Subject;
use crate::state::probed::Probed;
use crate::state::session::{Session, Which};
use isophote_example::kernels::Kernels;
use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::precision::Precision;
use isophote_render::gpu::Gpu;
use isophote_render::timestamps::Timestamps;

/// All of one device. Fields are dropped in order: what uses the device before it.
pub struct Stage {
    /// The look, what it is compared with, and what is shown instead.
    looks: [LiveLook; 3],
    /// The same on the CPU.
    processed: Processed,
    /// True where all looks are computed there, as the device's driver would do itself.
    computes_on_cpu: bool,
    /// True where looks have rules for things of what is open, which are followed there.
    is_ruled: bool,
    /// Frames of a scene for looks on the CPU.
    frames: SceneFrames,
    /// Needs of looks on a scene there.
    needs: Needs,
    /// State of the scene that was rendered last for them.
    rendered: Option<FrameState>,
    /// True while something moves.
    moves: bool,
    sources: Sources,
    /// Waits for the device.
    waiter: Worker<Instant, Result<Duration>>,
    /// Work that the device is doing.
    pending: Option<Pending>,
    canvas: Canvas,
    probe: Probe,
    snapshots: Snapshots<FrameState>,
    counter: Counter,
    /// The pixel under the pointer, as of the last frame.
    pub probed: Option<Probed>,
    /// Draws the controls.
    pub panel: Panel,
    /// Measures the controls, where a report is wanted and the device can.
    clock: Option<Timestamps>,
    /// Time that they took in the last frame.
    pub panel_time: Option<Duration>,
    screen: Screen,
    gpu: Gpu,
    kernels: Arc<Kernels>,
    made: Option<Made>,
    /// Progress of the picture.
    progress: Progress,
    /// Passes of a picture that are recorded at once, where the processor draws.
    passes: usize,
    /// Time that drawing the window took last, where the picture is drawn in parts.
    cost: Duration,
    /// Time at which the window was drawn last.
    drawn: Instant,
}

/// Progress of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// There is none to be made.
    Done,
    /// None of its passes is recorded.
    Wanted,
    /// Some of its passes have been recorded, which took so long.
    Begun(Duration),
    /// All have been, and it waits for being shown.
    Whole(Duration),
}

/// Work that the device was given.
enum Pending {
    /// A part of a picture.
    Part,
    /// The window, which is presented when it is drawn: software drivers would wait for it. After that the surface must
    /// perhaps be configured anew.
    Window(Drawn, wgpu::SurfaceTexture, bool),
}

/// Work that was given to the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// It is on its way to the screen; the picture in it is a new one.
    Picture,
    /// So it is; the picture in it is the one of before, and another one is begun.
    Begun,
    /// So it is, with the picture of before.
    Controls,
    /// A part of a picture is being made, and nothing else.
    Part,
    /// There was no surface to draw on; try again later.
    Skipped,
}

/// Time that recording a part of a picture may take.
const GOAL: [Duration; 2] = [Duration::from_millis(15), Duration::from_millis(40)];

impl Stage {
    /// Opens a device for `window`; `wake` tells of looks and pictures that are ready, `landed` that the device is.
    ///
    /// # Errors
    /// [`Error::Failure`] when there is no adapter for the window or the device refuses.
    pub fn new(
        window: &Arc<Window>,
        display: OwnedDisplayHandle,
        session: &Session,
        wake: &Wake,
        landed: &Wake,
    ) -> Result<Self> {
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display));
        let instance = wgpu::Instance::new(descriptor);
        let surface = screen::surface(&instance, window)?;
        let gpu = Gpu::with_instance(instance, Some(&surface))?;
        let screen = Screen::new(&gpu, surface, window)?;
        let canvas = Canvas::new(&gpu.device, screen.format());
        let probe = Probe::new(&gpu.device);
        let panel = Panel::new(&gpu.device, screen.format());
        let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
        let live = || LiveLook::new(&kernels, Arc::clone(wake));
        let looks = [live()?, live()?, live()?];
        let own = gpu.clone();
        let waiter = Worker::new("device", Arc::clone(landed), move |since: Instant| {
            own.wait().map(|()| since.elapsed())
        })?;
        // Who asks for a precision of graphics devices asks for the device.
        let is_exact_software = gpu.is_software() && session.precision == Precision::Exact;
        let processed = Processed::new(&gpu, &session.library, wake)?;
        gpu.check()?;
        Ok(Self {
            looks,
            processed,
            computes_on_cpu: session.backend.is_cpu(is_exact_software),
            is_ruled: false,
            frames: SceneFrames::new(wake)?,
            needs: Needs::default(),
            rendered: None,
            moves: false,
            sources: Sources::new(&gpu, wake)?,
            waiter,
            pending: None,
            canvas,
            probe,
            snapshots: Snapshots::new(wake)?,
            counter: Counter::new(&gpu, wake)?,
            probed: None,
            panel,
            clock: None,
            panel_time: None,
            screen,
            gpu,
            kernels,
            made: None,
            progress: Progress::Done,
            passes: 4,
            cost: Duration::ZERO,
            drawn: Instant::now(),
        })
    }

    /// Measures what the controls take from now on, if the device can.
    pub fn measure(&mut self) {
        self.clock = Timestamps::new(&self.gpu, 1);
    }

    /// True where pictures are computed by the processor, which takes its time.
    pub fn is_software(&self) -> bool {
        self.gpu.is_software()
    }

    /// Takes over what is open, its size and the looks, as far as that can be done at once; the rest goes on beside the
    /// window. Returns what went wrong with the picture and the looks.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device fails.
    pub fn follow(&mut self, session: &Session, scale: f32) -> Result<Vec<(Subject, Error)>> {
        let mut problems = Vec::new();
        self.moves = scale < 1.0 || session.open.is_playing();
        self.follow_needs(session)?;
        let on_cpu = self.is_on_cpu(session);
        let is_whole = on_cpu && session.open.playback().is_some();
        match self.sources.follow(session, if is_whole { 1.0 } else { scale }) {
            Ok(false) => {}
            Ok(true) => self.looks.iter_mut().for_each(LiveLook::unbind),
            Err(problem) => problems.push((Subject::Other, problem)),
        }
        if self.needs.light
            && let Some(LookInput::Scene(source)) = self.sources.present_mut()
            && source.add_light()
        {
            self.looks.iter_mut().for_each(LiveLook::unbind);
        }
        if on_cpu {
            problems.extend(self.follow_on_cpu(session)?);
            self.gpu.check()?;
            return Ok(problems);
        }
        problems.extend(self.rest_on_cpu());
        // What is covered is built when it is seen, where that takes the processor's time.
        if session.is_covered() && self.is_software() {
            return Ok(problems);
        }
        let is_awaited = self.sources.is_whole_awaited();
        let Some(source) = self.sources.present_mut().filter(|_| !is_awaited) else {
            self.gpu.check()?;
            return Ok(problems);
        };
        let overlay = overlay(session)?;
        let seen = session.looks.seen();
        let compared = session.looks.compared.clone().unwrap_or_else(EditedLook::plain);
        let request = source.request();
        for (live, look) in self.looks.iter_mut().zip([&*seen, &compared, &overlay]) {
            let built = live.follow(&session.library, look, session.precision, request);
            problems.extend(built.err().map(|problem| (Subject::Look, problem)));
            if let LookInput::Scene(source) = source
                && live.wants_rest_positions()?
                && source.add_rest_positions()
            {
                live.unbind();
            }
        }
        self.gpu.check()?;
        Ok(problems)
    }

    /// The frame of a scene that was copied since the last call, for previews. Copies the present one where it stands still and
    /// is covered by them.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn snapshot(&mut self, session: &Session) -> Result<Option<Frame>> {
        let taken = self.snapshots.answer();
        // Panes that are all but ready are more to look at than none while a scene is turned.
        let waits = session.browser.comparison.is_some() && session.previews.is_busy() && !self.is_software();
        let is_wanted =
            session.is_covered() && !session.open.is_playing() && self.progress == Progress::Done && !waits;
        let made = self.made.as_ref().filter(|made| is_wanted && made.request.scale == 1.0);
        let state = made.map(|made| (made.request, made.source, made.scene));
        if let (Some(LookInput::Scene(source)), Some(scenery), Some(state)) =
            (self.sources.present_mut(), session.open.scenery(), state)
            && !self.snapshots.shows(&state)
        {
            if source.add_rest_positions() {
                self.looks.iter_mut().for_each(LiveLook::unbind);
                let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
                source.encode(&mut encoder, scenery);
                self.gpu.queue.submit([encoder.finish()]);
            }
            self.snapshots.take(&self.gpu, source, (state, &Default::default()), false);
        }
        Ok(taken.transpose()?.map(|taken| taken.frame))
    }

    /// True while a look is being built, or a picture or scene uploaded.
    pub fn is_busy(&self) -> bool {
        self.sources.is_busy() || self.looks.iter().any(LiveLook::is_busy) || self.is_busy_on_cpu()
    }

    /// True while the device is doing what it was given. Nothing else is given to it meanwhile: a viewer that runs
    /// ahead of its device answers the mouse late.
    pub fn is_waiting(&self) -> bool {
        self.pending.is_some()
    }

    /// Gives the device its next work: the window, with the picture if it is to be another than before. Where the processor
    /// draws, a picture is made in parts, and the window between them. `always`: the picture even if it is the same, and at
    /// once. [`Stage::land`] tells when it is done.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device is lost or reports an error.
    pub fn draw(&mut self, window: &Arc<Window>, session: &Session, always: bool) -> Result<Drawn> {
        self.screen.resize(&self.gpu, window)?;
        match self.to_make(session) {
            made if self.is_on_cpu(session) => self.follow_results(session, made)?,
            None => (self.made, self.progress) = (None, Progress::Done),
            made if !always && (made == self.made || self.finishes(made.as_ref())) => {}
            made => (self.made, self.progress) = (made, Progress::Wanted),
        }
        let in_parts = self.is_software() && !always && !self.is_on_cpu(session);
        if in_parts && self.go_on(session)? {
            return Ok(Drawn::Part);
        }
        self.draw_window(window, session, in_parts)
    }

    /// True where the picture that is begun is to become whole although another one is wanted: while a slider moves,
    /// none would.
    fn finishes(&self, wanted: Option<&Made>) -> bool {
        matches!(self.progress, Progress::Begun(_))
            && self.made.as_ref().zip(wanted).is_some_and(|(begun, wanted)| {
                let Made { shown, overlay, request, source, .. } = begun;
                request.scale < 1.0
                    && (shown, overlay, request, source)
                        == (&wanted.shown, &wanted.overlay, &wanted.request, &wanted.source)
            })
    }

    /// Gives the device the next part of a picture, unless it is time for the window; says whether it did.
    ///
    /// # Errors
    /// As [`Stage::draw`].
    pub fn go_on(&mut self, session: &Session) -> Result<bool> {
        let (begins, spent) = match self.progress {
            Progress::Wanted => (true, Duration::ZERO),
            Progress::Begun(spent) => (false, spent),
            Progress::Done | Progress::Whole(_) => return Ok(false),
        };
        // What is spent on the window is spent on the picture, too.
        if self.drawn.elapsed() > self.cost.max(GOAL[1]) {
            return Ok(false);
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let is_whole = self.encode_picture(&mut encoder, session, begins, self.passes)?;
        self.progress = if is_whole { Progress::Whole(spent) } else { Progress::Begun(spent) };
        self.gpu.queue.submit([encoder.finish()]);
        self.wait_for(Pending::Part);
        Ok(true)
    }

    fn draw_window(&mut self, window: &Arc<Window>, session: &Session, in_parts: bool) -> Result<Drawn> {
        self.panel.upload(&self.gpu.device, &self.gpu.queue);
        let Some((frame, renew)) = self.screen.next_frame(&self.gpu, window)? else {
            return Ok(Drawn::Skipped);
        };
        let target = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let drawn = match self.progress {
            Progress::Wanted | Progress::Begun(_) if !in_parts => {
                self.encode_picture(&mut encoder, session, true, usize::MAX)?;
                self.progress = Progress::Whole(Duration::ZERO);
                Drawn::Picture
            }
            Progress::Wanted | Progress::Begun(_) => Drawn::Begun,
            Progress::Whole(_) => Drawn::Picture,
            Progress::Done => Drawn::Controls,
        };
        self.arrange(session);
        self.encode_probe(&mut encoder, session);
        self.paint(&mut encoder, &target, session);
        self.gpu.queue.submit([encoder.finish()]);
        self.probe.ask();
        self.clock.iter().for_each(Timestamps::ask);
        self.panel.free();
        self.wait_for(Pending::Window(drawn, frame, renew));
        Ok(drawn)
    }

    fn wait_for(&mut self, pending: Pending) {
        self.pending = Some(pending);
        self.waiter.ask(Instant::now());
    }

    /// Work that the device has done since the last call, and how long that took: of a picture all of its parts.
    /// Nothing as long as it is at work.
    ///
    /// # Errors
    /// As [`Stage::draw`].
    pub fn land(&mut self, window: &Window) -> Result<Option<(Drawn, Duration)>> {
        let Some(took) = self.waiter.answer() else { return Ok(None) };
        let Some(pending) = self.pending.take() else { return Ok(None) };
        let took = took?;
        let (drawn, frame, renew) = match pending {
            Pending::Part => {
                self.passes = match took {
                    took if took < GOAL[0] => self.passes.saturating_mul(2).min(64),
                    took if took > GOAL[1] => (self.passes / 2).max(1),
                    _ => self.passes,
                };
                if let Progress::Begun(spent) | Progress::Whole(spent) = &mut self.progress {
                    *spent += took;
                }
                return Ok(Some((Drawn::Part, took)));
            }
            Pending::Window(drawn, frame, renew) => (drawn, frame, renew),
        };
        window.pre_present_notify();
        self.gpu.queue.present(frame);
        self.probed = self.probe.read();
        let times = self.clock.as_ref().and_then(|clock| clock.read().ok()).unwrap_or_default();
        self.panel_time = times.first().map(|seconds| Duration::from_secs_f64(*seconds));
        (self.cost, self.drawn) = (took, Instant::now());
        if renew {
            self.screen.configure(&self.gpu);
        }
        let spent = match self.progress {
            Progress::Whole(spent) => {
                self.progress = Progress::Done;
                spent
            }
            _ => Duration::ZERO,
        };
        Ok(Some((drawn, if spent.is_zero() { took } else { spent })))
    }

    /// Origins of the picture as it would be made now.
    fn to_make(&self, session: &Session) -> Option<Made> {
        let is_on_cpu = self.is_on_cpu(session);
        let source = self.sources.present().filter(|_| is_on_cpu || !self.sources.is_whole_awaited())?;
        let scene = session.open.scenery();
        Some(Made {
            shown: session.shown(),
            overlay: session.viewport.overlay,
            request: source.request(),
            is_on_cpu,
            revisions: self.revisions(session),
            source: self.sources.number(),
            scene: scene.map(|scenery| (scenery.view(), *scenery.light(), scenery.time().0)),
        })
    }

    /// Records the picture and the looks that are shown, or a part of it, and says whether all is recorded.
    fn encode_picture(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        session: &Session,
        begins: bool,
        passes: usize,
    ) -> Result<bool> {
        let origin = self.sources.origin().cloned();
        let (Some(source), Some(origin)) = (self.sources.present_mut(), &origin) else { return Ok(true) };
        if let (LookInput::Scene(source), Some(scenery), true) =
            (&mut *source, session.open.scenery(), begins)
        {
            source.encode(encoder, scenery);
        }
        let request = source.request();
        let shown = session.shown();
        let part = Part { begins, passes, number: source.number(), origin };
        let mut is_whole = true;
        for (live, which) in self.looks.iter_mut().zip([Which::Look, Which::Compared, Which::Overlay]) {
            if shown.contains(&which) {
                is_whole &= live.encode(encoder, request, part, |stylizer| source.bind(stylizer))?;
            }
        }
        Ok(is_whole)
    }
}

/// The look that is shown instead, if it is not a picture that is there anyway.
fn overlay(session: &Session) -> Result<EditedLook> {
    let node = session.viewport.overlay.node();
    let opened = node.map(|node| EditedLook::open(&session.library, node.as_ref()));
    Ok(opened.transpose()?.unwrap_or_else(EditedLook::plain))
}
