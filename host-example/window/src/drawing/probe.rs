//! The pixel under the pointer: its values before and after, read back with the frame.

use isophote_render::readback::decode;

/// Bytes that copies of rows begin at multiples of.
const PITCH: u64 = wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as u64;

/// Reads pixels back.
pub struct Probe {
    buffer: wgpu::Buffer,
    formats: Option<[wgpu::TextureFormat; 2]>,
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
        Self { buffer, formats: None }
    }

    /// Copies the pixels at a place, as shares of width and height, of two pictures.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pictures: [&wgpu::TextureView; 2],
        place: [f32; 2],
    ) {
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
        self.formats = Some(pictures.map(|view| view.texture().format()));
    }

    /// Asks for what was copied, after its submission.
    pub fn ask(&self) {
        if self.formats.is_some() {
            // Success shows when it is read.
            self.buffer.slice(..).map_async(wgpu::MapMode::Read, |_| {});
        }
    }

    /// Values that were copied, once the device has done it.
    pub fn read(&mut self) -> Option<[[f32; 4]; 2]> {
        let formats = self.formats.take()?;
        let pixels = self.buffer.slice(..).get_mapped_range().ok().map(|bytes| {
            let pixel = |format: wgpu::TextureFormat, at: u64| {
                let size = format.block_copy_size(None).unwrap_or_default() as usize;
                let mut data = Vec::with_capacity(4);
                decode(format, &bytes[at as usize..][..size], &mut data);
                // Grey is all colours.
                let grey = data.first().copied().unwrap_or_default();
                let at = |index: usize| data.get(index).copied();
                let alpha = at(3).unwrap_or(1.0);
                [grey, at(1).unwrap_or(grey), at(2).unwrap_or(grey), alpha]
            };
            [pixel(formats[0], 0), pixel(formats[1], PITCH)]
        });
        self.buffer.unmap();
        pixels
    }
}
