//! The frames of a run: read, filtered and written at the same time, within a bound of memory.
//!
//! One thread reads and decodes, the calling one filters, one encodes and writes; decoding and encoding use all
//! cores within a frame. On a graphics device two others filter in turn, so that it computes one frame while another one goes
//! there or comes back. Where the system gives no threads the calling one does it all, frame by frame.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, Scope, ScopedJoinHandle};

use super::filter::{Filter, Filtered};
use super::frame_cache::{CachedFrame, Window};
use super::reader::Reader;
use super::report::{Outcome, Report};
use super::tasks::Task;
use isophote_files::error::{Error, Result};
use isophote_files::limits::{self, Threads};
use isophote_files::replacing::Consent;
use isophote_files::stop::Stop;
use isophote_pictures::exr::ExrFile;
use isophote_pictures::read;
use isophote_pictures::write::{self, Format};
use std::sync::Arc;

/// Most frames between being read and being written: one in each hand and one waiting between them.
pub const MOST_IN_FLIGHT: u64 = 5;

/// Run over the frames of a sequence.
#[derive(Debug)]
pub struct Run<'a> {
    /// All frames.
    pub tasks: &'a [Task],
    /// Consent to replace files.
    pub consent: Consent,
    /// Options of the files.
    pub options: write::Options,
    /// Threads on which frames are read and written beside being filtered, if they are.
    pub threads: Threads,
    /// Report of the progress.
    pub report: &'a Report,
    /// Set when the run shall end early.
    pub stop: &'a Stop,
}

/// A frame that was read, with its neighbours.
struct Ready<'a> {
    task: &'a Task,
    window: Window<'a>,
}

/// A frame that was filtered.
struct Done<'a> {
    task: &'a Task,
    own: Arc<CachedFrame<'a>>,
    exr: Option<ExrFile>,
    filtered: Filtered,
}

/// A filter on a thread of its own: where it takes frames, and its end.
type Lane<'scope, 'a> = (SyncSender<Ready<'a>>, ScopedJoinHandle<'scope, Result<()>>);

impl<'a> Run<'a> {
    /// Does all frames. Frames that cannot be read or filtered are reported and left out, and of several pictures by
    /// themselves those that cannot be written; a run of one picture ends with its error. `reader` reads these frames for
    /// the filters' style; there is at least one filter.
    ///
    /// # Errors
    /// The problem that kept a frame from being written, [`Error::Failure`] of the library or the device.
    pub fn all(&self, filters: &mut [Filter], mut reader: Reader<'a>) -> Result<()> {
        match (self.threads, filters) {
            (_, []) => Ok(()),
            (Threads::Calling, [filter, ..]) => {
                let mut result = Ok(());
                self.read(&mut reader, &mut |ready| {
                    let done = self.filter_one(filter, ready);
                    result = done.and_then(|done| done.map_or(Ok(()), |done| self.write_one(done)));
                    result.is_ok()
                })?;
                result
            }
            (Threads::Several, filters) => self.at_once(filters, reader),
        }
    }

    /// The same on several threads, all of which are there before the first frame takes memory.
    fn at_once(&self, filters: &mut [Filter], mut reader: Reader<'a>) -> Result<()> {
        std::thread::scope(|scope| {
            let (send, decoded) = sync_channel(1);
            // Nobody takes it when the run ends early.
            let mut sink = move |ready| SyncSender::send(&send, ready).is_ok();
            let (finished, results): (Vec<_>, Vec<_>) = filters.iter().map(|_| sync_channel(1)).unzip();
            let writing = spawn(scope, move || self.write(&results))?;
            let (own, lanes) = match filters {
                [filter] => (Some(filter), Vec::new()),
                filters => (None, self.lanes(scope, filters, &finished)?),
            };
            let reading = spawn(scope, move || self.read(&mut reader, &mut sink))?;
            let filtered = match own {
                Some(filter) => self.filter(filter, decoded, &finished[0]),
                None => filter_in_turn(lanes, decoded),
            };
            drop(finished);
            let read = reading.join().unwrap_or_else(|_| Err(broken("reading")));
            let written = writing.join().unwrap_or_else(|_| Err(broken("writing")));
            // What could not be written is why the others ended.
            written.and(filtered).and(read)
        })
    }

    /// Filters, each at work on a thread of its own.
    fn lanes<'scope>(
        &'scope self,
        scope: &'scope Scope<'scope, '_>,
        filters: &'scope mut [Filter],
        finished: &[SyncSender<Option<Done<'a>>>],
    ) -> Result<Vec<Lane<'scope, 'a>>>
    where
        'a: 'scope,
    {
        let lanes = filters.iter_mut().zip(finished).map(|(filter, finished)| {
            let (input, frames) = sync_channel(0);
            let finished = finished.clone();
            Ok((input, spawn(scope, move || self.filter(filter, frames, &finished))?))
        });
        lanes.collect()
    }

