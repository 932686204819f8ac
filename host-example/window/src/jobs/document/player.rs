//! A thread that reads frames before they are shown.

use std::ops::RangeInclusive;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;

use super::reader::{FrameReader, Sink};
use super::store::Store;
use crate::state::document::frame::Frame;
use isophote_files::error::{Error, Result};

/// Frames that are read on a thread of their own, until the player is dropped.
#[derive(Debug)]
pub struct Player {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    /// Rung when something is to be read.
    work: Condvar,
    /// Rung when something was read.
    news: Condvar,
}

#[derive(Debug)]
struct State {
    store: Store,
    is_over: bool,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Player {
    /// Starts to read from `source` into `store`.
    ///
    /// # Errors
    /// [`Error::Failure`] when the system gives no thread.
    pub fn start(source: FrameReader, store: Store) -> Result<Self> {
        let state = Mutex::new(State { store, is_over: false });
        let shared = Arc::new(Shared { state, work: Condvar::new(), news: Condvar::new() });
        let player = Self { shared: Arc::clone(&shared) };
        Builder::new()
            .name("frames".into())
            .spawn(move || work(source, &shared))
            .map_err(|e| Error::failure(format!("a thread cannot be started: {e}"), "try again"))?;
        Ok(player)
    }

    /// The frame, or why there is none; nothing while it is being read. It is what is shown from now on.
    pub fn frame(&self, number: i64) -> Option<Result<Arc<Frame>>> {
        self.go_to(&mut self.shared.state(), number)
    }

    /// Waits for a frame.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn wait(&self, number: i64) -> Result<Arc<Frame>> {
        let mut state = self.shared.state();
        loop {
            if let Some(result) = self.go_to(&mut state, number) {
                return result;
            }
            state = self.shared.news.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Sets the direction in which frames are shown from now on: 1 forward, -1 backward, 0 not at all.
    pub fn play(&self, direction: i64) {
        if self.shared.state().store.play(direction) {
            self.shared.work.notify_all();
        }
    }

    /// All frames that there are, and those that are in memory.
    pub fn numbers(&self) -> (Arc<[i64]>, Vec<i64>) {
        let state = self.shared.state();
        (Arc::clone(state.store.numbers()), state.store.cached())
    }

    fn go_to(&self, state: &mut State, number: i64) -> Option<Result<Arc<Frame>>> {
        if state.store.numbers().binary_search(&number).is_err() {
            return Some(Err(Error::input(
                format!("frame {number}"),
                "is none of the document's",
                "choose another",
            )));
        }
        if state.store.go_to(number) {
            self.shared.work.notify_all();
        }
        state.store.get(number)
    }
}

impl Drop for Player {
    fn drop(&mut self) {
        // What is being read is finished, which nobody waits for.
        self.shared.state().is_over = true;
        self.shared.work.notify_all();
    }
}

/// Reads until the player is gone.
fn work(mut source: FrameReader, shared: &Shared) {
    loop {
        let mut state = shared.state();
        let (number, direction) = loop {
            if state.is_over {
                return;
            }
            match state.store.next() {
                Some(number) => break (number, state.store.direction()),
                None => state = shared.work.wait(state).unwrap_or_else(PoisonError::into_inner),
            }
        };
        drop(state);
        let sink = Wanted(shared);
        // A decoder that fails in a way of its own spoils one frame.
        if catch_unwind(AssertUnwindSafe(|| source.read(number, direction, &sink))).is_err() {
            let problem = format!("frame {number} cannot be read");
            let error = Error::failure(problem, "this is a mistake in the program; please report it");
            sink.put(number, Err(error));
        }
        if let Some(last) = source.last() {
            let mut state = shared.state();
            if state.store.numbers().last() != Some(&last) {
                state.store.renumber((1..=last).collect());
            }
        }
    }
}

/// Sink of frames that were read.
struct Wanted<'a>(&'a Shared);

impl Sink for Wanted<'_> {
    fn wants(&self, number: i64) -> bool {
        self.0.state().store.wants(number)
    }

    fn put(&self, number: i64, frame: Result<Frame>) {
        self.0.state().store.put(number, frame.map(Arc::new));
        self.0.news.notify_all();
    }

    fn is_elsewhere(&self, frames: RangeInclusive<i64>) -> bool {
        let state = self.0.state();
        state.is_over || state.store.next().is_none_or(|next| !frames.contains(&next))
    }
}
