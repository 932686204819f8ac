//! Reading frames with their neighbours, each file once where frames are done in order.
//!
//! A frame takes its share of the memory before it is decoded, and keeps it until neither it nor a frame that depends on it
//! is left to be done.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::frame_cache::{CachedFrame, Window};
use super::masks::Masks;
use super::memory::{Budget, Needs, too_large};
use super::planner::Planner;
use super::tasks::Task;
use isophote_files::error::{Error, Result};
use isophote_files::frames::Pattern;
use isophote_files::limits;
use isophote_pictures::exr::{self, Selection};
use isophote_pictures::read::{Opened, Source, Unread};

/// Source of the frames of a run.
#[derive(Clone, Copy, Debug)]
pub struct FrameSource<'a> {
    /// The sequence, whose frames beyond the run's are read where others depend on them.
    pub frames: Option<&'a Pattern>,
    /// Motion vectors in files of their own.
    pub motion: Option<&'a Pattern>,
    /// Selection of what is read of EXR files.
    pub selection: &'a Selection,
    /// Masks of the run.
    pub masks: &'a Masks,
    /// Memory of frames in flight.
    pub budget: &'a Budget,
}

/// Reads the frames of a run.
#[derive(Debug)]
pub struct Reader<'a> {
    frame_source: FrameSource<'a>,
    /// Knows what frames depend on and need.
    planner: Planner,
    /// Frames whose result will be written.
    tasks: HashSet<i64>,
    /// The first frame, where it was opened before.
    first: Option<(PathBuf, Opened)>,
    /// Frames that the last one depended on; none where a file cannot be read.
    cached: Vec<(i64, Option<Arc<CachedFrame<'a>>>)>,
}

impl<'a> Reader<'a> {
    /// Of the frames `tasks`, of which `first` is the first, where it was opened before.
    pub fn new(
        frame_source: FrameSource<'a>,
        planner: Planner,
        tasks: &[Task],
        first: Option<Opened>,
    ) -> Self {
        let first = tasks.first().map(|task| task.input.clone()).zip(first);
        let tasks = tasks.iter().filter_map(|task| task.frame).collect();
        Self { frame_source, planner, tasks, first, cached: Vec::new() }
    }

    /// Forgets that the first frame was opened: it is not done.
    pub fn skip(&mut self) {
        self.first = None;
    }

    /// Reads a frame and the neighbours that it depends on and that there are. Waits for room.
    ///
    /// # Errors
    /// The problem with the frame's own file, and [`Error::Failure`] where memory is short.
    pub fn window(&mut self, task: &Task) -> Result<Window<'a>> {
        let Some(frame) = task.frame else {
            let own = Arc::new(self.read(&task.input, None, 1)?);
            own.source.check()?;
            return Ok(Window { own: Arc::clone(&own), frames: vec![own] });
        };
        let [past, future] = self.planner.frames(task.frame)?;
        let wanted = frame - past..=frame + future;
        self.cached.retain(|(number, _)| wanted.contains(number));
        let span = self.planner.span(task.frame)?;
        let own = self.frame(frame, &task.input, span)?;
        own.source.check()?;
        for towards in [-1, 1] {
            let reach = if towards < 0 { past } else { future };
            for number in (1..=reach).map(|n| frame + towards * n) {
                let Some(pattern) = self.frame_source.frames else { break };
                let path = pattern.file(number);
                let is_bad = self.cached.iter().any(|(n, cached)| *n == number && cached.is_none());
                if is_bad || !path.is_file() {
                    break;
                }
                match self.frame(number, &path, span) {
                    Ok(_) => {}
                    Err(error @ Error::Failure { .. }) => return Err(error),
                    Err(_) => {
                        // The frame is done as if there were none; a task of this number will tell.
                        self.cached.push((number, None));
                        break;
                    }
                }
            }
        }
        Ok(Window { own, frames: self.cached.iter().filter_map(|(_, cached)| cached.clone()).collect() })
    }

    /// A frame, from memory or from its file.
    fn frame(&mut self, number: i64, path: &Path, span: u64) -> Result<Arc<CachedFrame<'a>>> {
        if let Some((_, cached)) = self.cached.iter().find(|(n, _)| *n == number)
            && let Some(cached) = cached
        {
            return Ok(Arc::clone(cached));
        }
        let cached = Arc::new(self.read(path, Some(number), span)?);
        self.cached.retain(|(n, _)| *n != number);
        self.cached.push((number, Some(Arc::clone(&cached))));
        Ok(cached)
    }

    /// Reads a frame when there is room for its file, and decodes it when there is room for all that it needs; `span` frames
    /// are held together.
    fn read(&mut self, path: &Path, number: Option<i64>, span: u64) -> Result<CachedFrame<'a>> {
        let FrameSource { selection, budget, .. } = self.frame_source;
        let share = budget.share();
        let grow = |needs: Needs| {
            let together = needs.of(span);
            share.grow(needs, together.total()).map_err(|most| too_large(path, span, together, most))
        };
        let opened = match self.first.take_if(|(first, _)| first == path) {
            Some((_, opened)) => opened,
            None => {
                let file = Unread::open(path)?;
                grow(Needs { frame: file.length(), filter: 0 })?;
                file.read(path, selection)?
            }
        };
        let needs = self.planner.needs(path, number, &opened)?;
        if let Some(needs) = needs {
            grow(needs)?;
            limits::must_have(needs.total(), &path.display().to_string())?;
        }
        let mut source = opened.decode(path)?;
        if let (Some(pattern), Some(number)) = (self.frame_source.motion, number) {
            add_motion(&mut source, &pattern.file(number), selection)?;
        }
        let is_written = number.is_none_or(|number| self.tasks.contains(&number));
        self.frame_source.masks.add(&mut source, number)?;
        self.planner.square(&path.display().to_string(), &mut source)?;
        let bound = needs.map_or(0, |needs| needs.filter);
        Ok(CachedFrame::new(number, source, is_written, share).within(bound))
    }
}

/// Adds the motion of a file of its own to what is known of a frame; nothing where there is no such file, as often before
/// the first frame.
fn add_motion(source: &mut Source, path: &Path, selection: &Selection) -> Result<()> {
    if !path.is_file() {
        return Ok(());
    }
    let bytes = Unread::open(path)?.bytes(path)?;
    for picture in &mut source.pictures {
        let found = exr::motion_of(path, bytes.clone(), selection, picture)?;
        picture.guides.retain(|(name, _)| found.iter().all(|(other, _)| name != other));
        picture.guides.extend(found);
    }
    Ok(())
}
