//! The last pass of a frame: from scene-linear radiance to display light.

use glam::Vec4;

use crate::layouts::{self, bind_buffer, bind_view};
use crate::targets::{COLOR_FORMAT, Layers, Target, Targets};
use crate::{buffers, pipelines};

/// The pass with what it binds.
pub struct ToneMap {
    module: wgpu::ShaderModule,
    settings: wgpu::Buffer,
    color: Step,
    /// What makes light of surfaces such as displays show, where it is rendered.
    light: Option<Step>,
}

/// A shader with the targets that it reads.
struct Step {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
}

impl Step {
    /// Compiles the entry point `name`, which writes as many targets as are given and reads the textures `read` behind the settings.
    fn new(
        device: &wgpu::Device,
        module: &wgpu::ShaderModule,
        settings: &wgpu::Buffer,
        (name, targets): (&str, usize),
        read: &[&Target],
    ) -> Self {
        let sample = wgpu::TextureSampleType::Float { filterable: false };
        let textures = (1..=read.len()).map(|binding| layouts::texture(binding as u32, sample));
        let entries: Vec<_> =
            std::iter::once(layouts::uniform(0, wgpu::ShaderStages::FRAGMENT)).chain(textures).collect();
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(name),
            entries: &entries,
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let formats = vec![COLOR_FORMAT; targets];
        let pipeline = pipelines::full_screen(device, &pipeline_layout, module, name, &formats, None, 1);
        let bind_group = group(device, &layout, settings, read);
        Self { layout, pipeline, bind_group }
    }

    /// Reads other textures.
    fn bind(&mut self, device: &wgpu::Device, settings: &wgpu::Buffer, read: &[&Target]) {
        self.bind_group = group(device, &self.layout, settings, read);
    }

    /// Records the pass into these targets.
    fn encode(&self, encoder: &mut wgpu::CommandEncoder, written: &[&Target]) {
        let attachments: Vec<_> =
            written.iter().map(|target| Some(layouts::cleared(&target.view, wgpu::Color::BLACK))).collect();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tone map"),
            color_attachments: &attachments,
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    settings: &wgpu::Buffer,
    read: &[&Target],
) -> wgpu::BindGroup {
    let textures = (1..).zip(read).map(|(binding, target)| bind_view(binding, &target.view));
    let entries: Vec<_> = std::iter::once(bind_buffer(0, settings)).chain(textures).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("tone map"),
        layout,
        entries: &entries,
    })
}

impl ToneMap {
    /// Compiles the shader and binds the targets.
    pub fn new(device: &wgpu::Device, targets: &Targets) -> Self {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("tone map"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../shaders/tone_map.wgsl").into()),
        });
        let settings = buffers::filled_buffer(device, "tone map", &[0; 32], wgpu::BufferUsages::UNIFORM);
        let color = Step::new(device, &module, &settings, ("tone_map", 1), &[&targets.radiance]);
        Self { module, settings, color, light: None }
    }

    /// Binds targets of another size, or more of them.
    pub fn bind(&mut self, device: &wgpu::Device, targets: &Targets) {
        self.color.bind(device, &self.settings, &[&targets.radiance]);
        if let Some(Layers { diffuse, specular, displayed: Some(_), .. }) = &targets.layers {
            let (read, settings) = ([&targets.radiance, diffuse, specular], &self.settings);
            match &mut self.light {
                Some(light) => light.bind(device, settings, &read),
                None => {
                    let made = Step::new(device, &self.module, settings, ("tone_map_light", 2), &read);
                    self.light = Some(made);
                }
            }
        }
    }

    /// Sets from the next frame on the factor on the radiance, and what is behind its transparent parts
    /// (premultiplied display light), if it may have any.
    pub fn set(&self, queue: &wgpu::Queue, exposure: f32, behind: Option<Vec4>) {
        let has_transparent = if behind.is_some() { 1.0 } else { 0.0 };
        let block = [Vec4::new(exposure, has_transparent, 0.0, 0.0), behind.unwrap_or_default()];
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&block));
    }

    /// Records the pass from radiance to colour, and that of light where it is rendered.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets) {
        self.color.encode(encoder, &[&targets.color]);
        let displayed = targets.layers.as_ref().and_then(|layers| layers.displayed.as_ref());
        if let (Some(light), Some([diffuse, specular])) = (&self.light, displayed) {
            light.encode(encoder, &[diffuse, specular]);
        }
    }
}
