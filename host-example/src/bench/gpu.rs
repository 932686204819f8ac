//! A node on the host's own graphics device, as the library plans it.

use std::sync::Arc;
use std::time::Instant;

use isophote_engine::gpu::{Device, Executor, Prepared};

use super::entry::{Entry, PassEntry};
use super::{Subject, median};
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::pixels::Pixels;
use crate::render::gpu::Gpu;
use crate::stylize::style::Style;

/// A device to measure on.
pub struct Bench {
    gpu: Gpu,
    device: Arc<Device>,
}

impl Bench {
    /// Measures on `gpu`.
    pub fn new(gpu: Gpu) -> Self {
        let device = Device::wrap(gpu.device.clone(), gpu.queue.clone());
        Self { gpu, device }
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> String {
        self.device.name().to_owned()
    }

    /// Measures one node: the whole without timestamps, which cost something, then each pass with them, where
    /// the adapter has any.
    pub fn run(
        &mut self,
        library: &Library,
        subject: &Subject,
        picture: &Pixels,
        runs: u32,
    ) -> Result<Entry> {
        let node = &subject.node;
        let size = (picture.width(), picture.height());
        let style = Style::any(library, node, &subject.settings)?;
        let request = library.request(size).map_err(|e| e.at("--size", "choose another size"))?;
        let plan = style.graph.plan(&request).map_err(|e| e.at(node, "leave it out with --node"))?;
        let program = plan.program().map_err(|e| e.at(node, "leave it out with --node"))?;
        let executor = Executor::new(Arc::clone(&self.device));
        let mut prepared = executor.prepare(&program).map_err(failed)?;
        if program.input("color").is_some() {
            self.upload(&prepared.own_input("color").map_err(failed)?, picture);
        }
        prepared.own_output("output").map_err(failed)?;
        // The first run compiles, and is not counted.
        self.once(&prepared)?;
        let totals = (0..runs).map(|_| self.once(&prepared)).collect::<Result<Vec<f64>>>()?;
        let mut measured = Vec::new();
        if self.device.has_timestamps() {
            prepared.record_times(true).map_err(failed)?;
            for _ in 0..runs {
                self.once(&prepared)?;
                measured.push(prepared.times().map_err(failed)?);
            }
        }
        let seconds = |at: usize| {
            median(measured.iter().filter_map(|times| Some(times.get(at)?.time.as_secs_f64())).collect())
        };
        let passes = measured.first().map_or(&[][..], Vec::as_slice);
        Ok(Entry {
            node: subject.label.clone(),
            backend: "gpu",
            size,
            seconds: median(totals),
            call_seconds: None,
            passes: passes
                .iter()
                .enumerate()
                .map(|(at, pass)| PassEntry {
                    kernel: pass.kernel.clone(),
                    seconds: seconds(at),
                    pixels: pass.pixels,
                    work: None,
                })
                .collect(),
        })
    }

    /// From the first command recorded to the last one done, in seconds.
    fn once(&self, prepared: &Prepared) -> Result<f64> {
        let started = Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        prepared.encode(&mut encoder).map_err(failed)?;
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(started.elapsed().as_secs_f64())
    }

    fn upload(&self, view: &wgpu::TextureView, picture: &Pixels) {
        self.gpu.queue.write_texture(
            view.texture().as_image_copy(),
            picture.bytes(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(picture.width() * 16),
                rows_per_image: None,
            },
            view.texture().size(),
        );
    }
}

fn failed(error: isophote_engine::Error) -> Error {
    Error::failure(error, "use a smaller size or --backend cpu")
}
