//! The textures that a frame is rendered into.

use crate::layouts;
use isophote_files::error::{Error, Result};
use isophote_pictures::meaning::ImageState;

/// Samples per pixel of the colour pass.
pub const SAMPLES: u32 = 4;

/// Format of colours, linear and scene-linear.
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of normals.
pub const NORMAL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of the linear depth.
pub const LINEAR_DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Format of object ids.
pub const OBJECT_ID_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;
/// Format of motion vectors.
pub const MOTION_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// Format of rest positions.
pub const REST_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Format of control maps, which holds neutral values exactly and far more steps than bytes have.
pub const CONTROL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of depth buffers and the shadow map.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// A texture with its default view.
#[derive(Clone, Debug)]
pub struct Target {
    /// The texture.
    pub texture: wgpu::Texture,
    /// The view of all of it.
    pub view: wgpu::TextureView,
}

impl Target {
    pub(super) fn new(
        device: &wgpu::Device,
        label: &str,
        format: wgpu::TextureFormat,
        samples: u32,
        (width, height): (u32, u32),
    ) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: if samples == 1 {
                wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_SRC
            } else {
                wgpu::TextureUsages::RENDER_ATTACHMENT
            },
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        Self { texture, view }
    }
}

/// What surfaces are and how they are lit, scene-linear Rec.709 times coverage, which alpha is; all 0 on the background, and on
/// what is shown as it is. The radiance less diffuse and specular light is what surfaces emit, and the background.
#[derive(Clone, Debug)]
pub struct Layers {
    /// Base colours without light, those of metals too.
    pub albedo: Target,
    /// Light that is reflected diffusely, in the colours of surfaces.
    pub diffuse: Target,
    /// Light that is mirrored: highlights and reflections.
    pub specular: Target,
    /// Diffuse and specular light in the share that tone mapping leaves of the radiance, so that they add up to the colour as
    /// they do to the radiance. Missing until [`crate::renderer::Renderer::add_layers`] asks for them.
    pub displayed: Option<[Target; 2]>,
    /// The same before samples are resolved.
    pub(super) multisampled: [Target; 3],
}

impl Layers {
    /// Allocates them.
    pub(super) fn new(device: &wgpu::Device, size: (u32, u32)) -> Self {
        let make = |label, samples| Target::new(device, label, COLOR_FORMAT, samples, size);
        let labels = ["albedo", "diffuse", "specular"];
        let [albedo, diffuse, specular] = labels.map(|label| make(label, 1));
        let multisampled = labels.map(|label| make(label, SAMPLES));
        Self { albedo, diffuse, specular, displayed: None, multisampled }
    }

    /// Adds what displays show of light.
    pub(super) fn add_displayed(&mut self, device: &wgpu::Device) {
        let size = (self.albedo.texture.width(), self.albedo.texture.height());
        let make = |label| Target::new(device, label, COLOR_FORMAT, 1, size);
        self.displayed.get_or_insert_with(|| ["displayed diffuse", "displayed specular"].map(make));
    }

    /// Attachments in the order of the shader, which begin with nothing.
    pub(super) fn attachments(&self) -> [Option<wgpu::RenderPassColorAttachment<'_>>; 3] {
        let [a, b, c] = &self.multisampled;
        [(a, &self.albedo), (b, &self.diffuse), (c, &self.specular)].map(|(multisampled, resolved)| {
            let cleared = layouts::cleared(&multisampled.view, wgpu::Color::TRANSPARENT);
            let ops = wgpu::Operations { store: wgpu::StoreOp::Discard, ..cleared.ops };
            Some(wgpu::RenderPassColorAttachment { resolve_target: Some(&resolved.view), ops, ..cleared })
        })
    }
}

/// All targets of one size. Those that are public can be sampled and copied from.
#[derive(Clone, Debug)]
pub struct Targets {
    /// Display-referred linear Rec.709 in [0, 1]; alpha is 1. What the stylizer reads.
    pub color: Target,
    /// Scene-linear Rec.709 before exposure and tone mapping.
    pub radiance: Target,
    /// View-space unit normal of the surface in x, y, z (+X right, +Y up, +Z towards the camera); w is 1 on
    /// geometry. All 0 on the background.
    pub normal: Target,
    /// Distance from the camera along its axis in scene units; 0 on the background, where nothing else can be.
    pub depth: Target,
    /// Number of the draw, from 1, exact as a float; 0 on the background.
    pub object_id: Target,
    /// Pixels from where the surface is to where it was one frame ago, x right and y down; 0 on the background but where a
    /// shadow falls on the ground.
    pub motion: Target,
    /// Position in the scene before anything moves in x, y, z, where w is 1; all 0 on the background but where a shadow
    /// falls on the ground. Missing until [`crate::renderer::Renderer::add_rest_positions`] asks for it.
    pub rest: Option<Target>,
    /// Control map: values of the scene's vertices, and 0.5 where a surface has none and where there is no surface. Missing
    /// until [`crate::renderer::Renderer::add_control`] asks for it, and of scenes without any.
    pub control: Option<Target>,
    /// Colours of surfaces and their light. Missing until [`crate::renderer::Renderer::add_layers`] asks for them.
    pub layers: Option<Layers>,
    pub(super) multisampled: Target,
    pub(super) multisampled_depth: Target,
    pub(super) geometry_depth: Target,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl Targets {
    /// Allocates all targets.
    ///
    /// # Errors
    /// [`Error::Input`] for sizes that are 0 or beyond the limit of the device.
    pub fn new(device: &wgpu::Device, width: u32, height: u32) -> Result<Self> {
        let most = device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > most || height > most {
            return Err(Error::input(
                format!("size {width}x{height}"),
                "cannot be rendered on this device",
                format!("give a width and height from 1 to {most}"),
            ));
        }
        let make =
            |label: &str, format, samples| Target::new(device, label, format, samples, (width, height));
        Ok(Self {
            color: make("color", COLOR_FORMAT, 1),
            radiance: make("radiance", COLOR_FORMAT, 1),
            normal: make("normal", NORMAL_FORMAT, 1),
            depth: make("depth", LINEAR_DEPTH_FORMAT, 1),
            object_id: make("object id", OBJECT_ID_FORMAT, 1),
            motion: make("motion", MOTION_FORMAT, 1),
            rest: None,
            control: None,
            layers: None,
            multisampled: make("multisampled", COLOR_FORMAT, SAMPLES),
            multisampled_depth: make("multisampled depth", DEPTH_FORMAT, SAMPLES),
            geometry_depth: make("geometry depth", DEPTH_FORMAT, 1),
            width,
            height,
        })
    }

    /// The colour in a state: before tone mapping, or after it.
    pub fn color_in(&self, state: ImageState) -> &Target {
        match state {
            ImageState::SceneReferred => &self.radiance,
            ImageState::DisplayReferred => &self.color,
        }
    }

    /// Albedo, diffuse and specular light that go with the colour in this state, where they are rendered.
    pub fn layers_in(&self, state: ImageState) -> Option<[&Target; 3]> {
        let Layers { albedo, diffuse, specular, displayed, .. } = self.layers.as_ref()?;
        match (state, displayed) {
            (ImageState::SceneReferred, _) => Some([albedo, diffuse, specular]),
            (ImageState::DisplayReferred, Some([diffuse, specular])) => Some([albedo, diffuse, specular]),
            (ImageState::DisplayReferred, None) => None,
        }
    }
}
