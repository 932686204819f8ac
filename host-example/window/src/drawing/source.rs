//! The picture that looks are put on, on the graphics device.

use std::sync::Arc;

use super::canvas::Numbers;
use super::pictures::PictureSource;
use crate::state::scenery::{Scenery, is_same};
use isophote_example::guides;
use isophote_files::error::Result;
use isophote_finishing::stylize::Stylizer;
use isophote_loader::abi::{ISOPHOTE_SPACE_LINEAR, IsophoteRequest};
use isophote_pictures::meaning::ImageState;
use isophote_render::background::Background;
use isophote_render::gpu::Gpu;
use isophote_render::lighting::Lighting as Light;
use isophote_render::renderer::Renderer;
use isophote_render::samples;
use isophote_render::targets::Targets;
use isophote_scene::Scene;
use isophote_scene::camera::View;
use isophote_scene::pose::Pose;

/// A scene at a standstill, to be uploaded.
pub struct SceneState {
    /// The scene.
    pub scene: Arc<Scene>,
    pose: Pose,
    view: View,
    light: Light,
    background: Background,
    ground: bool,
}

impl SceneState {
    /// The scene as it is now.
    pub fn of(scenery: &Scenery) -> Self {
        Self {
            scene: Arc::clone(&scenery.scene),
            pose: scenery.pose.clone(),
            view: scenery.view(),
            light: *scenery.light(),
            background: scenery.lighting.background.clone(),
            ground: scenery.ground,
        }
    }
}

/// A scene with its renderer.
pub struct SceneSource {
    scene: Arc<Scene>,
    renderer: Renderer,
    background: Background,
    /// Request of looks on its pictures, but for the size.
    usual: IsophoteRequest,
}

