//! `isophote apply`: a node, graph or preset on a picture or a sequence of frames, without any scene.

mod convert;
mod exr;
mod frame;
mod jpeg;
mod memory;
mod pattern;
mod primaries;
mod read;
mod report;
mod sequence;
pub mod sheet;
pub mod throughput;
mod write;

pub use self::exr::GuideChoice;
pub use self::memory::Bytes;

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use self::exr::Selection;
use self::frame::Filter;
use self::memory::Budget;
use self::pattern::Pattern;
use self::report::{Outcome, Report};
use self::sequence::{Run, Task};
use self::write::Format;
use crate::cli::{ApplyArgs, OnMissing};
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::stylize::style::Style;

/// Memory of a run that was given no bound, in bytes.
const USUAL_MEMORY: u64 = 4 << 30;

/// What is read and written, as the command line says.
struct Places<'a> {
    style: Cow<'a, str>,
    input: &'a Path,
    output: &'a Path,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Input`] for bad input, before anything is computed where it can be told then; [`Error::Failure`] when the
/// library or the device fails. Each output is written as a whole or not at all.
pub fn run(args: &ApplyArgs) -> Result<()> {
    let places = places(args)?;
    let format = Format::of(places.output)?;
    let (tasks, missing, sequence) = tasks(args, &places)?;
    let library = Library::open()?;
    let style = Style::load(&library, &places.style, &args.set)?;
    let selection = selection(args, &style, format)?;
    let Some(first) = tasks.first() else {
        return Err(Error::file(places.input, "has none of the frames asked for", "give other --frames"));
    };
    if let Some(task) = tasks.iter().find(|task| task.output.is_dir()) {
        return Err(Error::file(&task.output, "is a folder", "name a file"));
    }
    let opened = match read::open(&first.input, &selection) {
        // A picture that cannot be read is told of before a folder that cannot be written.
        Err(error) if !sequence && !args.skip_existing => return Err(error),
        opened => opened.ok(),
    };
    crate::output::check_writable(&first.output)?;
    crate::output::sweep(&first.output);
    if args.threads > 0 {
        // It may have been set by an earlier run of this process.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(args.threads as usize).build_global();
    }
    let backend = if args.dry_run { crate::cli::Backend::Cpu } else { args.backend };
    let mut filter = Filter::new(library, style, backend, args.space, args.threads)?;
    let needs = match &opened {
        Some(opened) => needs(&filter, first, opened, &selection)?,
        None => None,
    };
    let most = args.memory.map_or(USUAL_MEMORY, |m| m.0);
    if let (Some(memory), Some(needs)) = (args.memory, needs)
        && needs.frame + needs.filter > memory.0
    {
        let least = Bytes(needs.frame + needs.filter);
        return Err(Error::input("--memory", format!("a frame needs about {least}"), "give more"));
    }
    if args.dry_run {
        dry_run(args, &tasks, &missing, needs, most);
        return Ok(());
    }
    let stop = stop_on_signal();
    let budget = Budget::new(most.saturating_sub(needs.map_or(0, |n| n.filter)));
    let report = Report::new(tasks.len() + missing.len(), sequence, args.json);
    for task in &missing {
        report.frame(task, &Outcome::Missing);
    }
    let run = Run {
        tasks: &tasks,
        selection: &selection,
        format,
        skip_existing: args.skip_existing,
        budget: &budget,
        report: &report,
        stop: &stop,
    };
    let result = run.all(&mut filter, opened);
    let counts = report.end(result.is_ok() && !stop.load(Ordering::Relaxed));
    result?;
    if stop.load(Ordering::Relaxed) {
        return Err(Error::failure(
            format!("stopped after {} frames were written", counts.written),
            "start again with --skip-existing to go on",
        ));
    }
    if counts.failed > 0 {
        return Err(Error::file(
            places.input,
            format!("{} of {} frames could not be done", counts.failed, tasks.len()),
            "mend these files and start again with --skip-existing",
        ));
    }
    Ok(())
}

/// The frames that a command would do.
///
/// # Errors
/// [`Error::Input`] when the command names no sequence, or frames are missing and must not be.
pub fn frames_of(args: &ApplyArgs) -> Result<Vec<i64>> {
    let places = places(args)?;
    let (tasks, _, sequence) = tasks(args, &places)?;
    if !sequence {
        return Err(Error::file(places.input, "is no sequence", "write shot.####.exr"));
    }
    Ok(tasks.iter().filter_map(|task| task.frame).collect())
}

/// Set by the first Ctrl-C or termination; the second ends the process at once.
fn stop_on_signal() -> Arc<AtomicBool> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let stop = Arc::new(AtomicBool::new(false));
    for (signal, code) in [(SIGINT, 130), (SIGTERM, 143)] {
        // Where signals cannot be caught they end the process, which leaves whole files too.
        let _ = signal_hook::flag::register_conditional_shutdown(signal, code, Arc::clone(&stop));
        let _ = signal_hook::flag::register(signal, Arc::clone(&stop));
    }
    stop
}

