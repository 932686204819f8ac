//! Pixels on their way to textures: written to memory that the device copies from, in buffers which take turns, so that one
//! is written while the device still reads another.

use super::device::Device;
use super::prepared::Prepared;
use super::timing::answer;
use super::transfer::{RowWriter, extent};
use crate::error::{Error, Result};
use crate::image::{Image, Rect};
use crate::program::{Program, Role, Texture};
use std::sync::mpsc::{Receiver, channel};

/// A buffer whose memory was asked back from the device.
#[derive(Debug)]
pub(super) struct Upload {
    buffer: wgpu::Buffer,
    /// Answer of the device.
    mapped: Receiver<std::result::Result<(), wgpu::BufferAsyncError>>,
}

/// Pixels that were written, and where they go.
pub(super) struct Staged {
    buffer: wgpu::Buffer,
    copies: Vec<CopyTo>,
}

struct CopyTo {
    texture: wgpu::Texture,
    window: Rect,
    offset: u64,
    row: u64,
}

/// Bytes from one row to the next of a texture's pixels: copies want a multiple of 256.
fn row(texture: &Texture) -> u64 {
    let row = u64::from(texture.window.width()) * u64::from(texture.format.texel());
    row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT))
}

fn bytes(texture: &Texture) -> u64 {
    row(texture) * u64::from(texture.window.height())
}

/// Bytes of all inputs of a program on their way.
pub(super) fn bytes_of(program: &Program) -> u64 {
    program.textures.iter().filter(|t| matches!(t.role, Role::Input(_))).map(bytes).sum()
}

impl Upload {
    /// Bytes that it holds.
    pub fn size(&self) -> u64 {
        self.buffer.size()
    }

    /// Waits until it is mapped. The device is done with it.
    pub fn mapped(self) -> Option<wgpu::Buffer> {
        answer(&self.mapped).ok()?.ok().map(|()| self.buffer)
    }
}

impl Staged {
    /// Writes the inputs of a program to a buffer that is mapped and holds [`bytes_of`] it.
    ///
    /// # Errors
    /// [`Error::Input`] for a missing one; those of the device.
    pub fn write(
        device: &Device,
        buffer: wgpu::Buffer,
        inputs: &[(&str, &Image)],
        program: &Program,
        prepared: &mut Prepared,
    ) -> Result<Self> {
        let (mut copies, mut offset) = (Vec::new(), 0);
        device.guarded("writing an image for the device", |_| {
            let failed = |e: wgpu::MapRangeError| Error::Device(format!("memory is not mapped: {e}"));
            let mut view = buffer.get_mapped_range_mut(..).map_err(failed)?;
            for texture in &program.textures {
                let Role::Input(name) = &texture.role else { continue };
                let Some((_, image)) = inputs.iter().find(|(n, _)| n == name) else {
                    return Err(Error::Input(format!("input image '{name}' is missing")));
                };
                let mut writer = RowWriter::new(image, texture);
                for index in 0..texture.window.height() {
                    let bytes = writer.row(texture.window.y0 + index as i32);
                    let start = (offset + u64::from(index) * row(texture)) as usize;
                    view.slice(start..start + bytes.len()).copy_from_slice(bytes);
                }
                let of = prepared.own_input(name)?.texture().clone();
                copies.push(CopyTo { texture: of, window: texture.window, offset, row: row(texture) });
                offset += bytes(texture);
            }
            drop(view);
            buffer.unmap();
            Ok(())
        })??;
        Ok(Self { buffer, copies })
    }

    /// Records the copies into textures.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        for CopyTo { texture, window, offset, row } in &self.copies {
            let layout = wgpu::TexelCopyBufferLayout {
                offset: *offset,
                bytes_per_row: Some(*row as u32),
                rows_per_image: None,
            };
            encoder.copy_buffer_to_texture(
                wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout },
                texture.as_image_copy(),
                extent(*window),
            );
        }
    }

    /// Asks for the memory back, once what was submitted is done.
    pub fn map(self) -> Upload {
        let (sender, mapped) = channel();
        self.buffer.map_async(wgpu::MapMode::Write, .., move |answer| {
            // The receiver is gone where nobody wants the buffer any more.
            let _ = sender.send(answer);
        });
        Upload { buffer: self.buffer, mapped }
    }
}
