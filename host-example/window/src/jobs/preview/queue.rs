//! The thread that makes previews, the most urgent first. What is wanted no more is not made, and is given up where it was
//! begun.

use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

use super::render::Renderer;
use crate::jobs::worker::Wake;
use crate::state::preview::order::{Done, Task};
use isophote_files::error::{Error, Result};
use isophote_loader::Library;

/// Most threads of the library for one preview; small pictures have no work for more.
const MOST_THREADS: usize = 8;

/// Makes previews beside the window. Dropping it waits for the one that is being made, which is given up.
#[derive(Debug)]
pub struct Queue {
    shared: Arc<Shared>,
    answers: Receiver<Done>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Shared {
    tray: Mutex<Tray>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Tray {
    /// Tasks to be made, the first at the end.
    tasks: Vec<Task>,
    /// Task that is being made.
    running: Option<u64>,
    /// Tasks that were made and not collected.
    made: HashSet<u64>,
    closed: bool,
}

impl Shared {
    fn tray(&self) -> MutexGuard<'_, Tray> {
        self.tray.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True where a task is given up.
    fn is_cancelled(&self, serial: u64) -> bool {
        let tray = self.tray();
        tray.closed || tray.running != Some(serial)
    }
}

impl Queue {
    /// Starts the thread.
    ///
    /// # Errors
    /// [`Error::Failure`] when the system has no thread to give.
    pub fn new(library: Library, wake: Wake) -> Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, answers) = channel();
        let own = Arc::clone(&shared);
        // One core is left to the window.
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let threads = cores.saturating_sub(1).clamp(1, MOST_THREADS) as u32;
        let thread = thread::Builder::new()
            .name("previews".into())
            .spawn(move || serve(&own, &sender, &wake, Renderer::new(library, threads)))
            .map_err(|e| Error::failure(format!("no thread can be started: {e}"), "close other programs"))?;
        Ok(Self { shared, answers, thread: Some(thread) })
    }

    /// Makes these from now on, in this order, and nothing else.
    pub fn follow(&self, mut tasks: Vec<Task>) {
        let mut tray = self.shared.tray();
        let running = tray.running.filter(|running| tasks.iter().any(|task| task.serial == *running));
        tasks.retain(|task| Some(task.serial) != running && !tray.made.contains(&task.serial));
        tasks.reverse();
        (tray.running, tray.tasks) = (running, tasks);
        drop(tray);
        self.shared.changed.notify_one();
    }

    /// Results made since the last call.
    pub fn collect(&self) -> Vec<Done> {
        let done: Vec<Done> = self.answers.try_iter().collect();
        let mut tray = self.shared.tray();
        tray.made.retain(|serial| done.iter().all(|(made, _)| made != serial));
        done
    }
}

fn serve(shared: &Shared, answers: &Sender<Done>, wake: &Wake, mut renderer: Renderer) {
    loop {
        let mut tray = shared.tray();
        let task = loop {
            if tray.closed {
                return;
            }
            match tray.tasks.pop() {
                Some(task) => break task,
                None => {
                    renderer.rest();
                    tray = shared.changed.wait(tray).unwrap_or_else(PoisonError::into_inner);
                }
            }
        };
        let serial = task.serial;
        tray.running = Some(serial);
        drop(tray);
        let make = || renderer.render(&task.picture, &task.order, &|| shared.is_cancelled(serial));
        // A look that fails in a way of its own spoils one preview.
        let made = catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|_| {
            let problem = format!("{} cannot be previewed", task.order.look.name);
            Err(Error::failure(problem, "this is a mistake in the program; please report it"))
        });
        let Some(made) = made.transpose() else { continue };
        let mut tray = shared.tray();
        // Another picture may have come when it was all but done.
        if tray.running.take() != Some(serial) {
            continue;
        }
        tray.made.insert(serial);
        drop(tray);
        if answers.send((serial, made)).is_err() {
            return;
        }
        wake();
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        self.shared.tray().closed = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has been printed.
            let _ = thread.join();
        }
    }
}
