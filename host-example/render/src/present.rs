//! Presentation: the pass that puts the picture of a frame on a window.

use crate::layouts::{self, bind_view};
use crate::pipelines;

/// The pass, with the picture that it binds.
#[derive(Debug)]
pub struct Present {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    bound: Option<(wgpu::TextureView, wgpu::BindGroup)>,
}

impl Present {
    /// Compiles the pass for surfaces of `format` and pictures like `picture`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat, picture: &wgpu::TextureView) -> Self {
        let is_grey = picture.texture().format() == wgpu::TextureFormat::R32Float;
        let constants = format!("const IS_GREY = {is_grey};\nconst WANTS_ENCODED = {};\n", !format.is_srgb());
        let module =
            pipelines::module(device, "present", &[&constants, include_str!("../shaders/present.wgsl")]);
        let sampled = wgpu::TextureSampleType::Float { filterable: false };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("present"),
            entries: &[layouts::texture(0, sampled)],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("present"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline =
            pipelines::full_screen(device, &pipeline_layout, &module, "present", &[format], None, 1);
        Self { layout, pipeline, bound: None }
    }

    /// Records it: `picture` on all of `surface`.
    pub fn encode(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        surface: &wgpu::TextureView,
    ) {
        if self.bound.as_ref().is_none_or(|(bound, _)| bound != picture) {
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("present"),
                layout: &self.layout,
                entries: &[bind_view(0, picture)],
            });
            self.bound = Some((picture.clone(), group));
        }
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("present"),
            color_attachments: &[Some(layouts::cleared(surface, wgpu::Color::BLACK))],
            ..Default::default()
        });
        if let Some((_, group)) = &self.bound {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
