//! Who runs the jobs of a pass.

use crate::memory;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes that a thread may take: its stack, and what kernels work with.
const THREAD: usize = 8 << 20;

/// Something that runs independent jobs: the engine's own pool, the caller's thread, or the host's
/// threads.
pub trait Threads: Sync {
    /// Number of jobs that can make progress at once; at least 1.
    fn count(&self) -> usize;
    /// Runs `job(0)`, ..., `job(jobs - 1)`, each once, in any order, and returns when all are done.
    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync));
}

/// Everything on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct CallingThread;

impl Threads for CallingThread {
    fn count(&self) -> usize {
        1
    }

    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..jobs).for_each(job);
    }
}

/// The calling thread and a pool of helpers, whose threads end when it is dropped.
///
/// The caller works along: a batch of jobs begins at once, while sleeping helpers are still waking, and a
/// pass takes as long as the slowest thread, not as long as the slowest to wake.
#[derive(Debug)]
pub struct Pool {
    helpers: Option<rayon::ThreadPool>,
}

impl Pool {
    /// A pool of `threads` threads, the calling one among them; 0 means one per core. Where the system refuses
    /// some there are fewer, the calling one at least.
    pub fn new(threads: usize) -> Self {
        let count = match threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            given => given,
        };
        let started = |helpers: usize| {
            memory::must_have((helpers * THREAD) as u64).ok()?;
            let builder = rayon::ThreadPoolBuilder::new().num_threads(helpers);
            let pool = builder.thread_name(|i| format!("isophote-{i}")).build().ok()?;
            // They begin before frames take memory: what a thread takes then cannot be refused.
            pool.broadcast(|_| ());
            Some(pool)
        };
        let fewer = std::iter::successors(Some(count - 1), |helpers| Some(helpers / 2));
        Self { helpers: fewer.take_while(|helpers| *helpers > 0).find_map(started) }
    }
}

impl Threads for Pool {
    fn count(&self) -> usize {
        1 + self.helpers.as_ref().map_or(0, rayon::ThreadPool::current_num_threads)
    }

    fn run(&self, jobs: usize, job: &(dyn Fn(usize) + Sync)) {
        let next = AtomicUsize::new(0);
        let work = || {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= jobs {
                    break;
                }
                job(index);
            }
        };
        let Some(helpers) = &self.helpers else { return work() };
        helpers.in_place_scope(|scope| {
            for _ in 1..jobs.min(self.count()) {
                scope.spawn(|_| work());
            }
            work();
        });
    }
}
