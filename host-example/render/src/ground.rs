//! The shadow of a model on an invisible ground. It darkens colours, and where it is, guides have the ground's rest
//! positions and motion, so that marks stick to it. Normals and depths there are none, nor an object: a shadow has no
//! outline.
//!
//! A pass of its own finds the shadow by a limited number of samples, whose borders are ripples in it; those that show it
//! smooth these away.

use glam::{Vec3, Vec4};

use crate::layouts::{self, Layouts, bind_sampler, bind_view};
use crate::lighting::Lighting;
use crate::pipelines::{Pass, SCENE, behind_everything, module};
use crate::targets::{
    COLOR_FORMAT, LINEAR_DEPTH_FORMAT, MOTION_FORMAT, NORMAL_FORMAT, OBJECT_ID_FORMAT, REST_FORMAT, SAMPLES,
    Target,
};
use isophote_scene::Scene;
use isophote_scene::camera::View;
use isophote_scene::model::Projection;

/// Share of the light that the sun's shadow takes away which is taken: a full shadow is heavier than any model needs.
const STRENGTH: f32 = 0.75;

/// Lowest sun whose shadow falls on the ground, as the sine of its height.
const LOWEST: f32 = 0.03;

/// Reach of shadows, in radii of the scene.
const REACH: f32 = 8.0;

/// Depth of the ground below the lowest point, in radii of the scene, so that a floor that is there hides it.
const BELOW: f32 = 1e-3;

/// Beginning of the shaders of the ground.
const PLANE: &str = include_str!("../shaders/ground.wgsl");

/// The ground of a frame: its least corner with the darkness of full shadow, its greatest with how far shadows reach.
pub type Plane = [Vec4; 2];

/// The part of the ground that shadows may fall on; nothing where they cannot be seen.
pub fn plane(scene: &Scene, lighting: &Lighting, view: &View) -> Option<Plane> {
    let sun = lighting.sun_direction;
    let sun_color = lighting.sun_color.filter(|_| sun.y > LOWEST)?;
    let (bounds, radius) = (&scene.bounds, scene.bounds.radius());
    let height = bounds.min.y - BELOW * radius;
    let is_above = match view.projection {
        Projection::Perspective { .. } => view.eye().y > height,
        Projection::Orthographic { .. } => view.world_to_view.row(2).y > 0.0,
    };
    if !is_above {
        return None;
    }
    let center = bounds.center();
    let (mut low, mut high) = (bounds.min, bounds.max);
    for y in [bounds.min.y, bounds.max.y] {
        // Where the sun throws the upper corners, and as far again as the shadow is soft.
        let fall = (y - height) / sun.y;
        let offset = Vec3::new(-sun.x * fall, 0.0, -sun.z * fall);
        let soft = 0.2 * fall / sun.y;
        low = low.min(bounds.min + offset - soft);
        high = high.max(bounds.max + offset + soft);
    }
    let reach = REACH * radius;
    let within = |v: Vec3| v.clamp(center - reach, center + reach);
    let (low, high) = (within(low), within(high));
    let weight = Vec3::new(0.2126, 0.7152, 0.0722);
    let key = weight.dot(sun_color) * sun.y;
    let fill = weight.dot(lighting.zenith + lighting.horizon) * 0.5 * lighting.sky_scale;
    let darkness = STRENGTH * key / (key + fill).max(1e-6);
    Some([low.with_y(height).extend(darkness), high.with_y(height).extend(reach)])
}

/// Format of the shadow by itself.
const SHADOW_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;

/// The pipelines of the ground and the texture between them.
pub struct Ground {
    shadow: wgpu::RenderPipeline,
    surface: wgpu::RenderPipeline,
    motion: wgpu::RenderPipeline,
    rest: wgpu::RenderPipeline,
    target: Target,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    group: wgpu::BindGroup,
}

