//! From a texture to numbers in main memory.

use half::f16;

use crate::gpu::Gpu;
use isophote_files::error::{Error, Result};
use isophote_pictures::floats::Picture;

/// Copies textures to main memory; keeps its buffer from one call to the next.
#[derive(Debug, Default)]
pub struct Readback {
    buffer: Option<wgpu::Buffer>,
}

impl Readback {
    /// The whole texture as 32-bit floats with as many channels as its format has. Textures need the usage
    /// `COPY_SRC` and one of the formats `Rgba16Float`, `Rgba32Float`, `Rg32Float`, `R32Float`, `Rgba8Unorm`.
    ///
    /// # Errors
    /// [`Error::Failure`] for other formats and when the device fails.
    pub fn read(&mut self, gpu: &Gpu, texture: &wgpu::Texture) -> Result<Picture> {
        let (width, height) = (texture.width(), texture.height());
        let (channels, bytes) = match texture.format() {
            wgpu::TextureFormat::Rgba16Float => (4, 8),
            wgpu::TextureFormat::Rgba32Float => (4, 16),
            wgpu::TextureFormat::Rg32Float => (2, 8),
            wgpu::TextureFormat::R32Float => (1, 4),
            wgpu::TextureFormat::Rgba8Unorm => (4, 4),
            other => {
                return Err(Error::failure(
                    format!("textures of format {other:?} are not read"),
                    "use another",
                ));
            }
        };
        let row = (width * bytes) as usize;
        let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let size = (pitch * height as usize) as u64;
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.size() >= size => buffer,
            _ => gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("readback"),
                size,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            }),
        };
        copy(gpu, texture, &buffer, pitch);
        let slice = buffer.slice(..size);
        // Success shows in the mapping below.
        slice.map_async(wgpu::MapMode::Read, |_| {});
        gpu.wait()?;
        let mut data = Vec::with_capacity(width as usize * height as usize * channels);
        {
            let mapped = slice.get_mapped_range().map_err(|e| {
                Error::failure(
                    format!("a picture could not be read from the graphics device: {e}"),
                    "start again",
                )
            })?;
            for line in mapped.chunks_exact(pitch) {
                decode(texture.format(), &line[..row], &mut data);
            }
        }
        buffer.unmap();
        self.buffer = Some(buffer);
        Ok(Picture { width, height, channels, data })
    }
}

/// Copies a texture to a buffer whose rows are `pitch` bytes apart.
fn copy(gpu: &Gpu, texture: &wgpu::Texture, buffer: &wgpu::Buffer, pitch: usize) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(pitch as u32),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    gpu.queue.submit([encoder.finish()]);
}

/// The numbers of one row.
pub fn decode(format: wgpu::TextureFormat, line: &[u8], data: &mut Vec<f32>) {
    match format {
        wgpu::TextureFormat::Rgba16Float => {
            data.extend(line.as_chunks::<2>().0.iter().map(|b| f16::from_le_bytes(*b).to_f32()));
        }
        wgpu::TextureFormat::Rgba8Unorm => data.extend(line.iter().map(|b| f32::from(*b) / 255.0)),
        _ => data.extend(line.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b))),
    }
}
