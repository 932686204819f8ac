//! The pixel under the pointer: its values before and after, read back with the frame.

use super::shown::{Output, picture};
use super::source::LookInput;
use crate::state::probed::{Pixel, Probed};
use crate::state::session::{Session, Which};
use crate::state::viewport::Overlay;
use isophote_render::readback::decode;

/// Bytes that copies of rows begin at multiples of.
const PITCH: u64 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as u64;

/// A pixel that was copied.
struct Copied {
    at: [u32; 2],
    formats: [wgpu::TextureFormat; 2],
    overlay: Overlay,
    /// True where the second one is of a look or a layer, and not of the original once more.
    is_other: bool,
}

/// Reads pixels back.
pub struct Probe {
    buffer: wgpu::Buffer,
    copied: Option<Copied>,
}

impl Probe {
    /// Makes room for two pixels.
    pub fn new(device: &wgpu::Device) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("probe"),
            size: 2 * PITCH,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Self { buffer, copied: None }
    }

    /// Copies the pixels under the pointer, if that is on the picture: of the original, and of what is made of it.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        session: &Session,
        source: &LookInput,
        outputs: &[Option<Output>; 3],
    ) {
        let Some(pointer) = session.viewport.pointer else { return };
        let size = session.nominal_size();
        let Some((x, y)) = session.viewport.pixel(size, pointer) else { return };
        let overlay = session.viewport.overlay;
        let which = if overlay == Overlay::None { Which::Look } else { Which::Overlay };
        let (before, _) = source.original();
        let (after, _) = picture(source, outputs, overlay, which);
        let pictures = [before, after];
        let place = [(x as f32 + 0.5) / size.0 as f32, (y as f32 + 0.5) / size.1 as f32];
        for (view, offset) in pictures.into_iter().zip([0, PITCH]) {
            let texture = view.texture();
            let at = |share: f32, length: u32| ((share * length as f32) as u32).min(length.saturating_sub(1));
            let origin =
                wgpu::Origin3d { x: at(place[0], texture.width()), y: at(place[1], texture.height()), z: 0 };
            let layout = wgpu::TexelCopyBufferLayout { offset, bytes_per_row: None, rows_per_image: None };
            encoder.copy_texture_to_buffer(
                wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() },
                wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout },
                wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
            );
        }
        self.copied = Some(Copied {
            at: [x, y],
            formats: pictures.map(|view| view.texture().format()),
            overlay,
            is_other: after != before,
        });
    }

    /// Asks for what was copied, after its submission.
    pub fn ask(&self) {
        if self.copied.is_some() {
            // Success shows when it is read.
            self.buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        }
    }

    /// Values that were copied, once the device has done it.
    pub fn read(&mut self) -> Option<Probed> {
        let Copied { at, formats, overlay, is_other } = self.copied.take()?;
        let probed = self.buffer.slice(..).get_mapped_range().ok().map(|bytes| {
            let pixel = |format: wgpu::TextureFormat, at: u64| -> Pixel {
                let size = format.block_copy_size(None).unwrap_or_default() as usize;
                let mut data = Vec::with_capacity(4);
                decode(format, &bytes[at as usize..][..size], &mut data);
                // Grey is all colours.
                let grey = data.first().copied().unwrap_or_default();
                let at = |index: usize| data.get(index).copied();
                let alpha = at(3).unwrap_or(1.0);
                [grey, at(1).unwrap_or(grey), at(2).unwrap_or(grey), alpha]
            };
            let shown = is_other.then(|| pixel(formats[1], PITCH));
            Probed { at, original: pixel(formats[0], 0), shown, overlay }
        });
        self.buffer.unmap();
        probed
    }
}
