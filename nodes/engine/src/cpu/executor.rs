//! A run of a plan on the CPU.

use super::bands::{BAND, run_bands};
use super::control::{Control, PassTime};
use super::images::Images;
use super::strips::Schedule;
use super::threads::Threads;
use crate::error::{Error, Result};
use crate::image::{Image, Rect, View};
use crate::kernel::CpuPass;
use crate::plan::{ImageId, Pass, Plan, Port};
use fearless_simd::Level;
use std::time::{Duration, Instant};

/// Least rows of the result that all passes go through together: few enough for what passes hand on to stay
/// in a third-level cache, enough for threads to share, for passes to reach beyond, and for the ends of
/// passes, where threads wait for each other, to be rare.
const STRIP: i32 = 192;

/// Runs plans on the CPU. Keeps the memory of transient images from run to run.
#[derive(Debug)]
pub struct CpuExecutor {
    level: Level,
    strip: Option<i32>,
    spare: Vec<Image>,
    times: Option<Vec<PassTime>>,
}

impl Default for CpuExecutor {
    fn default() -> Self {
        Self::new()
    }
}

impl CpuExecutor {
    /// An executor that uses the widest instruction set of this machine.
    pub fn new() -> Self {
        Self::with_level(Level::new())
    }

    /// An executor that uses the given instruction set (for tests and benchmarks).
    pub fn with_level(level: Level) -> Self {
        Self { level, strip: None, spare: Vec::new(), times: None }
    }

    /// Goes through plans in strips of about `rows` rows (for tests and benchmarks); none lets the
    /// executor choose.
    pub fn set_strip(&mut self, rows: Option<u32>) {
        self.strip = rows.map(|rows| i32::try_from(rows.max(1)).unwrap_or(i32::MAX));
    }

    /// Starts or stops recording the time of every pass.
    pub fn record_times(&mut self, on: bool) {
        self.times = on.then(Vec::new);
    }

    /// Times of the last run, when recorded.
    pub fn times(&self) -> &[PassTime] {
        self.times.as_deref().unwrap_or(&[])
    }

    /// Keeps the memory of a result that is no longer wanted for the next run, whose first touch of new
    /// memory would cost as much as a pass.
    pub fn recycle(&mut self, image: Image) {
        self.spare.push(image);
    }

    /// Bytes of memory kept for the next run.
    pub fn kept(&self) -> u64 {
        self.spare.iter().map(Image::memory).sum()
    }

    /// Gives back the memory kept for the next run.
    pub fn purge(&mut self) {
        self.spare.clear();
    }

    /// Computes `region` (level 0) of every output of `plan`.
    ///
    /// `inputs` are found by name; each must hold at least the window that [`Plan::windows`] names
    /// for it. The outputs come in the order of [`Plan::outputs`].
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a missing or unfitting input, [`Error::Geometry`](crate::Error::Geometry) for a region outside
    /// the picture, [`Error::Cancelled`](crate::Error::Cancelled) when `control` says so,
    /// [`Error::Memory`] when there is not enough; what was kept for the next run is then given back.
    pub fn run(
        &mut self,
        plan: &Plan,
        inputs: &[(&str, &Image)],
        region: Rect,
        threads: &dyn Threads,
        control: Control<'_>,
    ) -> Result<Vec<Image>> {
        plan.check_region(region)?;
        // What earlier runs left is kept as far as this plan could use it.
        self.spare.truncate(plan.images().len());
        let windows = plan.windows(region);
        let images = Images::bind(plan, inputs, &windows)?;
        let rows = self.strip.unwrap_or(STRIP.max(BAND * threads.count() as i32 * 4));
        let schedule = Schedule::new(plan, region, &windows, rows);
        let mut run = Run { executor: self, plan, windows, schedule, images, threads, control };
        let results = run.passes().and_then(|()| run.results(region));
        run.images.recycle(&mut run.executor.spare);
        if matches!(results, Err(Error::Memory(_))) {
            self.purge();
        }
        results
    }

    /// Memory for an image that passes write: the spare one that wastes least, or a new one.
    ///
    /// # Errors
    /// [`Error::Memory`] when there is not enough.
    fn take(&mut self, window: Rect, channels: u32) -> Result<Image> {
        let need = window.area() as usize * channels as usize;
        let best = self
            .spare
            .iter()
            .enumerate()
            .min_by_key(|(_, image)| image.data().len().abs_diff(need))
            .map(|(i, _)| i);
        let mut image = best.map(|i| self.spare.swap_remove(i)).unwrap_or_default();
        if image.reshape(window, channels).is_err() {
            // What is kept may be all that there is.
            self.purge();
            image.reshape(window, channels)?;
        }
        Ok(image)
    }
}

