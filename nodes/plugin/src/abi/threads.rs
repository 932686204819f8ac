//! Threads that work is done on: pools of the library's own, and the host's.
//!
//! A host's callback may return early, call a job twice, or call it long after the batch is over.
//! Batches are therefore named by numbers, not by pointers, every job is done once, and a batch ends
//! only when nothing of it runs any more.

use super::failure::{Failure, Outcome};
use super::guard::lock;
use isophote::engine::cpu::{CallingThread, Pool, Threads};
use isophote_abi::*;
use std::any::Any;
use std::collections::HashMap;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, LazyLock, Mutex, PoisonError};

/// Most threads that a host may ask for.
const MOST: u32 = 1024;
/// Pools of different sizes that are kept; hosts rarely use more than one.
const KEPT: usize = 4;

static POOLS: Mutex<Vec<(usize, Arc<Pool>)>> = Mutex::new(Vec::new());

/// The pool of so many threads, 0 for one per core; shared by all who ask for the same. It has fewer where the
/// system refuses them.
pub fn pool(threads: usize) -> Arc<Pool> {
    let mut pools = lock(&POOLS);
    if let Some((_, pool)) = pools.iter().find(|(n, _)| *n == threads) {
        return Arc::clone(pool);
    }
    let pool = Arc::new(Pool::new(threads));
    if pool.count() < wanted(threads) {
        // The next call may find more.
        return pool;
    }
    if pools.len() == KEPT {
        pools.remove(0);
    }
    pools.push((threads, Arc::clone(&pool)));
    pool
}

/// Number of threads that a number stands for, of which 0 means one per core.
fn wanted(threads: usize) -> usize {
    match threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        given => given,
    }
}

/// Ends the pools that no call uses.
pub fn forget_pools() {
    let pools = std::mem::take(&mut *lock(&POOLS));
    drop(pools);
}

/// The threads that a call uses.
pub enum CallThreads {
    /// None but the caller's.
    Calling(CallingThread),
    /// The library's.
    Pool(Arc<Pool>),
    /// The host's.
    Host(HostThreads),
}

impl CallThreads {
    /// Threads that `control` asks for.
    ///
    /// # Errors
    /// Out of range for too many threads.
    pub fn new(control: &IsophoteControl) -> Outcome<Self> {
        if control.threads > MOST {
            return Err(Failure::new(
                ISOPHOTE_ERROR_OUT_OF_RANGE,
                format!("{} threads are more than the {MOST} that are allowed", control.threads),
            ));
        }
        let threads = control.threads as usize;
        if let Some(run) = control.run {
            return Ok(Self::Host(HostThreads::new(run, User(control.user), wanted(threads))));
        }
        Ok(if threads == 1 { Self::Calling(CallingThread) } else { Self::Pool(pool(threads)) })
    }

    /// The executor's view of them.
    pub fn threads(&self) -> &dyn Threads {
        match self {
            Self::Calling(threads) => threads,
            Self::Pool(pool) => &**pool,
            Self::Host(threads) => threads,
        }
    }
}

/// The host's word for itself, handed back to its callbacks.
#[derive(Clone, Copy, Debug)]
pub struct User(pub *mut c_void);

// SAFETY: the pointer is never followed here; the contract says on which threads callbacks are called.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

/// The host's threads, behind its callback.
#[derive(Debug)]
pub struct HostThreads {
    run: unsafe extern "C" fn(user: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64),
    user: User,
    count: usize,
}

impl HostThreads {
    /// `count` threads behind a function that runs the jobs of a batch.
    pub fn new(
        run: unsafe extern "C" fn(user: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64),
        user: User,
        count: usize,
    ) -> Self {
        Self { run, user, count }
    }
}

type IndexedTask<'a> = dyn Fn(usize) + Sync + 'a;

/// A batch of jobs in the hands of the host.
struct Batch {
    job: *const IndexedTask<'static>,
    state: Mutex<BatchState>,
    idle: Condvar,
}

// SAFETY: `job` is `Sync` and is only called while the batch is open, which `HostThreads::run` outlives.
unsafe impl Send for Batch {}
// SAFETY: as above.
unsafe impl Sync for Batch {}

struct BatchState {
    open: bool,
    running: usize,
    taken: Vec<bool>,
    panicked: Option<Box<dyn Any + Send>>,
}

