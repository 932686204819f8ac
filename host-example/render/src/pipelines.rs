//! Render pipelines, made when a scene first needs them and kept.

use std::collections::HashMap;

use crate::layouts::Layouts;
use crate::targets::{
    COLOR_FORMAT, CONTROL_FORMAT, DEPTH_FORMAT, LINEAR_DEPTH_FORMAT, MOTION_FORMAT, NORMAL_FORMAT,
    OBJECT_ID_FORMAT, REST_FORMAT, SAMPLES,
};
use isophote_scene::model::NEUTRAL;
use isophote_scene::{AlphaMode, Material, Vertex};

/// The passes over the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Depth as the sun sees it.
    Shadow,
    /// Depth of opaque draws alone, so that the colours of each pixel are computed once.
    Depth,
    /// Colours.
    Surface,
    /// The geometry buffer.
    Geometry,
    /// Rest positions.
    Rest,
    /// Control maps.
    Control,
    /// Colours of surfaces and their light.
    Layers,
}

impl Pass {
    /// True where surfaces are shaded, and what is transparent is blended.
    fn is_seen(self) -> bool {
        matches!(self, Self::Surface | Self::Layers)
    }

    /// Values of the geometry buffer where there is no surface.
    pub fn nothing(self) -> wgpu::Color {
        match self {
            Self::Control => {
                let [r, g, b, a] = NEUTRAL.map(f64::from);
                wgpu::Color { r, g, b, a }
            }
            _ => wgpu::Color::TRANSPARENT,
        }
    }
}

/// Properties that distinguish the pipelines of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// The pass.
    pub pass: Pass,
    /// 0 opaque, 1 mask, 2 blend.
    pub alpha: u8,
    /// Shows backs.
    pub double_sided: bool,
    /// The transform mirrors, so that front faces run clockwise.
    pub mirrored: bool,
}

impl Variant {
    /// The variant that draws a material, with no distinctions that the pass does not make.
    pub fn new(pass: Pass, material: &Material, mirrored: bool) -> Self {
        let alpha = match material.alpha_mode {
            AlphaMode::Opaque => 0,
            AlphaMode::Mask { .. } => 1,
            AlphaMode::Blend => 2,
        };
        match pass {
            Pass::Depth => Self { pass, alpha: 0, double_sided: material.double_sided, mirrored },
            Pass::Shadow => Self { pass, alpha: alpha.min(1), double_sided: true, mirrored: false },
            Pass::Geometry | Pass::Rest | Pass::Control => {
                Self { pass, alpha: alpha.min(1), double_sided: material.double_sided, mirrored }
            }
            Pass::Surface | Pass::Layers => {
                Self { pass, alpha, double_sided: material.double_sided, mirrored }
            }
        }
    }
}

/// Shaders, layouts and the pipelines made so far.
#[derive(Debug)]
pub struct Pipelines {
    layout: wgpu::PipelineLayout,
    shadow_layout: wgpu::PipelineLayout,
    control_layout: wgpu::PipelineLayout,
    surface: wgpu::ShaderModule,
    geometry: wgpu::ShaderModule,
    shadow: wgpu::ShaderModule,
    made: HashMap<Variant, wgpu::RenderPipeline>,
    /// Draws the sky.
    pub background: wgpu::RenderPipeline,
}

/// Beginning of every shader of the scene.
pub const SCENE: &str = include_str!("../shaders/scene.wgsl");
const MATERIAL: &str = include_str!("../shaders/material.wgsl");
const SKY: &str = include_str!("../shaders/sky.wgsl");

/// The parts of the shader of the sky behind everything.
pub const BACKGROUND_PARTS: [&str; 3] = [SCENE, SKY, include_str!("../shaders/background.wgsl")];

/// Compiles a shader from its parts.
pub fn module(device: &wgpu::Device, label: &str, parts: &[&str]) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(parts.concat().into()),
    })
}

/// Depth of what is drawn where nothing is yet.
pub fn behind_everything() -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(false),
        // Depth is reversed.
        depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
        stencil: Default::default(),
        bias: Default::default(),
    }
}

