//! Background: what is seen where no surface is.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use crate::layouts::{self, Layouts, bind_sampler, bind_view};
use crate::pipelines::{BACKGROUND_PARTS, behind_everything, full_screen, module};
use crate::targets::{COLOR_FORMAT, SAMPLES};
use isophote_files::error::{Error, Result};
use isophote_scene::environment::Environment;

/// Background of a scene.
#[derive(Clone, Debug, Default)]
pub enum Background {
    /// The sky that lights it.
    #[default]
    Sky,
    /// Nothing: alpha is 0 there.
    Transparent,
    /// One colour, linear Rec.709, shown as it is and not tone-mapped.
    Color(Vec3),
    /// A picture of the surroundings.
    Environment(Arc<Environment>),
}

impl Background {
    /// The picture of the surroundings, if it is one.
    pub fn environment(&self) -> Option<&Environment> {
        match self {
            Self::Environment(environment) => Some(environment),
            _ => None,
        }
    }
}

/// A background on the GPU.
pub struct Backdrop {
    /// Colour that pictures begin with.
    pub clear: wgpu::Color,
    /// Colour that is put behind them after tone mapping, premultiplied, where they have transparent parts.
    pub behind: Option<Vec4>,
    drawn: Drawn,
}

/// Backdrop that is drawn behind everything.
enum Drawn {
    Nothing,
    Sky,
    Environment(wgpu::RenderPipeline, wgpu::BindGroup),
}

impl Backdrop {
    /// The sky.
    pub fn sky() -> Self {
        Self { clear: wgpu::Color::BLACK, behind: None, drawn: Drawn::Sky }
    }

    /// Any background. Where colours are wanted before tone mapping, a colour is among them.
    ///
    /// # Errors
    /// [`Error::Input`] for pictures beyond the limits of the device.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layouts: &Layouts,
        background: &Background,
        scene_referred: bool,
    ) -> Result<Self> {
        let clear = wgpu::Color::TRANSPARENT;
        Ok(match background {
            Background::Sky => Self::sky(),
            Background::Transparent => Self { clear, behind: Some(Vec4::ZERO), drawn: Drawn::Nothing },
            Background::Color(color) if scene_referred => {
                let [r, g, b] = color.to_array().map(f64::from);
                Self { clear: wgpu::Color { r, g, b, a: 1.0 }, behind: None, drawn: Drawn::Nothing }
            }
            Background::Color(color) => {
                Self { clear, behind: Some(color.extend(1.0)), drawn: Drawn::Nothing }
            }
            Background::Environment(environment) => {
                Self { drawn: surroundings(device, queue, layouts, environment)?, ..Self::sky() }
            }
        })
    }

    /// Draws it where nothing is yet, the sky with the pipeline that is given.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, sky: &wgpu::RenderPipeline) {
        match &self.drawn {
            Drawn::Nothing => return,
            Drawn::Sky => pass.set_pipeline(sky),
            Drawn::Environment(pipeline, group) => {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(1, group, &[]);
            }
        }
        pass.draw(0..3, 0..1);
    }
}

/// Uploads a picture of the surroundings and makes the pipeline that shows it.
fn surroundings(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    layouts: &Layouts,
    environment: &Environment,
) -> Result<Drawn> {
    let most = device.limits().max_texture_dimension_2d;
    if environment.width > most {
        return Err(Error::input(
            "--background",
            format!("is {} pixels wide, more than this device takes", environment.width),
            format!("scale it to at most {most} pixels"),
        ));
    }
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("environment"),
        entries: &[
            layouts::texture(0, wgpu::TextureSampleType::Float { filterable: true }),
            layouts::sampler(1, wgpu::SamplerBindingType::Filtering),
        ],
    });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("environment"),
        bind_group_layouts: &[Some(&layouts.frame), Some(&layout)],
        immediate_size: 0,
    });
    let [scene, sky, background] = BACKGROUND_PARTS;
    let parts = [scene, sky, background, include_str!("../shaders/environment.wgsl")];
    let module = module(device, "environment", &parts);
    let depth = Some(behind_everything());
    let pipeline =
        full_screen(device, &pipeline_layout, &module, "environment", &[COLOR_FORMAT], depth, SAMPLES);
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("environment"),
        // The left edge meets the right one.
        address_mode_u: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let texture = upload(device, queue, environment);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("environment"),
        layout: &layout,
        entries: &[bind_view(0, &texture.create_view(&Default::default())), bind_sampler(1, &sampler)],
    });
    Ok(Drawn::Environment(pipeline, group))
}

/// Rows that are uploaded at once, so that no copy is larger than the devices' buffers.
const ROWS: u32 = 256;

fn upload(device: &wgpu::Device, queue: &wgpu::Queue, environment: &Environment) -> wgpu::Texture {
    let Environment { width, height, pixels, .. } = environment;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("environment"),
        size: wgpu::Extent3d { width: *width, height: *height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: COLOR_FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (strip, rows) in pixels.chunks((ROWS * width * 4).max(4) as usize).enumerate() {
        let height = rows.len() as u32 / (width * 4);
        let origin = wgpu::Origin3d { x: 0, y: strip as u32 * ROWS, z: 0 };
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() },
            bytemuck::cast_slice(rows),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 8), rows_per_image: None },
            wgpu::Extent3d { width: *width, height, depth_or_array_layers: 1 },
        );
    }
    texture
}