    /// Writes what filters hand over in turn.
    fn write(&self, results: &[Receiver<Option<Done<'a>>>]) -> Result<()> {
        for result in results.iter().cycle() {
            match result.recv() {
                Ok(Some(done)) => self.write_one(done)?,
                Ok(None) => {}
                Err(_) => break,
            }
        }
        Ok(())
    }

    fn read(&self, reader: &mut Reader<'a>, sink: &mut dyn FnMut(Ready<'a>) -> bool) -> Result<()> {
        for task in self.tasks {
            if self.stop.is_requested() {
                break;
            }
            if self.consent.skip_existing && read::is_whole(&task.output) {
                reader.skip();
                self.report.frame(task, &Outcome::Skipped);
                continue;
            }
            match reader.window(task) {
                Ok(window) => {
                    if !sink(Ready { task, window }) {
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

    fn filter(
        &self,
        filter: &mut Filter,
        decoded: Receiver<Ready<'a>>,
        finished: &SyncSender<Option<Done<'a>>>,
    ) -> Result<()> {
        for ready in decoded {
            if self.stop.is_requested() || finished.send(self.filter_one(filter, ready)?).is_err() {
                break;
            }
        }
        Ok(())
    }

    /// Nothing where the frame failed and the run goes on.
    fn filter_one(&self, filter: &mut Filter, Ready { task, window }: Ready<'a>) -> Result<Option<Done<'a>>> {
        let name = task.input.display().to_string();
        let mut progress = |done: f32| self.report.progress(done);
        let exr = window.own.take_exr();
        let format = Format::of(&task.output)?;
        match filter.run(&name, &window, exr.as_ref(), format, &mut progress) {
            Ok(filtered) => Ok(Some(Done { task, own: window.own, exr, filtered })),
            // Neither device nor memory is better for the next frame.
            Err(error @ Error::Failure { .. }) => Err(error),
            Err(error) => self.failed(task, error).map(|()| None),
        }
    }

    fn write_one(&self, Done { task, own, exr, filtered }: Done<'a>) -> Result<()> {
        let replaced = filtered.replaced;
        let format = Format::of(&task.output)?;
        let is_written = self.consent.write(task.made(), read::is_whole, |existing| {
            write::write(
                &task.output,
                existing,
                (format, self.options),
                filtered.results,
                &filtered.meaning,
                &own.source,
                exr,
            )
        });
        drop(own);
        let is_written = match is_written {
            // What keeps one picture from being written is no matter of the others.
            Err(error @ Error::Input { .. }) if task.frame.is_none() => return self.failed(task, error),
            written => written?,
        };
        self.report.frame(task, &if is_written { Outcome::Written(replaced) } else { Outcome::Skipped });
        Ok(())
    }

    /// One of several is reported; a picture alone ends the run.
    fn failed(&self, task: &Task, error: Error) -> Result<()> {
        if task.frame.is_none() && self.tasks.len() == 1 {
            return Err(error);
        }
        self.report.frame(task, &Outcome::Failed(error));
        Ok(())
    }
}

/// Hands frames out to filters in turn.
fn filter_in_turn<'a>(lanes: Vec<Lane<'_, 'a>>, decoded: Receiver<Ready<'a>>) -> Result<()> {
    let (inputs, lanes): (Vec<_>, Vec<_>) = lanes.into_iter().unzip();
    for (ready, input) in decoded.into_iter().zip(inputs.iter().cycle()) {
        if input.send(ready).is_err() {
            break;
        }
    }
    drop(inputs);
    let ends = lanes.into_iter().map(|lane| lane.join().unwrap_or_else(|_| Err(broken("filtering"))));
    ends.fold(Ok(()), Result::and)
}

/// Starts a thread and waits until it is there: the memory that it takes when it begins cannot be refused.
fn spawn<'scope, 'env, T: Send + 'scope>(
    scope: &'scope Scope<'scope, 'env>,
    work: impl FnOnce() -> T + Send + 'scope,
) -> Result<ScopedJoinHandle<'scope, T>> {
    if !limits::has_room_for_a_thread() {
        return Err(limits::too_little("another thread"));
    }
    let (begin, has_begun) = sync_channel(1);
    let thread = Builder::new().spawn_scoped(scope, move || {
        // The thread that started it waits for that.
        let _ = begin.send(());
        work()
    });
    let thread =
        thread.map_err(|e| Error::failure(format!("a thread cannot be started: {e}"), "start again"))?;
    has_begun.recv().map_err(|_| broken("a thread"))?;
    Ok(thread)
}

fn broken(what: &str) -> Error {
    Error::failure(format!("{what} stopped"), "this is a mistake in the program; please report it")
}
