//! Times of passes by the device's own clock.

use crate::gpu::Gpu;
use isophote_files::error::{Error, Result};

const BYTES: u64 = wgpu::QUERY_SIZE as u64;

/// Two timestamps a pass, and the way back to the CPU.
#[derive(Debug)]
pub struct Timestamps {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    /// Nanoseconds of a tick.
    period: f64,
}

impl Timestamps {
    /// Room for so many passes; nothing where the device has no timestamps or not so many.
    pub fn new(gpu: &Gpu, passes: usize) -> Option<Self> {
        let count = u32::try_from(passes).ok()?.checked_mul(2)?;
        let most = wgpu::QUERY_SET_MAX_QUERIES;
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) || count == 0 || count > most {
            return None;
        }
        let buffer = |usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: u64::from(count) * BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            period: f64::from(gpu.queue.get_timestamp_period()),
        })
    }

    /// For the compute pass of an index.
    pub fn compute(&self, index: usize) -> wgpu::ComputePassTimestampWrites<'_> {
        let [begin, end] = places(index);
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        }
    }

    /// For the render pass of an index.
    pub fn render(&self, index: usize) -> wgpu::RenderPassTimestampWrites<'_> {
        let [begin, end] = places(index);
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        }
    }

    /// Records how timestamps become readable, after all passes.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.queries.count(), &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
    }

    /// Asks for them, after their submission.
    pub fn ask(&self) {
        // Success shows when they are read.
        self.readable.map_async(wgpu::MapMode::Read, .., |_| {});
    }

    /// Time that each pass took, in seconds, once the device has done them.
    ///
    /// # Errors
    /// [`Error::Failure`] when the device fails.
    pub fn read(&self) -> Result<Vec<f64>> {
        let mapped = self.readable.get_mapped_range(..).map_err(|e| {
            Error::failure(
                format!("timestamps could not be read from the graphics device: {e}"),
                "start again",
            )
        })?;
        let ticks: Vec<u64> = mapped.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b)).collect();
        drop(mapped);
        self.readable.unmap();
        let seconds = |[begin, end]: &[u64; 2]| end.saturating_sub(*begin) as f64 * self.period / 1e9;
        Ok(ticks.as_chunks().0.iter().map(seconds).collect())
    }
}

/// Places of the timestamps of a pass.
fn places(index: usize) -> [u32; 2] {
    let first = index as u32 * 2;
    [first, first + 1]
}
