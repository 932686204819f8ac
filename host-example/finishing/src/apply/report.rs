//! Progress of a run: a bar for people, lines of JSON for programs, and a summary.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use super::tasks::{Task, Tasks};
use isophote_files::error::{Error, Result};
use isophote_files::output;
use isophote_files::replacing::Consent;

/// Outcome of a frame.
#[derive(Debug)]
pub enum Outcome {
    /// It was written; so many samples were replaced.
    Written(u64),
    /// Its result was there already.
    Skipped,
    /// It has no file.
    Missing,
    /// It could not be done.
    Failed(Error),
}

/// Numbers of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Frames that were written.
    pub written: u64,
    /// Frames whose result was there already.
    pub skipped: u64,
    /// Frames without a file.
    pub missing: u64,
    /// Frames that could not be done.
    pub failed: u64,
    /// Samples that were NaN or infinite and were replaced.
    pub replaced: u64,
}

impl Counts {
    /// Frames that are over, of those that have a file.
    pub fn done(&self) -> u64 {
        self.written + self.skipped + self.failed
    }

    /// Checks that all of these were done.
    ///
    /// # Errors
    /// [`Error::Failure`] when the run was stopped before, and as [`check_failed`].
    pub fn check(&self, input: &Path, tasks: &Tasks, consent: Consent) -> Result<()> {
        if self.done() < tasks.ready.len() as u64 {
            let problem = format!("stopped after {} {} were written", self.written, tasks.noun());
            return Err(Error::failure(problem, consent.resuming()));
        }
        check_failed(input, self.failed, tasks, consent)
    }
}

/// Checks that none of them failed.
///
/// # Errors
/// [`Error::Input`] with how many did.
pub fn check_failed(input: &Path, failed: u64, tasks: &Tasks, consent: Consent) -> Result<()> {
    match failed {
        0 => Ok(()),
        _ => Err(Error::file(
            input,
            format!("{failed} of {} {} could not be done", tasks.ready.len(), tasks.noun()),
            format!("fix these files and {}", consent.resuming()),
        )),
    }
}

/// Prints the progress of a run and counts its frames.
#[derive(Debug)]
pub struct Report {
    bar: ProgressBar,
    json: bool,
    sequence: bool,
    /// True where every result gets a line.
    lists: bool,
    /// True where nothing is told of what goes well.
    quiet: bool,
    /// Result as people are told of it, with its size where that is known.
    result: Option<(PathBuf, Option<(u32, u32)>)>,
    /// Number of all frames; none where nobody knows exactly.
    frames: Option<u64>,
    /// Hundredths of the picture that were told of.
    told: AtomicU32,
    /// True where it was said that nothing can be printed.
    unheard: AtomicBool,
    started: Instant,
    counts: Mutex<Counts>,
}

impl Report {
    /// A report on so many frames; of a picture by itself the bar shows the share of the work done.
    pub fn new(frames: usize, sequence: bool, json: bool) -> Self {
        let bar = if json {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(if sequence { frames as u64 } else { 1000 })
        };
        let template =
            if sequence { "{wide_bar} {pos}/{len} {per_sec} {eta}" } else { "{wide_bar} {percent} %" };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let report = Self {
            bar,
            json,
            sequence,
            lists: false,
            quiet: false,
            result: None,
            frames: Some(frames as u64),
            told: AtomicU32::new(0),
            unheard: AtomicBool::new(false),
            started: Instant::now(),
            counts: Mutex::new(Counts::default()),
        };
        report.line(&json!({"event": "start", "frames": frames}));
        report
    }

    /// The same where the number of frames is a guess.
    pub fn about(frames: usize, json: bool) -> Self {
        Self { frames: None, ..Self::new(frames, true, json) }
    }

    /// A report on so many pictures that have nothing to do with each other, with a line for each result.
    pub fn listing(pictures: usize, json: bool) -> Self {
        Self { lists: true, ..Self::new(pictures, true, json) }
    }