/// A run under way: step by step all passes go on to the row that the schedule names for the step.
struct Run<'r> {
    executor: &'r mut CpuExecutor,
    plan: &'r Plan,
    windows: Vec<Rect>,
    schedule: Schedule,
    images: Images<'r>,
    threads: &'r dyn Threads,
    control: Control<'r>,
}

impl Run<'_> {
    /// Runs all passes that the region needs.
    fn passes(&mut self) -> Result<()> {
        let plan = self.plan;
        let pixels = |pass: &Pass| self.windows[pass.outputs[0].index()].area();
        let needed: Vec<usize> =
            (0..plan.passes().len()).filter(|i| pixels(&plan.passes()[*i]) > 0).collect();
        if let Some(times) = &mut self.executor.times {
            let unmeasured = |pass: &Pass| PassTime {
                kernel: pass.kernel.name.to_owned(),
                time: Duration::ZERO,
                pixels: pixels(pass),
            };
            *times = needed.iter().map(|i| unmeasured(&plan.passes()[*i])).collect();
        }
        let total = plan.passes().iter().map(pixels).sum::<u64>().max(1) as f32;
        let mut done = 0;
        let steps = self.schedule.frontiers.len();
        for step in 0..steps {
            for (place, index) in needed.iter().enumerate() {
                self.control.check()?;
                // Only where times are wanted: WebAssembly has no clock of its own.
                let started = self.executor.times.is_some().then(Instant::now);
                done += self.compute(step, &plan.passes()[*index])?;
                if step + 1 == steps {
                    self.release(*index);
                }
                let time = self.executor.times.as_mut().and_then(|times| times.get_mut(place));
                if let Some((time, started)) = time.zip(started) {
                    time.time += started.elapsed();
                }
                if let Some(progress) = self.control.progress {
                    progress(done as f32 / total);
                }
            }
        }
        self.control.check()
    }

    /// Takes a pass from the row it has reached to that of the step; returns how many pixels that were.
    fn compute(&mut self, step: usize, pass: &Pass) -> Result<u64> {
        let first = pass.outputs[0];
        let (all, end) = (self.windows[first.index()], self.schedule.frontiers[step][first.index()]);
        let window = Rect { y0: self.images.filled(first).max(all.y0), y1: end, ..all };
        let outputs: Result<Vec<Image>> = pass.outputs.iter().map(|id| self.output(step, *id)).collect();
        let mut outputs = outputs?;
        if !window.is_empty() {
            let views: Vec<View<'_>> =
                pass.inputs.iter().map(|id| self.images.view(self.plan, *id)).collect();
            let call = CpuPass { params: &pass.params, inputs: &views, level: self.executor.level };
            let full = self.plan.level_size(self.plan.desc(first).level);
            run_bands(pass.kernel, &call, window, full, &mut outputs, self.threads, self.control)?;
        }
        for (id, image) in pass.outputs.iter().zip(outputs) {
            self.images.put(*id, image, end);
        }
        Ok(window.area())
    }

    /// The memory that a pass writes an image to, with room for the rows of the step. Rows that are
    /// not read any more give way.
    fn output(&mut self, step: usize, id: ImageId) -> Result<Image> {
        let at = id.index();
        let mut image = match self.images.take(id) {
            Some(image) => image,
            None => {
                let window = self.windows[at];
                let y1 = window.y0 + self.schedule.capacity[at];
                self.executor.take(Rect { y1, ..window }, self.plan.desc(id).channels)?
            }
        };
        if self.schedule.frontiers[step][at] > image.window().y1 {
            image.slide(self.schedule.kept[step - 1][at], self.images.filled(id));
        }
        Ok(image)
    }

    /// Hands on the memory of images that no pass after this one reads.
    fn release(&mut self, pass: usize) {
        let ended = self.plan.lifetimes().ending_with(pass);
        self.executor.spare.extend(ended.iter().filter_map(|id| self.images.take(*id)));
    }

    fn results(&mut self, region: Rect) -> Result<Vec<Image>> {
        let plan = self.plan;
        let part = |port: &Port| plan.region_at(region, plan.desc(port.image).level);
        plan.outputs().iter().map(|port| self.images.finish(port.image, part(port))).collect()
    }
}
