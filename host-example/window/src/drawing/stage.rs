//! Everything of the window that lives on the graphics device: surface, picture, looks, canvas and panel.
//!
//! When the device is lost, the stage is thrown away and made anew; what is shown and how is kept outside.

mod counted;

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::canvas::{Arrangement, Canvas, Reading, SURROUND, Shown};
use super::counter::Counter;
use super::live_look::{LiveLook, Part};
use super::made::{FrameState, Made};
use super::panel::Panel;
use super::probe::Probe;
use super::screen::{self, Screen};
use super::shown::picture;
use super::snapshot::Snapshots;
use super::source::LookInput;
use super::sources::Sources;
use crate::jobs::worker::{Wake, Worker};
use crate::state::document::frame::Frame;
use crate::state::look::EditedLook;
use crate::state::notes::Subject;
use crate::state::session::{Session, Which};
use isophote_example::kernels::Kernels;
use isophote_files::error::{Error, Result};
use isophote_render::gpu::Gpu;
use isophote_render::layouts;
use isophote_render::timestamps::Timestamps;

/// All of one device. Fields are dropped in order: what uses the device before it.
pub struct Stage {
    /// The look, what it is compared with, and what is shown instead.
    looks: [LiveLook; 3],
    sources: Sources,
    /// Waits for the device.
    waiter: Worker<Instant, Result<Duration>>,
    /// Work that the device is doing.
    pending: Option<Pending>,
    canvas: Canvas,
    probe: Probe,
    snapshots: Snapshots<FrameState>,
    counter: Counter,
    /// Colours under the pointer, before and after, as of the last frame.
    pub probed: Option<[[f32; 4]; 2]>,
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
        gpu.check()?;
        Ok(Self {
            looks,
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
        self.gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Takes over what is open, its size and the looks, as far as that can be done at once; the rest goes on beside the
    /// window. Returns what went wrong with the picture and the looks.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device fails.
    pub fn follow(&mut self, session: &Session, scale: f32) -> Result<Vec<(Subject, Error)>> {
        let mut problems = Vec::new();
        match self.sources.follow(session, scale) {
            Ok(false) => {}
            Ok(true) => self.looks.iter_mut().for_each(LiveLook::unbind),
            Err(problem) => problems.push((Subject::Other, problem)),
        }
        // What is covered is built when it is seen, where that takes the processor's time.
        if session.is_covered() && self.is_software() {
            return Ok(problems);
        }
        let Some(source) = self.sources.present_mut() else {
            self.gpu.check()?;
            return Ok(problems);
        };
        let overlay =
            session.viewport.overlay.node().map(|node| EditedLook::open(&session.library, node.as_ref()));
        let overlay = overlay.transpose()?.unwrap_or_else(EditedLook::plain);
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
            self.snapshots.take(&self.gpu, source, state);
        }
        taken.transpose()
    }

    /// True while a look is being built, or a picture or scene uploaded.
    pub fn is_busy(&self) -> bool {
        self.sources.is_busy() || self.looks.iter().any(LiveLook::is_busy)
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
            None => (self.made, self.progress) = (None, Progress::Done),
            made if !always && (made == self.made || self.finishes(made.as_ref())) => {}
            made => (self.made, self.progress) = (made, Progress::Wanted),
        }
        if self.is_software() && !always && self.go_on(session)? {
            return Ok(Drawn::Part);
        }
        self.draw_window(window, session, always)
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

    fn draw_window(&mut self, window: &Arc<Window>, session: &Session, always: bool) -> Result<Drawn> {
        self.panel.upload(&self.gpu.device, &self.gpu.queue);
        let Some((frame, renew)) = self.screen.next_frame(&self.gpu, window)? else {
            return Ok(Drawn::Skipped);
        };
        let target = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let drawn = match self.progress {
            Progress::Wanted | Progress::Begun(_) if always || !self.is_software() => {
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

    /// Draws canvas and controls; in a pass of their own where that is measured.
    fn paint(&mut self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, session: &Session) {
        let size = self.screen.size();
        self.panel.prepare(&self.gpu.device, &self.gpu.queue, encoder, size);
        let grey = wgpu::Color { r: SURROUND.into(), g: SURROUND.into(), b: SURROUND.into(), a: 1.0 };
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
            color_attachments: &[Some(layouts::cleared(target, grey))],
            ..Default::default()
        });
        let mut pass = pass.forget_lifetime();
        if self.sources.present().is_some() && !session.is_covered() {
            self.canvas.draw(&mut pass, session.viewport.area, size);
        }
        if let Some(clock) = &self.clock {
            drop(pass);
            let kept = wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store };
            let own = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("controls"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    ops: kept,
                    ..layouts::cleared(target, grey)
                })],
                timestamp_writes: Some(clock.render(0)),
                ..Default::default()
            });
            self.panel.draw(&mut own.forget_lifetime(), size);
            clock.encode(encoder);
        } else {
            self.panel.draw(&mut pass, size);
        }
    }

    /// Origins of the picture as it would be made now.
    fn to_make(&self, session: &Session) -> Option<Made> {
        let source = self.sources.present()?;
        let scene = session.open.scenery();
        Some(Made {
            shown: session.shown(),
            overlay: session.viewport.overlay,
            request: source.request(),
            revisions: self.looks.each_ref().map(LiveLook::revision),
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
        let Some(source) = self.sources.present_mut() else { return Ok(true) };
        if let (LookInput::Scene(source), Some(scenery), true) =
            (&mut *source, session.open.scenery(), begins)
        {
            source.encode(encoder, scenery);
        }
        let request = source.request();
        let shown = session.shown();
        let part = Part { begins, passes, number: source.number() };
        let mut is_whole = true;
        for (live, which) in self.looks.iter_mut().zip([Which::Look, Which::Compared, Which::Overlay]) {
            if shown.contains(&which) {
                is_whole &= live.encode(encoder, request, part, |stylizer| source.bind(stylizer))?;
            }
        }
        Ok(is_whole)
    }

    /// Places pictures on the canvas.
    fn arrange(&mut self, session: &Session) {
        let Some(source) = self.sources.present() else { return };
        let viewport = &session.viewport;
        let places = viewport.places(session.nominal_size());
        let [left, right] = session.shown();
        let pictures = [(left, places[0]), (right, places[1])].map(|(which, place)| {
            let (view, numbers) = picture(source, &self.looks, viewport.overlay, which);
            Shown { view, numbers, place }
        });
        let arrangement = Arrangement {
            area: viewport.area,
            pictures,
            split: viewport.split(),
            exposure: viewport.exposure.exp2(),
            middle: session.open.scenery().map_or(1.0, |scenery| scenery.distance()),
            square: 8.0,
            reading: match viewport.is_difference() && left != right {
                true => Reading::Difference(viewport.amplification),
                false => Reading::Seen,
            },
        };
        self.canvas.set(&self.gpu.device, &self.gpu.queue, &arrangement);
    }

    /// Lets the pixels under the pointer be read.
    fn encode_probe(&mut self, encoder: &mut wgpu::CommandEncoder, session: &Session) {
        let (Some(source), Some(pointer)) = (self.sources.present(), session.viewport.pointer) else {
            return;
        };
        let size = session.nominal_size();
        let Some((x, y)) = session.viewport.pixel(size, pointer) else { return };
        let place = [(x as f32 + 0.5) / size.0 as f32, (y as f32 + 0.5) / size.1 as f32];
        let (before, _) = source.original();
        let after = self.looks[0].output().map_or(before, |(view, ..)| view);
        self.probe.encode(encoder, [before, after], place);
    }
}
