//! A picture on the graphics device, with what its file knows beside colour.

use std::sync::Arc;

use super::canvas::Numbers;
use crate::state::document::frame::Frame;
use isophote_example::kernels::checked;
use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::Stylizer;
use isophote_loader::abi::{ISOPHOTE_SPACE_ACESCG, ISOPHOTE_SPACE_LINEAR, IsophoteRequest, IsophoteSpace};
use isophote_render::gpu::Gpu;

/// Bytes that are uploaded at once, so that no copy is larger than the devices' buffers.
const STRIP: usize = 32 << 20;

/// A picture whose frames may follow one another.
pub struct PictureSource {
    frame: Arc<Frame>,
    request: IsophoteRequest,
    /// Colour and guides by the names of the graph's inputs.
    textures: Vec<(&'static str, wgpu::TextureView)>,
}

impl PictureSource {
    /// Uploads a frame, whose size is so much of the file's. `usual` is a request of any size.
    ///
    /// # Errors
    /// [`Error::Input`] when it is beyond the limits of the device, [`Error::Failure`] when that has no memory for it.
    pub fn new(gpu: &Gpu, frame: &Arc<Frame>, scale: f32, usual: IsophoteRequest) -> Result<Self> {
        let most = gpu.device.limits().max_texture_dimension_2d;
        if frame.width > most || frame.height > most {
            return Err(Error::input(
                "the picture",
                format!("is larger than the {most} pixels that this device takes"),
                "scale it down",
            ));
        }
        let mut source = Self {
            frame: Arc::clone(frame),
            request: frame.request_of_all(scale, usual),
            textures: Vec::new(),
        };
        for (name, channels, _) in inputs(frame) {
            let size = (frame.width, frame.height);
            let view = checked(&gpu.device, || Ok(texture(gpu, name, size, channels)))?;
            source.textures.push((name, view));
        }
        source.upload(gpu, None);
        Ok(source)
    }

    /// True where it shows this frame.
    pub fn shows(&self, frame: &Arc<Frame>) -> bool {
        Arc::ptr_eq(&self.frame, frame)
    }

    /// Shows another frame in the place of this one, if it is of the same kind.
    pub fn follow(&mut self, gpu: &Gpu, frame: &Arc<Frame>, scale: f32) -> bool {
        let names = |frame: &Frame| inputs(frame).map(|(name, ..)| name).collect::<Vec<_>>();
        let new = frame.request_of_all(scale, self.request);
        if new != self.request || names(frame) != names(&self.frame) {
            return false;
        }
        let before = std::mem::replace(&mut self.frame, Arc::clone(frame));
        self.upload(gpu, Some(&before));
        true
    }

    /// The same picture with other maps painted over it, beside this one, of which it has what is the same; nothing where it is
    /// another picture.
    ///
    /// # Errors
    /// As [`PictureSource::new`].
    pub fn repainted(&self, gpu: &Gpu, frame: &Arc<Frame>, scale: f32) -> Option<Result<Self>> {
        if !Arc::ptr_eq(&self.frame.color, &frame.color) {
            return None;
        }
        let request = frame.request_of_all(scale, self.request);
        let own = |name: &str| self.textures.iter().find(|(known, _)| *known == name);
        let mut source = Self { frame: Arc::clone(frame), request, textures: Vec::new() };
        for (name, channels, _) in inputs(frame) {
            let size = (frame.width, frame.height);
            let view = match own(name) {
                Some((_, view)) => Ok(view.clone()),
                None => checked(&gpu.device, || Ok(texture(gpu, name, size, channels))),
            };
            match view {
                Ok(view) => source.textures.push((name, view)),
                Err(error) => return Some(Err(error)),
            }
        }
        source.upload(gpu, Some(&self.frame));
        Some(Ok(source))
    }

    /// Puts the numbers of the frame on the device, but for those that its textures have from the frame before.
    fn upload(&self, gpu: &Gpu, before: Option<&Frame>) {
        for ((_, view), (name, _, data)) in self.textures.iter().zip(inputs(&self.frame)) {
            let mut known = before.into_iter().flat_map(inputs);
            if !known.any(|(of, _, numbers)| of == name && std::ptr::eq(numbers, data)) {
                write(gpu, view, data);
            }
        }
    }

    /// Request of looks on it.
    pub fn request(&self) -> IsophoteRequest {
        self.request
    }

    /// Number of the frame.
    pub fn number(&self) -> i64 {
        self.frame.number.unwrap_or_default()
    }

    /// Lets a style read it.
    ///
    /// # Errors
    /// As [`Stylizer::bind`].
    pub fn bind(&self, stylizer: &mut Stylizer) -> Result<()> {
        let inputs: Vec<_> = self.textures.iter().map(|(name, view)| (*name, view)).collect();
        stylizer.bind_inputs(&inputs)
    }

    /// The picture without any look.
    pub fn original(&self) -> (&wgpu::TextureView, Numbers) {
        (&self.textures[0].1, numbers(self.request.space))
    }

    /// One of its guides.
    pub fn picture(&self, numbers: Numbers) -> Option<&wgpu::TextureView> {
        let name = match numbers {
            Numbers::Normal => "normal",
            Numbers::Depth => "depth",
            Numbers::ObjectId => "object_id",
            Numbers::Motion => "motion",
            _ => return None,
        };
        self.textures.iter().find(|(known, _)| *known == name).map(|(_, view)| view)
    }
}

/// Meaning of the numbers of a space on the canvas.
pub fn numbers(space: IsophoteSpace) -> Numbers {
    match space {
        ISOPHOTE_SPACE_LINEAR => Numbers::Linear,
        ISOPHOTE_SPACE_ACESCG => Numbers::AcesCg,
        _ => Numbers::Srgb,
    }
}

/// Inputs that a frame has: names, numbers a pixel, and these.
fn inputs(frame: &Frame) -> impl Iterator<Item = (&'static str, u32, &[f32])> {
    let guides = frame.guides.iter().map(|image| (image.guide.id(), image.channels, image.data.as_slice()));
    let mask = frame.mask.iter().map(|mask| ("mask", 1, mask.as_slice()));
    [("color", 4, frame.color.as_flattened())].into_iter().chain(guides).chain(mask)
}

/// Writes all numbers of a texture.
pub fn write(gpu: &Gpu, view: &wgpu::TextureView, data: &[f32]) {
    let texture = view.texture();
    let texel = texture.format().block_copy_size(None).unwrap_or_default() as usize;
    let row = texture.width() as usize * texel / 4;
    let rows = (STRIP / 4 / row.max(1)).max(1);
    for (strip, values) in data.chunks(rows * row).enumerate() {
        let origin = wgpu::Origin3d { x: 0, y: (strip * rows) as u32, z: 0 };
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..texture.as_image_copy() },
            bytemuck::cast_slice(values),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row as u32 * 4),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: texture.width(),
                height: (values.len() / row) as u32,
                depth_or_array_layers: 1,
            },
        );
        // Its copy in memory goes as soon as the device has it, and not with the window's next frame.
        gpu.queue.submit([]);
    }
}

/// A texture of 32-bit floats, 1, 2 or 4 a pixel, that looks can read.
pub fn texture(gpu: &Gpu, name: &str, (width, height): (u32, u32), channels: u32) -> wgpu::TextureView {
    let format = match channels {
        1 => wgpu::TextureFormat::R32Float,
        2 => wgpu::TextureFormat::Rg32Float,
        _ => wgpu::TextureFormat::Rgba32Float,
    };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(name),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