impl SceneSource {
    /// Uploads a scene for pictures of a size; `usual` is a request of any size at their scale.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when the scene is beyond the limits of the device.
    pub fn new(gpu: &Gpu, state: &SceneState, size: (u32, u32), usual: IsophoteRequest) -> Result<Self> {
        let SceneState { scene, pose, view, light, background, ground } = state;
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, scene, size)?;
        renderer.set_background(background, false)?;
        if *ground {
            renderer.add_ground();
        }
        renderer.add_control(scene)?;
        // A frame that is not submitted compiles what the first one needs, so that the window does not wait for it.
        renderer.encode(
            &mut gpu.device.create_command_encoder(&Default::default()),
            scene,
            pose,
            view,
            light,
        );
        renderer.forget_motion();
        Ok(Self { scene: Arc::clone(scene), renderer, background: background.clone(), usual })
    }

    /// True where it is of this scene.
    pub fn is_of(&self, scenery: &Scenery) -> bool {
        Arc::ptr_eq(&self.scene, &scenery.scene)
    }

    /// Takes over the size of the pictures and what is behind the scene; says whether the pictures are others then.
    ///
    /// # Errors
    /// As [`SceneSource::new`].
    pub fn follow(&mut self, scenery: &Scenery, size: (u32, u32), scale: f32) -> Result<bool> {
        if !is_same(&self.background, &scenery.lighting.background) {
            self.background = scenery.lighting.background.clone();
            self.renderer.set_background(&self.background, false)?;
        }
        self.usual.scale = scale;
        let targets = self.renderer.targets();
        if (targets.width, targets.height) == size {
            return Ok(false);
        }
        self.renderer.resize(size)?;
        Ok(true)
    }

    /// Request of looks on pictures of it.
    pub fn request(&self) -> IsophoteRequest {
        let targets = self.renderer.targets();
        IsophoteRequest {
            width: targets.width,
            height: targets.height,
            space: ISOPHOTE_SPACE_LINEAR,
            guides: guides::known(targets, ImageState::DisplayReferred),
            ..self.usual
        }
    }

    /// Renders rest positions too from now on; says whether they are new.
    pub fn add_rest_positions(&mut self) -> bool {
        let is_new = self.renderer.targets().rest.is_none();
        self.renderer.add_rest_positions();
        is_new
    }

    /// Renders colours of surfaces and their light too from now on, where there is any; says whether they are new, and requests
    /// others then.
    pub fn add_light(&mut self) -> bool {
        let is_new = self.renderer.targets().layers.is_none() && self.scene.is_lit();
        if is_new {
            self.renderer.add_layers(ImageState::DisplayReferred);
        }
        is_new
    }

    /// Targets that the last frame was rendered into.
    pub fn targets(&self) -> &Targets {
        self.renderer.targets()
    }

    /// Records a frame.
    pub fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, scenery: &Scenery) {
        let Scenery { scene, pose, .. } = scenery;
        self.renderer.encode(encoder, scene, pose, &scenery.view(), scenery.light());
    }

    /// Records one of the samples of the frame that was recorded last, whose encoder must have been submitted: which things it shows
    /// is in the place of their numbers, until [`SceneSource::encode_again`].
    pub fn encode_sample(&mut self, encoder: &mut wgpu::CommandEncoder, scenery: &Scenery, sample: u32) {
        let shown = (&*scenery.scene, &scenery.pose, &scenery.view(), scenery.light());
        self.renderer.encode_shifted(encoder, shown, samples::shift(sample));
    }

    /// Records what is known of that frame beside its colour once more, at a standstill.
    pub fn encode_again(&mut self, encoder: &mut wgpu::CommandEncoder, scenery: &Scenery) {
        let Scenery { scene, pose, .. } = scenery;
        self.renderer.encode_motion(encoder, scene, pose, &scenery.view(), scenery.light());
    }

    /// Lets a style read what was rendered.
    ///
    /// # Errors
    /// As [`Stylizer::bind`].
    pub fn bind(&self, stylizer: &mut Stylizer) -> Result<()> {
        stylizer.bind(self.renderer.targets())
    }

    /// The picture without any look.
    pub fn original(&self) -> (&wgpu::TextureView, Numbers) {
        (&self.renderer.targets().color.view, Numbers::Linear)
    }

    /// One of its guides.
    pub fn picture(&self, numbers: Numbers) -> Option<&wgpu::TextureView> {
        let targets = self.renderer.targets();
        let target = match numbers {
            Numbers::Normal => &targets.normal,
            Numbers::Depth => &targets.depth,
            Numbers::ObjectId => &targets.object_id,
            Numbers::Motion => &targets.motion,
            _ => return None,
        };
        Some(&target.view)
    }
}

/// Input of looks.
pub enum LookInput {
    /// A scene.
    Scene(Box<SceneSource>),
    /// A picture.
    Picture(PictureSource),
}

impl LookInput {
    /// Request of looks on it.
    pub fn request(&self) -> IsophoteRequest {
        match self {
            Self::Scene(source) => source.request(),
            Self::Picture(source) => source.request(),
        }
    }

    /// Lets a style read it.
    ///
    /// # Errors
    /// As [`Stylizer::bind`].
    pub fn bind(&self, stylizer: &mut Stylizer) -> Result<()> {
        match self {
            Self::Scene(source) => source.bind(stylizer),
            Self::Picture(source) => source.bind(stylizer),
        }
    }

    /// The picture without any look.
    pub fn original(&self) -> (&wgpu::TextureView, Numbers) {
        match self {
            Self::Scene(source) => source.original(),
            Self::Picture(source) => source.original(),
        }
    }

    /// One of its guides.
    pub fn guide(&self, numbers: Numbers) -> Option<&wgpu::TextureView> {
        match self {
            Self::Scene(source) => source.picture(numbers),
            Self::Picture(source) => source.picture(numbers),
        }
    }

    /// Number of the frame, where frames follow one another.
    pub fn number(&self) -> Option<i64> {
        match self {
            Self::Scene(_) => None,
            Self::Picture(source) => Some(source.number()),
        }
    }
}