impl Pipelines {
    /// Compiles the shaders.
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let module = |label, parts: &[&str]| module(device, label, parts);
        let pipeline_layout = |label, groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let scene = [Some(&layouts.frame), Some(&layouts.geometry), Some(&layouts.material)];
        let background = module("background", &BACKGROUND_PARTS);
        let background_layout = pipeline_layout("background", &scene[..1]);
        Self {
            layout: pipeline_layout("scene", &[scene[0], scene[1], scene[2], Some(&layouts.shadow)]),
            shadow_layout: pipeline_layout("shadow", &[scene[0], scene[1], scene[2], Some(&layouts.cascade)]),
            control_layout: pipeline_layout(
                "control",
                &[scene[0], scene[1], scene[2], Some(&layouts.control)],
            ),
            surface: module("surface", &[SCENE, MATERIAL, SKY, include_str!("../shaders/surface.wgsl")]),
            geometry: module(
                "geometry buffer",
                &[SCENE, MATERIAL, include_str!("../shaders/geometry_buffer.wgsl")],
            ),
            shadow: module("shadow", &[SCENE, MATERIAL, include_str!("../shaders/shadow.wgsl")]),
            background: full_screen(
                device,
                &background_layout,
                &background,
                "background",
                &[COLOR_FORMAT],
                Some(behind_everything()),
                SAMPLES,
            ),
            made: HashMap::new(),
        }
    }

    /// Makes a pipeline unless it is there.
    pub fn prepare(&mut self, device: &wgpu::Device, variant: Variant) {
        if !self.made.contains_key(&variant) {
            let pipeline = self.make(device, variant);
            self.made.insert(variant, pipeline);
        }
    }

    /// A pipeline that was prepared.
    pub fn get(&self, variant: Variant) -> Option<&wgpu::RenderPipeline> {
        self.made.get(&variant)
    }

    /// Shaders that a pass runs, and targets that it writes.
    fn stage(&self, variant: Variant) -> Stage<'_> {
        let target = |format, blend| {
            Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
        };
        // The pass has a colour target all the same.
        let untouched = Some(wgpu::ColorTargetState {
            format: COLOR_FORMAT,
            blend: None,
            write_mask: wgpu::ColorWrites::empty(),
        });
        let blend = (variant.alpha == 2).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        let alpha_mode = vec![("ALPHA_MODE", f64::from(variant.alpha))];
        let cutout = vec![("CUTOUT", f64::from(variant.alpha))];
        match variant.pass {
            Pass::Shadow => (&self.shadow, "shadow", vec![], vec![]),
            Pass::Depth => (&self.surface, "depth", vec![untouched], alpha_mode),
            Pass::Surface => (&self.surface, "surface", vec![target(COLOR_FORMAT, blend)], alpha_mode),
            Pass::Geometry => {
                let formats = [NORMAL_FORMAT, LINEAR_DEPTH_FORMAT, OBJECT_ID_FORMAT, MOTION_FORMAT];
                (&self.geometry, "geometry", formats.map(|f| target(f, None)).to_vec(), cutout)
            }
            Pass::Rest => (&self.geometry, "rest", vec![target(REST_FORMAT, None)], cutout),
            Pass::Control => (&self.geometry, "control", vec![target(CONTROL_FORMAT, None)], cutout),
            Pass::Layers => {
                let layers = [COLOR_FORMAT; 3].map(|f| target(f, blend)).to_vec();
                (&self.surface, "layers", layers, alpha_mode)
            }
        }
    }

    fn make(&self, device: &wgpu::Device, variant: Variant) -> wgpu::RenderPipeline {
        let attributes = wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x4, 3 => Float32x2, 4 => Float32x2, 5 => Float32x4
        ];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        })];
        let (module, name, targets, constants) = self.stage(variant);
        let in_shadow = variant.pass == Pass::Shadow;
        let multisampled = matches!(variant.pass, Pass::Depth | Pass::Surface | Pass::Layers);
        let no_fragments = in_shadow && variant.alpha == 0;
        let has_holes = variant.pass.is_seen() && variant.alpha == 1;
        // Layers are of the same surfaces.
        let vertices = if variant.pass == Pass::Layers { "surface" } else { name };
        let vertex_entry = format!("{vertices}_vertex");
        let fragment_entry = format!("{name}_{}fragment", if has_holes { "holed_" } else { "" });
        // Constants may only be given to stages whose module declares them, and the vertex stage shares it.
        let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(name),
            layout: Some(match variant.pass {
                Pass::Shadow => &self.shadow_layout,
                Pass::Control => &self.control_layout,
                _ => &self.layout,
            }),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(&vertex_entry),
                compilation_options: options.clone(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState {
                front_face: if variant.mirrored { wgpu::FrontFace::Cw } else { wgpu::FrontFace::Ccw },
                cull_mode: (!variant.double_sided).then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(depth_state(variant)),
            multisample: wgpu::MultisampleState {
                count: if multisampled { SAMPLES } else { 1 },
                ..Default::default()
            },
            fragment: (!no_fragments).then_some(wgpu::FragmentState {
                module,
                entry_point: Some(&fragment_entry),
                compilation_options: options,
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// Module, name, targets and constants of a pass.
type Stage<'a> =
    (&'a wgpu::ShaderModule, &'static str, Vec<Option<wgpu::ColorTargetState>>, Vec<(&'static str, f64)>);

/// Depth is reversed but in shadow maps.
fn depth_state(variant: Variant) -> wgpu::DepthStencilState {
    let in_shadow = variant.pass == Pass::Shadow;
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(!variant.pass.is_seen() || variant.alpha < 2),
        depth_compare: Some(if in_shadow {
            wgpu::CompareFunction::Less
        } else {
            // Depth is reversed, and may be there already.
            wgpu::CompareFunction::GreaterEqual
        }),
        stencil: Default::default(),
        bias: if in_shadow {
            wgpu::DepthBiasState { constant: 1, slope_scale: 1.5, clamp: 0.0 }
        } else {
            Default::default()
        },
    }
}

/// A pipeline that covers its target with one triangle; entry points are `<name>_vertex` and
/// `<name>_fragment`.
pub fn full_screen(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    name: &str,
    formats: &[wgpu::TextureFormat],
    depth_stencil: Option<wgpu::DepthStencilState>,
    samples: u32,
) -> wgpu::RenderPipeline {
    let targets: Vec<_> = formats.iter().map(|format| Some((*format).into())).collect();
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(&format!("{name}_vertex")),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil,
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(&format!("{name}_fragment")),
            compilation_options: Default::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
