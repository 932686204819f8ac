//! A node on the host's own graphics device, as the library plans it.

use std::sync::Arc;
use std::time::Instant;

use super::entry::{Entry, PassEntry};
use super::timer::Timer;
use super::transfers::{self, Transfers};
use super::{Subject, median, motion};
use isophote_example::kernels::Kernels;
use isophote_example::plan_runner::{ALL, PlanRunner};
use isophote_files::error::{AtPlace, Result};
use isophote_finishing::stylize::precision::Precision;
use isophote_finishing::stylize::style::Style;
use isophote_loader::abi::ISOPHOTE_GUIDE_MOTION;
use isophote_loader::history::Past;
use isophote_loader::plan::{Pass, Texture};
use isophote_loader::{Library, Plan};
use isophote_pictures::pixels::Pixels;
use isophote_render::gpu::Gpu;

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
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for nodes that need more than a picture, [`isophote_files::error::Error::Failure`] when the device
    /// fails.
    pub fn run(
        &mut self,
        library: &Library,
        subject: &Subject,
        picture: &Pixels,
        runs: u32,
    ) -> Result<Entry> {
        let refused = |e: isophote_loader::Error| e.at(&subject.node, "leave it out with --node");
        let (plan, mut runner) = self.prepare(library, subject, picture)?;
        let totals = (0..runs).map(|_| self.once(&mut runner)).collect::<Result<Vec<f64>>>()?;
        let texture = self.upload(picture);
        let transfers = Transfers::measure(&self.gpu, picture, texture.texture(), runs)?;
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
            size: (picture.width(), picture.height()),
            seconds: median(totals),
            call_seconds: None,
            transfers: Some(transfers),
            bytes: Some(bytes),
            memory: None,
            passes,
        })
    }

    /// Seconds of single frames, one after the other for so long; at least one.
    ///
    /// # Errors
    /// As [`Bench::run`].
    pub fn frames(
        &mut self,
        library: &Library,
        subject: &Subject,
        picture: &Pixels,
        seconds: f64,
    ) -> Result<Vec<f64>> {
        let (_plan, mut runner) = self.prepare(library, subject, picture)?;
        let (started, mut times) = (Instant::now(), Vec::new());
        while times.is_empty() || started.elapsed().as_secs_f64() < seconds {
            times.push(self.once(&mut runner)?);
        }
        Ok(times)
    }

    /// Seconds until the shaders of a node are compiled, as far as they are not yet.
    ///
    /// # Errors
    /// As [`Bench::run`].
    pub fn compile(&mut self, library: &Library, subject: &Subject) -> Result<f64> {
        const SMALL: (u32, u32) = (64, 64);
        let (plan, past, _) = self.plan(library, subject, SMALL)?;
        let started = Instant::now();
        PlanRunner::new(&self.kernels, &plan, past)?;
        Ok(started.elapsed().as_secs_f64())
    }

    /// Plan of a node on a picture of a size, the frames before that it reads, and the number of them.
    fn plan(&self, library: &Library, subject: &Subject, size: (u32, u32)) -> Result<(Plan, Past, u32)> {
        let style = Style::any(library, &subject.node, &subject.settings)?;
        self.precision.apply(&style)?;
        let mut request = library.request(size).map_err(|e| e.at("--size", "choose another size"))?;
        let frames = library.frames(&style.graph);
        let [frames, _] = frames.map_err(|e| e.at(&subject.node, "leave it out with --node"))?;
        if frames > 0 {
            request.guides = ISOPHOTE_GUIDE_MOTION;
        }
        // Of one that is steady, frames in order of which those before are known.
        let past = style.named().past(library, &request)?;
        Ok((style.named().plan(library, &request, past.frames)?, past, frames))
    }

    /// A node that has run on a picture: its first runs compile, and find the frames that others are based on.
    fn prepare(
        &mut self,
        library: &Library,
        subject: &Subject,
        picture: &Pixels,
    ) -> Result<(Plan, PlanRunner)> {
        let size = (picture.width(), picture.height());
        let (plan, past, frames) = self.plan(library, subject, size)?;
        let mut runner = PlanRunner::new(&self.kernels, &plan, past)?;
        let (color, motion) = (self.upload(picture), self.upload(&motion(size)));
        runner.bind(&[("color", &color), ("motion", &motion)])?;
        for _ in 0..=frames {
            self.once(&mut runner)?;
        }
        Ok((plan, runner))
    }

    /// From the first command recorded to the last one done, in seconds.
    fn once(&self, runner: &mut PlanRunner) -> Result<f64> {
        let started = Instant::now();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        runner.encode(&mut encoder, ALL)?;
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
        transfers::write(&self.gpu, picture, &texture);
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }
}

/// The passes of a plan, not measured yet.
fn passes(plan: &Plan) -> isophote_loader::Result<Vec<PassEntry>> {
    let textures = plan.textures()?;
    let texture = |at: &u32| textures.get(*at as usize);
    let entry = |pass: Pass<'_>| PassEntry {
        kernel: pass.kernel.to_owned(),
        seconds: 0.0,
        pixels: pass
            .outputs
            .first()
            .and_then(texture)
            .map_or(0, |t| u64::from(t.size[0]) * u64::from(t.size[1])),
        work: None,
        bytes: Some(pass.inputs.iter().chain(pass.outputs).filter_map(texture).map(Texture::bytes).sum()),
    };
    Ok(plan.passes()?.map(entry).collect())
}
