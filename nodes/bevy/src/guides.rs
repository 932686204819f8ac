//! The guides of a look, from a camera's prepasses.
//!
//! Bevy's prepass has normals in the world's space, depth as it is tested, and motion in widths and heights of the viewport. A look has
//! them in the camera's space, as distances and in pixels, in its viewport alone.

use crate::shaders;
use isophote::engine::gpu::wgpu;
use wgpu::{TextureFormat, TextureSampleType};

/// The images that are written: the names that plans have for them, and their formats.
pub(crate) const IMAGES: [(&str, TextureFormat); 4] = [
    ("color", TextureFormat::Rgba16Float),
    ("normal", TextureFormat::Rgba16Float),
    ("depth", TextureFormat::R32Float),
    ("motion", TextureFormat::Rg32Float),
];

/// Side of a workgroup, as in the shader.
const SIDE: u32 = 8;

const SHADER: &str = include_str!("guides.wgsl");
const LABEL: &str = "isophote guides";

/// The uniform block.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct View {
    pub(crate) view_from_world: [[f32; 4]; 4],
    pub(crate) view_from_clip: [[f32; 4]; 4],
    /// In the target, in pixels: left, top, width and height.
    pub(crate) viewport: [i32; 4],
}

/// The camera's pictures as Bevy has them.
#[derive(Clone, Copy)]
pub(crate) struct Prepasses<'v> {
    pub(crate) color: &'v wgpu::TextureView,
    pub(crate) depth: Option<&'v wgpu::TextureView>,
    pub(crate) normal: Option<&'v wgpu::TextureView>,
    pub(crate) motion: Option<&'v wgpu::TextureView>,
}

impl Prepasses<'_> {
    fn views(&self) -> impl Iterator<Item = &wgpu::TextureView> {
        [self.depth, self.normal, self.motion].into_iter().flatten()
    }

    /// True where a pixel has several samples.
    pub(crate) fn is_multisampled(&self) -> bool {
        self.views().any(|view| view.texture().sample_count() > 1)
    }
}

/// The pass that writes guides, for prepasses of one kind.
#[derive(Debug)]
pub(crate) struct Pass {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    /// Stands for prepasses that a camera does not have; what is made of them is not read.
    nothing: [wgpu::TextureView; 2],
    is_multisampled: bool,
}

impl Pass {
    /// The pass for prepasses that are multisampled or not.
    pub(crate) fn new(device: &wgpu::Device, is_multisampled: bool) -> Self {
        let floats = shaders::texture(shaders::FLOATS, is_multisampled);
        let mut types = vec![
            shaders::UNIFORMS,
            shaders::texture(shaders::FLOATS, false),
            shaders::texture(TextureSampleType::Depth, is_multisampled),
            floats,
            floats,
        ];
        types.extend(IMAGES.map(|(_, format)| shaders::written(format)));
        let layout = shaders::layout(device, LABEL, wgpu::ShaderStages::COMPUTE, &types);
        let kind = if is_multisampled { "multisampled_2d" } else { "2d" };
        let types = format!("alias Depths = texture_depth_{kind};\nalias Vectors = texture_{kind}<f32>;\n");
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(LABEL),
            layout: Some(&shaders::pipeline_layout(device, LABEL, &layout)),
            module: &shaders::module(device, LABEL, types + SHADER),
            entry_point: Some("write_guides"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let nothing = [TextureFormat::Depth32Float, TextureFormat::Rgba16Float]
            .map(|format| nothing(device, format, is_multisampled));
        Self { pipeline, layout, nothing, is_multisampled }
    }

    /// True where the prepasses are of its kind.
    pub(crate) fn fits(&self, prepasses: &Prepasses) -> bool {
        prepasses.views().next().is_none() || prepasses.is_multisampled() == self.is_multisampled
    }

    /// Records the guides of a frame, into `targets`, which are those of [`IMAGES`]. `uniforms` holds the [`View`], whose viewport has this size.
    pub(crate) fn encode(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        uniforms: &wgpu::Buffer,
        prepasses: Prepasses,
        targets: &[&wgpu::TextureView],
        [width, height]: [u32; 2],
    ) {
        let [no_depth, no_vectors] = &self.nothing;
        let mut views = vec![
            prepasses.color,
            prepasses.depth.unwrap_or(no_depth),
            prepasses.normal.unwrap_or(no_vectors),
            prepasses.motion.unwrap_or(no_vectors),
        ];
        views.extend(targets);
        let group = shaders::group(device, &self.layout, uniforms, &views);
        let descriptor = wgpu::ComputePassDescriptor { label: Some(LABEL), timestamp_writes: None };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(width.div_ceil(SIDE), height.div_ceil(SIDE), 1);
    }
}

fn nothing(device: &wgpu::Device, format: TextureFormat, is_multisampled: bool) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(LABEL),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: if is_multisampled { 4 } else { 1 },
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

#[cfg(test)]
mod tests;
