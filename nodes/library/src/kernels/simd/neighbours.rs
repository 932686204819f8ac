//! The eight neighbours of eight pixels, for kernels of small support.

use crate::kernels::simd::line_buffer::{Rows, strips};
use crate::kernels::simd::pixels::put_pixels4;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, View};

/// Up to eight pixels of a row with what surrounds them.
#[derive(Clone, Copy)]
pub struct Neighbours<'a, S: Simd> {
    simd: S,
    /// Column of the first pixel.
    pub x: i32,
    /// Row.
    pub y: i32,
    /// Pixels, 1..=8.
    pub len: usize,
    rows: &'a Rows,
    at: usize,
}

impl<S: Simd> Neighbours<'_, S> {
    /// One channel of the pixels.
    #[inline(always)]
    pub fn centre(&self, channel: usize) -> f32x8<S> {
        self.value(0, 0, channel)
    }

    /// By how much the neighbour at (dx, dy), -1..=1, exceeds the pixel in one channel of colour; as far
    /// as it is transparent it stands for the pixel.
    #[inline(always)]
    pub fn excess(&self, dx: i32, dy: i32, channel: usize) -> f32x8<S> {
        (self.value(dx, dy, channel) - self.centre(channel)) * self.value(dx, dy, 3)
    }

    #[inline(always)]
    fn value(&self, dx: i32, dy: i32, channel: usize) -> f32x8<S> {
        let at = (self.at as i32 + dx) as usize;
        f32x8::from_slice(self.simd, &self.rows.row(self.y + dy, channel)[at..at + 8])
    }
}

/// Runs `f` on every eight pixels of a band and their neighbours in `view`.
#[inline(always)]
pub fn each<S: Simd>(
    simd: S,
    view: &View<'_>,
    band: &mut Band<'_>,
    mut f: impl FnMut(Neighbours<'_, S>) -> [f32x8<S>; 4],
) {
    let window = band.window;
    let mut rows = Rows::default();
    for (x0, x1) in strips(window.x0, window.x1) {
        rows.start(x0, x1, 1, 4);
        for y in window.y0 - 1..window.y0 + 1 {
            rows.load4(
                simd,
                view,
                y,
                #[inline(always)]
                |v| v,
            );
        }
        for y in window.y0..window.y1 {
            rows.load4(
                simd,
                view,
                y + 1,
                #[inline(always)]
                |v| v,
            );
            let start = 4 * (x0 - window.x0) as usize;
            let target = &mut band.row_mut(0, y)[start..start + 4 * (x1 - x0) as usize];
            for (i, pixels) in target.chunks_mut(32).enumerate() {
                let x = x0 + 8 * i as i32;
                let around = Neighbours { simd, x, y, len: pixels.len() / 4, rows: &rows, at: 1 + 8 * i };
                put_pixels4(f(around), pixels);
            }
        }
    }
}
