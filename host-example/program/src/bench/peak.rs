//! Peak of this machine, measured: fused multiply-adds and bytes copied per second, on all
//! threads. Benchmarks state the share of it that a pass attains.

use std::hint::black_box;
use std::time::Instant;

use fearless_simd::{Level, Simd, dispatch, f32x8, f32x16, prelude::*};
use rayon::ThreadPool;
use rayon::prelude::*;

/// The machine's peak.
#[derive(Clone, Copy, Debug)]
pub struct Peak {
    /// Fused multiply-adds of 32-bit floats per second.
    pub multiply_adds: f64,
    /// Bytes read and written per second by a copy that no cache holds.
    pub copied: f64,
}

/// Independent chains of multiply-adds: enough to hide their latency, few enough for the registers.
const CHAINS: usize = 12;
/// Multiply-adds of each chain in a job: some milliseconds' worth.
const ROUNDS: usize = 1 << 20;
/// Each measurement is repeated, and the best counts.
const REPEATS: usize = 7;
/// Bytes of the copy's source; no cache holds so many.
const BYTES: usize = 128 << 20;

/// Measures on `threads` with the instructions of `level`; takes about a second.
pub fn measure(level: Level, threads: &ThreadPool) -> Peak {
    let narrow = multiply_adds(threads, 8, &|| dispatch!(level, simd => chains_of_8(simd)));
    let wide = multiply_adds(threads, 16, &|| dispatch!(level, simd => chains_of_16(simd)));
    Peak { multiply_adds: narrow.max(wide), copied: copied(threads) }
}

fn multiply_adds(threads: &ThreadPool, lanes: usize, chains: &(dyn Fn() -> f32 + Sync)) -> f64 {
    let jobs = threads.current_num_threads();
    let work = (jobs * lanes * CHAINS * ROUNDS) as f64;
    let mut best: f64 = 0.0;
    for _ in 0..REPEATS {
        let started = Instant::now();
        threads.broadcast(|_| black_box(chains()));
        best = best.max(work / started.elapsed().as_secs_f64());
    }
    best
}

macro_rules! chains {
    ($name:ident, $float:ident) => {
        #[inline(always)]
        fn $name<S: Simd>(simd: S) -> f32 {
            // The values stay finite, and the compiler cannot know them.
            let factor = $float::splat(simd, black_box(0.999_9));
            let term = $float::splat(simd, black_box(1e-4));
            let mut chains = [$float::splat(simd, black_box(1.0)); CHAINS];
            for _ in 0..ROUNDS {
                for chain in &mut chains {
                    *chain = chain.mul_add(factor, term);
                }
            }
            let mut sum = $float::splat(simd, 0.0);
            for chain in chains {
                sum += chain;
            }
            sum[0]
        }
    };
}

chains!(chains_of_8, f32x8);
chains!(chains_of_16, f32x16);

fn copied(threads: &ThreadPool) -> f64 {
    let from = vec![1.0f32; BYTES / 4];
    let mut to = vec![0.0f32; BYTES / 4];
    // Several parts for each thread even out that some are slower.
    let part = from.len().div_ceil(threads.current_num_threads() * 4);
    let mut best: f64 = 0.0;
    for _ in 0..REPEATS {
        let started = Instant::now();
        threads.install(|| {
            to.par_chunks_mut(part)
                .zip(from.par_chunks(part))
                .for_each(|(to, from)| to.copy_from_slice(from));
        });
        best = best.max(2.0 * BYTES as f64 / started.elapsed().as_secs_f64());
        black_box(&to);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_that_of_a_computer() {
        let peak = measure(Level::new(), &rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap());
        // From a small board to the fastest core there will be for a while.
        assert!((1e8..1e13).contains(&peak.multiply_adds), "{peak:?}");
        assert!((1e8..1e13).contains(&peak.copied), "{peak:?}");
    }
}
