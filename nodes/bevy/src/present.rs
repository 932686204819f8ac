//! The stylized picture back in the camera's target.

use crate::shaders;
use isophote::engine::gpu::wgpu;

const LABEL: &str = "isophote present";

/// The pass that writes the picture, for targets of one format.
#[derive(Debug)]
pub(crate) struct Pass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    format: wgpu::TextureFormat,
}

impl Pass {
    /// The pass for targets of a format.
    pub(crate) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let floats = shaders::texture(shaders::FLOATS, false);
        let types = [shaders::UNIFORMS, floats, floats];
        let layout = shaders::layout(device, LABEL, wgpu::ShaderStages::FRAGMENT, &types);
        let module = shaders::module(device, LABEL, include_str!("present.wgsl").into());
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(LABEL),
            layout: Some(&shaders::pipeline_layout(device, LABEL, &layout)),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("cover_target"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("present"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { pipeline, layout, format }
    }

    /// True for targets of its format.
    pub(crate) fn fits(&self, format: wgpu::TextureFormat) -> bool {
        self.format == format
    }

    /// Records the picture: `stylized` in the viewport that `uniforms` holds, and `plain` around it.
    pub(crate) fn encode(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        uniforms: &wgpu::Buffer,
        [plain, stylized]: [&wgpu::TextureView; 2],
        target: &wgpu::TextureView,
    ) {
        let group = shaders::group(device, &self.layout, uniforms, &[plain, stylized]);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(LABEL),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            depth_stencil_attachment: None,
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
