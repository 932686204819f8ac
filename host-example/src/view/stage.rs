//! Everything of the window that lives on the graphics device: surface, picture, looks, canvas and panel.
//!
//! When the device is lost, the stage is thrown away and made anew; what is shown and how is kept outside.

use std::sync::Arc;
use std::time::{Duration, Instant};

use winit::dpi::PhysicalSize;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::canvas::{Arrangement, Canvas, Numbers, SURROUND, Shown};
use super::document::frame::Frame;
use super::easel::Overlay;
use super::lane::{Lane, Part};
use super::look::Look;
use super::panel::Panel;
use super::pictures::{PictureSource, numbers};
use super::probe::Probe;
use super::session::{Session, Which};
use super::snapshot::Snapshots;
use super::source::{SceneSource, Source};
use super::worker::Wake;
use crate::error::{Error, Result};
use crate::loader::catalogue::Kind;
use crate::loader::contract::IsophoteRequest;
use crate::render::gpu::Gpu;
use crate::render::layouts;
use crate::render::look::Look as Light;
use crate::scene::camera::View;
use crate::stylize::kernels::Kernels;

/// All of one device. Fields are dropped in order: what uses the device before it.
pub struct Stage {
    /// The look, what it is compared with, and what is shown instead.
    lanes: [Lane; 3],
    source: Option<Source>,
    canvas: Canvas,
    probe: Probe,
    snapshots: Snapshots<Face>,
    /// Colours under the pointer, before and after, as of the last frame.
    pub probed: Option<[[f32; 4]; 2]>,
    /// Draws the controls.
    pub panel: Panel,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    made: Option<Made>,
    /// Grows when the source is another one.
    sources: u64,
    /// Whether the picture is only begun.
    is_begun: bool,
    /// Passes of a picture that are recorded at once, where the processor draws.
    passes: usize,
    /// What drawing the window took last, without the picture.
    cost: Duration,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// It is on its way to the screen; the picture in it is a new one.
    Picture,
    /// So it is; the picture in it is the one of before, and another one is begun.
    Begun,
    /// So it is, with the picture of before.
    Controls,
    /// There was no surface to draw on; try again later.
    Skipped,
}

/// What a picture was made of. While it stays the same, so does the picture.
#[derive(Clone, Debug, PartialEq)]
struct Made {
    shown: [Which; 2],
    overlay: Overlay,
    asked: IsophoteRequest,
    revisions: [u64; 3],
    source: u64,
    scene: Option<(View, Light, f32)>,
}

/// What a frame of a scene shows, looks apart.
type Face = (IsophoteRequest, u64, Option<(View, Light, f32)>);

/// What recording a part of a picture may take.
const GOAL: [Duration; 2] = [Duration::from_millis(15), Duration::from_millis(40)];

