//! A run of a plan on the CPU.

use super::bands::{BAND, run_bands};
use super::control::{Control, PassTime};
use super::images::Images;
use super::rows::Rows;
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
        let schedule = Schedule::new(plan, region, &windows, self.strip_rows(threads));
        let leaving = plan.outputs().iter().map(|port| port.image).collect();
        let mut run =
            Run { executor: self, plan, windows, region, schedule, images, leaving, threads, control };
        let results = run.passes(None).and_then(|()| run.results());
        run.images.recycle(&mut run.executor.spare);
        if matches!(results, Err(Error::Memory(_))) {
            self.purge();
        }
        results
    }

    /// Computes `region` (level 0) of every output of `plan` from and to pictures that come and go by rows, so that
    /// images take at most `most` bytes ([`CpuExecutor::bytes_by_rows`]). Gives the bits of [`CpuExecutor::run`].
    ///
    /// # Errors
    /// Those of [`CpuExecutor::run`], and of `rows`.
    pub fn run_rows(
        &mut self,
        plan: &Plan,
        rows: &mut dyn Rows,
        (region, most): (Rect, u64),
        threads: &dyn Threads,
        control: Control<'_>,
    ) -> Result<()> {
        plan.check_region(region)?;
        let windows = plan.windows(region);
        let schedule = Schedule::within(plan, region, &windows, self.strip_rows(threads), most);
        // What another run left may be more than this may take.
        if self.kept() > schedule.bytes(plan, &windows) {
            self.purge();
        }
        let (images, leaving) = (Images::none(plan, &windows), Vec::new());
        let mut run =
            Run { executor: self, plan, windows, region, schedule, images, leaving, threads, control };
        let result = run.passes(Some(rows));
        run.images.recycle(&mut run.executor.spare);
        if matches!(result, Err(Error::Memory(_))) {
            self.purge();
        }
        result
    }

    /// Bytes that the images of [`CpuExecutor::run_rows`] take: at most `most`, or what the fewest rows take that it goes
    /// through plans by.
    pub fn bytes_by_rows(&self, plan: &Plan, (region, most): (Rect, u64), threads: &dyn Threads) -> u64 {
        let windows = plan.windows(region);
        Schedule::within(plan, region, &windows, self.strip_rows(threads), most).bytes(plan, &windows)
    }

    /// Rows of the result in a step, where memory does not matter.
    fn strip_rows(&self, threads: &dyn Threads) -> i32 {
        self.strip.unwrap_or(STRIP.max(BAND * threads.count() as i32 * 4))
    }

    /// Memory for an image that passes write: the smallest spare one that is enough, or a new one. One that `leaves` takes its
    /// memory with it, which is not to be much more than it needs.
    ///
    /// # Errors
    /// [`Error::Memory`] when there is not enough.
    fn take(&mut self, window: Rect, channels: u32, leaves: bool) -> Result<Image> {
        let need = window.area() * u64::from(channels) * size_of::<f32>() as u64;
        let fit = |image: &Image| (image.memory() < need, image.memory().abs_diff(need));
        let may = |i: &usize| !leaves || (need..=need + need / 2).contains(&self.spare[*i].memory());
        let best = (0..self.spare.len()).filter(may).min_by_key(|i| fit(&self.spare[*i]));
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
    region: Rect,
    schedule: Schedule,
    images: Images<'r>,
    /// Images whose memory goes to the caller.
    leaving: Vec<ImageId>,
    threads: &'r dyn Threads,
    control: Control<'r>,
}

impl Run<'_> {
    /// Runs all passes that the region needs; images that come and go by `rows` are read and handed on in each step.
    fn passes(&mut self, mut rows: Option<&mut dyn Rows>) -> Result<()> {
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
        let mut left = vec![i32::MIN; plan.outputs().len()];
        for step in 0..steps {
            if let Some(rows) = &mut rows {
                self.enter(step, *rows)?;
            }
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
            if let Some(rows) = &mut rows {
                self.leave(step, &mut left, *rows)?;
            }
        }
        self.control.check()
    }

    /// Has the rows read that the step needs of images that enter.
    fn enter(&mut self, step: usize, rows: &mut dyn Rows) -> Result<()> {
        for port in self.plan.inputs() {
            let (id, all) = (port.image, self.windows[port.image.index()]);
            let (y0, y1) = (self.images.filled(id).max(all.y0), self.schedule.frontiers[step][id.index()]);
            if !all.is_empty() && y0 < y1 {
                self.control.check()?;
                let mut image = self.output(step, id)?;
                rows.read(&port.name, y0..y1, &mut image)?;
                self.images.put(id, image, y1);
            }
        }
        Ok(())
    }

    /// Hands on the rows that the step has added to images that leave; `left` says how far each was.
    fn leave(&mut self, step: usize, left: &mut [i32], rows: &mut dyn Rows) -> Result<()> {
        for (output, (port, left)) in self.plan.outputs().iter().zip(left).enumerate() {
            let part = self.part(port);
            let y1 = self.schedule.frontiers[step][port.image.index()].min(part.y1);
            let part = Rect { y0: part.y0.max(*left), y1, ..part };
            if !part.is_empty() {
                rows.write(output, part, self.images.image(port.image))?;
                *left = y1;
            }
        }
        Ok(())
    }

    /// The part of an image that leaves the run.
    fn part(&self, port: &Port) -> Rect {
        self.plan.region_at(self.region, self.plan.desc(port.image).level)
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
                let leaves = self.leaving.contains(&id);
                self.executor.take(Rect { y1, ..window }, self.plan.desc(id).channels, leaves)?
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

    fn results(&mut self) -> Result<Vec<Image>> {
        let parts: Vec<(ImageId, Rect)> =
            self.plan.outputs().iter().map(|port| (port.image, self.part(port))).collect();
        parts.into_iter().map(|(id, part)| self.images.finish(id, part)).collect()
    }
}
