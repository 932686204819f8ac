//! Files that a run reads and writes.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::filter::MaskedStyle;
use isophote_files::error::{Error, Result};
use isophote_files::frames::{self, FrameList, Pattern};
use isophote_files::output;
use isophote_files::replacing::Made;

/// One frame, or a picture by itself.
#[derive(Clone, Debug)]
pub struct Task {
    /// Its number in a sequence.
    pub frame: Option<i64>,
    /// Path that is read.
    pub input: PathBuf,
    /// Path that is written.
    pub output: PathBuf,
}

impl Task {
    /// The result, and what it is made from.
    pub fn made(&self) -> Made<'_> {
        Made { from: Some(&self.input), to: &self.output }
    }
}

/// Treatment of missing frames by a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OnMissing {
    /// Stop before anything is made.
    Fail,
    /// Leave them out, and make the others.
    Skip,
}

/// All tasks of a run.
#[derive(Debug)]
pub struct Tasks {
    /// Frames whose input is there; at least one.
    pub ready: Vec<Task>,
    /// Frames of the sequence that have no file.
    pub missing: Vec<Task>,
    /// The sequence that they are of; otherwise they are pictures by themselves.
    pub sequence: Option<Pattern>,
}

impl Tasks {
    /// The picture `input`, or the frames of the pattern `input`: those of `list`, or all that are on disk.
    ///
    /// # Errors
    /// [`Error::Input`] when only one of the two paths is a pattern, there are no frames, or frames are missing
    /// and `on_missing` is [`OnMissing::Fail`].
    pub fn find(
        input: &Path,
        output: &Path,
        list: Option<&FrameList>,
        on_missing: OnMissing,
    ) -> Result<Self> {
        let Some(from) = Pattern::new(input)? else {
            if list.is_some() {
                return Err(Error::file(input, "has no place for a frame number", "write shot.####.exr"));
            }
            let task = Task { frame: None, input: input.to_owned(), output: output.to_owned() };
            return Ok(Self { ready: vec![task], missing: Vec::new(), sequence: None });
        };
        let found = found(&from, list)?;
        let Some(to) = Pattern::in_name(output)? else {
            return Err(Error::file(
                output,
                "has no place for a frame number, but there may be several frames",
                "write shot.####.exr",
            ));
        };
        let to = to.like(&from);
        check_missing(input, &found, on_missing)?;
        Ok(Self::of_frames(from, &found, |frame| to.file(frame)))
    }

    /// The frames of the pattern `input`, as [`Tasks::find`] finds them, which all go into one file.
    ///
    /// # Errors
    /// [`Error::Input`] where it is a picture by itself, and as [`Tasks::find`].
    pub fn into_one(
        input: &Path,
        output: &Path,
        list: Option<&FrameList>,
        on_missing: OnMissing,
    ) -> Result<Self> {
        let Some(from) = Pattern::new(input)? else {
            let problem = format!("is one picture, which makes no video such as {}", output.display());
            return Err(Error::file(input, problem, "name a sequence such as shot.####.png"));
        };
        let found = found(&from, list)?;
        check_missing(input, &found, on_missing)?;
        Ok(Self::of_frames(from, &found, |_| output.to_owned()))
    }

    fn of_frames(from: Pattern, found: &Found, output: impl Fn(i64) -> PathBuf) -> Self {
        let task =
            |frame: &i64| Task { frame: Some(*frame), input: from.file(*frame), output: output(*frame) };
        Self {
            ready: found.ready.iter().map(task).collect(),
            missing: found.missing.iter().map(task).collect(),
            sequence: Some(from),
        }
    }

    /// Pictures that have nothing to do with each other; at least one.
    pub fn of_pictures(ready: Vec<Task>) -> Self {
        Self { ready, missing: Vec::new(), sequence: None }
    }

    /// True where one that fails does not end the run.
    pub fn are_several(&self) -> bool {
        self.is_sequence() || self.ready.len() > 1
    }

    /// True where they are frames of a sequence.
    pub fn is_sequence(&self) -> bool {
        self.sequence.is_some()
    }

    /// Warns of keyframes of looks that no frame of a sequence reaches.
    pub fn warn_of_keys_beyond(&self, looks: &[MaskedStyle]) {
        if self.is_sequence() {
            let all = self.ready.iter().chain(&self.missing);
            let frames: Vec<i64> = all.filter_map(|task| task.frame).collect();
            looks.iter().for_each(|look| look.style.warn_of_keys_beyond(&frames));
        }
    }

    /// Word for them in messages.
    pub fn noun(&self) -> &'static str {
        if !self.is_sequence() && self.are_several() { "pictures" } else { "frames" }
    }

    /// Number of frames, with those that are missing.
    pub fn count(&self) -> usize {
        self.ready.len() + self.missing.len()
    }
}

/// Numbers of frames.
struct Found {
    ready: Vec<i64>,
    missing: Vec<i64>,
}

/// The frames of a pattern: those of `list`, or all that are on disk.
fn found(from: &Pattern, list: Option<&FrameList>) -> Result<Found> {
    let (ready, missing) = match list {
        Some(list) => list.frames().iter().partition(|frame| from.file(**frame).is_file()),
        None => {
            let frames = from.on_disk()?;
            let holes = if from.is_of_tiles() { Vec::new() } else { frames::holes(&frames) };
            (frames, holes)
        }
    };
    if ready.is_empty() {
        // A pattern that no file has is the likelier mistake.
        from.on_disk()?;
    }
    Ok(Found { ready, missing })
}

/// Refuses missing frames, or warns of them, and refuses a run of none.
fn check_missing(input: &Path, Found { ready, missing }: &Found, on_missing: OnMissing) -> Result<()> {
    if missing.is_empty() && !ready.is_empty() {
        return Ok(());
    }
    let problem = format!("has no files of the frames {}", frames::summary(missing));
    if on_missing == OnMissing::Fail {
        return Err(Error::file(input, problem, "give other --frames, or --on-missing skip"));
    }
    output::warn(format_args!("{}: {problem}", input.display()));
    if ready.is_empty() {
        return Err(Error::file(input, "has none of the frames asked for", "give other --frames"));
    }
    Ok(())
}
