//! The threads of the test host.

use super::state::{self, fault, lock};
use isophote_abi::openfx::*;
use std::cell::Cell;
use std::ffi::{c_int, c_uint, c_void};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// The functions.
pub(super) const SUITE: OfxMultiThreadSuiteV1 = OfxMultiThreadSuiteV1 {
    multiThread: Some(multi_thread),
    multiThreadNumCPUs: Some(processors),
    multiThreadIsSpawnedThread: Some(is_spawned),
    ..NONE
};

/// None of them.
pub(super) const NONE: OfxMultiThreadSuiteV1 = OfxMultiThreadSuiteV1 {
    multiThread: None,
    multiThreadNumCPUs: None,
    multiThreadIndex: None,
    multiThreadIsSpawnedThread: None,
    mutexCreate: None,
    mutexDestroy: None,
    mutexLock: None,
    mutexUnLock: None,
    mutexTryLock: None,
};

/// Time that threads that are left running take to begin.
const LATE: Duration = Duration::from_millis(2);

thread_local! {
    static SPAWNED: Cell<bool> = const { Cell::new(false) };
}

#[derive(Clone, Copy)]
struct Argument(*mut c_void);

impl Argument {
    /// The argument, as it was given.
    fn get(self) -> *mut c_void {
        self.0
    }
}

// SAFETY: the plugin gives it to be used by several threads.
unsafe impl Sync for Argument {}
// SAFETY: as above.
unsafe impl Send for Argument {}

unsafe extern "C" fn multi_thread(
    work: Option<ThreadFunction>,
    threads: c_uint,
    argument: *mut c_void,
) -> OfxStatus {
    let Some(work) = work else { return kOfxStatFailed };
    if SPAWNED.get() {
        fault("multiThread is entered from a thread that it started");
        return kOfxStatErrExists;
    }
    // The functions of this suite have no argument for the host.
    let host = state::current();
    if let Some(host) = &host {
        host.runs.fetch_add(1, Ordering::SeqCst);
    }
    let argument = Argument(argument);
    if let Some(host) = host.as_ref().filter(|host| host.behaviour.returns_early) {
        let begin_late = |index| {
            std::thread::spawn(move || {
                SPAWNED.set(true);
                std::thread::sleep(LATE);
                // SAFETY: the plugin's function; that it is called late is what such a host does.
                unsafe { work(index, threads, argument.get()) };
            })
        };
        lock(&host.late).extend((0..threads).map(begin_late));
        return kOfxStatOK;
    }
    std::thread::scope(|scope| {
        for index in 0..threads {
            let (argument, host) = (&argument, &host);
            scope.spawn(move || {
                SPAWNED.set(true);
                host.iter().for_each(state::enter);
                // SAFETY: the plugin's function, called as the standard has it.
                unsafe { work(index, threads, argument.get()) };
            });
        }
    });
    kOfxStatOK
}

unsafe extern "C" fn processors(place: *mut c_uint) -> OfxStatus {
    // SAFETY: the plugin gave a place.
    unsafe { place.write(state::current().map_or(1, |host| host.behaviour.processors.max(1))) };
    kOfxStatOK
}

unsafe extern "C" fn is_spawned() -> c_int {
    SPAWNED.get().into()
}
