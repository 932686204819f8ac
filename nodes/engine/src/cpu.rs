//! The CPU executor: bands of rows in parallel, SIMD as the machine has it, exact tiles.
//!
//! Every output pixel is computed by the same arithmetic wherever its tile begins and whichever
//! thread takes its band, so a tile equals the same tile cut from the full frame bit for bit.

use crate::error::{Error, Result};
use crate::image::{Image, Rect, View};
use crate::kernel::{Band, CpuPass};
use crate::plan::{Pass, Plan};
use crate::strips::Schedule;
use fearless_simd::Level;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Something that runs independent jobs: the engine's own pool, the caller's thread, or the host's
/// threads.
pub trait Threads: Sync {
    /// How many jobs can make progress at once; at least 1.
    fn count(&self) -> usize;
    /// Runs `job(0)`, ..., `job(jobs - 1)`, each once, in any order, and returns when all are done.
    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync));
}

/// Everything on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct CallingThread;

impl Threads for CallingThread {
    fn count(&self) -> usize {
        1
    }

    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..jobs).for_each(job);
    }
}

/// The calling thread and a pool of helpers, whose threads end when it is dropped.
///
/// The caller works along: a batch of jobs begins at once, while sleeping helpers are still waking, and a
/// pass takes as long as the slowest thread, not as long as the slowest to wake.
#[derive(Debug)]
pub struct Pool {
    helpers: Option<rayon::ThreadPool>,
}

impl Pool {
    /// A pool of `threads` threads, the calling one among them; 0 means one per core.
    ///
    /// # Errors
    /// [`Error::Memory`] when the system refuses the threads.
    pub fn new(threads: usize) -> Result<Self> {
        let count = match threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            given => given,
        };
        if count == 1 {
            return Ok(Self { helpers: None });
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(count - 1)
            .thread_name(|i| format!("isophote-{i}"))
            .build()
            .map(|helpers| Self { helpers: Some(helpers) })
            .map_err(|e| Error::Memory(format!("cannot start worker threads: {e}")))
    }
}

impl Threads for Pool {
    fn count(&self) -> usize {
        1 + self.helpers.as_ref().map_or(0, rayon::ThreadPool::current_num_threads)
    }

    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync)) {
        let next = AtomicUsize::new(0);
        let work = || {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= jobs {
                    break;
                }
                job(index);
            }
        };
        let Some(helpers) = &self.helpers else { return work() };
        helpers.in_place_scope(|scope| {
            for _ in 1..jobs.min(self.count()) {
                scope.spawn(|_| work());
            }
            work();
        });
    }
}

/// How the caller watches and stops a run.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Asked often, from any thread; true stops the run.
    pub cancelled: Option<&'a (dyn Fn() -> bool + Sync)>,
    /// Told the share of the work done, 0..=1, from the calling thread.
    pub progress: Option<&'a dyn Fn(f32)>,
}

impl Control<'_> {
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.is_some_and(|c| c())
    }
}

/// Least rows of the result that all passes go through together: few enough for what passes hand on to stay
/// in a third-level cache, enough for threads to share, for passes to reach beyond, and for the ends of
/// passes, where threads wait for each other, to be rare.
const STRIP: i32 = 192;

/// Least rows of a band.
const BAND: i32 = 16;

