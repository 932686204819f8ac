//! The last pass of a frame: from scene-linear radiance to display light.

use glam::Vec4;

use crate::layouts::{self, bind_buffer, bind_view};
use crate::targets::{COLOR_FORMAT, Targets};
use crate::{buffers, pipelines};

/// The pass with what it binds.
pub struct ToneMap {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    settings: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
}

impl ToneMap {
    /// Compiles the shader and binds the targets.
    pub fn new(device: &wgpu::Device, targets: &Targets) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tone map"),
            entries: &[
                layouts::texture(0, wgpu::TextureSampleType::Float { filterable: false }),
                layouts::uniform(1, wgpu::ShaderStages::FRAGMENT),
            ],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("tone map"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../shaders/tone_map.wgsl").into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("tone map"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline =
            pipelines::full_screen(device, &pipeline_layout, &module, "tone_map", COLOR_FORMAT, None, 1);
        let settings = buffers::filled_buffer(device, "tone map", &[0; 32], wgpu::BufferUsages::UNIFORM);
        let bind_group = Self::group(device, &layout, &settings, targets);
        Self { layout, pipeline, settings, bind_group }
    }

    fn group(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        settings: &wgpu::Buffer,
        targets: &Targets,
    ) -> wgpu::BindGroup {
        device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tone map"),
            layout,
            entries: &[bind_view(0, &targets.radiance.view), bind_buffer(1, settings)],
        })
    }

    /// Binds targets of another size.
    pub fn bind(&mut self, device: &wgpu::Device, targets: &Targets) {
        self.bind_group = Self::group(device, &self.layout, &self.settings, targets);
    }

    /// Sets from the next frame on the factor on the radiance, and what is behind its transparent parts
    /// (premultiplied display light), if it may have any.
    pub fn set(&self, queue: &wgpu::Queue, exposure: f32, behind: Option<Vec4>) {
        let has_transparent = if behind.is_some() { 1.0 } else { 0.0 };
        let block = [Vec4::new(exposure, has_transparent, 0.0, 0.0), behind.unwrap_or_default()];
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&block));
    }

    /// Records the pass from radiance to colour.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone map"),
            color_attachments: &[Some(layouts::cleared(&targets.color.view, wgpu::Color::BLACK))],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}
