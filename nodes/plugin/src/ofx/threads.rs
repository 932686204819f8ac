//! Threads for a frame: the host's own by its multi-thread suite, else the library's pool.
//!
//! The suite runs one function on several threads; which job each takes is decided here. What a host
//! leaves out, runs twice, runs late or refuses is made good by the batches of [`crate::abi::threads`].

use super::host::Host;
use crate::abi::guard::lock;
use crate::abi::threads::{self, HostThreads, User};
use isophote::engine::cpu::{CallingThread, Pool, Threads};
use isophote_abi::IsophoteJob;
use isophote_abi::openfx::*;
use std::collections::HashMap;
use std::ffi::{c_uint, c_void};
use std::ptr::without_provenance_mut;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Mutex};

/// The host's functions, where they live while a frame is rendered.
pub struct Suite {
    run: unsafe extern "C" fn(Option<ThreadFunction>, c_uint, *mut c_void) -> OfxStatus,
    count: c_uint,
}

/// The threads of one frame.
pub enum FrameThreads {
    /// The host's.
    Host(HostThreads, #[allow(dead_code, reason = "what the first points to")] Box<Suite>),
    /// The library's.
    Pool(Arc<Pool>),
    /// None but the host's calling thread.
    Calling(CallingThread),
}

impl FrameThreads {
    /// The threads to use now, on the thread that asks.
    pub fn of(host: &Host) -> Self {
        let own = || Self::Pool(threads::pool(0));
        let Some(suite) = host.threads.filter(|_| host.quirks.threads) else { return own() };
        // SAFETY: a function of the host's without arguments.
        if suite.multiThreadIsSpawnedThread.is_some_and(|spawned| unsafe { spawned() } != 0) {
            // The suite must not be entered again, and the host has given every core its work.
            return Self::Calling(CallingThread);
        }
        let (Some(run), Some(cpus)) = (suite.multiThread, suite.multiThreadNumCPUs) else { return own() };
        let mut count = 0;
        // SAFETY: a function of the host's, and a place for the answer.
        let status = unsafe { cpus(&raw mut count) };
        if status != kOfxStatOK || count == 0 {
            return own();
        }
        if count == 1 {
            return Self::Calling(CallingThread);
        }
        let suite = Box::new(Suite { run, count: count.min(256) });
        let user = User((&raw const *suite).cast_mut().cast());
        let count = suite.count as usize;
        Self::Host(HostThreads::new(run_batch, user, count), suite)
    }

    /// The executor's view of them.
    pub fn threads(&self) -> &dyn Threads {
        match self {
            Self::Host(threads, _) => threads,
            Self::Pool(pool) => &**pool,
            Self::Calling(threads) => threads,
        }
    }
}

/// Jobs that the host's threads take one after the other.
struct Batch {
    next: AtomicU32,
    jobs: u32,
    job: IsophoteJob,
    batch: u64,
}

/// The batches that hosts have, by the number that their threads are given for an argument. The standard has a
/// host return after all its threads have; the threads of one that does not find no batch, where a pointer would
/// lead to memory that is something else by now.
static BATCHES: LazyLock<Mutex<HashMap<usize, Arc<Batch>>>> = LazyLock::new(Mutex::default);
static NEXT: AtomicUsize = AtomicUsize::new(1);

unsafe extern "C" fn run_batch(user: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64) {
    // SAFETY: `user` is the suite that `FrameThreads::of` boxed, which lives as long as the threads.
    let suite = unsafe { &*user.cast::<Suite>() };
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    lock(&BATCHES).insert(number, Arc::new(Batch { next: AtomicU32::new(0), jobs, job, batch }));
    let count = suite.count.min(jobs.max(1));
    // A host that refuses leaves everything to the caller, who does what was left out.
    // SAFETY: a function of the host's, one of ours that takes any argument, and a number in its place.
    unsafe { (suite.run)(Some(work_off), count, without_provenance_mut(number)) };
    lock(&BATCHES).remove(&number);
}

unsafe extern "C" fn work_off(_: c_uint, _: c_uint, work: *mut c_void) {
    let found = lock(&BATCHES).get(&work.addr()).cloned();
    let Some(work) = found else { return };
    let Some(job) = work.job else { return };
    loop {
        let index = work.next.fetch_add(1, Ordering::Relaxed);
        if index >= work.jobs {
            return;
        }
        // SAFETY: a job takes any number, and lets no panic out.
        unsafe { job(work.batch, index) };
    }
}
