//! Pixels on their way to textures and back.

use crate::image::{Image, Rect};
use crate::plan::Plan;
use crate::program::{Format, Program, Texture};
use half::f16;
use half::slice::HalfFloatSliceExt;

/// Rows of an image in the format of a texture; what the image lacks is 0.
pub(super) struct RowWriter<'i> {
    image: &'i Image,
    window: Rect,
    format: Format,
    texels: Vec<f32>,
    halves: Vec<f16>,
}

impl<'i> RowWriter<'i> {
    /// Rows of an image for a texture.
    pub fn new(image: &'i Image, texture: &Texture) -> Self {
        let len = texture.window.width() as usize * texture.format.channels() as usize;
        let (texels, halves) = (vec![0.0; len], vec![f16::ZERO; len]);
        Self { image, window: texture.window, format: texture.format, texels, halves }
    }

    /// The bytes of a row.
    pub fn row(&mut self, y: i32) -> &[u8] {
        let (channels, stored) = (self.image.channels() as usize, self.format.channels() as usize);
        let first = (self.window.x0 - self.image.window().x0) as usize * channels;
        let row = &self.image.row(y)[first..first + self.window.width() as usize * channels];
        let is_half = self.format.sample() == 2;
        if channels == stored && !is_half {
            return bytemuck::cast_slice(row);
        }
        for (texel, pixel) in self.texels.chunks_exact_mut(stored).zip(row.chunks_exact(channels)) {
            texel[..channels].copy_from_slice(pixel);
        }
        if !is_half {
            return bytemuck::cast_slice(&self.texels);
        }
        self.halves.convert_from_f32_slice(&self.texels);
        bytemuck::cast_slice(&self.halves)
    }
}

pub(super) fn extent(window: Rect) -> wgpu::Extent3d {
    wgpu::Extent3d { width: window.width(), height: window.height(), depth_or_array_layers: 1 }
}

/// One output on its way back: which texels of the texture, and where they lie in the buffer.
pub(super) struct Part {
    pub name: String,
    /// The pixels wanted, at the output's level.
    wanted: Rect,
    /// Position of the first of them in the texture.
    at: [u32; 2],
    format: Format,
    offset: u64,
}

pub(super) fn parts(plan: &Plan, program: &Program, region: Rect) -> Vec<Part> {
    let mut offset = 0;
    let mut parts = Vec::with_capacity(plan.outputs().len());
    for port in plan.outputs() {
        // Every output has a texture: lowering made it.
        let Some(index) = program.output(&port.name) else { continue };
        let texture = &program.textures[index];
        let wanted = plan.region_at(region, plan.desc(port.image).level);
        let part = Part {
            name: port.name.clone(),
            wanted,
            at: [(wanted.x0 - texture.window.x0) as u32, (wanted.y0 - texture.window.y0) as u32],
            format: texture.format,
            offset,
        };
        offset += part.bytes();
        parts.push(part);
    }
    parts
}

impl Part {
    /// Bytes from one row to the next: copies want a multiple of 256.
    fn row(&self) -> u64 {
        let row = u64::from(self.wanted.width()) * u64::from(self.format.texel());
        row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT))
    }

    /// Bytes of all rows.
    pub fn bytes(&self) -> u64 {
        self.row() * u64::from(self.wanted.height())
    }

    /// Records the copy of the texels into a buffer.
    pub fn copy(&self, texture: &wgpu::Texture, buffer: &wgpu::Buffer, encoder: &mut wgpu::CommandEncoder) {
        let source = wgpu::TexelCopyTextureInfo {
            origin: wgpu::Origin3d { x: self.at[0], y: self.at[1], z: 0 },
            ..texture.as_image_copy()
        };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: self.offset,
            bytes_per_row: Some(self.row() as u32),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            source,
            wgpu::TexelCopyBufferInfo { buffer, layout },
            extent(self.wanted),
        );
    }

    /// Copies the values read back into their place in the result.
    pub fn store(&self, bytes: &[u8], image: &mut Image) {
        let (stored, kept) = (self.format.channels() as usize, image.channels() as usize);
        let texel = self.format.texel() as usize;
        let first = (self.wanted.x0 - image.window().x0) as usize * kept;
        let len = self.wanted.width() as usize;
        let mut values = vec![0.0f32; len * stored];
        for (index, y) in (self.wanted.y0..self.wanted.y1).enumerate() {
            let start = self.offset as usize + index * self.row() as usize;
            let row = &bytes[start..start + len * texel];
            let target = &mut image.row_mut(y)[first..first + len * kept];
            let is_half = self.format.sample() == 2;
            if stored == kept && !is_half {
                bytemuck::cast_slice_mut(target).copy_from_slice(row);
                continue;
            }
            if is_half {
                for (value, bytes) in values.iter_mut().zip(row.chunks_exact(2)) {
                    *value = f16::from_le_bytes([bytes[0], bytes[1]]).to_f32();
                }
            } else {
                bytemuck::cast_slice_mut(&mut values).copy_from_slice(row);
            }
            for (pixel, texel) in target.chunks_exact_mut(kept).zip(values.chunks_exact(stored)) {
                pixel.copy_from_slice(&texel[..kept]);
            }
        }
    }
}
