//! Memory of images between calls. The system gives new pages one by one as they are first touched, which takes longer
//! than many filters do; so what one frame leaves is kept for the next, within a bound, for all threads and instances.

use isophote::engine::cpu::{CpuExecutor, Threads};
use isophote::engine::{Error, Image, Rect, Result};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Images of fewer bytes are not kept: the allocator keeps their pages by itself.
const LEAST: u64 = 1 << 20;
/// Most bytes that are kept.
const MOST: u64 = 512 << 20;
/// One part in so many of the machine's memory is kept at most.
const SHARE: u64 = 16;
/// Memory of a machine that does not tell.
const UNKNOWN: u64 = 4 << 30;
/// What was not used for so long is given back at the next call.
const IDLE: Duration = Duration::from_secs(30);

/// Bytes of the machine's memory.
static MACHINE: LazyLock<u64> = LazyLock::new(|| {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"));
    let number = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    number.map_or(UNKNOWN, |kib| kib << 10)
});

/// One part in `part` of the machine's memory, in bytes.
pub fn share_of_machine(part: u64) -> u64 {
    *MACHINE / part
}

/// Memory that is kept, the last used at the end.
struct Pool {
    executors: Vec<(Instant, CpuExecutor)>,
    images: Vec<(Instant, Image)>,
}

static POOL: Mutex<Pool> = Mutex::new(Pool { executors: Vec::new(), images: Vec::new() });

impl Pool {
    fn bytes(&self) -> u64 {
        let executors = self.executors.iter().map(|(_, executor)| executor.kept()).sum::<u64>();
        executors + self.images.iter().map(|(_, image)| image.memory()).sum::<u64>()
    }

    /// Takes out what must not be kept any longer. It is dropped when the pool is no longer locked.
    fn excess(&mut self, most: u64, now: Instant) -> Vec<Self> {
        let mut gone = Vec::new();
        let is_idle = |since: &Instant| now.saturating_duration_since(*since) > IDLE;
        loop {
            let oldest = [self.executors.first().map(|(at, _)| *at), self.images.first().map(|(at, _)| *at)];
            let is_executor = match oldest {
                [None, None] => return gone,
                [Some(_), None] => true,
                [None, Some(_)] => false,
                [Some(executor), Some(image)] => executor <= image,
            };
            let since = oldest[usize::from(!is_executor)].unwrap_or(now);
            if self.bytes() <= most && !is_idle(&since) {
                return gone;
            }
            let (executors, images) = match is_executor {
                true => (vec![self.executors.remove(0)], Vec::new()),
                false => (Vec::new(), vec![self.images.remove(0)]),
            };
            gone.push(Self { executors, images });
        }
    }
}

fn lock() -> MutexGuard<'static, Pool> {
    POOL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Most bytes that are kept.
pub fn most() -> u64 {
    MOST.min(share_of_machine(SHARE))
}

/// An executor, with the memory that another call left in it, if any did.
pub fn executor() -> CpuExecutor {
    let mut pool = lock();
    let gone = pool.excess(most(), Instant::now());
    let found = pool.executors.pop();
    drop(pool);
    drop(gone);
    found.map(|(_, executor)| executor).unwrap_or_default()
}

/// Keeps an executor for another call.
pub fn keep_executor(executor: CpuExecutor) {
    if (LEAST..=most()).contains(&executor.kept()) {
        keep(|pool, now| pool.executors.push((now, executor)));
    }
}

/// Rows that one job copies.
const ROWS: usize = 16;

/// The part of an image in `window`.
///
/// # Errors
/// As [`Image::crop`].
pub fn part(of: &Image, window: Rect, threads: &dyn Threads) -> Result<Image> {
    if window.is_empty() || !of.window().contains(&window) {
        return Err(Error::Geometry(format!("cannot cut {window:?} out of {:?}", of.window())));
    }
    let mut part = image(window, of.channels())?;
    let stride = part.stride();
    let first = (window.x0 - of.window().x0) as usize * of.channels() as usize;
    let jobs: Vec<Mutex<&mut [f32]>> = part.data_mut().chunks_mut(ROWS * stride).map(Mutex::new).collect();
    threads.run(jobs.len(), &|job| {
        let mut rows = jobs[job].lock().unwrap_or_else(PoisonError::into_inner);
        for (y, row) in (window.y0 + (job * ROWS) as i32..).zip(rows.chunks_exact_mut(stride)) {
            row.copy_from_slice(&of.row(y)[first..first + stride]);
        }
    });
    drop(jobs);
    Ok(part)
}

/// Memory for an image of this shape, if some is kept.
pub fn spare(window: Rect, channels: u32) -> Option<Image> {
    let bytes = window.area() * u64::from(channels) * 4;
    if bytes < LEAST {
        return None;
    }
    let mut pool = lock();
    let fitting = pool.images.iter().enumerate().filter(|(_, (_, image))| {
        // Much larger ones are for others.
        (bytes..=bytes.saturating_mul(2)).contains(&image.memory())
    });
    let best = fitting.min_by_key(|(_, (_, image))| image.memory()).map(|(at, _)| at);
    best.map(|at| pool.images.remove(at).1)
}

/// An image of this shape, whose values are unspecified.
///
/// # Errors
/// As [`Image::with_window`].
pub fn image(window: Rect, channels: u32) -> Result<Image> {
    match spare(window, channels) {
        Some(image) => image.reshaped(window, channels),
        None => match Image::with_window(window, channels) {
            Err(Error::Memory(_)) => {
                // What is kept may be all that there is.
                forget();
                Image::with_window(window, channels)
            }
            new => new,
        },
    }
}

/// Keeps the memory of an image for another one.
pub fn keep_image(image: Image) {
    if (LEAST..=most()).contains(&image.memory()) {
        keep(|pool, now| pool.images.push((now, image)));
    }
}

fn keep(put: impl FnOnce(&mut Pool, Instant)) {
    let now = Instant::now();
    let mut pool = lock();
    put(&mut pool, now);
    let gone = pool.excess(most(), now);
    drop(pool);
    drop(gone);
}

/// Gives back all that is kept.
pub fn forget() {
    let mut pool = lock();
    let gone = (std::mem::take(&mut pool.executors), std::mem::take(&mut pool.images));
    drop(pool);
    drop(gone);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_handed_on_within_its_bound() {
        let window = Rect::of_size(1024, 512);
        let first = image(window, 4).unwrap();
        let place = first.data().as_ptr();
        keep_image(first);
        let second = image(Rect::of_size(512, 1000), 4).unwrap();
        assert_eq!(second.data().as_ptr(), place);
        assert_eq!((second.window(), second.channels()), (Rect::of_size(512, 1000), 4));
        assert!(image(window, 4).unwrap().data().iter().all(|v| *v == 0.0), "the other is in use");
        let mut pool = Pool { executors: Vec::new(), images: Vec::new() };
        let now = Instant::now();
        for _ in 0..4 {
            pool.images.push((now, Image::with_window(window, 4).unwrap()));
        }
        let each = pool.bytes() / 4;
        assert_eq!(pool.excess(3 * each, now).len(), 1);
        assert_eq!(pool.bytes(), 3 * each);
        assert_eq!(pool.excess(3 * each, now + 2 * IDLE).len(), 3, "idle for long");
        keep_image(second);
        forget();
        assert_eq!(lock().bytes(), 0);
    }
}
