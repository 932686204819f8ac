//! A scene seen by a camera over a number of frames, rendered and stylized without a window.

use std::f32::consts::TAU;

use crate::error::Result;
use crate::loader::Library;
use crate::output::Picture;
use crate::render::Renderer;
use crate::render::gpu::Gpu;
use crate::render::look::Look;
use crate::render::readback::Readback;
use crate::render::targets::{Target, Targets};
use crate::scene::Scene;
use crate::scene::camera::{self, Direction, Orbit, View};
use crate::scene::pose::Pose;
use crate::stylize::Stylizer;
use crate::stylize::plan_runner::Kernels;
use crate::stylize::style::Style;

/// What is rendered of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Size of the pictures in pixels.
    pub size: (u32, u32),
    /// Number of frames.
    pub frames: usize,
    /// Whether the camera turns once around the scene over all frames.
    pub turntable: bool,
    /// From where the default camera and turntables see the scene.
    pub direction: Direction,
    /// The animation that plays.
    pub animation: Option<usize>,
    /// Time of the first frame in seconds.
    pub start: f32,
    /// Frames per second.
    pub fps: f32,
}

/// A scene on a graphics device of its own.
pub struct Shot {
    options: Options,
    scene: Scene,
    pose: Pose,
    look: Look,
    camera: Camera,
    gpu: Gpu,
    renderer: Renderer,
    stylizer: Option<Stylizer>,
    readback: Readback,
}

impl Shot {
    /// Opens a device and makes everything ready.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] for scenes and styles that cannot be drawn,
    /// [`crate::error::Error::Failure`] without a device or when it fails.
    pub fn new(scene: Scene, style: Option<(&Library, Style)>, options: Options) -> Result<Self> {
        let gpu = Gpu::open()?;
        let renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, options.size)?;
        gpu.check()?;
        let mut stylizer = None;
        if let Some((library, style)) = style {
            let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
            let stylizer = stylizer.insert(Stylizer::new(&kernels, library, style, options.size)?);
            stylizer.bind(renderer.targets())?;
        }
        let pose = Pose::at_rest(&scene);
        Ok(Self {
            look: Look::for_scene(&scene, &pose),
            camera: Camera::choose(&options, &scene),
            readback: Readback::default(),
            options,
            scene,
            pose,
            gpu,
            renderer,
            stylizer,
        })
    }

    /// Renders and stylizes frame `index`, which counts from 0.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when the device fails.
    pub fn draw(&mut self, index: usize) -> Result<Picture> {
        let Options { animation, start, fps, frames, .. } = self.options;
        self.pose.update(&self.scene, animation, start + index as f32 / fps);
        let view = self.camera.view(&self.scene, &self.pose, index as f32 / frames as f32);
        if let Some(stylizer) = &mut self.stylizer {
            stylizer.at_frame(index as i64 + 1)?;
            if stylizer.update()? {
                stylizer.bind(self.renderer.targets())?;
            }
        }
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.renderer.encode(&mut encoder, &self.scene, &self.pose, &view, &self.look);
        if let Some(stylizer) = &self.stylizer {
            stylizer.encode(&mut encoder)?;
        }
        self.gpu.queue.submit([encoder.finish()]);
        let result = self.stylizer.as_ref().map_or(&self.renderer.targets().color.view, Stylizer::output);
        self.readback.read(&self.gpu, result.texture())
    }

    /// What the renderer knows of the pixels of the frame drawn last, as `choose` picks it.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when the device fails.
    pub fn read(&mut self, choose: impl FnOnce(&Targets) -> &Target) -> Result<Picture> {
        self.readback.read(&self.gpu, &choose(self.renderer.targets()).texture)
    }
}

/// Where the pictures are taken from.
enum Camera {
    File(usize, Orbit),
    Framing(Orbit),
    Turntable(Orbit),
}

impl Camera {
    fn choose(options: &Options, scene: &Scene) -> Self {
        let aspect = options.size.0 as f32 / options.size.1 as f32;
        match camera::file_camera(scene) {
            _ if options.turntable => Self::Turntable(Orbit::turntable(scene, aspect, options.direction)),
            Some(node) => Self::File(node, Orbit::framing(scene, aspect, options.direction)),
            None => Self::Framing(Orbit::framing(scene, aspect, options.direction)),
        }
    }

    /// The view at a share of the sequence in [0, 1).
    fn view(&self, scene: &Scene, pose: &Pose, share: f32) -> View {
        match self {
            Self::File(node, fallback) => {
                View::from_node(scene, pose, *node).unwrap_or_else(|| fallback.view())
            }
            Self::Framing(orbit) => orbit.view(),
            Self::Turntable(orbit) => orbit.turned(share * TAU).view(),
        }
    }
}
