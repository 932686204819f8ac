//! Timestamps around every dispatch.

use super::device::{Device, count};
use crate::error::{Error, Result};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

const BYTES: u64 = wgpu::QUERY_SIZE as u64;

/// Longest time that a thread which took a callback may be held up before it calls it: on a busy machine those of the lowest
/// priority wait for many seconds.
const LATEST: Duration = Duration::from_secs(120);

/// Answer of the device, which is done with what was asked. Of several threads that wait at once another one may have taken the
/// callback, and be about to call it.
pub(super) fn answer<T>(receiver: &Receiver<T>) -> std::result::Result<T, RecvTimeoutError> {
    receiver.recv_timeout(LATEST)
}

/// Two timestamps a dispatch, and the way back to the CPU.
#[derive(Debug)]
pub(super) struct Timer {
    device: Arc<Device>,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    dispatches: u32,
}

impl Timer {
    pub fn new(device: &Arc<Device>, dispatches: usize) -> Result<Self> {
        if !device.has_timestamps() {
            return Err(Error::NoDevice(format!(
                "passes cannot be timed: the device '{}' was opened without timestamps or has none",
                device.name()
            )));
        }
        let dispatches = dispatches as u32;
        if dispatches == 0 || dispatches > wgpu::QUERY_SET_MAX_QUERIES / 2 {
            return Err(Error::Input(format!(
                "{dispatches} passes cannot be timed at once: 1 to {} can",
                wgpu::QUERY_SET_MAX_QUERIES / 2
            )));
        }
        let size = u64::from(dispatches) * 2 * BYTES;
        let (queries, resolved, readable) = device.guarded("timestamps", |raw| {
            let buffer = |usage| {
                raw.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("isophote timestamps"),
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            };
            let queries = raw.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("isophote timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: dispatches * 2,
            });
            let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
            let readable = buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
            (queries, resolved, readable)
        })?;
        count(&device.counters.query_sets);
        count(&device.counters.buffers);
        count(&device.counters.buffers);
        Ok(Self { device: Arc::clone(device), queries, resolved, readable, dispatches })
    }

    /// Place to which the `index`th dispatch writes its timestamps.
    pub fn writes(&self, index: usize) -> wgpu::ComputePassTimestampWrites<'_> {
        let first = index as u32 * 2;
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Records the copy of all timestamps to memory that the CPU can read.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.dispatches * 2, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
    }

    /// Waits for the last submission and returns what each dispatch took.
    pub fn read(&self) -> Result<Vec<Duration>> {
        let period = f64::from(self.device.queue.get_timestamp_period());
        read_buffer(&self.device, &self.readable, self.readable.size(), None, |bytes| {
            let tick = |i: usize| {
                bytes[i * BYTES as usize..].first_chunk().map_or(0, |value| u64::from_le_bytes(*value))
            };
            (0..self.dispatches as usize)
                .map(|i| {
                    let ticks = tick(2 * i + 1).saturating_sub(tick(2 * i));
                    Duration::from_nanos((ticks as f64 * period) as u64)
                })
                .collect()
        })
    }
}

/// Waits for `submission` (or all), maps the first `size` bytes of `buffer` and hands them to `read`.
pub(super) fn read_buffer<T>(
    device: &Device,
    buffer: &wgpu::Buffer,
    size: u64,
    submission: Option<wgpu::SubmissionIndex>,
    read: impl FnOnce(&[u8]) -> T,
) -> Result<T> {
    let (sender, receiver) = std::sync::mpsc::channel();
    device.guarded("reading back", |_| {
        buffer.map_async(wgpu::MapMode::Read, 0..size, move |mapped| {
            // The receiver is gone only when the wait below failed.
            let _ = sender.send(mapped);
        });
    })?;
    device.wait(submission)?;
    let failed = |e: String| Error::Device(format!("cannot read back from '{}': {e}", device.name()));
    match answer(&receiver) {
        Ok(Ok(())) => {}
        Ok(Err(e)) => return Err(failed(e.to_string())),
        Err(e) => return Err(failed(e.to_string())),
    }
    let view = buffer.get_mapped_range(0..size).map_err(|e| failed(e.to_string()))?;
    let value = read(&view);
    drop(view);
    buffer.unmap();
    Ok(value)
}