impl Stage {
    /// Opens a device for `window`.
    ///
    /// # Errors
    /// [`Error::Failure`] when there is no adapter for the window or the device refuses.
    pub fn new(window: &Arc<Window>, display: OwnedDisplayHandle, wake: &Wake) -> Result<Self> {
        let descriptor = wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display));
        let instance = wgpu::Instance::new(descriptor);
        let surface = surface(&instance, window)?;
        let gpu = Gpu::with_instance(instance, Some(&surface))?;
        let size = drawable(window.inner_size());
        let mut config = surface.get_default_config(&gpu.adapter, size.0, size.1).ok_or_else(|| {
            Error::failure(
                "the adapter cannot draw on the window",
                "install a Vulkan driver with X11 or Wayland support",
            )
        })?;
        // Controls are blended as designers expect it, which is on encoded values.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        let plain = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
        config.format = plain.into_iter().find(|format| formats.contains(format)).unwrap_or(config.format);
        config.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&gpu.device, &config);
        let canvas = Canvas::new(&gpu.device, config.format);
        let probe = Probe::new(&gpu.device);
        let panel = Panel::new(&gpu.device, config.format);
        let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
        let lane = || Lane::new(&kernels, Arc::clone(wake));
        let lanes = [lane()?, lane()?, lane()?];
        gpu.check()?;
        Ok(Self {
            lanes,
            source: None,
            canvas,
            probe,
            snapshots: Snapshots::new(wake)?,
            probed: None,
            panel,
            surface,
            config,
            gpu,
            made: None,
            sources: 0,
            is_begun: false,
            passes: 4,
            cost: Duration::ZERO,
        })
    }

    /// Whether pictures are computed by the processor, which takes its time.
    pub fn is_software(&self) -> bool {
        self.gpu.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Takes over the size of the window.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn resize(&mut self, size: PhysicalSize<u32>) -> Result<()> {
        let size = drawable(size);
        if size == (self.config.width, self.config.height) {
            return Ok(());
        }
        (self.config.width, self.config.height) = size;
        self.surface.configure(&self.gpu.device, &self.config);
        self.gpu.check()
    }

    /// Takes over what is open, its size and the looks, as far as that can be done at once; the rest goes on beside the
    /// window. Returns what went wrong with the looks.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device fails, [`Error::Input`] for a scene beyond its limits.
    pub fn follow(&mut self, session: &Session, scale: f32) -> Result<Vec<Error>> {
        self.follow_source(session, scale)?;
        // What is covered is built when it is seen, where that takes the processor's time.
        if session.is_covered() && self.is_software() {
            return Ok(Vec::new());
        }
        let Some(source) = &mut self.source else { return Ok(Vec::new()) };
        let overlay = session.easel.overlay.node().map(|node| Look::open(&session.library, node.as_ref()));
        let overlay = overlay.transpose()?.unwrap_or_else(Look::plain);
        let seen = session.seen();
        let compared = session.compared.clone().unwrap_or_else(Look::plain);
        let asked = source.asked();
        let mut problems = Vec::new();
        for (lane, look) in self.lanes.iter_mut().zip([&*seen, &compared, &overlay]) {
            problems.extend(lane.follow(&session.library, look, asked).err());
            if let Source::Scene(source) = source
                && lane.wants_rest_positions()?
                && source.add_rest_positions()
            {
                lane.unbind();
            }
        }
        self.gpu.check()?;
        Ok(problems)
    }

    /// Takes over the scene or picture that is open, its frame and its size.
    fn follow_source(&mut self, session: &Session, scale: f32) -> Result<()> {
        let usual = session.library.request((1, 1)).map_err(|e| e.at("the library", "install it again"))?;
        let gpu = &self.gpu;
        let (is_new, source) = match (&session.scenery, &session.reel, self.source.take()) {
            (Some(scenery), _, old) => {
                let [_, half] = session.easel.halves();
                let pixels = |length: f32| ((length * scale).round() as u32).max(1);
                let size = (pixels(half.width), pixels(half.height));
                match old {
                    Some(Source::Scene(mut source)) if source.is_of(scenery) => {
                        (source.follow(scenery, size, scale)?, Source::Scene(source))
                    }
                    _ => {
                        let usual = IsophoteRequest { scale, ..usual };
                        (true, Source::Scene(Box::new(SceneSource::new(gpu, scenery, size, usual)?)))
                    }
                }
            }
            (None, Some(reel), old) => {
                let Some((frame, scale)) = reel.frame(scale < 1.0) else { return Ok(()) };
                match old {
                    Some(Source::Picture(source)) if source.shows(frame) => {
                        self.source = Some(Source::Picture(source));
                        return Ok(());
                    }
                    Some(Source::Picture(mut source)) => {
                        self.sources += 1;
                        match source.follow(gpu, frame, scale) {
                            true => (false, Source::Picture(source)),
                            false => (true, Source::Picture(PictureSource::new(gpu, frame, scale, usual)?)),
                        }
                    }
                    _ => (true, Source::Picture(PictureSource::new(gpu, frame, scale, usual)?)),
                }
            }
            (None, None, _) => return Ok(()),
        };
        self.source = Some(source);
        if is_new {
            self.lanes.iter_mut().for_each(Lane::unbind);
            self.sources += 1;
        }
        Ok(())
    }

    /// The frame of a scene that was copied since the last call, for previews. Copies the present one where it stands still and
    /// is covered by them.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device refuses.
    pub fn snapshot(&mut self, session: &Session) -> Result<Option<Frame>> {
        let taken = self.snapshots.answer();
        // Panes that are all but ready are more to look at than none while a scene is turned.
        let waits = session.comparison.is_some() && session.previews.is_busy() && !self.is_software();
        let is_wanted = session.is_covered() && !session.is_playing() && !self.is_begun && !waits;
        let made = self.made.as_ref().filter(|made| is_wanted && made.asked.scale == 1.0);
        let face = made.map(|made| (made.asked, made.source, made.scene));
        if let (Some(Source::Scene(source)), Some(scenery), Some(face)) =
            (&mut self.source, &session.scenery, face)
            && !self.snapshots.shows(&face)
        {
            if source.add_rest_positions() {
                self.lanes.iter_mut().for_each(Lane::unbind);
                let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
                source.encode(&mut encoder, scenery);
                self.gpu.queue.submit([encoder.finish()]);
            }
            self.snapshots.take(&self.gpu, source, face);
        }
        taken.transpose()
    }

    /// Whether a look is being built.
    pub fn is_busy(&self) -> bool {
        self.lanes.iter().any(Lane::is_busy)
    }

    /// Draws one frame in one submission: the picture, if it is to be another than before, canvas and controls. `always`:
    /// the picture even if it is the same.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device is lost or reports an error.
    pub fn draw(&mut self, window: &Arc<Window>, session: &Session, always: bool) -> Result<Drawn> {
        self.panel.upload(&self.gpu.device, &self.gpu.queue);
        let Some((frame, renew)) = self.next_frame(window)? else { return Ok(Drawn::Skipped) };
        let target = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let drawn = self.make(&mut encoder, session, always)?;
        let started = Instant::now();
        self.arrange(session);
        self.encode_probe(&mut encoder, session);
        self.paint(&mut encoder, &target, session);
        self.gpu.queue.submit([encoder.finish()]);
        self.probe.ask();
        window.pre_present_notify();
        self.gpu.queue.present(frame);
        self.panel.free();
        // The time of a frame is only known once it is done; a viewer that runs ahead of its device
        // would also answer the mouse late.
        self.gpu.wait()?;
        self.probed = self.probe.read();
        self.cost = started.elapsed();
        if renew {
            self.surface.configure(&self.gpu.device, &self.config);
        }
        Ok(drawn)
    }

    /// Records the picture, if it is to be another one. Where the processor draws, a part of it is done at once instead, and
    /// what is left with the next frames, so that the window answers meanwhile.
    fn make(&mut self, encoder: &mut wgpu::CommandEncoder, session: &Session, always: bool) -> Result<Drawn> {
        let made = self.to_make(session);
        let mut begins = made.is_some() && (always || made != self.made);
        if !begins && !self.is_begun {
            return Ok(Drawn::Controls);
        }
        self.made = made;
        if always || !self.is_software() {
            self.encode_picture(encoder, session, begins, usize::MAX)?;
            self.is_begun = false;
            return Ok(Drawn::Picture);
        }
        let started = Instant::now();
        loop {
            let part = Instant::now();
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            self.is_begun = !self.encode_picture(&mut encoder, session, begins, self.passes)?;
            self.gpu.queue.submit([encoder.finish()]);
            self.gpu.wait()?;
            begins = false;
            self.passes = match part.elapsed() {
                took if took < GOAL[0] => self.passes.saturating_mul(2).min(64),
                took if took > GOAL[1] => (self.passes / 2).max(1),
                _ => self.passes,
            };
            if !self.is_begun {
                return Ok(Drawn::Picture);
            }
            // What is spent on the window is spent on the picture, too.
            if started.elapsed() > self.cost.max(GOAL[1]) {
                return Ok(Drawn::Begun);
            }
        }
    }

    /// Draws canvas and controls.
    fn paint(&mut self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, session: &Session) {
        let size = (self.config.width, self.config.height);
        self.panel.prepare(&self.gpu.device, &self.gpu.queue, encoder, size);
        let grey = wgpu::Color { r: SURROUND.into(), g: SURROUND.into(), b: SURROUND.into(), a: 1.0 };
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("window"),
            color_attachments: &[Some(layouts::cleared(target, grey))],
            ..Default::default()
        });
        let mut pass = pass.forget_lifetime();
        if self.source.is_some() && !session.is_covered() {
            self.canvas.draw(&mut pass, session.easel.area, size);
        }
        self.panel.draw(&mut pass, size);
    }

    /// The texture to draw on, and whether the surface must be configured anew afterwards.
    fn next_frame(&mut self, window: &Arc<Window>) -> Result<Option<(wgpu::SurfaceTexture, bool)>> {
        use wgpu::CurrentSurfaceTexture as Current;
        match self.surface.get_current_texture() {
            Current::Success(frame) => return Ok(Some((frame, false))),
            Current::Suboptimal(frame) => return Ok(Some((frame, true))),
            Current::Timeout | Current::Occluded => return Ok(None),
            Current::Lost => self.surface = surface(&self.gpu.instance, window)?,
            Current::Outdated | Current::Validation => self.gpu.check()?,
        }
        self.surface.configure(&self.gpu.device, &self.config);
        Ok(None)
    }

    /// What the picture would be made of now.
    fn to_make(&self, session: &Session) -> Option<Made> {
        let source = self.source.as_ref()?;
        let scene = session.scenery.as_ref();
        Some(Made {
            shown: session.shown(),
            overlay: session.easel.overlay,
            asked: source.asked(),
            revisions: self.lanes.each_ref().map(Lane::revision),
            source: self.sources,
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
        let Some(source) = &mut self.source else { return Ok(true) };
        if let (Source::Scene(source), Some(scenery), true) = (&mut *source, &session.scenery, begins) {
            source.encode(encoder, scenery);
        }
        let asked = source.asked();
        let shown = session.shown();
        let part = Part { begins, passes, number: source.number() };
        let mut is_whole = true;
        for (lane, which) in self.lanes.iter_mut().zip([Which::Look, Which::Compared, Which::Overlay]) {
            if shown.contains(&which) {
                is_whole &= lane.encode(encoder, asked, part, |stylizer| source.bind(stylizer))?;
            }
        }
        Ok(is_whole)
    }

    /// Says what lies where on the canvas.
    fn arrange(&mut self, session: &Session) {
        let Some(source) = &self.source else { return };
        let easel = &session.easel;
        let places = easel.places(session.nominal_size());
        let [left, right] = session.shown();
        let pictures = [(left, places[0]), (right, places[1])].map(|(which, place)| {
            let (view, numbers) = picture(source, &self.lanes, easel.overlay, which);
            Shown { view, numbers, place }
        });
        let arrangement = Arrangement {
            area: easel.area,
            pictures,
            split: easel.split(),
            exposure: easel.exposure.exp2(),
            middle: session.scenery.as_ref().map_or(1.0, |scenery| scenery.distance()),
            square: 8.0,
        };
        self.canvas.set(&self.gpu.device, &self.gpu.queue, &arrangement);
    }

    /// Lets the pixels under the pointer be read.
    fn encode_probe(&mut self, encoder: &mut wgpu::CommandEncoder, session: &Session) {
        let (Some(source), Some(pointer)) = (&self.source, session.pointer) else { return };
        let size = session.nominal_size();
        let Some((x, y)) = session.easel.pixel(size, pointer) else { return };
        let place = [(x as f32 + 0.5) / size.0 as f32, (y as f32 + 0.5) / size.1 as f32];
        let (before, _) = source.original();
        let after = self.lanes[0].output().map_or(before, |(view, ..)| view);
        self.probe.encode(encoder, [before, after], place);
    }

    /// Whether the device is gone, and with it the stage.
    pub fn is_lost(&self) -> bool {
        self.gpu.is_lost()
    }

    /// Most texels of a texture across.
    pub fn most_texels(&self) -> usize {
        self.gpu.device.limits().max_texture_dimension_2d as usize
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> String {
        self.gpu.adapter.get_info().name
    }
}

/// One of the pictures that can be shown; the original where there is nothing else yet.
fn picture<'s>(
    source: &'s Source,
    lanes: &'s [Lane; 3],
    overlay: Overlay,
    which: Which,
) -> (&'s wgpu::TextureView, Numbers) {
    let guide = match overlay {
        Overlay::Normal => Some(Numbers::Normal),
        Overlay::Depth => Some(Numbers::Depth),
        Overlay::ObjectId => Some(Numbers::ObjectId),
        Overlay::Motion => Some(Numbers::Motion),
        _ => None,
    };
    let guide = guide.filter(|_| which == Which::Overlay);
    if let Some((numbers, view)) = guide.and_then(|numbers| Some((numbers, source.guide(numbers)?))) {
        return (view, numbers);
    }
    let lane = match which {
        Which::Original => None,
        Which::Look => lanes[0].output(),
        Which::Compared => lanes[1].output(),
        Which::Overlay => lanes[2].output(),
    };
    match lane {
        Some((view, Kind::Scalar, _)) => (view, Numbers::Grey),
        Some((view, _, space)) => (view, numbers(space)),
        None => source.original(),
    }
}

fn surface(instance: &wgpu::Instance, window: &Arc<Window>) -> Result<wgpu::Surface<'static>> {
    instance.create_surface(Arc::clone(window)).map_err(|e| {
        Error::failure(
            format!("the window cannot be drawn on: {e}"),
            "install a Vulkan driver with X11 or Wayland support",
        )
    })
}

/// A minimised window has no pixels; targets have at least one.
fn drawable(size: PhysicalSize<u32>) -> (u32, u32) {
    (size.width.max(1), size.height.max(1))
}
