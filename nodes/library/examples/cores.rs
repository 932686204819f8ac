//! Times of nodes on machines with more cores than this one, simulated: `cores [WIDTH HEIGHT] NODE...`.
//!
//! The bands of each pass are computed as they are for so many threads, but one after the other, and each is timed. Then they are
//! dealt out as the pool deals them, in their order to the first core that is free. What lies between passes stays with one core.
//! A pass ends when its last band does, and begins [`BARRIER`] later. All cores are taken to be as fast as this one is with nothing
//! beside it: memory that they share, clocks that sink under load, and neighbours are left out, so that no machine is faster.

use isophote::engine::cpu::{Control, CpuExecutor, Threads};
use isophote::engine::{Image, Plan, Rect};
use isophote::{Graph, Planned, Request};
use std::error::Error;
use std::sync::Mutex;
use std::time::Instant;

/// Machines that are simulated, by their cores.
const CORES: [usize; 5] = [1, 2, 8, 32, 128];
/// Seconds from the end of a pass to the beginning of the next, in which threads are woken.
const BARRIER: f64 = 5e-6;
/// Runs that count, after one that takes memory.
const RUNS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut size = [1920, 1080];
    if let [width, height, ..] = arguments.as_slice()
        && let (Ok(width), Ok(height)) = (width.parse(), height.parse())
    {
        size = [width, height];
        arguments.drain(..2);
    }
    if arguments.is_empty() {
        return Err("say nodes, maybe after the width and the height of the picture".into());
    }
    println!("{}x{}; milliseconds, and how many times faster than on one core", size[0], size[1]);
    for node in &arguments {
        report(node, size)?;
    }
    Ok(())
}

/// Prints the times of a node.
fn report(node: &str, [width, height]: [u32; 2]) -> Result<(), Box<dyn Error>> {
    let request = Request { premultiplied: false, reference_height: 1080, ..Request::new(width, height) };
    let planned = Planned::new(&Graph::single(node)?, request)?;
    let picture = picture(width, height)?;
    let times = CORES
        .map(|cores| fastest(planned.plan(), &picture, cores))
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    print!("{node:28}");
    for (cores, time) in CORES.iter().zip(&times) {
        print!("  {cores}: {:.1} (x{:.1})", time.simulated * 1e3, times[0].simulated / time.simulated);
    }
    let last = &times[times.len() - 1];
    println!(
        "  batches {}, serial {:.2} ms, longest bands {:.2} ms",
        last.batches,
        last.serial * 1e3,
        last.longest * 1e3
    );
    Ok(())
}

/// Time of a run, in seconds.
struct Time {
    /// On so many cores.
    simulated: f64,
    /// Outside passes.
    serial: f64,
    /// Of the longest band of each pass, in all.
    longest: f64,
    /// Batches of bands.
    batches: usize,
}

/// The fastest of some runs.
fn fastest(plan: &Plan, picture: &Image, cores: usize) -> Result<Time, Box<dyn Error>> {
    let mut executor = CpuExecutor::new();
    let mut best = None::<Time>;
    for run in 0..=RUNS {
        let dealer = Dealer { cores, dealt: Mutex::default() };
        let all = Rect::of_size(picture.width(), picture.height());
        let started = Instant::now();
        let results = executor.run(plan, &[("color", picture)], all, &dealer, Control::default())?;
        let elapsed = started.elapsed().as_secs_f64();
        results.into_iter().for_each(|image| executor.recycle(image));
        let dealt = dealer.dealt.into_inner().map_err(|_| "a band failed")?;
        let serial = elapsed - dealt.computed;
        let simulated = serial + dealt.taken + BARRIER * dealt.batches as f64;
        if run > 0 && best.as_ref().is_none_or(|best| simulated < best.simulated) {
            best = Some(Time { simulated, serial, longest: dealt.longest, batches: dealt.batches });
        }
    }
    best.ok_or_else(|| "nothing was run".into())
}

/// Threads that compute one after the other, and say when as many cores would have been done.
struct Dealer {
    cores: usize,
    dealt: Mutex<Dealt>,
}

/// What was dealt out, in seconds.
#[derive(Default)]
struct Dealt {
    /// Time of all bands.
    computed: f64,
    /// Time until the last core is done with each batch.
    taken: f64,
    longest: f64,
    batches: usize,
}

impl Threads for Dealer {
    fn count(&self) -> usize {
        self.cores
    }

    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync)) {
        let (mut free, mut longest) = (vec![0.0f64; self.cores], 0.0f64);
        let mut computed = 0.0;
        for index in 0..jobs {
            let started = Instant::now();
            job(index);
            let time = started.elapsed().as_secs_f64();
            computed += time;
            longest = longest.max(time);
            if let Some(first) = free.iter_mut().min_by(|a, b| a.total_cmp(b)) {
                *first += time;
            }
        }
        if let Ok(mut dealt) = self.dealt.lock() {
            dealt.computed += computed;
            dealt.taken += free.into_iter().fold(0.0, f64::max);
            dealt.longest += longest;
            dealt.batches += 1;
        }
    }
}

/// A picture of slow waves and of grain.
fn picture(width: u32, height: u32) -> Result<Image, isophote::engine::Error> {
    let mut grain = 1u32;
    let mut values = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            grain = grain.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = (grain >> 8) as f32 / (1 << 24) as f32 - 0.5;
            let [u, v] = [x, y].map(|place| place as f32 / 97.0);
            let wave = |phase: f32| 0.5 + 0.35 * (u + (v * 0.7 + phase).sin() * 2.0).sin() + 0.1 * noise;
            values.extend([wave(0.0), wave(1.0), wave(2.5), 1.0]);
        }
    }
    Image::from_vec(width, height, 4, values)
}
