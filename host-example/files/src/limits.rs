//! Memory and threads that the system may refuse this process.

use std::num::NonZero;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, Builder};

use signal_hook::consts::SIGABRT;

use crate::error::{Error, Result};

/// Threads that a run starts beside those that share a frame: one reads, one writes, one watches for the end.
const BESIDE: usize = 3;

/// Threads that frames are worked on with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    /// Several threads.
    Several,
    /// The calling thread alone, since the system gives no other.
    Calling,
}

/// Lets the process end with exit code 1 where a small allocation fails: the standard library says so and aborts.
/// Memory for what is large is asked for with [`must_have`] before.
pub fn end_where_memory_ends() {
    // Where the signal cannot be caught the process aborts.
    let _ = signal_hook::flag::register_conditional_shutdown(SIGABRT, 1, Arc::new(AtomicBool::new(true)));
}

/// Makes sure that the system has so many bytes to give now. Decoders and drivers end the process where it has not.
///
/// # Errors
/// [`Error::Failure`] when it has not.
pub fn must_have(bytes: u64, what: &str) -> Result<()> {
    // Pages that are not touched take no memory.
    let given = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if given {
        return Ok(());
    }
    Err(too_little(&format!("{what}, which takes about {} MiB", bytes.div_ceil(1 << 20))))
}

/// The error of what the system has no memory for.
pub fn too_little(what: &str) -> Error {
    Error::failure(
        format!("the system gives too little memory for {what}"),
        "use a smaller picture, or raise the limit of the process (ulimit -v)",
    )
}

/// Starts the threads that share the work on a frame: `wanted` of them, 0 for one per core, or as many as the system
/// gives.
///
/// # Errors
/// [`Error::Failure`] when the system takes back what it has just given.
pub fn start_threads(wanted: usize) -> Result<Threads> {
    let wanted = match wanted {
        0 => thread::available_parallelism().map_or(1, NonZero::get),
        given => given,
    };
    let given = available(wanted + BESIDE).saturating_sub(BESIDE);
    let builder = rayon::ThreadPoolBuilder::new();
    let (threads, builder) = match given {
        0 => (Threads::Calling, builder.num_threads(1).use_current_thread()),
        given => (Threads::Several, builder.num_threads(given)),
    };
    match builder.build_global() {
        // An earlier run of this process has started them where there is no other reason.
        Err(problem) if std::error::Error::source(&problem).is_some() => Err(Error::failure(
            format!("threads cannot be started: {problem}"),
            "raise the limit (ulimit -u)",
        )),
        _ => {
            if threads == Threads::Several {
                // They begin before anything else takes memory: what a thread takes then cannot be refused.
                rayon::broadcast(|_| ());
            }
            Ok(threads)
        }
    }
}

/// True where there is memory for a thread beside its stack: the standard library and the system's own need some when
/// it begins, and panic where there is none.
pub fn has_room_for_a_thread() -> bool {
    // Above 32 MiB glibc asks the system anew. What is smaller may be found in what was given back before, where a thread
    // that begins does not look.
    const ROOM: usize = 33 << 20;
    Vec::<u8>::new().try_reserve_exact(ROOM).is_ok()
}

/// Number of threads that the system gives this process now, up to `most`.
fn available(most: usize) -> usize {
    let gate = Arc::new(Mutex::new(()));
    let closed = gate.lock().unwrap_or_else(PoisonError::into_inner);
    let start = || {
        let gate = Arc::clone(&gate);
        let (up, is_up) = sync_channel(1);
        let wait = move || {
            // Whoever started it waits for that.
            let _ = up.send(());
            drop(gate.lock().unwrap_or_else(PoisonError::into_inner));
        };
        has_room_for_a_thread().then_some(())?;
        let thread = Builder::new().spawn(wait).ok()?;
        // One after the other: what a thread takes when it begins cannot be refused.
        is_up.recv().ok()?;
        Some(thread)
    };
    let started: Vec<_> = (0..most).map_while(|_| start()).collect();
    drop(closed);
    // What they return is nothing.
    started.into_iter().filter_map(|thread| thread.join().ok()).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_system_has_not_is_refused() {
        must_have(1 << 20, "a picture").unwrap();
        let refused = must_have(1 << 60, "a picture").unwrap_err();
        assert_eq!(refused.exit_code(), 1);
        assert!(refused.to_string().contains("a picture, which takes about 1099511627776 MiB"), "{refused}");
    }

    #[test]
    fn threads_are_counted() {
        assert_eq!(available(5), 5);
    }
}