static BATCHES: LazyLock<Mutex<HashMap<u64, Arc<Batch>>>> = LazyLock::new(Mutex::default);
static NEXT: AtomicU64 = AtomicU64::new(1);

impl Batch {
    /// Does a job, unless it is done already or the batch is over.
    fn work(&self, index: usize) {
        {
            let mut state = lock(&self.state);
            match state.taken.get_mut(index) {
                Some(taken) if !*taken => *taken = true,
                _ => return,
            }
            if !state.open {
                return;
            }
            state.running += 1;
        }
        // SAFETY: the batch was open when this job was counted as running, and the owner of the closure
        // waits until none is.
        let outcome = catch_unwind(AssertUnwindSafe(|| unsafe { (*self.job)(index) }));
        let mut state = lock(&self.state);
        state.running -= 1;
        if let Err(payload) = outcome {
            state.panicked.get_or_insert(payload);
        }
        drop(state);
        self.idle.notify_all();
    }
}

unsafe extern "C" fn work(batch: u64, index: u32) {
    // Nothing unwinds from `work`, but a poisoned allocator might from the look-up.
    let _ = catch_unwind(|| {
        let found = lock(&BATCHES).get(&batch).cloned();
        if let Some(found) = found {
            found.work(index as usize);
        }
    });
}

impl Threads for HostThreads {
    fn count(&self) -> usize {
        self.count
    }

    fn run(&self, jobs: usize, job: &IndexedTask<'_>) {
        // SAFETY: only the lifetime changes. The closure is called by `Batch::work` alone, while the
        // batch is open, and below this function closes it and waits before it returns.
        let job = unsafe { std::mem::transmute::<*const IndexedTask<'_>, *const IndexedTask<'static>>(job) };
        let batch = Arc::new(Batch {
            job,
            state: Mutex::new(BatchState {
                open: true,
                running: 0,
                taken: vec![false; jobs],
                panicked: None,
            }),
            idle: Condvar::new(),
        });
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        lock(&BATCHES).insert(number, Arc::clone(&batch));
        // SAFETY: the host promised a function of this type that returns normally.
        unsafe { (self.run)(self.user.0, jobs as u32, Some(work), number) };
        // What the host left out.
        (0..jobs).for_each(|index| batch.work(index));
        lock(&BATCHES).remove(&number);
        let mut state = lock(&batch.state);
        state.open = false;
        while state.running > 0 {
            state = batch.idle.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if let Some(payload) = state.panicked.take() {
            drop(state);
            resume_unwind(payload);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicU32;

    static LATE: Mutex<Vec<(u64, u32)>> = Mutex::new(Vec::new());

    /// Calls the first job twice, one that does not exist, and leaves out the rest.
    unsafe extern "C" fn careless(_: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64) {
        let job = job.unwrap();
        // SAFETY: a job takes any number.
        unsafe {
            job(batch, 0);
            job(batch, 0);
            job(batch, jobs + 7);
            job(batch + 1000, 1);
        }
        LATE.lock().unwrap().push((batch, jobs));
    }

    #[test]
    fn every_job_is_done_once_whatever_the_host_does() {
        let threads = HostThreads { run: careless, user: User(std::ptr::null_mut()), count: 3 };
        let counts: Vec<AtomicU32> = (0..9).map(|_| AtomicU32::new(0)).collect();
        threads.run(counts.len(), &|i| {
            counts[i].fetch_add(1, Ordering::Relaxed);
        });
        assert!(counts.iter().all(|c| c.load(Ordering::Relaxed) == 1));
        // Calls after the end reach nothing.
        for (batch, jobs) in LATE.lock().unwrap().drain(..) {
            // SAFETY: a job takes any number.
            (0..jobs).for_each(|i| unsafe { work(batch, i) });
        }
        assert!(counts.iter().all(|c| c.load(Ordering::Relaxed) == 1));
    }

    #[test]
    fn a_panic_in_a_job_comes_out_where_the_work_was_asked_for() {
        let threads = HostThreads { run: careless, user: User(std::ptr::null_mut()), count: 1 };
        let payload = catch_unwind(AssertUnwindSafe(|| threads.run(3, &|i| assert!(i != 0, "broken"))));
        assert_eq!(*payload.unwrap_err().downcast_ref::<&str>().unwrap(), "broken");
    }
}
