//! Pictures on their way to a graphics device and back: what an OpenFX host or `apply` waits for beside the passes.

use std::time::Instant;

use super::median;
use isophote_files::error::Result;
use isophote_pictures::pixels::Pixels;
use isophote_render::gpu::Gpu;
use isophote_render::readback::Readback;

/// Seconds that a picture of a size takes each way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfers {
    /// From memory to a texture.
    pub upload: f64,
    /// From a texture to memory.
    pub download: f64,
}

impl Transfers {
    /// Medians of `runs`, after one that allocates. The result of a node is taken for a picture as large as `picture`, which
    /// is in `texture`.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device fails.
    pub fn measure(gpu: &Gpu, picture: &Pixels, texture: &wgpu::Texture, runs: u32) -> Result<Self> {
        let (mut readback, mut times) = (Readback::default(), [Vec::new(), Vec::new()]);
        for run in 0..=runs {
            let started = Instant::now();
            write(gpu, picture, texture);
            gpu.queue.submit([]);
            gpu.wait()?;
            let uploaded = started.elapsed().as_secs_f64();
            readback.read(gpu, texture)?;
            if run > 0 {
                times[0].push(uploaded);
                times[1].push(started.elapsed().as_secs_f64() - uploaded);
            }
        }
        let [upload, download] = times.map(median);
        Ok(Self { upload, download })
    }
}

/// Gives a texture the pixels of a picture.
pub fn write(gpu: &Gpu, picture: &Pixels, texture: &wgpu::Texture) {
    gpu.queue.write_texture(
        texture.as_image_copy(),
        picture.bytes(),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(picture.width() * picture.channels() * 4),
            rows_per_image: None,
        },
        texture.size(),
    );
}
