//! The present frame of a scene on its way from the device to main memory, with what is known beside its colour.

use std::ops::Range;
use std::sync::Arc;

use super::source::SceneSource;
use crate::jobs::worker::{Wake, Worker};
use crate::state::document::frame::{Frame, GuideImage};
use crate::state::scenery::{OnScene, Scenery};
use crate::state::things::Sampled;
use isophote_files::error::{Error, Result};
use isophote_finishing::apply::materials;
use isophote_finishing::apply::picture_request::PictureRequest;
use isophote_pictures::exr::Guide;
use isophote_pictures::meaning::ImageState;
use isophote_pictures::space::Space;
use isophote_render::gpu::Gpu;
use isophote_render::readback::decode;
use isophote_render::samples::SAMPLES;
use isophote_render::targets::Target;

/// Samples of a frame that are drawn at once. Between them the window is drawn.
const AT_ONCE: u32 = 4;

/// Copies frames and turns them into numbers on a thread of its own.
pub struct Snapshots<F> {
    worker: Worker<Copied, Result<Snapshot>>,
    /// State that the last one shows.
    taken: Option<F>,
    /// A frame of which samples are still to be drawn.
    begun: Option<Copied>,
}

/// A frame in main memory.
pub struct Snapshot {
    /// The frame.
    pub frame: Frame,
    /// Things that samples of its pixels show, where these were asked for.
    pub sampled: Option<Sampled>,
}

/// A frame in buffers that are being mapped.
struct Copied {
    gpu: Gpu,
    size: (u32, u32),
    color: Buffer,
    guides: Vec<(Guide, Buffer)>,
    /// Numbers of things in samples of it.
    samples: Vec<Buffer>,
    /// Materials that it is to lie on.
    materials: Arc<[OnScene]>,
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
        let worker = Worker::new("snapshot", Arc::clone(wake), |copied: Copied| copied.snapshot())?;
        Ok(Self { worker, taken: None, begun: None })
    }

    /// True where the last one shows this.
    pub fn shows(&self, state: &F) -> bool {
        self.taken.as_ref() == Some(state)
    }

    /// Copies what was rendered last, which shows this, to lie on materials. Where things in samples of its pixels are wanted, these are drawn by
    /// [`Snapshots::sample`].
    pub fn take(
        &mut self,
        gpu: &Gpu,
        source: &SceneSource,
        (state, materials): (F, &Arc<[OnScene]>),
        is_sampled: bool,
    ) {
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
        let size = (targets.width, targets.height);
        let materials = Arc::clone(materials);
        let copied = Copied { gpu: gpu.clone(), size, color, guides, samples: Vec::new(), materials };
        self.taken = Some(state);
        match is_sampled {
            true => self.begun = Some(copied),
            false => self.finish(copied),
        }
    }

    /// True while samples are still to be drawn of a frame.
    pub fn is_sampling(&self) -> bool {
        self.begun.is_some()
    }

    /// Draws some more of them, of the frame that was rendered last of a scene.
    pub fn sample(&mut self, gpu: &Gpu, (source, scenery): (&mut SceneSource, &Scenery)) {
        let Some(mut copied) = self.begun.take() else { return };
        let first = copied.samples.len() as u32;
        let end = (first + AT_ONCE).min(SAMPLES);
        copied.samples.extend(samples(gpu, (source, scenery), first..end));
        match end {
            SAMPLES => self.finish(copied),
            _ => self.begun = Some(copied),
        }
    }

    /// Takes the frame no more of which samples are still to be drawn.
    pub fn give_up(&mut self) {
        if self.begun.take().is_some() {
            self.taken = None;
        }
    }

    /// Has a frame read that is copied whole.
    fn finish(&mut self, copied: Copied) {
        let Copied { color, guides, samples, .. } = &copied;
        for buffer in guides.iter().map(|(_, buffer)| buffer).chain([color]).chain(samples) {
            // Success shows when it is read.
            buffer.buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        }
        self.worker.ask(copied);
    }

    /// The frame, when it is there.
    pub fn answer(&mut self) -> Option<Result<Snapshot>> {
        self.worker.answer()
    }
}

/// Draws some of the samples of the frame that was rendered last, and copies which things they show.
fn samples(gpu: &Gpu, (source, scenery): (&mut SceneSource, &Scenery), numbers: Range<u32>) -> Vec<Buffer> {
    let mut record = |record: &mut dyn FnMut(&mut SceneSource, &mut wgpu::CommandEncoder)| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        record(source, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
    };
    let mut samples = Vec::with_capacity(numbers.len());
    for sample in numbers {
        record(&mut |source, encoder| {
            source.encode_sample(encoder, scenery, sample);
            samples.push(Buffer::copied(gpu, encoder, &source.targets().object_id.texture));
        });
    }
    record(&mut |source, encoder| source.encode_again(encoder, scenery));
    samples
}

impl Copied {
    /// The frame; each buffer is given back once it is read.
    fn snapshot(mut self) -> Result<Snapshot> {
        // Whether that went well shows below.
        let _ = self.gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None });
        let mut sampled: Option<Sampled> = None;
        for buffer in self.samples.drain(..) {
            let numbers = buffer.numbers()?;
            match &mut sampled {
                Some(sampled) => sampled.add(&numbers),
                None => sampled = Some(Sampled::new(numbers)),
            }
        }
        Ok(Snapshot { frame: self.frame()?, sampled })
    }

    fn frame(&self) -> Result<Frame> {
        let color = self.color.numbers()?.as_chunks::<4>().0.to_vec();
        let pixels = color.len().max(1);
        let guides = self.guides.iter().map(|(guide, buffer)| {
            let data = buffer.numbers()?;
            Ok(Arc::new(GuideImage { guide: *guide, channels: (data.len() / pixels) as u32, data }))
        });
        let sheets = self.materials.iter().map(|own| &*own.material);
        let laid = materials::on_frame(sheets, self.size).into_iter().filter_map(|(name, pixels)| {
            let guide = Guide::ALL.into_iter().find(|guide| guide.id() == name)?;
            Some(Arc::new(GuideImage { guide, channels: pixels.channels(), data: pixels.to_f32() }))
        });
        let guides = guides.chain(laid.map(Ok));
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
