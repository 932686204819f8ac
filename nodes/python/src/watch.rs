//! Watching a call: Ctrl-C, and who wants to know how far it is.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks at what Python wants; each takes the interpreter's lock.
const PAUSE: Duration = Duration::from_millis(50);

/// Callbacks of one call.
#[derive(Debug)]
pub struct Watch {
    progress: Option<Py<PyAny>>,
    looked: Mutex<Instant>,
    stopped: AtomicBool,
    raised: Mutex<Option<PyErr>>,
}

impl Watch {
    /// Tells the share of the work that is done to `progress`, where there is one.
    pub fn new(progress: Option<Py<PyAny>>) -> Self {
        Self {
            progress,
            looked: Mutex::new(Instant::now()),
            stopped: AtomicBool::new(false),
            raised: Mutex::new(None),
        }
    }

    /// Ends the call with an exception.
    pub fn stop(&self, raised: PyErr) {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(raised);
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// The exception that ended the call, if one did.
    pub fn raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// True where the call shall end.
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Tells how much is done, and looks whether Python wants the call to end.
    pub fn look(&self, done: f32) {
        let mut looked = self.looked.lock().unwrap_or_else(PoisonError::into_inner);
        if looked.elapsed() < PAUSE && done < 1.0 {
            return;
        }
        *looked = Instant::now();
        drop(looked);
        let answer = Python::attach(|py| {
            py.check_signals()?;
            self.progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (done,)).map(drop))
        });
        if let Err(raised) = answer {
            self.stop(raised);
        }
    }
}
