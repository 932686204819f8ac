//! `isophote bench --card`: all that is to be known of a graphics card in one run, as a report in Markdown for people and one
//! in JSON for programs. It needs nothing but the program and the library.

mod copy;
mod found;
mod report;
mod twins;

use std::path::Path;

use self::found::{Card, Compiled, Loop, Sequence};
use super::gpu::Bench;
use super::throughput;
use super::{Subject, median, picture};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::files::Existing;
use isophote_files::output;
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::apply::filter::{Filter, MaskedStyle};
use isophote_finishing::apply::memory;
use isophote_finishing::apply::planner::Planner;
use isophote_finishing::stylize::precision::Precision;
use isophote_finishing::stylize::preset::Lengths;
use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;
use isophote_render::gpu::Gpu;

/// The style of the loop and of the sequences.
const STYLE: &str = "cartoon";
/// Precisions whose times are measured.
const MEASURED: [Precision; 2] = [Precision::Exact, Precision::Fast];
/// Size of the pictures that twins are compared on, at most.
const TWINS: (u32, u32) = (320, 200);

/// Options of the measurement.
pub struct Options<'a> {
    /// Folder that the reports go to.
    pub folder: &'a Path,
    /// Treatment of reports that are there.
    pub existing: Existing,
    /// Nodes.
    pub subjects: &'a [Subject],
    /// Sizes of pictures.
    pub sizes: &'a [(u32, u32)],
    /// Timed runs, of which the median counts.
    pub runs: u32,
    /// Seconds of the loop.
    pub seconds: f64,
    /// Frames of a sequence.
    pub frames: u32,
}

/// Measures everything and writes the reports. What cannot be measured is told there, and the rest goes on.
///
/// # Errors
/// [`Error::Failure`] without an adapter, and when all is written for twins that differ and for what could not be measured;
/// [`Error::Input`] when the reports cannot be written.
pub fn run(library: &Library, options: &Options<'_>) -> Result<()> {
    std::fs::create_dir_all(options.folder)
        .map_err(|e| Error::file(options.folder, format!("cannot be made: {e}"), "name another folder"))?;
    report::check(options.folder, options.existing)?;
    let gpu = Gpu::open()?;
    let info = gpu.adapter.get_info();
    output::print(&format!("{}\n", info.name))?;
    let mut card = Card {
        version: library.version().to_owned(),
        adapter: info.name,
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        kind: format!("{:?}", info.device_type),
        backend: info.backend.to_string(),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        copied: copy::measure(&gpu)?,
        ..Card::default()
    };
    card.compare(library, options)?;
    for precision in MEASURED {
        let mut setup = Setup { library, bench: Bench::new(gpu.clone(), precision), precision, options };
        card.compile(&mut setup)?;
        for size in options.sizes {
            card.measure(&mut setup, *size)?;
            card.loop_for(&mut setup, *size)?;
            card.sequence(library, precision, options, *size)?;
        }
    }
    report::write(&card, options.folder, options.existing)?;
    let others = card.twins.iter().filter(|twin| !twin.agrees).count();
    match (others, card.problems.len()) {
        (0, 0) => Ok(()),
        (others, problems) => Err(Error::failure(
            format!(
                "of the comparisons with the CPU {others} differ too much, and {problems} measurements failed"
            ),
            "send the report to the authors; --backend cpu or --precision exact may do meanwhile",
        )),
    }
}

/// All that measurements in one precision share.
struct Setup<'a> {
    library: &'a Library,
    bench: Bench,
    precision: Precision,
    options: &'a Options<'a>,
}

impl Card {
    /// Prints the name of a step, does it, and notes why it could not be done.
    fn step<T>(&mut self, what: &str, step: impl FnOnce() -> Result<T>) -> Result<Option<T>> {
        output::print(&format!("{what}\n"))?;
        let done = step();
        self.problems.extend(done.as_ref().err().map(|problem| format!("{what}: {problem}")));
        Ok(done.ok())
    }

    fn compare(&mut self, library: &Library, options: &Options<'_>) -> Result<()> {
        let device = library.device(None).map_err(|e| e.at("the card", "install a graphics driver"))?;
        let smallest = options.sizes.iter().copied().min().unwrap_or(TWINS);
        let picture = picture((smallest.0.min(TWINS.0), smallest.1.min(TWINS.1)));
        for subject in options.subjects {
            let what = format!("{} beside the CPU", subject.label);
            let twins = self.step(&what, || twins::compare(library, &device, subject, &picture))?;
            self.twins.extend(twins.into_iter().flatten());
        }
        Ok(())
    }

    fn compile(&mut self, setup: &mut Setup<'_>) -> Result<()> {
        let Setup { library, bench, precision, options } = setup;
        for subject in options.subjects {
            let what = format!("compiling {}, {}", subject.label, precision.name());
            let seconds = self.step(&what, || bench.compile(library, subject))?;
            let (node, precision) = (subject.label.clone(), precision.name());
            self.compiled.extend(seconds.map(|seconds| Compiled { node, precision, seconds }));
        }
        Ok(())
    }

    fn measure(&mut self, setup: &mut Setup<'_>, size: (u32, u32)) -> Result<()> {
        let Setup { library, bench, precision, options } = setup;
        let picture = picture(size);
        for subject in options.subjects {
            let what = described(&subject.label, *precision, size);
            let entry = self.step(&what, || bench.run(library, subject, &picture, options.runs))?;
            self.entries.extend(entry.map(|entry| (*precision, entry)));
        }
        Ok(())
    }

    fn loop_for(&mut self, setup: &mut Setup<'_>, size: (u32, u32)) -> Result<()> {
        let Setup { library, bench, precision, options } = setup;
        let subject = Subject { label: STYLE.to_owned(), node: STYLE.to_owned(), settings: Vec::new() };
        let what = format!("a loop of {}", described(STYLE, *precision, size));
        let times = self.step(&what, || bench.frames(library, &subject, &picture(size), options.seconds))?;
        self.loops.extend(times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            Loop {
                node: STYLE,
                precision: precision.name(),
                size,
                frames: times.len(),
                most_seconds: times.get(times.len() * 99 / 100).copied().unwrap_or_default(),
                median_seconds: median(times),
            }
        }));
        Ok(())
    }

    fn sequence(
        &mut self,
        library: &Library,
        precision: Precision,
        options: &Options<'_>,
        size: (u32, u32),
    ) -> Result<()> {
        let looks = || {
            let mut style = Style::load(library, STYLE, &[])?;
            style.lengths = Lengths::Pixels;
            precision.apply(&style)?;
            Ok::<_, Error>(vec![MaskedStyle::whole(style)])
        };
        let what = format!("a sequence of {}", described(STYLE, precision, size));
        let measured = self.step(&what, || {
            let planner = Planner::new(library.clone(), looks()?)?;
            // As apply does.
            let mut filters = vec![Filter::new(library.clone(), looks()?, Backend::Gpu, None, 0)?];
            while filters.len() < filters[0].best_count()? {
                filters.push(filters[0].beside(looks()?)?);
            }
            let bound = memory::usual().0;
            throughput::measure(&mut filters, planner, &picture(size), options.frames, bound)
        })?;
        self.sequences.extend(measured.map(|measured| Sequence {
            node: STYLE,
            precision: precision.name(),
            size,
            measured,
        }));
        Ok(())
    }
}

fn described(label: &str, precision: Precision, (width, height): (u32, u32)) -> String {
    format!("{label} at {width}x{height}, {}", precision.name())
}
