//! State that all handles of a host lead back to: its behaviour, and what it noted of its plugins.

use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_int};
use std::sync::atomic::{AtomicI32, AtomicU32};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use std::thread::JoinHandle;

/// Locks, also after a test has failed.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Behaviour of a host.
#[derive(Clone, Debug)]
pub struct Behaviour {
    /// Its name.
    pub name: &'static CStr,
    /// Properties that it does not know: setting and getting them is answered with "unknown".
    pub refused: Vec<&'static CStr>,
    /// True where it refuses every property that the standard does not require of it.
    pub refuses_optional: bool,
    /// True where images may be parts of pictures.
    pub tiles: bool,
    /// True where clips give the images of any time.
    pub temporal: bool,
    /// True where an image that there is not is a success without an image.
    pub null_images: bool,
    /// True where it has half floats.
    pub half: bool,
    /// Processors of its multi-thread suite; 0 for a host without the suite.
    pub processors: u32,
    /// True where its multi-thread suite returns while its threads still have to begin.
    pub returns_early: bool,
    /// True where the multi-thread suite and the message suite consist of null functions.
    pub null_functions: bool,
    /// True where a text that was asked for is destroyed at the next call.
    pub strings_die: bool,
    /// True where it calls clips without a picture connected.
    pub all_connected: bool,
    /// True where properties of clips and images are missing as far as a plugin can do without.
    pub bare: bool,
    /// After so many questions it wants to stop.
    pub abort_after: Option<u32>,
    /// The latest version of its message suite.
    pub message_version: c_int,
    /// Suites that it lacks.
    pub without: Vec<&'static CStr>,
}

impl Default for Behaviour {
    fn default() -> Self {
        Self {
            name: c"org.isophote.tests",
            refused: Vec::new(),
            refuses_optional: false,
            tiles: true,
            temporal: true,
            null_images: false,
            half: true,
            processors: 0,
            returns_early: false,
            null_functions: false,
            strings_die: false,
            all_connected: false,
            bare: false,
            abort_after: None,
            message_version: 2,
            without: Vec::new(),
        }
    }
}

/// A suite that a host gives out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Suite {
    /// Its name.
    pub name: &'static CStr,
    /// Its version.
    pub version: c_int,
    /// Address of its functions, for the life of the host.
    pub address: usize,
}

/// State that all handles of a host lead back to.
#[derive(Debug)]
pub struct Inner {
    /// Behaviour of the host.
    pub behaviour: Behaviour,
    /// Images that were lent and not given back.
    pub lent: AtomicI32,
    /// The most that were lent at once.
    pub most_lent: AtomicI32,
    /// Number of times that it was asked whether to stop.
    pub abort_calls: AtomicU32,
    /// Runs of its multi-thread suite.
    pub runs: AtomicU32,
    /// Threads that were left running.
    pub(super) late: Mutex<Vec<JoinHandle<()>>>,
    /// Messages that it shows.
    pub messages: Mutex<Vec<String>>,
    /// Faults of its plugins against the standard.
    faults: Mutex<Vec<String>>,
    pub(super) suites: OnceLock<Vec<Suite>>,
}

/// Faults against the standard where nothing says of which host.
static NOBODYS: Mutex<Vec<String>> = Mutex::new(Vec::new());

thread_local! {
    /// The host whose plugin this thread last called. Some functions of the standard have no argument
    /// for the host.
    static CURRENT: RefCell<Weak<Inner>> = const { RefCell::new(Weak::new()) };
    /// The time that this thread renders, while it does.
    static RENDERED: Cell<Option<f64>> = const { Cell::new(None) };
}

/// Sets the time that the calling thread renders, if any.
pub(super) fn render_at(time: Option<f64>) {
    RENDERED.set(time);
}

/// The time that the calling thread renders.
pub(super) fn rendered() -> Option<f64> {
    RENDERED.get()
}

impl Inner {
    pub(super) fn new(behaviour: Behaviour) -> Self {
        Self {
            behaviour,
            lent: AtomicI32::new(0),
            most_lent: AtomicI32::new(0),
            abort_calls: AtomicU32::new(0),
            runs: AtomicU32::new(0),
            late: Mutex::default(),
            messages: Mutex::default(),
            faults: Mutex::default(),
            suites: OnceLock::new(),
        }
    }

    /// Waits for the threads that were left running, and says how many there were.
    ///
    /// # Panics
    /// When one did.
    pub fn wait(&self) -> usize {
        let late = std::mem::take(&mut *lock(&self.late));
        late.into_iter().map(|thread| thread.join().expect("a thread ends well")).count()
    }

    /// Notes that the plugin broke a rule.
    pub(super) fn fault(&self, what: impl Into<String>) {
        lock(&self.faults).push(what.into());
    }

    /// Faults of plugins against the standard so far.
    pub(super) fn faults(&self) -> Vec<String> {
        [lock(&self.faults).clone(), lock(&NOBODYS).clone()].concat()
    }
}

/// Makes the host that of the calling thread, until another is.
pub(super) fn enter(host: &Arc<Inner>) {
    CURRENT.set(Arc::downgrade(host));
}

/// The host of the calling thread.
pub(super) fn current() -> Option<Arc<Inner>> {
    CURRENT.with_borrow(Weak::upgrade)
}

/// Notes that a plugin broke a rule, where it did not say of which host.
pub(super) fn fault(what: impl Into<String>) {
    match current() {
        Some(host) => host.fault(what),
        None => lock(&NOBODYS).push(what.into()),
    }
}