/// What one pass took.
#[derive(Clone, Debug)]
pub struct PassTime {
    /// The kernel's name.
    pub kernel: String,
    /// Wall-clock time.
    pub time: Duration,
    /// Output pixels computed.
    pub pixels: u64,
}

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
    /// [`Error::Input`] for a missing or unfitting input, [`Error::Geometry`] for a region outside
    /// the picture, [`Error::Cancelled`] when `control` says so.
    pub fn run(
        &mut self,
        plan: &Plan,
        inputs: &[(&str, &Image)],
        region: Rect,
        threads: &dyn Threads,
        control: Control<'_>,
    ) -> Result<Vec<Image>> {
        let [width, height] = plan.size();
        if region.is_empty() || !Rect::of_size(width, height).contains(&region) {
            return Err(Error::Geometry(format!(
                "region {region:?} is not inside the picture of {width}x{height}"
            )));
        }
        // What earlier runs left is kept as far as this plan could use it.
        self.spare.truncate(plan.images().len());
        let windows = plan.windows(region);
        let mut slots = Slots::bind(plan, inputs, &windows)?;
        let rows = self.strip.unwrap_or(STRIP.max(BAND * threads.count() as i32 * 4));
        let schedule = Schedule::new(plan, region, &windows, rows);
        let last_uses = plan.last_uses();
        let needed = |pass: &Pass| !windows[pass.outputs[0].index()].is_empty();
        let pixels = |pass: &Pass| windows[pass.outputs[0].index()].area();
        if let Some(times) = &mut self.times {
            times.clear();
            times.extend(plan.passes().iter().filter(|p| needed(p)).map(|pass| PassTime {
                kernel: pass.kernel.name.to_owned(),
                time: Duration::ZERO,
                pixels: pixels(pass),
            }));
        }
        let total = plan.passes().iter().map(pixels).sum::<u64>().max(1) as f32;
        let mut done = 0;
        for (step, frontier) in schedule.frontiers.iter().enumerate() {
            let last_step = step + 1 == schedule.frontiers.len();
            let passes = plan.passes().iter().enumerate().filter(|(_, p)| needed(p));
            for (place, (index, pass)) in passes.enumerate() {
                if control.is_cancelled() {
                    slots.recycle(&mut self.spare);
                    return Err(Error::Cancelled);
                }
                let started = Instant::now();
                let mut outputs = Vec::with_capacity(pass.outputs.len());
                for output in &pass.outputs {
                    let at = output.index();
                    let mut image = match slots.owned[at].take() {
                        Some(image) => image,
                        None => {
                            let window = windows[at];
                            let y1 = window.y0 + schedule.capacity[at];
                            self.take(Rect { y1, ..window }, plan.desc(*output).channels)
                        }
                    };
                    if frontier[at] > image.window().y1 {
                        image.slide(schedule.kept[step - 1][at], slots.filled[at]);
                    }
                    outputs.push(image);
                }
                let first = pass.outputs[0].index();
                let from = slots.filled[first].max(windows[first].y0);
                let window = Rect { y0: from, y1: frontier[first], ..windows[first] };
                if !window.is_empty() {
                    let views: Vec<View<'_>> =
                        pass.inputs.iter().map(|i| slots.view(plan, i.index())).collect();
                    let call = CpuPass { params: &pass.params, inputs: &views, level: self.level };
                    let full = plan.level_size(plan.desc(pass.outputs[0]).level);
                    run_bands(pass.kernel.cpu, &call, window, full, &mut outputs, threads, control);
                }
                for (id, image) in pass.outputs.iter().zip(outputs) {
                    slots.owned[id.index()] = Some(image);
                    slots.filled[id.index()] = frontier[first];
                }
                for id in &pass.inputs {
                    if last_step
                        && last_uses[id.index()] == index
                        && let Some(image) = slots.owned[id.index()].take()
                    {
                        self.spare.push(image);
                    }
                }
                if let Some(time) = self.times.as_mut().and_then(|times| times.get_mut(place)) {
                    time.time += started.elapsed();
                }
                done += window.area();
                if let Some(progress) = control.progress {
                    progress(done as f32 / total);
                }
            }
        }
        if control.is_cancelled() {
            slots.recycle(&mut self.spare);
            return Err(Error::Cancelled);
        }
        let results = plan
            .outputs()
            .iter()
            .map(|port| slots.finish(port.image.index(), plan.region_at(region, plan.desc(port.image).level)))
            .collect();
        slots.recycle(&mut self.spare);
        results
    }

    /// A transient image: the spare one that wastes least memory, or a new one.
    fn take(&mut self, window: Rect, channels: u32) -> Image {
        let need = window.width() as usize * window.height() as usize * channels as usize;
        let best = self
            .spare
            .iter()
            .enumerate()
            .min_by_key(|(_, image)| image.data().len().abs_diff(need))
            .map(|(i, _)| i);
        let mut image = best.map(|i| self.spare.swap_remove(i)).unwrap_or_default();
        image.reshape(window, channels);
        image
    }
}

