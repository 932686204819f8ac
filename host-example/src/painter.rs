//! A scene and its style on a device: everything that a frame takes.

use isophote_example::frame_runner::FrameRunner;
use isophote_example::guides;
use isophote_example::kernels::Kernels;
use isophote_example::plan_runner::ALL;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::Library;
use isophote_loader::abi::IsophoteRequest;
use isophote_pictures::meaning::ImageState;
use isophote_render::gpu::Gpu;
use isophote_render::lighting::Lighting;
use isophote_render::renderer::Renderer;
use isophote_scene::camera::Viewpoint;
use isophote_scene::pose::Pose;
use isophote_scene::{Scene, floor};

use crate::style::Style;

/// Lines of the picture whose pixels are the lengths of a style: pictures of all sizes get the same look.
const REFERENCE_HEIGHT: u32 = 1080;

/// What styles read and windows show is what was tone-mapped.
const STATE: ImageState = ImageState::DisplayReferred;

/// A style with what runs it.
struct Stylized {
    style: Style,
    frames: FrameRunner,
}

/// Renderer and style of a scene.
pub struct Painter {
    /// The camera that the scene is seen from.
    pub camera: Viewpoint,
    scene: Scene,
    pose: Pose,
    lighting: Lighting,
    renderer: Renderer,
    stylized: Option<Stylized>,
}

impl Painter {
    /// Uploads the scene and makes the style of that name ready for frames of a size. Light is chosen for the camera.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for scenes and styles that cannot be drawn,
    /// [`isophote_files::error::Error::Failure`] without the library or when the device refuses.
    pub fn new(gpu: &Gpu, scene: Scene, style: &str, size: (u32, u32), camera: Viewpoint) -> Result<Self> {
        let library = Library::open()?;
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, &scene, size)?;
        if floor::lacks_floor(&scene) {
            renderer.add_ground();
        }
        let mut stylized = None;
        if let Some(style) = Style::open(&library, style)? {
            if style.wants_rest_positions()? {
                renderer.add_rest_positions();
            }
            renderer.add_control(&scene)?;
            let request = guides::request(&library, size, REFERENCE_HEIGHT)
                .map_err(|e| e.at("--size", "choose another size"))?;
            let request = IsophoteRequest { guides: guides::known(renderer.targets(), STATE), ..request };
            let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
            let frames = FrameRunner::new(&kernels, &library, style.named(), request)?;
            stylized = Some(Stylized { style, frames });
        }
        let pose = Pose::at_rest(&scene);
        let view = camera.view(&scene, &pose);
        let lighting = Lighting::for_scene(&scene, &pose, &view, None, None);
        let mut painter = Self { camera, scene, pose, lighting, renderer, stylized };
        painter.bind()?;
        gpu.check()?;
        Ok(painter)
    }

    /// Takes the moment of the next frame, in seconds of the scene's first animation.
    pub fn go_to(&mut self, seconds: f32) {
        self.pose.update(&self.scene, Some(0), seconds);
    }

    /// Changes the size of frames.
    ///
    /// # Errors
    /// As [`Painter::new`].
    pub fn resize(&mut self, size: (u32, u32)) -> Result<()> {
        self.renderer.resize(size)?;
        if let Some(Stylized { style, frames }) = &mut self.stylized {
            frames.resize(style.named(), size, 1.0)?;
        }
        self.bind()
    }

    /// Lets the plan read the renderer's own textures, where they are.
    fn bind(&mut self) -> Result<()> {
        let targets = self.renderer.targets();
        match &mut self.stylized {
            Some(Stylized { frames, .. }) => frames.bind(&guides::inputs(targets, STATE)),
            None => Ok(()),
        }
    }

    /// Records the frame of a number, from 1: the scene's passes, and then the style's in the same encoder.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device refuses.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, number: i64) -> Result<()> {
        let mut is_rebuilt = false;
        if let Some(Stylized { style, frames }) = &mut self.stylized {
            let is_edited = frames.request().frame != number;
            frames.number(number);
            is_rebuilt = frames.update(style.named(), is_edited)?;
        }
        if is_rebuilt {
            self.bind()?;
        }
        let view = self.camera.view(&self.scene, &self.pose);
        self.renderer.encode(encoder, &self.scene, &self.pose, &view, &self.lighting);
        if let Some(Stylized { frames, .. }) = &mut self.stylized {
            frames.encode(encoder, ALL)?;
        }
        Ok(())
    }

    /// The picture of the last frame: four channels of linear light, or one of grey.
    pub fn picture(&self) -> &wgpu::TextureView {
        let plain = &self.renderer.targets().color.view;
        self.stylized.as_ref().map_or(plain, |stylized| stylized.frames.output())
    }
}
