//! `isophote bench`: what each node and each of its passes takes, on the CPU and on the GPU.
//!
//! Every number is the median of warm runs: plans are made, memory is allocated and shaders are compiled
//! before. The CPU's are set against what the machine can do at most, measured in the same run; a small picture
//! that stays in the caches may be copied faster than that.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fearless_simd::Level;

use super::shared::{ForceArgs, PrecisionArgs, parse_size};
use crate::bench::compare::Saved;
use crate::bench::report::{Machine, Report, Shown};
use crate::bench::{Subject, card, cpu, gpu, peak, picture, sequence};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::files;
use isophote_files::output;
use isophote_files::replacing::{Inputs, Made};
use isophote_loader::Library;
use isophote_render::gpu::Gpu;

/// Sizes that are measured when none is given.
const SIZES: [(u32, u32); 2] = [(1280, 720), (1920, 1080)];
/// The same of a graphics card.
const CARD_SIZES: [(u32, u32); 2] = [(1920, 1080), (3840, 2160)];
/// Frames of the sequences of a graphics card.
const CARD_FRAMES: u32 = 12;

/// Options of `bench`.
#[derive(Args, Debug)]
#[command(
    after_help = "Times are medians of warm runs, without the conversion of pixels in and out. Nodes that are steady, such as cartoon,steadiness=0.5, are measured on frames in order of which those before are known. On the GPU, upload and download are a picture's way there and the result's way back, which OpenFX hosts wait for as well."
)]
pub struct BenchArgs {
    /// Prints JSON.
    #[arg(long)]
    json: bool,
    /// Backend to measure [default: both].
    #[arg(long, value_enum)]
    backend: Option<BenchBackend>,
    #[command(flatten)]
    precision: PrecisionArgs,
    /// Size of the picture in pixels [default: 1280x720 and 1920x1080].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// Measures only this node, with parameters after commas, such as oriented_bilateral,iterations=1. May be
    /// repeated.
    #[arg(long, value_name = "ID[,PARAM=VALUE]...")]
    node: Vec<String>,
    /// Also writes the measurements to this file, for --compare.
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Compares with an earlier run, saved with --save: x0.50 is twice as fast. Both runs need an otherwise idle
    /// machine.
    #[arg(long, value_name = "FILE")]
    compare: Option<PathBuf>,
    /// Measures a sequence of so many EXR frames (half floats, ZIP) on the CPU instead, from file to file, and
    /// compares it with filtering alone; cartoon at 1920x1080 unless --node and --size say otherwise.
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["save", "compare", "markdown", "backend"],
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    sequence: Option<u32>,
    /// Measures all that is to be known of a graphics card, and writes a report of it into this folder, card.md and card.json:
    /// whether it computes what the CPU does, what nodes and their passes take in 1920x1080 and 3840x2160 and which share that
    /// is of what the card can copy, what compiling takes, a loop of ten seconds, and sequences from file to file.
    #[arg(long, value_name = "DIR",
        conflicts_with_all = ["save", "compare", "markdown", "backend", "json", "sequence", "precision"])]
    card: Option<PathBuf>,
    /// Seconds of the loop of --card.
    #[arg(long, value_name = "S", default_value_t = 10.0, requires = "card", value_parser = parse_seconds)]
    seconds: f64,
    /// Prints a table in Markdown, beside the times of comparable programs where those are known.
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Timed runs, of which the median counts, after one that is not timed.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    runs: u32,
    #[command(flatten)]
    force: ForceArgs,
}

/// Backend that `bench` measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BenchBackend {
    /// The CPU, against its own peak.
    Cpu,
    /// The best graphics device there is.
    Gpu,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Failure`] without a library, and without an adapter when the GPU was asked for;
/// [`Error::Input`] for nodes that do not exist.
pub fn run(args: &BenchArgs) -> Result<()> {
    if let Some(path) = &args.save {
        let made = Made { from: None, to: path };
        args.force.consent().check(&[made], false, || Ok(Inputs::of(&args.compare)))?;
        files::check_writable(path, args.force.existing())?;
    }
    let library = Library::open()?;
    if let Some(frames) = args.sequence {
        let usual = ["cartoon".to_owned()];
        let subjects = subjects(&library, if args.node.is_empty() { &usual } else { &args.node })?;
        return sequence::run(&subjects, &picture(args.size.unwrap_or(SIZES[1])), frames, args.json);
    }
    let subjects = subjects(&library, &args.node)?;
    if let Some(folder) = &args.card {
        return card::run(
            &library,
            &card::Options {
                folder,
                existing: args.force.existing(),
                subjects: &subjects,
                sizes: &args.size.map_or(CARD_SIZES.to_vec(), |size| vec![size]),
                runs: args.runs,
                seconds: args.seconds,
                frames: CARD_FRAMES,
            },
        );
    }
    let before = args.compare.as_deref().map(Saved::read).transpose()?;
    let gpu = match args.backend {
        Some(BenchBackend::Cpu) => None,
        Some(BenchBackend::Gpu) => Some(Gpu::open()?),
        None => Gpu::open().map_err(|e| output::warn(format_args!("the GPU is left out: {e}"))).ok(),
    };
    let mut gpu = gpu.map(|gpu| gpu::Bench::new(gpu, args.precision.precision));
    let on_cpu = args.backend != Some(BenchBackend::Gpu);
    let machine = machine(on_cpu, gpu.as_ref())?;
    let shown = match (args.json, args.markdown) {
        (true, _) => Shown::Json,
        (_, true) => Shown::Markdown,
        _ => Shown::Table,
    };
    let mut report = Report::new(&library, machine, args.runs, shown, before);
    report.print_heading()?;
    let sizes = args.size.map_or(SIZES.to_vec(), |size| vec![size]);
    for size in sizes {
        let picture = picture(size);
        for subject in &subjects {
            if on_cpu {
                report.add(cpu::run(&library, subject, &picture, args.runs)?)?;
            }
            if let Some(gpu) = &mut gpu {
                report.add(gpu.run(&library, subject, &picture, args.runs)?)?;
            }
        }
    }
    if let Some(path) = &args.save {
        files::write_bytes(path, args.force.existing(), report.json()?.as_bytes())?;
    }
    report.print_end()
}

/// Machine that times are taken on; with the most that its cores do if `on_cpu`.
fn machine(on_cpu: bool, gpu: Option<&gpu::Bench>) -> Result<Machine> {
    let pool = rayon::ThreadPoolBuilder::new().build();
    let pool = pool.map_err(|e| Error::failure(e, "close other programs"))?;
    let peak = on_cpu.then(|| peak::measure(Level::new(), &pool));
    Ok(Machine::new(pool.current_num_threads(), peak, gpu.map(gpu::Bench::adapter)))
}

/// A number of seconds, 0 or more.
fn parse_seconds(text: &str) -> std::result::Result<f64, String> {
    let seconds = text.parse().ok().filter(|s: &f64| (0.0..=3600.0).contains(s));
    seconds.ok_or_else(|| "write a number from 0 to 3600".to_owned())
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
