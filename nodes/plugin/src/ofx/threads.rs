//! Threads for a frame: the host's own by its multi-thread suite, else the library's pool.
//!
//! The suite runs one function on several threads; which job each takes is decided here. What a host
//! leaves out, runs twice or refuses is made good by the batches of [`crate::abi::threads`].

use super::host::Host;
use super::interface::*;
use crate::abi::contract::IsophoteJob;
use crate::abi::threads::{self, HostThreads, User};
use isophote::engine::cpu::{CallingThread, Pool, Threads};
use std::ffi::{c_uint, c_void};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

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
        let own = || threads::pool(0).map_or(Self::Calling(CallingThread), Self::Pool);
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

unsafe extern "C" fn run_batch(user: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64) {
    // SAFETY: `user` is the suite that `FrameThreads::of` boxed, which lives as long as the threads.
    let suite = unsafe { &*user.cast::<Suite>() };
    let work = Batch { next: AtomicU32::new(0), jobs, job, batch };
    let count = suite.count.min(jobs.max(1));
    // A host that refuses leaves everything to the caller, who does what was left out.
    // SAFETY: the standard has the function return after all its threads have.
    unsafe { (suite.run)(Some(work_off), count, (&raw const work).cast_mut().cast()) };
}

unsafe extern "C" fn work_off(_: c_uint, _: c_uint, work: *mut c_void) {
    // SAFETY: the batch of `run_batch`, which waits for this thread.
    let work = unsafe { &*work.cast::<Batch>() };
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
