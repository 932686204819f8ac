//! The shadow of a model on an invisible ground. It darkens colours only: the geometry buffer, and with it every
//! guide of the styles, knows nothing of it.

use glam::{Vec3, Vec4};

use crate::layouts::Layouts;
use crate::lighting::Lighting;
use crate::pipelines::{SCENE, behind_everything, module};
use crate::targets::{COLOR_FORMAT, SAMPLES};
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

/// Makes the pipeline that draws the plane over what is behind it.
pub fn pipeline(device: &wgpu::Device, layouts: &Layouts) -> wgpu::RenderPipeline {
    let module = module(device, "ground", &[SCENE, include_str!("../shaders/ground.wgsl")]);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("ground"),
        bind_group_layouts: &[Some(&layouts.frame), Some(&layouts.shadow)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("ground"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("ground_vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: Some(behind_everything()),
        multisample: wgpu::MultisampleState { count: SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("ground_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: COLOR_FORMAT,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