/// A preset stands for the style.
fn places(args: &ApplyArgs) -> Result<Places<'_>> {
    match (&args.output, &args.preset) {
        (Some(output), None) => {
            Ok(Places { style: args.style.to_string_lossy(), input: &args.input, output })
        }
        (None, Some(preset)) => {
            Ok(Places { style: preset.to_string_lossy(), input: &args.style, output: &args.input })
        }
        _ => Err(Error::input(
            "--preset",
            "the preset names the style",
            "give the picture and the result alone, or leave --preset out",
        )),
    }
}

/// All frames that have a file, those that have none, and whether they are a sequence.
fn tasks(args: &ApplyArgs, places: &Places<'_>) -> Result<(Vec<Task>, Vec<Task>, bool)> {
    let (input, output) = (Pattern::new(places.input)?, Pattern::new(places.output)?);
    let Some(input) = input else {
        if args.frames.is_some() {
            return Err(Error::file(places.input, "has no place for a frame number", "write shot.####.exr"));
        }
        let task = Task { frame: None, input: places.input.to_owned(), output: places.output.to_owned() };
        return Ok((vec![task], Vec::new(), false));
    };
    let (frames, holes) = match &args.frames {
        Some(list) => {
            let frames = pattern::frames(list)
                .map_err(|e| Error::input("--frames", e, "write a list such as 1001-1100x2,1200"))?;
            frames.into_iter().partition(|frame| input.file(*frame).is_file())
        }
        None => {
            let frames = input.on_disk()?;
            let holes = pattern::holes(&frames);
            (frames, holes)
        }
    };
    let Some(output) = output else {
        return Err(Error::file(
            places.output,
            "has no place for a frame number, but there may be several frames",
            "write shot.####.exr",
        ));
    };
    if !holes.is_empty() {
        let problem = format!("has no files of the frames {}", pattern::shown(&holes));
        if args.on_missing == OnMissing::Fail {
            return Err(Error::file(places.input, problem, "give other --frames, or --on-missing skip"));
        }
        eprintln!("warning: {}: {problem}", places.input.display());
    }
    let task =
        |frame: &i64| Task { frame: Some(*frame), input: input.file(*frame), output: output.file(*frame) };
    Ok((frames.iter().map(task).collect(), holes.iter().map(task).collect(), true))
}

/// Memory in bytes.
#[derive(Clone, Copy)]
struct Needs {
    /// Of a frame from being read to being written.
    frame: u64,
    /// Of filtering.
    filter: u64,
}

/// What the first frame needs; nothing when it will be refused, which is told when its turn comes.
fn needs(
    filter: &Filter,
    first: &Task,
    opened: &read::Opened,
    selection: &Selection,
) -> Result<Option<Needs>> {
    let Some(size) = opened.size() else { return Ok(None) };
    let name = first.input.display().to_string();
    let filter = filter.working_memory(&name, size, &selection.wanted)?;
    Ok(Some(Needs { frame: opened.weight(), filter }))
}

fn dry_run(args: &ApplyArgs, tasks: &[Task], missing: &[Task], needs: Option<Needs>, most: u64) {
    let is_done = |task: &&Task| args.skip_existing && read::is_whole(&task.output);
    let done = tasks.iter().filter(is_done).count();
    if args.json {
        for task in tasks {
            let status = if is_done(&task) { "skipped" } else { "planned" };
            println!(
                "{}",
                serde_json::json!({
                    "event": "frame", "frame": task.frame, "status": status,
                    "input": task.input.to_string_lossy(), "output": task.output.to_string_lossy(),
                })
            );
        }
        return;
    }
    for task in tasks {
        let note = if is_done(&task) { " (there already)" } else { "" };
        println!("{} -> {}{note}", task.input.display(), task.output.display());
    }
    let mut text = format!("{} frames to be written", tasks.len() - done);
    for (count, what) in [(done, "there already"), (missing.len(), "missing")] {
        if count > 0 {
            text += &format!(", {count} {what}");
        }
    }
    if let Some(needs) = needs {
        let at_once = most.saturating_sub(needs.filter).checked_div(needs.frame).unwrap_or(1);
        text += &format!(
            "; filtering takes about {}, a frame {}, {} at a time",
            Bytes(needs.filter),
            Bytes(needs.frame),
            at_once.clamp(1, sequence::MOST_IN_FLIGHT)
        );
    }
    println!("{text}");
}

/// What is read of EXR files.
fn selection(args: &ApplyArgs, style: &Style, format: Format) -> Result<Selection> {
    if args.into.is_some() && format != Format::Exr {
        return Err(Error::input(
            "--into",
            "only EXR files hold several layers",
            "name a result that ends in .exr",
        ));
    }
    if let Some(bad) = args.into.as_deref().filter(|name| {
        name.is_empty() || name.split('.').any(str::is_empty) || name.contains(char::is_control)
    }) {
        return Err(Error::input(
            "--into",
            format!("'{}' is no name of a layer", bad.escape_default()),
            "name a layer such as cartoon",
        ));
    }
    Ok(Selection {
        layer: args.layer.clone(),
        view: args.view.clone(),
        alpha: args.alpha.clone(),
        into: args.into.clone(),
        guides: args.guide.clone(),
        wanted: frame::usable_guides(style)?,
    })
}
