//! Samples of what is shown and of the original, on their way from the device to histograms.

use std::sync::Arc;

use super::canvas::{Arrangement, Canvas, Reading, Shown};
use super::made::Made;
use crate::jobs::worker::{Wake, Worker};
use crate::state::histogram::{Histogram, Histograms};
use crate::state::viewport::Area;
use isophote_files::error::{Error, Result};
use isophote_render::gpu::Gpu;
use isophote_render::layouts;

/// Samples of a picture across and down. A row of both pictures is as long as rows of copies must be multiples of.
const SIDE: u32 = 256;
/// Bytes of a sample.
const BYTES: u32 = 4;
/// Format of the samples.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Pictures that are counted, by what they were made of, and the brightness at which they are shown.
pub type Counted = (Made, u32);

/// Takes samples of pictures, and counts them on a thread of its own.
pub struct Counter {
    canvas: Canvas,
    target: wgpu::Texture,
    worker: Worker<Samples, Result<Histograms>>,
    /// Pictures that were counted last.
    taken: Option<Counted>,
}

/// Samples in a buffer that is being mapped.
struct Samples {
    gpu: Gpu,
    buffer: wgpu::Buffer,
}

impl Counter {
    /// Compiles the pass and starts the thread.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(gpu: &Gpu, wake: &Wake) -> Result<Self> {
        let target = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("samples"),
            size: wgpu::Extent3d { width: 2 * SIDE, height: SIDE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let worker = Worker::new("histogram", Arc::clone(wake), |samples: Samples| samples.count())?;
        Ok(Self { canvas: Canvas::new(&gpu.device, FORMAT), target, worker, taken: None })
    }

    /// True where nothing is being counted, and these were not counted last.
    pub fn wants(&self, counted: &Counted) -> bool {
        !self.worker.is_busy() && self.taken.as_ref() != Some(counted)
    }

    /// The histograms, when they are there.
    pub fn answer(&mut self) -> Option<Result<Histograms>> {
        self.worker.answer()
    }

    /// Counts the original and what is shown; their places do not matter.
    pub fn take(&mut self, gpu: &Gpu, pictures: [Shown<'_>; 2], counted: Counted) {
        let side = SIDE as f32;
        let area = Area { x: 0.0, y: 0.0, width: 2.0 * side, height: side };
        let [left, right] = pictures;
        self.canvas.set(
            &gpu.device,
            &gpu.queue,
            &Arrangement {
                area,
                pictures: [
                    Shown { place: Area { width: side, ..area }, ..left },
                    Shown { place: Area { x: side, width: side, ..area }, ..right },
                ],
                split: side,
                exposure: f32::from_bits(counted.1),
                middle: 1.0,
                square: 1.0,
                reading: Reading::Samples,
            },
        );
        let view = self.target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("samples"),
            color_attachments: &[Some(layouts::cleared(&view, wgpu::Color::TRANSPARENT))],
            ..Default::default()
        });
        self.canvas.draw(&mut pass, area, (2 * SIDE, SIDE));
        drop(pass);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("samples"),
            size: u64::from(2 * SIDE * SIDE * BYTES),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(2 * SIDE * BYTES),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            self.target.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
            self.target.size(),
        );
        gpu.queue.submit([encoder.finish()]);
        // Success shows when it is read.
        buffer.map_async(wgpu::MapMode::Read, .., |_| {});
        self.worker.ask(Samples { gpu: gpu.clone(), buffer });
        self.taken = Some(counted);
    }
}

impl Samples {
    fn count(&self) -> Result<Histograms> {
        // Whether that went well shows below.
        let _ = self.gpu.device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None });
        let mapped = self.buffer.slice(..).get_mapped_range().map_err(|e| {
            let problem = format!("the picture cannot be read from the graphics device: {e}");
            Error::failure(problem, "close the histogram")
        })?;
        let pixels = mapped.as_chunks::<4>().0;
        let half = |is_right: usize| {
            let rows = pixels.chunks_exact(2 * SIDE as usize);
            Histogram::of(rows.flat_map(|row| row.chunks_exact(SIDE as usize).nth(is_right).unwrap_or(&[])))
        };
        Ok(Histograms { original: half(0), shown: half(1) })
    }
}
