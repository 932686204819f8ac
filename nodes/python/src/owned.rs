//! Objects of the library that one thread at a time may use, shared between Python's threads.

use crate::exception::usage;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// An object that threads take in turns.
#[derive(Debug)]
pub struct Owned<T> {
    object: Mutex<T>,
    /// The thread that has it, 0 for none.
    owner: AtomicUsize,
}

impl<T: Send> Owned<T> {
    /// Shares an object.
    pub const fn new(object: T) -> Self {
        Self { object: Mutex::new(object), owner: AtomicUsize::new(0) }
    }

    /// Calls `work` with the object, without the interpreter's lock, once no other thread has it.
    ///
    /// # Errors
    /// `RuntimeError` when this thread has it already: a function that the library calls meanwhile uses it.
    pub fn with<R: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut T) -> R + Send) -> PyResult<R> {
        let me = this_thread();
        if self.owner.load(Ordering::Relaxed) == me {
            return Err(usage("the object is at work, and this is called from within; use another object"));
        }
        Ok(py.detach(|| {
            let mut object = self.object.lock().unwrap_or_else(PoisonError::into_inner);
            self.owner.store(me, Ordering::Relaxed);
            let result = work(&mut object);
            self.owner.store(0, Ordering::Relaxed);
            result
        }))
    }
}

/// A number that no other living thread has.
fn this_thread() -> usize {
    thread_local!(static PLACE: u8 = const { 0 });
    PLACE.with(|place| std::ptr::from_ref(place) as usize)
}