    /// The same without a word on what goes well.
    #[must_use]
    pub fn quietly(mut self, quiet: bool) -> Self {
        if quiet {
            self.bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        self.quiet = quiet;
        self
    }

    /// The same with the result that the last line names: a picture and its size in pixels, or a pattern or a video.
    #[must_use]
    pub fn of_result(mut self, result: &Path, size: Option<(u32, u32)>) -> Self {
        self.result = Some((result.to_owned(), size));
        self
    }

    /// The share of the frame at hand that is done.
    pub fn progress(&self, done: f32) {
        if self.sequence {
            return;
        }
        self.bar.set_position((done * 1000.0) as u64);
        let hundredths = (done * 100.0) as u32;
        if self.json && self.told.fetch_max(hundredths, Ordering::Relaxed) < hundredths {
            self.line(&json!({"event": "progress", "done": f64::from(hundredths) / 100.0}));
        }
    }

    /// A frame is over.
    pub fn frame(&self, task: &Task, outcome: &Outcome) {
        let mut counts = self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        let (status, replaced, problem) = match outcome {
            Outcome::Written(replaced) => {
                counts.written += 1;
                counts.replaced += replaced;
                ("written", *replaced, None)
            }
            Outcome::Skipped => {
                counts.skipped += 1;
                ("skipped", 0, None)
            }
            Outcome::Missing => {
                counts.missing += 1;
                ("missing", 0, None)
            }
            Outcome::Failed(error) => {
                counts.failed += 1;
                ("failed", 0, Some(error.to_string()))
            }
        };
        if replaced > 0 {
            let name = task.input.display();
            self.warn(&format!("{name}: {replaced} samples were NaN or infinite and were replaced"));
        }
        if let (Some(problem), true) = (&problem, self.sequence && !self.json) {
            self.warn(problem);
        }
        if self.sequence {
            self.bar.inc(1);
        }
        if self.lists
            && !self.json
            && !self.quiet
            && matches!(outcome, Outcome::Written(_) | Outcome::Skipped)
        {
            let note = if matches!(outcome, Outcome::Skipped) { " (there already)" } else { "" };
            let text = format!("{} -> {}{note}\n", task.input.display(), task.output.display());
            self.bar.suspend(|| self.say(&text));
        }
        self.line(&json!({
            "event": "frame",
            "frame": task.frame,
            "status": status,
            "input": task.input.to_string_lossy(),
            "output": task.output.to_string_lossy(),
            "replaced": replaced,
            "error": problem,
            "seconds": self.started.elapsed().as_secs_f64(),
        }));
    }

    /// Warns, beside the bar.
    pub fn warn(&self, warning: &str) {
        self.bar.suspend(|| output::warn(warning));
    }

    /// Takes back that frames were written, since their file is not there.
    pub fn nothing_written(&self) {
        self.counts.lock().unwrap_or_else(PoisonError::into_inner).written = 0;
    }

    /// The run is over; one that failed is summed up by its error.
    pub fn end(&self, whole: bool) -> Counts {
        let counts = *self.counts.lock().unwrap_or_else(PoisonError::into_inner);
        self.bar.finish_and_clear();
        let seconds = self.started.elapsed().as_secs_f64();
        self.line(&json!({
            "event": "end",
            "written": counts.written,
            "skipped": counts.skipped,
            "missing": counts.missing,
            "failed": counts.failed,
            "replaced": counts.replaced,
            "seconds": seconds,
        }));
        let is_complete =
            counts.failed == 0 && self.frames.is_none_or(|frames| counts.done() + counts.missing == frames);
        if !self.lists && !self.json && !self.quiet && whole && is_complete {
            self.sum_up(&counts, seconds);
        }
        counts
    }

    /// The one line on a run that went well.
    fn sum_up(&self, counts: &Counts, seconds: f64) {
        let Some((result, size)) = &self.result else { return };
        let result = result.display();
        let mut text = match (self.sequence, counts.written) {
            (true, written) => format!("{written} frames written in {seconds:.1} s"),
            (false, 0) => format!("{result}: there already"),
            (false, _) => {
                let size = size.map_or_else(String::new, |(width, height)| format!("{width}x{height}, "));
                format!("{result}: {size}{seconds:.1} s")
            }
        };
        let notes = [
            (counts.skipped, "there already"),
            (counts.missing, "missing"),
            (counts.failed, "failed"),
            (counts.replaced, "samples replaced"),
        ];
        for (count, what) in notes.into_iter().filter(|(count, _)| self.sequence && *count > 0) {
            text += &format!(", {count} {what}");
        }
        if self.sequence {
            text += &format!(": {result}");
        }
        self.say(&format!("{text}\n"));
    }

    /// Prints; the frames are written, whether or not anybody is told.
    fn say(&self, text: &str) {
        if let Err(error) = output::print(text)
            && !self.unheard.swap(true, Ordering::Relaxed)
        {
            output::warn(error);
        }
    }

    fn line(&self, value: &Value) {
        if self.json {
            self.say(&format!("{value}\n"));
        }
    }
}
