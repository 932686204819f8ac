//! A node on the host's own graphics device, as the library plans it.

use std::sync::Arc;
use std::time::Instant;

use super::entry::{Entry, PassEntry};
use super::timer::Timer;
use super::{Subject, median, motion};
use crate::error::Result;
use crate::loader::contract::ISOPHOTE_GUIDE_MOTION;
use crate::loader::plan::{Pass, Texture};
use crate::loader::{Answer, Library, Plan, Refusal};
use crate::pixels::Pixels;
use crate::render::gpu::Gpu;
use crate::stylize::kernels::Kernels;
use crate::stylize::plan_runner::PlanRunner;
use crate::stylize::precision::Precision;
use crate::stylize::style::Style;

/// A device to measure on.
pub struct Bench {
    gpu: Gpu,
    kernels: Arc<Kernels>,
    precision: Precision,
}

impl Bench {
    /// Measures on `gpu`, as precisely as asked for.
    pub fn new(gpu: Gpu, precision: Precision) -> Self {
        let kernels = Kernels::new(gpu.device.clone(), gpu.queue.clone());
        Self { gpu, kernels, precision }
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> String {
        self.gpu.adapter.get_info().name
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
        let refused = |e: Refusal| e.at(&subject.node, "leave it out with --node");
        let size = (picture.width(), picture.height());
        let style = Style::any(library, &subject.node, &subject.settings)?;
        self.precision.apply(&style)?;
        let mut request = library.request(size).map_err(|e| e.at("--size", "choose another size"))?;
        let [frames, _] = library.frames(&style.graph).map_err(refused)?;
        if frames > 0 {
            request.guides = ISOPHOTE_GUIDE_MOTION;
        }
        // Of one that is steady, frames in order of which those before are known.
        let past = style.past(library, &request)?;
        let plan = style.plan(library, &request, past.frames)?;
        let mut runner = PlanRunner::new(&self.kernels, &plan, past)?;
        let (color, motion) = (self.upload(picture), self.upload(&motion(size)));
        runner.bind(&[("color", &color), ("motion", &motion)])?;
        // The first runs compile, and find the frames that others are based on; they are not counted.
        for _ in 0..=frames {
            self.once(&mut runner)?;
        }
        let totals = (0..runs).map(|_| self.once(&mut runner)).collect::<Result<Vec<f64>>>()?;
        let mut passes = passes(&plan).map_err(refused)?;
        let bytes = passes.iter().filter_map(|pass| pass.bytes).sum();
        match Timer::new(&self.gpu, passes.len()) {
            Some(timer) => {
                let times =
                    (0..runs).map(|_| timer.run(&self.gpu, &runner)).collect::<Result<Vec<Vec<f64>>>>()?;
                for (at, pass) in passes.iter_mut().enumerate() {
                    pass.seconds = median(times.iter().filter_map(|t| t.get(at).copied()).collect());
                }
            }
            None => passes.clear(),
        }
        Ok(Entry {
            node: subject.label.clone(),
            backend: "gpu",
            size,
            seconds: median(totals),
            call_seconds: None,
            bytes: Some(bytes),
            passes,
        })
    }

    /// From the first command recorded to the last one done, in seconds.
    fn once(&self, runner: &mut PlanRunner) -> Result<f64> {
        let started = Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        runner.encode(&mut encoder)?;
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.wait()?;
        Ok(started.elapsed().as_secs_f64())
    }

    fn upload(&self, picture: &Pixels) -> wgpu::TextureView {
        let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d {
                width: picture.width(),
                height: picture.height(),
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: match picture.channels() {
                2 => wgpu::TextureFormat::Rg32Float,
                _ => wgpu::TextureFormat::Rgba32Float,
            },
            // Frames that are kept are copied.
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_DST
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        self.gpu.queue.write_texture(
            texture.as_image_copy(),
            picture.bytes(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(picture.width() * picture.channels() * 4),
                rows_per_image: None,
            },
            texture.size(),
        );
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }
}

/// The passes of a plan, not measured yet. Of the bytes that a pass reads, each texel counts once.
fn passes(plan: &Plan) -> Answer<Vec<PassEntry>> {
    let textures = plan.textures()?;
    let written = |i: &u32| textures.get(*i as usize).map(|t| u64::from(t.size[0]) * u64::from(t.size[1]));
    let bytes = |at: &u32| textures.get(*at as usize).map_or(0, Texture::bytes);
    let entry = |pass: Pass<'_>| PassEntry {
        kernel: pass.kernel.to_owned(),
        seconds: 0.0,
        pixels: pass.outputs.first().and_then(written).unwrap_or(0),
        bytes: Some(pass.inputs.iter().chain(pass.outputs).map(bytes).sum()),
        work: None,
    };
    Ok(plan.passes()?.map(entry).collect())
}
