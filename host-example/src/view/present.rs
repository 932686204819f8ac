//! The last pass of the viewer: a finished picture onto the window's surface.

use crate::loader::catalogue::Kind;
use crate::render::layouts::{self, bind_buffer, bind_view};
use crate::render::{buffers, pipelines};

const GREY: u32 = 1;
const ENCODE: u32 = 2;

/// The pass with what it binds.
pub struct Present {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    settings: wgpu::Buffer,
    bind_group: Option<wgpu::BindGroup>,
    encode: u32,
}

impl Present {
    /// Compiles the pass for surfaces of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("present"),
            entries: &[
                layouts::texture(0, wgpu::TextureSampleType::Float { filterable: false }),
                layouts::uniform(1, wgpu::ShaderStages::FRAGMENT),
            ],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("present"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../../shaders/present.wgsl").into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("present"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = pipelines::full_screen(device, &pipeline_layout, &module, "present", format, None, 1);
        let settings = buffers::filled_buffer(device, "present", &[0; 16], wgpu::BufferUsages::UNIFORM);
        let encode = if format.is_srgb() { 0 } else { ENCODE };
        Self { layout, pipeline, settings, bind_group: None, encode }
    }

    /// Shows `picture` from now on: linear light, or grey values.
    pub fn bind(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        picture: &wgpu::TextureView,
        kind: Kind,
    ) {
        let grey = if kind == Kind::Scalar { GREY } else { 0 };
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&[grey | self.encode, 0, 0, 0]));
        self.bind_group = Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("present"),
            layout: &self.layout,
            entries: &[bind_view(0, picture), bind_buffer(1, &self.settings)],
        }));
    }

    /// Records the pass onto `surface`.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, surface: &wgpu::TextureView) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(layouts::cleared(surface, wgpu::Color::BLACK))],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}