impl Ground {
    /// Compiles the shaders, for pictures of a size.
    pub fn new(device: &wgpu::Device, layouts: &Layouts, size: (u32, u32)) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("ground"),
            entries: &[
                layouts::texture(0, wgpu::TextureSampleType::Float { filterable: true }),
                layouts::sampler(1, wgpu::SamplerBindingType::Filtering),
            ],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("ground"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let compiled = |shader| module(device, "ground", &[SCENE, PLANE, shader]);
        let finds = compiled(include_str!("../shaders/ground_shadow.wgsl"));
        let shows = compiled(include_str!("../shaders/ground_picture.wgsl"));
        let drawn = |entry, targets: &[_], samples| {
            pipeline(device, [&layouts.frame, &layout], (&shows, entry), targets, Some(samples))
        };
        let target = shadow_target(device, size);
        let group = bind(device, &layout, &sampler, &target);
        let maps = [&layouts.frame, &layouts.shadow];
        Self {
            shadow: pipeline(device, maps, (&finds, "ground_fragment"), &[Some(SHADOW_FORMAT.into())], None),
            surface: drawn("ground_surface_fragment", &[Some(over())], SAMPLES),
            motion: drawn("ground_motion_fragment", &motion_alone(), 1),
            rest: drawn("ground_rest_fragment", &[Some(REST_FORMAT.into())], 1),
            target,
            layout,
            sampler,
            group,
        }
    }

    /// Takes another size of pictures.
    pub fn resize(&mut self, device: &wgpu::Device, size: (u32, u32)) {
        self.target = shadow_target(device, size);
        self.group = bind(device, &self.layout, &self.sampler, &self.target);
    }

    /// Records the pass that finds the shadow, after that of the maps; group 0 and they are given.
    pub fn shadow_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        maps: &wgpu::BindGroup,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("ground"),
            color_attachments: &[Some(layouts::cleared(&self.target.view, wgpu::Color::TRANSPARENT))],
            ..Default::default()
        });
        pass.set_bind_group(0, frame, &[]);
        pass.set_bind_group(1, maps, &[]);
        pass.set_pipeline(&self.shadow);
        pass.draw(0..4, 0..1);
    }

    /// Draws what is known of the ground in a pass over the scene, whose group 0 is bound, after what is before it.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, kind: Pass) {
        let pipeline = match kind {
            Pass::Surface => &self.surface,
            Pass::Geometry => &self.motion,
            Pass::Rest => &self.rest,
            // Of the ground itself there is nothing.
            Pass::Shadow | Pass::Depth | Pass::Layers | Pass::Control => return,
        };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        pass.draw(0..4, 0..1);
    }
}

/// Colours that are laid over others.
fn over() -> wgpu::ColorTargetState {
    wgpu::ColorTargetState {
        format: COLOR_FORMAT,
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    }
}

/// Of the geometry buffer, motion: normals, depths and numbers of objects would draw outlines around shadows.
fn motion_alone() -> [Option<wgpu::ColorTargetState>; 4] {
    let kept =
        |format| Some(wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::empty() });
    let [normal, depth, object_id] = [NORMAL_FORMAT, LINEAR_DEPTH_FORMAT, OBJECT_ID_FORMAT].map(kept);
    [normal, depth, object_id, Some(MOTION_FORMAT.into())]
}

fn shadow_target(device: &wgpu::Device, size: (u32, u32)) -> Target {
    Target::new(device, "ground shadow", SHADOW_FORMAT, 1, size)
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    sampler: &wgpu::Sampler,
    target: &Target,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("ground"),
        layout,
        entries: &[bind_view(0, &target.view), bind_sampler(1, sampler)],
    })
}

/// Makes a pipeline that draws the plane, where it is not hidden in passes with so many samples of depth.
fn pipeline(
    device: &wgpu::Device,
    [frame, own]: [&wgpu::BindGroupLayout; 2],
    (module, entry): (&wgpu::ShaderModule, &str),
    targets: &[Option<wgpu::ColorTargetState>],
    depth_samples: Option<u32>,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("ground"),
        bind_group_layouts: &[Some(frame), Some(own)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("ground"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("ground_vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: depth_samples.map(|_| behind_everything()),
        multisample: wgpu::MultisampleState { count: depth_samples.unwrap_or(1), ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(entry),
            compilation_options: Default::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
