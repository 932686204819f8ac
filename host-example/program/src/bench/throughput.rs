//! Measures, for `isophote bench`, how well reading and writing of a sequence hide behind filtering.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::resident::Resident;
use isophote_files::error::{Error, Result};
use isophote_files::files::Existing;
use isophote_files::limits::Threads;
use isophote_files::replacing::Consent;
use isophote_files::stop::Stop;
use isophote_finishing::apply::filter::Filter;
use isophote_finishing::apply::frame_cache::{CachedFrame, Window};
use isophote_finishing::apply::masks::Masks;
use isophote_finishing::apply::memory::Budget;
use isophote_finishing::apply::planner::Planner;
use isophote_finishing::apply::reader::{FrameSource, Reader};
use isophote_finishing::apply::report::Report;
use isophote_finishing::apply::sequence::Run;
use isophote_finishing::apply::tasks::Task;
use isophote_pictures::exr::{Selection, components};
use isophote_pictures::floats::{self, Picture, Precision};
use isophote_pictures::pixels::Pixels;
use isophote_pictures::read;
use isophote_pictures::write::Format;

/// Throughput that was measured.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Throughput {
    /// Frames of the sequence.
    pub frames: u32,
    /// Seconds that filtering them takes by itself, from memory to memory.
    pub filter_seconds: f64,
    /// Seconds of the whole run, from file to file.
    pub seconds: f64,
    /// Most memory of the process during the run, bytes; not on all systems.
    pub peak_bytes: Option<u64>,
    /// The bound that the run was given, bytes.
    pub bound_bytes: u64,
}

/// Finishes `frames` EXR frames of half floats, scan lines and ZIP compression, all of them `picture` (RGBA),
/// within `bound` bytes. `filters`, at least one, take frames in turn; `planner` is of their style.
///
/// # Errors
/// [`Error::Input`] for styles that do not fit, [`Error::Failure`] when there is no room for the files.
pub fn measure(
    filters: &mut [Filter],
    planner: Planner,
    picture: &Pixels,
    frames: u32,
    bound: u64,
) -> Result<Throughput> {
    let folder = tempfile::tempdir().map_err(|e| Error::failure(e, "make room for temporary files"))?;
    let tasks: Vec<Task> = (1..=i64::from(frames))
        .map(|frame| Task {
            frame: Some(frame),
            input: folder.path().join(format!("in.{frame:04}.exr")),
            output: folder.path().join(format!("out.{frame:04}.exr")),
        })
        .collect();
    for task in &tasks {
        save(&task.input, picture)?;
    }
    let selection = Selection { wanted: planner.guides().to_vec(), ..Selection::default() };
    let mut filter_seconds = 0.0;
    let (budget, report) = (Budget::new(bound, filters.len()), Report::new(tasks.len(), false, false));
    let masks = Masks::default();
    let frame_source =
        FrameSource { frames: None, motion: None, selection: &selection, masks: &masks, budget: &budget };
    // The first of these runs makes the plan and is not counted.
    for (at, task) in tasks.iter().take(1).chain(&tasks).enumerate() {
        let source = read::read(&task.input, &selection)?;
        let own = Arc::new(CachedFrame::new(task.frame, source, true, budget.share()));
        let (exr, window) = (own.take_exr(), Window { own: Arc::clone(&own), frames: vec![own] });
        let started = Instant::now();
        filters[0].run("a frame", &window, exr.as_ref(), Format::Exr, &mut |_| {})?;
        if at > 0 {
            filter_seconds += started.elapsed().as_secs_f64();
        }
    }
    let stop = Stop::default();
    let run = Run {
        tasks: &tasks,
        options: Default::default(),
        consent: Consent::default(),
        threads: Threads::Several,
        report: &report,
        stop: &stop,
    };
    let resident = Resident::new();
    let started = Instant::now();
    let result = run.all(filters, Reader::new(frame_source, planner, &tasks, None));
    let seconds = started.elapsed().as_secs_f64();
    let counts = report.end(false);
    result?;
    if counts.written != u64::from(frames) {
        return Err(Error::failure(
            format!("{} frames failed", counts.failed),
            "make room for temporary files",
        ));
    }
    Ok(Throughput { frames, filter_seconds, seconds, peak_bytes: resident.peak(), bound_bytes: bound })
}

fn save(path: &Path, picture: &Pixels) -> Result<()> {
    let data = Picture {
        width: picture.width(),
        height: picture.height(),
        channels: picture.channels() as usize,
        data: picture.to_f32(),
    };
    floats::save_exr(
        path,
        Existing::Keep,
        &data,
        components(picture.channels()),
        Precision::Half,
        (None, None),
    )
}