/// The images of `inputs` by virtual image, after checking that each covers what `windows` names.
pub(crate) fn bind_inputs<'a>(
    plan: &Plan,
    inputs: &[(&str, &'a Image)],
    windows: &[Rect],
) -> Result<Vec<Option<&'a Image>>> {
    let mut borrowed = vec![None; plan.images().len()];
    for port in plan.inputs() {
        let needed = windows[port.image.index()];
        if needed.is_empty() {
            continue;
        }
        let Some((_, image)) = inputs.iter().find(|(name, _)| *name == port.name) else {
            return Err(Error::Input(format!("input image '{}' is missing", port.name)));
        };
        let channels = plan.desc(port.image).channels;
        if image.channels() != channels {
            return Err(Error::Input(format!(
                "input image '{}' has {} channels; {channels} are needed",
                port.name,
                image.channels()
            )));
        }
        if !image.window().contains(&needed) {
            return Err(Error::Input(format!(
                "input image '{}' covers {:?}; {needed:?} is needed",
                port.name,
                image.window()
            )));
        }
        borrowed[port.image.index()] = Some(*image);
    }
    Ok(borrowed)
}

/// The images of a run, by virtual image.
struct Slots<'a> {
    borrowed: Vec<Option<&'a Image>>,
    owned: Vec<Option<Image>>,
    /// The row down to which an owned image is computed, exclusive.
    filled: Vec<i32>,
}

impl<'a> Slots<'a> {
    fn bind(plan: &Plan, inputs: &[(&str, &'a Image)], windows: &[Rect]) -> Result<Self> {
        let borrowed = bind_inputs(plan, inputs, windows)?;
        let filled = windows.iter().map(|w| w.y0).collect();
        Ok(Self { borrowed, owned: vec![None; plan.images().len()], filled })
    }

    /// What is computed of an image, for a pass to read.
    fn view(&self, plan: &Plan, index: usize) -> View<'_> {
        let full = plan.level_size(plan.images()[index].level);
        match &self.owned[index] {
            Some(image) => View::down_to(image, full, self.filled[index]),
            None => View::new(self.image(index), full),
        }
    }

    fn image(&self, index: usize) -> &Image {
        static EMPTY: Image = Image::EMPTY;
        self.borrowed[index].or(self.owned[index].as_ref()).unwrap_or(&EMPTY)
    }

    fn finish(&mut self, index: usize, region: Rect) -> Result<Image> {
        match self.owned[index].take() {
            Some(image) if image.window() == region => Ok(image),
            Some(image) => {
                let part = image.crop(region);
                self.owned[index] = Some(image);
                part
            }
            None => self.image(index).crop(region),
        }
    }

    fn recycle(self, spare: &mut Vec<Image>) {
        spare.extend(self.owned.into_iter().flatten());
    }
}

fn run_bands(
    kernel: fn(&CpuPass<'_>, &mut Band<'_>),
    pass: &CpuPass<'_>,
    window: Rect,
    full: [i32; 2],
    outputs: &mut [Image],
    threads: &dyn Threads,
    control: Control<'_>,
) {
    let height = window.height() as usize;
    // Some bands per thread even out unequal rows; very thin ones would read their halo too often.
    let bands = (threads.count() * 4).clamp(1, height.div_ceil(BAND as usize).max(1));
    let rows = height.div_ceil(bands);
    let count = height.div_ceil(rows);
    let mut jobs: Vec<Mutex<Band<'_>>> = (0..count)
        .map(|i| {
            let y0 = window.y0 + (i * rows) as i32;
            let y1 = (y0 + rows as i32).min(window.y1);
            Mutex::new(Band {
                window: Rect { y0, y1, ..window },
                full,
                outputs: Vec::with_capacity(outputs.len()),
            })
        })
        .collect();
    for image in outputs {
        let (stride, held) = (image.stride(), image.window());
        let at = |y: i32| (y - held.y0) as usize * stride;
        let target = &mut image.data_mut()[at(window.y0)..at(window.y1)];
        for (job, part) in jobs.iter_mut().zip(target.chunks_mut(rows * stride)) {
            if let Ok(band) = job.get_mut() {
                band.outputs.push(part);
            }
        }
    }
    let cancelled = control.cancelled;
    threads.run(jobs.len(), &|i| {
        if cancelled.is_some_and(|c| c()) {
            return;
        }
        // A band is locked once, by the one job that owns it.
        if let Ok(mut band) = jobs[i].lock() {
            kernel(pass, &mut band);
        }
    });
}
