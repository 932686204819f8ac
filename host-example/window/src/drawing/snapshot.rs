//! The present frame of a scene on its way from the device to main memory, with what is known beside its colour.

use std::sync::Arc;

use super::source::SceneSource;
use crate::jobs::worker::{Wake, Worker};
use crate::state::document::frame::{Frame, GuideImage};
use isophote_files::error::{Error, Result};
use isophote_finishing::apply::picture_request::PictureRequest;
use isophote_pictures::exr::Guide;
use isophote_pictures::meaning::ImageState;
use isophote_pictures::space::Space;
use isophote_render::gpu::Gpu;
use isophote_render::readback::decode;
use isophote_render::targets::Target;

/// Copies frames and turns them into numbers on a thread of its own.
pub struct Snapshots<F> {
    worker: Worker<Copied, Result<Frame>>,
    /// State that the last one shows.
    taken: Option<F>,
}

/// A frame in buffers that are being mapped.
struct Copied {
    gpu: Gpu,
    size: (u32, u32),
    color: Buffer,
    guides: Vec<(Guide, Buffer)>,
}

/// A texture in a buffer.
struct Buffer {
    buffer: wgpu::Buffer,
    format: wgpu::TextureFormat,
    /// Bytes of a row, and from one to the next.
    row: usize,
    pitch: usize,
}

impl<F: PartialEq> Snapshots<F> {
    /// Starts the thread.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        let worker = Worker::new("snapshot", Arc::clone(wake), |copied: Copied| copied.frame())?;
        Ok(Self { worker, taken: None })
    }

    /// True where the last one shows this.
    pub fn shows(&self, state: &F) -> bool {
        self.taken.as_ref() == Some(state)
    }

    /// Copies what was rendered last, which shows this.
    pub fn take(&mut self, gpu: &Gpu, source: &SceneSource, state: F) {
        let targets = source.targets();
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut copied = |target: &Target| Buffer::copied(gpu, &mut encoder, &target.texture);
        let mut guides = vec![
            (Guide::Normal, copied(&targets.normal)),
            (Guide::Depth, copied(&targets.depth)),
            (Guide::ObjectId, copied(&targets.object_id)),
        ];
        guides.extend(targets.rest.iter().map(|rest| (Guide::RestPosition, copied(rest))));
        guides.extend(targets.control.iter().map(|control| (Guide::Control, copied(control))));
        let light = targets.layers_in(ImageState::DisplayReferred).into_iter().flatten();
        let names = [Guide::Albedo, Guide::Diffuse, Guide::Specular];
        guides.extend(names.into_iter().zip(light).map(|(guide, target)| (guide, copied(target))));
        let color = copied(&targets.color);
        gpu.queue.submit([encoder.finish()]);
        for buffer in guides.iter().map(|(_, buffer)| buffer).chain([&color]) {
            // Success shows when it is read.
            buffer.buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        }
        let size = (targets.width, targets.height);
        self.worker.ask(Copied { gpu: gpu.clone(), size, color, guides });
        self.taken = Some(state);
    }

    /// The frame, when it is there.
    pub fn answer(&mut self) -> Option<Result<Frame>> {
        self.worker.answer()
    }
}

impl Copied {
    fn frame(&self) -> Result<Frame> {
        // Whether that went well shows below.
        let _ = self.gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None });
        let color = self.color.numbers()?.as_chunks::<4>().0.to_vec();
        let pixels = color.len().max(1);
        let guides = self.guides.iter().map(|(guide, buffer)| {
            let data = buffer.numbers()?;
            Ok(Arc::new(GuideImage { guide: *guide, channels: (data.len() / pixels) as u32, data }))
        });
        Ok(Frame {
            number: None,
            width: self.size.0,
            height: self.size.1,
            file_size: self.size,
            guides: guides.collect::<Result<_>>()?,
            mask: None,
            color: Arc::new(color),
            request: PictureRequest {
                space: Space::Linear,
                is_premultiplied: true,
                origin: [0.0; 2],
                canonical_height: 0,
                scale: 1.0,
                frame: 0,
            },
            has_light: false,
            is_bytes: false,
            replaced: 0,
        })
    }
}

impl Buffer {
    fn copied(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) -> Self {
        let format = texture.format();
        let texel = format.block_copy_size(None).unwrap_or_default();
        let row = (texture.width() * texel) as usize;
        let pitch = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("snapshot"),
            size: (pitch * texture.height() as usize) as u64,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(pitch as u32),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            texture.size(),
        );
        Self { buffer, format, row, pitch }
    }

    fn numbers(&self) -> Result<Vec<f32>> {
        let mapped = self.buffer.slice(..).get_mapped_range().map_err(|e| {
            let problem = format!("the picture cannot be read from the graphics device: {e}");
            Error::failure(problem, "open the browser of looks again")
        })?;
        let mut numbers = Vec::with_capacity(mapped.len() / 2);
        for line in mapped.chunks_exact(self.pitch) {
            decode(self.format, &line[..self.row], &mut numbers);
        }
        Ok(numbers)
    }
}
