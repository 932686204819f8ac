//! The frames of a run: read, filtered and written at the same time, within a bound of memory.
//!
//! One thread reads and decodes, the calling one filters, one encodes and writes; decoding and encoding use all
//! cores within a frame. A frame takes its share of the memory before it is decoded and gives it back when it is
//! written. Where the system gives no threads the calling one does it all, frame by frame.

use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, Scope, ScopedJoinHandle};

use super::exr::Selection;
use super::filter::{Filter, Filtered, Planner};
use super::memory::{Budget, Bytes, Needs, Share};
use super::read::{self, Opened, Source, Unread};
use super::report::{Outcome, Report};
use super::tasks::Task;
use super::write::{self, Format};
use crate::error::{Error, Result};
use crate::limits::{self, Threads};
use crate::stop::Stop;

/// Most frames between being read and being written: one in each hand and one waiting between them.
pub const MOST_IN_FLIGHT: u64 = 5;

/// How a run is done.
#[derive(Debug)]
pub struct Run<'a> {
    /// All frames.
    pub tasks: &'a [Task],
    /// What is read of EXR files.
    pub selection: &'a Selection,
    /// Kind of the outputs.
    pub format: Format,
    /// Whether whole outputs stay as they are.
    pub skip_existing: bool,
    /// Whether frames are read and written beside being filtered.
    pub threads: Threads,
    /// Memory of frames in flight.
    pub budget: &'a Budget,
    /// Where progress is reported.
    pub report: &'a Report,
    /// Set when the run shall end early.
    pub stop: &'a Stop,
}

/// A frame that was read.
struct Ready<'a> {
    task: &'a Task,
    source: Source,
    share: Share<'a>,
}

/// A frame that was filtered.
struct Done<'a> {
    ready: Ready<'a>,
    filtered: Filtered,
}

impl Run<'_> {
    /// Does all frames. Frames that cannot be read or filtered are reported and left out; a run of one picture ends
    /// with its error. `planner` is of the filter's style; `first` is the first frame, where it was opened before.
    ///
    /// # Errors
    /// What kept a frame from being written, [`Error::Failure`] of the library or the device.
    pub fn all(&self, filter: &mut Filter, mut planner: Planner, first: Option<Opened>) -> Result<()> {
        if self.threads == Threads::Calling {
            let mut result = Ok(());
            self.read(&mut planner, first, &mut |ready| {
                result = self
                    .filter_one(filter, ready)
                    .and_then(|done| done.map_or(Ok(()), |d| self.write_one(d)));
                result.is_ok()
            })?;
            return result;
        }
        std::thread::scope(|scope| {
            let (send, decoded) = sync_channel(1);
            let (finished, receive) = sync_channel(1);
            // Nobody takes it when the run ends early.
            let mut sink = move |ready| SyncSender::send(&send, ready).is_ok();
            let reader = spawn(scope, move || self.read(&mut planner, first, &mut sink))?;
            let writer = spawn(scope, move || receive.into_iter().try_for_each(|done| self.write_one(done)))?;
            let filtered = self.filter(filter, decoded, &finished);
            drop(finished);
            let read = reader.join().unwrap_or_else(|_| Err(broken("reading")));
            let written = writer.join().unwrap_or_else(|_| Err(broken("writing")));
            // What could not be written is why the others ended.
            written.and(filtered).and(read)
        })
    }

    fn read<'a>(
        &'a self,
        planner: &mut Planner,
        mut first: Option<Opened>,
        sink: &mut dyn FnMut(Ready<'a>) -> bool,
    ) -> Result<()> {
        for task in self.tasks {
            let early = first.take();
            if self.stop.is_requested() {
                break;
            }
            if self.skip_existing && read::is_whole(&task.output) {
                self.report.frame(task, &Outcome::Skipped);
                continue;
            }
            match self.read_one(planner, task, early) {
                Ok(ready) => {
                    if !sink(ready) {
                        break;
                    }
                }
                // The next frame would find no more memory.
                Err(error @ Error::Failure { .. }) => return Err(error),
                Err(error) => self.failed(task, error)?,
            }
        }
        Ok(())
    }

    /// Reads a frame when there is room for its file, and decodes it when there is room for all that it needs.
    fn read_one<'a>(
        &'a self,
        planner: &mut Planner,
        task: &'a Task,
        early: Option<Opened>,
    ) -> Result<Ready<'a>> {
        let share = self.budget.share();
        let grow = |needs: Needs| {
            share.grow(needs).map_err(|most| too_large(&task.input, Bytes(needs.total()), most))
        };
        let opened = match early {
            Some(opened) => opened,
            None => {
                let file = Unread::open(&task.input)?;
                grow(Needs { frame: file.length(), filter: 0 })?;
                file.read(&task.input, self.selection)?
            }
        };
        if let Some(needs) = planner.needs(&task.input, task.frame, &opened)? {
            grow(needs)?;
            limits::must_have(needs.total(), &task.input.display().to_string())?;
        }
        Ok(Ready { task, source: opened.decode(&task.input)?, share })
    }

    fn filter<'a>(
        &'a self,
        filter: &mut Filter,
        decoded: Receiver<Ready<'a>>,
        finished: &SyncSender<Done<'a>>,
    ) -> Result<()> {
        for ready in decoded {
            if self.stop.is_requested() {
                break;
            }
            if let Some(done) = self.filter_one(filter, ready)?
                && finished.send(done).is_err()
            {
                break;
            }
        }
        Ok(())
    }

    /// Nothing where the frame failed and the run goes on.
    fn filter_one<'a>(&self, filter: &mut Filter, ready: Ready<'a>) -> Result<Option<Done<'a>>> {
        let name = ready.task.input.display().to_string();
        let mut progress = |done: f32| self.report.progress(done);
        match filter.run(&name, ready.task.frame, &ready.source, self.format, &mut progress) {
            Ok(filtered) => Ok(Some(Done { ready, filtered })),
            // Neither device nor memory is better for the next frame.
            Err(error @ Error::Failure { .. }) => Err(error),
            Err(error) => self.failed(ready.task, error).map(|()| None),
        }
    }

    fn write_one(&self, Done { ready: Ready { task, source, share }, filtered }: Done<'_>) -> Result<()> {
        let replaced = filtered.replaced;
        write::write(&task.output, self.format, filtered.results, source)?;
        drop(share);
        self.report.frame(task, &Outcome::Written(replaced));
        Ok(())
    }

    /// A frame of a sequence is reported; a picture by itself ends the run.
    fn failed(&self, task: &Task, error: Error) -> Result<()> {
        if task.frame.is_none() {
            return Err(error);
        }
        self.report.frame(task, &Outcome::Failed(error));
        Ok(())
    }
}

/// The error of a frame that needs more memory than all may take together.
pub fn too_large(path: &Path, needed: Bytes, most: Bytes) -> Error {
    Error::file(
        path,
        format!("a frame needs about {needed} of memory, and {most} may be used"),
        "give more by --memory",
    )
}

fn spawn<'scope, 'env, T: Send + 'scope>(
    scope: &'scope Scope<'scope, 'env>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Result<ScopedJoinHandle<'scope, T>> {
    if !limits::has_room_for_a_thread() {
        return Err(limits::too_little("another thread"));
    }
    Builder::new()
        .spawn_scoped(scope, work)
        .map_err(|e| Error::failure(format!("a thread cannot be started: {e}"), "start again"))
}

fn broken(what: &str) -> Error {
    Error::failure(format!("{what} stopped"), "this is a mistake in the program; please report it")
}
