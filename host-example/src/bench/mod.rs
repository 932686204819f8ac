//! `isophote bench`: what each node and each of its passes takes, on the CPU and on the GPU.
//!
//! Every number is the median of warm runs: plans are made, memory is allocated and shaders are compiled
//! before. The CPU's are set against what the machine can do at most, measured in the same run; a small picture
//! that stays in the caches may be copied faster than that.

mod compare;
mod cpu;
mod gpu;
mod peak;
mod peers;
mod report;
mod sequence;

use std::path::Path;

use isophote_engine::cpu::Pool;
use isophote_engine::fearless_simd::Level;

use self::compare::Saved;
use self::report::{Machine, Report, Shown};
use crate::cli::{BenchArgs, BenchBackend};
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::pixels::{Pixels, Samples};
use crate::render::gpu::Gpu;
use crate::stylize::style::Setting;

/// Sizes that are measured when none is given.
const SIZES: [(u32, u32); 2] = [(1280, 720), (1920, 1080)];

/// Runs the verb.
///
/// # Errors
/// [`Error::Failure`] without a library, and without an adapter when the GPU was asked for;
/// [`Error::Input`] for nodes that do not exist.
pub fn run(args: &BenchArgs) -> Result<()> {
    let library = Library::open()?;
    if let Some(frames) = args.sequence {
        let usual = ["cartoon".to_owned()];
        let subjects = subjects(&library, if args.node.is_empty() { &usual } else { &args.node })?;
        return sequence::run(&subjects, &picture(args.size.unwrap_or(SIZES[1])), frames, args.json);
    }
    let subjects = subjects(&library, &args.node)?;
    let before = args.compare.as_deref().map(Saved::read).transpose()?;
    let gpu = match args.backend {
        Some(BenchBackend::Cpu) => None,
        Some(BenchBackend::Gpu) => Some(Gpu::open()?),
        None => Gpu::open().map_err(|e| eprintln!("warning: the GPU is left out: {e}")).ok(),
    };
    let mut gpu = gpu.map(gpu::Bench::new);
    let on_cpu = args.backend != Some(BenchBackend::Gpu);
    let pool = Pool::new(0).map_err(|e| Error::failure(e, "close other programs"))?;
    let machine = Machine::new(
        isophote_engine::cpu::Threads::count(&pool),
        on_cpu.then(|| peak::measure(Level::new(), &pool)),
        gpu.as_ref().map(gpu::Bench::adapter),
    );
    drop(pool);
    let shown = match (args.json, args.markdown) {
        (true, _) => Shown::Json,
        (_, true) => Shown::Markdown,
        _ => Shown::Table,
    };
    let mut report = Report::new(&library, machine, args.runs, shown, before);
    report.print_heading();
    let sizes = args.size.map_or(SIZES.to_vec(), |size| vec![size]);
    for size in sizes {
        let picture = picture(size);
        for subject in &subjects {
            if on_cpu {
                report.add(cpu::run(&library, subject, &picture, args.runs)?);
            }
            if let Some(gpu) = &mut gpu {
                report.add(gpu.run(&library, subject, &picture, args.runs)?);
            }
        }
    }
    if let Some(path) = &args.save {
        save(path, &report)?;
    }
    report.print_end()
}

fn save(path: &Path, report: &Report) -> Result<()> {
    std::fs::write(path, report.json()?).map_err(|e| Error::file(path, e, "choose another file"))
}

/// What is measured: a node, with other values than the defaults where they are given.
#[derive(Debug)]
pub struct Subject {
    /// As it was written.
    label: String,
    /// Id of the node.
    node: String,
    settings: Vec<Setting>,
}

/// The nodes asked for, or all.
fn subjects(library: &Library, wanted: &[String]) -> Result<Vec<Subject>> {
    let mut subjects = Vec::new();
    for label in wanted {
        let fail = |e: String| Error::input(format!("--node {label}"), e, "such as gaussian,sigma=3");
        let mut parts = label.split(',');
        let id = parts.next().unwrap_or_default();
        let node = library
            .find_node(id)
            .map_err(|e| e.at(format!("--node {label}"), "`isophote nodes` lists all"))?;
        let settings = parts.map(str::parse).collect::<std::result::Result<_, String>>().map_err(fail)?;
        subjects.push(Subject { label: label.clone(), node: node.id.to_owned(), settings });
    }
    if subjects.is_empty() {
        let catalogue = library.catalogue().map_err(|e| e.at("the catalogue", "use another library"))?;
        let plain = |id: &str| Subject { label: id.to_owned(), node: id.to_owned(), settings: Vec::new() };
        subjects.extend(catalogue.nodes.iter().map(|n| plain(n.id)));
    }
    Ok(subjects)
}

/// A picture that has what pictures have: slow changes, edges in all directions, fine detail.
fn picture((width, height): (u32, u32)) -> Pixels {
    let mut samples = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
            let cell = [(x % 160) as f32 - 80.0, (y % 160) as f32 - 80.0];
            let disc = if cell[0].hypot(cell[1]) < 50.0 { 0.35 } else { 0.0 };
            let hash = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77)).wrapping_mul(0xc2b2_ae3d);
            let noise = (hash >> 24) as f32 / 255.0 * 0.04;
            let waves = 0.05 * (x as f32 * 0.3 + y as f32 * 0.1).sin();
            samples.extend([
                0.1 + 0.5 * u + disc + noise,
                0.2 + 0.4 * v + noise + waves,
                0.6 - disc + noise,
                1.0,
            ]);
        }
    }
    // Four samples were made for each pixel.
    let black = || Pixels::zeroed(width, height, 4, crate::pixels::Precision::F32);
    Pixels::new(width, height, 4, Samples::F32(samples)).unwrap_or_else(black)
}

/// The middle one of some numbers, the mean of the middle two; 0 of none.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let count = numbers.len();
    match (numbers.get(count.saturating_sub(1) / 2), numbers.get(count / 2)) {
        (Some(a), Some(b)) => (a + b) / 2.0,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![]), 0.0);
        assert_eq!(median(vec![3.0]), 3.0);
        assert_eq!(median(vec![9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![9.0, 1.0, 2.0, 4.0]), 3.0);
    }
}
