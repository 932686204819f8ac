//! Uploading of images with their smaller copies, and of samplers.

use std::collections::HashMap;

use isophote_files::error::{Error, Result};
use isophote_scene::material::Wrap;
use isophote_scene::{ColorSpace, Sampler, Scene, TextureUse};

/// Textures and samplers of a scene, each made once however often it is used.
pub struct TextureStore {
    mipmaps: Mipmaps,
    views: HashMap<(usize, ColorSpace), wgpu::TextureView>,
    samplers: HashMap<Sampler, wgpu::Sampler>,
    blank: wgpu::TextureView,
}

impl TextureStore {
    /// An empty store.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let mipmaps = Mipmaps::new(device);
        let blank = mipmaps.upload(device, queue, 1, 1, &[255; 4], ColorSpace::Linear);
        Self { mipmaps, views: HashMap::new(), samplers: HashMap::new(), blank }
    }

    /// The texture and sampler of a use, or blank ones.
    ///
    /// # Errors
    /// [`Error::Input`] for images beyond the limit of the device.
    pub fn get(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        use_: Option<TextureUse>,
        space: ColorSpace,
    ) -> Result<(wgpu::TextureView, wgpu::Sampler)> {
        let texture = use_.and_then(|u| scene.textures.get(u.texture));
        let sampler = texture.map_or_else(Sampler::default, |t| t.sampler);
        let sampler = self.samplers.entry(sampler).or_insert_with(|| make_sampler(device, sampler)).clone();
        let Some(index) = texture.and_then(|t| t.image) else { return Ok((self.blank.clone(), sampler)) };
        if let Some(view) = self.views.get(&(index, space)) {
            return Ok((view.clone(), sampler));
        }
        let image = &scene.images[index];
        let most = device.limits().max_texture_dimension_2d;
        if image.width > most || image.height > most {
            return Err(Error::input(
                format!("texture {}", image.name),
                format!("is {}x{}, more than this device takes", image.width, image.height),
                format!("scale it to at most {most} pixels a side"),
            ));
        }
        let view = self.mipmaps.upload(device, queue, image.width, image.height, &image.rgba, space);
        self.views.insert((index, space), view.clone());
        Ok((view, sampler))
    }
}

fn make_sampler(device: &wgpu::Device, sampler: Sampler) -> wgpu::Sampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let filter = |linear| if linear { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    // Surfaces seen at a slant would blur without; allowed only with linear filters throughout. Software
    // drivers walk over every texel under a pixel for it, which can take minutes a frame.
    let hardware = device.adapter_info().device_type != wgpu::DeviceType::Cpu;
    let anisotropic = hardware && sampler.linear_mag && sampler.linear_min && sampler.mipmaps;
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("material"),
        address_mode_u: wrap(sampler.wrap_u),
        address_mode_v: wrap(sampler.wrap_v),
        mag_filter: filter(sampler.linear_mag),
        min_filter: filter(sampler.linear_min),
        mipmap_filter: if sampler.mipmaps {
            wgpu::MipmapFilterMode::Linear
        } else {
            wgpu::MipmapFilterMode::Nearest
        },
        lod_max_clamp: if sampler.mipmaps { 32.0 } else { 0.0 },
        anisotropy_clamp: if anisotropic { 8 } else { 1 },
        ..Default::default()
    })
}

/// Makes the smaller copies of textures. Rendering them lets the device decode sRGB, so that means are taken
/// of light and not of its encoding.
struct Mipmaps {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    srgb: wgpu::RenderPipeline,
    linear: wgpu::RenderPipeline,
}

impl Mipmaps {
    fn new(device: &wgpu::Device) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("mipmap"),
            entries: &[
                super::layouts::texture(0, wgpu::TextureSampleType::Float { filterable: true }),
                super::layouts::sampler(1, wgpu::SamplerBindingType::Filtering),
            ],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("mipmap"),
            source: wgpu::ShaderSource::Wgsl(include_str!("../shaders/mipmap.wgsl").into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("mipmap"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |format| {
            super::pipelines::full_screen(device, &pipeline_layout, &module, "mipmap", &[format], None, 1)
        };
        Self {
            srgb: pipeline(wgpu::TextureFormat::Rgba8UnormSrgb),
            linear: pipeline(wgpu::TextureFormat::Rgba8Unorm),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("mipmap"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            layout,
        }
    }

    fn upload(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        width: u32,
        height: u32,
        rgba: &[u8],
        space: ColorSpace,
    ) -> wgpu::TextureView {
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let levels = width.max(height).ilog2() + 1;
        let (format, pipeline) = match space {
            ColorSpace::Srgb => (wgpu::TextureFormat::Rgba8UnormSrgb, &self.srgb),
            ColorSpace::Linear => (wgpu::TextureFormat::Rgba8Unorm, &self.linear),
        };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("material"),
            size,
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * 4),
            rows_per_image: Some(height),
        };
        queue.write_texture(texture.as_image_copy(), rgba, layout, size);
        queue.submit([self.fill_levels(device, &texture, pipeline)]);
        texture.create_view(&Default::default())
    }

    /// Draws each level of the texture from the one above.
    fn fill_levels(
        &self,
        device: &wgpu::Device,
        texture: &wgpu::Texture,
        pipeline: &wgpu::RenderPipeline,
    ) -> wgpu::CommandBuffer {
        let level_view = |level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        let mut encoder = device.create_command_encoder(&Default::default());
        for level in 1..texture.mip_level_count() {
            let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("mipmap"),
                layout: &self.layout,
                entries: &[
                    super::layouts::bind_view(0, &level_view(level - 1)),
                    super::layouts::bind_sampler(1, &self.sampler),
                ],
            });
            let target = level_view(level);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("mipmap"),
                color_attachments: &[Some(super::layouts::cleared(&target, wgpu::Color::TRANSPARENT))],
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
        encoder.finish()
    }
}
