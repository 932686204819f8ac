//! Work on another thread, asked for its result from time to time.

use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::thread::Builder;

use isophote_files::error::{Error, Result};
use isophote_files::limits;

/// Work on another thread. Dropped, it is finished there and thrown away.
#[derive(Debug)]
pub struct Loading<T> {
    result: Receiver<Result<T>>,
}

impl<T: Send + 'static> Loading<T> {
    /// Starts the work.
    pub fn start(work: impl FnOnce() -> Result<T> + Send + 'static) -> Self {
        let (send, result) = sync_channel(1);
        let failed = send.clone();
        let run = move || {
            // Nobody waits for it any more where it was dropped.
            let _ = send.send(work());
        };
        let started = match limits::has_room_for_a_thread() {
            true => Builder::new().name("load".into()).spawn(run).map(drop).map_err(|e| e.to_string()),
            false => Err("there is too little memory".into()),
        };
        if let Err(problem) = started {
            let error = Error::failure(format!("a thread cannot be started: {problem}"), "try again");
            // There is room for one result.
            let _ = failed.send(Err(error));
        }
        Self { result }
    }

    /// The result, once, as soon as it is there.
    pub fn poll(&mut self) -> Option<Result<T>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(broken())),
        }
    }

    /// Waits for the result.
    ///
    /// # Errors
    /// The error that the work ended with.
    pub fn wait(self) -> Result<T> {
        self.result.recv().unwrap_or_else(|_| Err(broken()))
    }
}

/// The error of work that panicked.
fn broken() -> Error {
    Error::failure("loading stopped", "this is a mistake in the program; please report it")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_errors_and_panics_arrive() {
        assert_eq!(Loading::start(|| Ok(7)).wait().unwrap(), 7);
        assert!(Loading::<()>::start(|| Err(broken())).wait().is_err());
        let mut panicked = Loading::<()>::start(|| panic!("as a decoder might"));
        let error = loop {
            if let Some(result) = panicked.poll() {
                break result.unwrap_err();
            }
            std::thread::yield_now();
        };
        assert_eq!(error.exit_code(), 1);
    }
}
