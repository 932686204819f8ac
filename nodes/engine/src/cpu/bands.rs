//! One pass over some rows, in bands that threads share.

use super::control::Control;
use super::threads::Threads;
use crate::error::Result;
use crate::image::{Image, Rect};
use crate::kernel::{Band, CpuPass, Kernel};
use crate::memory;
use std::sync::{Mutex, OnceLock};

/// Least rows of a band.
pub(super) const BAND: i32 = 16;

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
    // Some bands per thread even out unequal rows; very thin ones would read their halo too often.
    let bands = (threads.count() * 4).clamp(1, height.div_ceil(BAND as usize).max(1));
    let jobs = split(window, full, outputs, height.div_ceil(bands));
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
