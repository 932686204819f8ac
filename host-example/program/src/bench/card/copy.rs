//! Speed at which a card copies its own memory: what passes that are limited by memory are set against.

use std::time::Instant;

use isophote_files::error::Result;
use isophote_render::gpu::Gpu;

/// Bytes of the source; few caches hold so many.
const BYTES: u64 = 256 << 20;
/// Copies of a submission: few, and more, whose difference is free of what a submission takes by itself.
const COPIES: [u32; 2] = [2, 8];
/// Each measurement is repeated, and the best counts.
const REPEATS: usize = 3;

/// Bytes read and written per second.
///
/// # Errors
/// [`isophote_files::error::Error::Failure`] when the device fails.
pub fn measure(gpu: &Gpu) -> Result<f64> {
    let bytes = BYTES.min(gpu.device.limits().max_buffer_size);
    let buffer = |usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("copy"),
            size: bytes,
            usage,
            mapped_at_creation: false,
        })
    };
    let (from, to) = (
        buffer(wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST),
        buffer(wgpu::BufferUsages::COPY_DST),
    );
    let time = |copies: u32| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for _ in 0..copies {
            encoder.copy_buffer_to_buffer(&from, 0, &to, 0, bytes);
        }
        let started = Instant::now();
        gpu.queue.submit([encoder.finish()]);
        gpu.wait()?;
        Ok::<_, isophote_files::error::Error>(started.elapsed().as_secs_f64())
    };
    // Memory is cleared before its first use.
    time(1)?;
    let mut best: f64 = 0.0;
    for _ in 0..REPEATS {
        let [few, more] = [time(COPIES[0])?, time(COPIES[1])?];
        let copied = 2.0 * bytes as f64 * f64::from(COPIES[1] - COPIES[0]);
        // Where the machine stalls in the shorter one, all of the longer one counts.
        let seconds = if more > few { more - few } else { more };
        best = best.max(copied / seconds);
    }
    Ok(best)
}
