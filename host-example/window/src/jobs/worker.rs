//! Work beside the window: a thread that does the latest thing it was asked for and wakes the window when it is done.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;

use isophote_files::error::{Error, Result};

/// Lets the window look at what is done.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A thread that answers one kind of request. What waits is forgotten when something newer is asked for. Dropping it waits
/// for what is being done, since no thread may outlive the graphics driver.
#[derive(Debug)]
pub struct Worker<J, A> {
    shared: Arc<Shared<J>>,
    answers: Receiver<(u64, A)>,
    requested: u64,
    answered: u64,
    thread: Option<JoinHandle<()>>,
}

/// Place where requests are left.
#[derive(Debug)]
struct Shared<J> {
    tray: Mutex<Tray<J>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Tray<J> {
    next: Option<(u64, J)>,
    closed: bool,
}

impl<J: Send + 'static, A: Send + 'static> Worker<J, A> {
    /// Starts a thread that answers by `work`.
    ///
    /// # Errors
    /// [`Error::Failure`] when the system has no thread to give.
    pub fn new(name: &str, wake: Wake, work: impl FnMut(J) -> A + Send + 'static) -> Result<Self> {
        let tray = Mutex::new(Tray { next: None, closed: false });
        let shared = Arc::new(Shared { tray, changed: Condvar::new() });
        let (sender, answers) = channel();
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || serve(&own, &sender, &wake, work))
            .map_err(|e| Error::failure(format!("no thread can be started: {e}"), "close other programs"))?;
        Ok(Self { shared, answers, requested: 0, answered: 0, thread: Some(thread) })
    }

    /// Asks for something, instead of what was asked for and not begun.
    pub fn ask(&mut self, job: J) {
        self.requested += 1;
        self.shared.tray.lock().unwrap_or_else(PoisonError::into_inner).next = Some((self.requested, job));
        self.shared.changed.notify_one();
    }
}

impl<J, A> Worker<J, A> {
    /// Result since the last call, if there is one; the last of several.
    pub fn answer(&mut self) -> Option<A> {
        let (number, answer) = self.answers.try_iter().last()?;
        self.answered = number;
        Some(answer)
    }

    /// True while something that was asked for has not been answered.
    pub fn is_busy(&self) -> bool {
        self.answered < self.requested
    }
}

/// Does what is on the shared until it is closed.
fn serve<J, A>(shared: &Shared<J>, answers: &Sender<(u64, A)>, wake: &Wake, mut work: impl FnMut(J) -> A) {
    loop {
        let mut tray = shared.tray.lock().unwrap_or_else(PoisonError::into_inner);
        let (number, job) = loop {
            if tray.closed {
                return;
            }
            match tray.next.take() {
                Some(next) => break next,
                None => tray = shared.changed.wait(tray).unwrap_or_else(PoisonError::into_inner),
            }
        };
        drop(tray);
        if answers.send((number, work(job))).is_err() {
            return;
        }
        wake();
    }
}

impl<J, A> Drop for Worker<J, A> {
    fn drop(&mut self) {
        let mut tray = self.shared.tray.lock().unwrap_or_else(PoisonError::into_inner);
        (tray.closed, tray.next) = (true, None);
        drop(tray);
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has been printed; the window goes on without its answer.
            let _ = thread.join();
        }
    }
}
