//! The pass that puts pictures on the window: one or two, before and after, wherever pan and zoom have them.

use crate::state::viewport::Area;
use isophote_render::layouts::{self, bind_buffer, bind_view};
use isophote_render::{buffers, pipelines};

/// Meaning of the numbers of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Linear light, Rec.709.
    Linear,
    /// Gamma-encoded sRGB.
    Srgb,
    /// Linear light, AP1.
    AcesCg,
    /// One channel of grey, encoded for a display.
    Grey,
    /// View-space normals.
    Normal,
    /// Distances.
    Depth,
    /// Numbers of objects.
    ObjectId,
    /// Pixels to somewhere else.
    Motion,
}

/// A picture on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// The picture.
    pub view: &'a wgpu::TextureView,
    /// Meaning of its numbers.
    pub numbers: Numbers,
    /// Area where it lies.
    pub place: Area,
}

/// Reading of pictures: what becomes of their pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// They are seen, over squares where they are transparent.
    Seen,
    /// Their difference is seen in the place of both, times a factor.
    Difference(f32),
    /// Single pixels are taken, with their alpha beside colour.
    Samples,
}

/// Arrangement of pictures on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Arrangement<'a> {
    /// The part of the window that is the canvas.
    pub area: Area,
    /// The picture on the left of the split, and the one on its right.
    pub pictures: [Shown<'a>; 2],
    /// Column of the window at which the right one begins.
    pub split: f32,
    /// Factor on light.
    pub exposure: f32,
    /// The distance that is shown as half grey.
    pub middle: f32,
    /// Side of the squares behind transparent pictures.
    pub square: f32,
    /// Reading of the pictures.
    pub reading: Reading,
}

/// Grey that surrounds pictures, gamma-encoded.
pub const SURROUND: f32 = 0.105;

/// The pass with what it binds.
pub struct Canvas {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    settings: wgpu::Buffer,
    bound: Option<([wgpu::TextureView; 2], wgpu::BindGroup)>,
    encode: u32,
}

impl Canvas {
    /// Compiles the pass for surfaces of `format`.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let picture = wgpu::TextureSampleType::Float { filterable: false };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("canvas"),
            entries: &[
                layouts::uniform(0, wgpu::ShaderStages::FRAGMENT),
                layouts::texture(1, picture),
                layouts::texture(2, picture),
            ],
        });
        let module = pipelines::module(device, "canvas", &[include_str!("../../shaders/canvas.wgsl")]);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("canvas"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline =
            pipelines::full_screen(device, &pipeline_layout, &module, "canvas", &[format], None, 1);
        let usage = wgpu::BufferUsages::UNIFORM;
        let settings = buffers::filled_buffer(device, "canvas", &[0; 24 * 4], usage);
        Self { layout, pipeline, settings, bound: None, encode: u32::from(!format.is_srgb()) }
    }

    /// Changes what is drawn from now on.
    pub fn set(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, arrangement: &Arrangement<'_>) {
        let Arrangement { area, pictures: [left, right], split, exposure, middle, square, reading } =
            arrangement;
        let place = |area: &Area| [area.x, area.y, area.width.max(1e-3), area.height.max(1e-3)];
        let (reading, factor) = match *reading {
            Reading::Seen => (0, 1.0),
            Reading::Difference(factor) => (1, factor),
            Reading::Samples => (2, 1.0),
        };
        let kinds = [left.numbers as u32, right.numbers as u32, self.encode, reading];
        let words: Vec<u32> = [place(area), place(&left.place), place(&right.place)]
            .concat()
            .into_iter()
            .map(f32::to_bits)
            .chain(kinds)
            .chain([*split, *exposure, middle.max(1e-6), square.max(1.0)].map(f32::to_bits))
            .chain([SURROUND, SURROUND, SURROUND, factor].map(f32::to_bits))
            .collect();
        queue.write_buffer(&self.settings, 0, bytemuck::cast_slice(&words));
        if self.bound.as_ref().is_none_or(|(views, _)| views[0] != *left.view || views[1] != *right.view) {
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("canvas"),
                layout: &self.layout,
                entries: &[bind_buffer(0, &self.settings), bind_view(1, left.view), bind_view(2, right.view)],
            });
            self.bound = Some(([left.view.clone(), right.view.clone()], group));
        }
    }

    /// Draws what was set, or nothing.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, area: Area, surface: (u32, u32)) {
        let Some((_, group)) = &self.bound else { return };
        let (x, y) = (area.x.max(0.0) as u32, area.y.max(0.0) as u32);
        let (width, height) = (area.width as u32, area.height as u32);
        let (width, height) =
            (width.min(surface.0.saturating_sub(x)), height.min(surface.1.saturating_sub(y)));
        if width == 0 || height == 0 {
            return;
        }
        pass.set_scissor_rect(x, y, width, height);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
