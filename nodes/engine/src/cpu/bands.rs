//! One pass over some rows, in bands that threads share.

use super::control::Control;
use super::threads::Threads;
use crate::error::Result;
use crate::image::{Image, Rect};
use crate::kernel::{Band, CpuPass, Kernel};
use crate::memory;
use std::sync::{Mutex, OnceLock};

/// Least rows of a band, where there are not more threads than bands of so many.
pub(super) const BAND: i32 = 16;
/// Least rows of a band among however many threads.
const THINNEST: usize = 4;

/// Runs `kernel` over the rows of `window` of `outputs`, which must hold them. Does less when `control`
/// says to stop.
///
/// # Errors
/// [`Error::Memory`](crate::Error::Memory) when the kernel got none to work with.
pub(super) fn run_bands(
    kernel: &Kernel,
    pass: &CpuPass<'_>,
    window: Rect,
    full: [i32; 2],
    outputs: &mut [Image],
    threads: &dyn Threads,
    control: Control<'_>,
) -> Result<()> {
    let height = window.height() as usize;
    let jobs = split(window, full, outputs, rows(height, threads.count()));
    let cancelled = control.cancelled;
    let failed = OnceLock::new();
    threads.run(jobs.len(), &|i| {
        if failed.get().is_some() || cancelled.is_some_and(|c| c()) {
            return;
        }
        // A band is locked once, by the one job that owns it.
        if let Ok(mut band) = jobs[i].lock()
            && let Err(error) = memory::caught(|| (kernel.cpu)(pass, &mut band))
        {
            // The first one is as good as any.
            let _ = failed.set(error);
        }
    });
    drop(jobs);
    failed.into_inner().map_or(Ok(()), Err)
}

/// Rows of a band of a picture of `height` rows. Up to four bands for each thread even out unequal rows, but very thin ones would
/// read their halo too often. As many for each thread, or in the last turn some would wait for others.
fn rows(height: usize, threads: usize) -> usize {
    let turns = (height / BAND as usize / threads.max(1)).clamp(1, 4);
    height.div_ceil(turns * threads.max(1)).max(THINNEST)
}

/// Bands of `rows` rows of `window`, each with its part of every image.
fn split(window: Rect, full: [i32; 2], outputs: &mut [Image], rows: usize) -> Vec<Mutex<Band<'_>>> {
    let images = outputs.len();
    let mut bands: Vec<Mutex<Band<'_>>> = (window.y0..window.y1)
        .step_by(rows)
        .map(|y0| {
            let y1 = (y0 + rows as i32).min(window.y1);
            Mutex::new(Band { window: Rect { y0, y1, ..window }, full, outputs: Vec::with_capacity(images) })
        })
        .collect();
    for image in outputs {
        let (stride, whole) = (image.stride(), image.window());
        let at = |y: i32| (y - whole.y0) as usize * stride;
        let target = &mut image.data_mut()[at(window.y0)..at(window.y1)];
        for (band, part) in bands.iter_mut().zip(target.chunks_mut(rows * stride)) {
            if let Ok(band) = band.get_mut() {
                band.outputs.push(part);
            }
        }
    }
    bands
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn threads_get_as_many_bands_each() {
        for (threads, expected) in
            [(0, 270), (1, 270), (2, 135), (16, 17), (32, 17), (64, 17), (128, 9), (2000, 4)]
        {
            assert_eq!(rows(1080, threads), expected, "{threads} threads");
        }
        assert_eq!((rows(1, 2), rows(0, 2), rows(20, 2)), (4, 4, 10));
    }
}
