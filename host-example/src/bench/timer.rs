//! Timestamps around every pass of a plan.

use crate::error::{Error, Result};
use crate::render::gpu::Gpu;
use crate::stylize::plan_runner::PlanRunner;

const BYTES: u64 = wgpu::QUERY_SIZE as u64;

/// Two timestamps a pass, and the way back to the CPU.
#[derive(Debug)]
pub struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    passes: usize,
}

impl Timer {
    /// Room for so many passes; nothing where the adapter has no timestamps or not so many.
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
            passes,
        })
    }

    /// Runs the plan with each of its passes as a compute pass of its own, so that the whole takes a little longer, and
    /// returns what each took, in seconds.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when the device fails.
    pub fn run(&self, gpu: &Gpu, runner: &PlanRunner) -> Result<Vec<f64>> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for index in 0..self.passes {
            let first = index as u32 * 2;
            let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("timed"),
                timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                    query_set: &self.queries,
                    beginning_of_pass_write_index: Some(first),
                    end_of_pass_write_index: Some(first + 1),
                }),
            });
            runner.encode_pass(&mut compute, index)?;
        }
        encoder.resolve_query_set(&self.queries, 0..self.passes as u32 * 2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
        gpu.queue.submit([encoder.finish()]);
        // Success shows in the mapping below.
        self.readable.map_async(wgpu::MapMode::Read, .., |_| {});
        gpu.wait()?;
        let period = f64::from(gpu.queue.get_timestamp_period());
        let mapped = self.readable.get_mapped_range(..).map_err(|e| {
            Error::failure(
                format!("timestamps could not be read from the graphics device: {e}"),
                "start again",
            )
        })?;
        let ticks: Vec<u64> = mapped.as_chunks().0.iter().map(|b| u64::from_le_bytes(*b)).collect();
        drop(mapped);
        self.readable.unmap();
        let seconds = |[begin, end]: &[u64; 2]| end.saturating_sub(*begin) as f64 * period / 1e9;
        Ok(ticks.as_chunks().0.iter().map(seconds).collect())
    }
}
