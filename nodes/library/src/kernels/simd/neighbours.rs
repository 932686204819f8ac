//! The eight neighbours of eight pixels, for kernels of small support.

use crate::kernels::simd::line_buffer::{LineBuffer, strips};
use crate::kernels::simd::pixels::{Block, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, View};

/// Up to eight pixels of a row with what surrounds them.
#[derive(Clone, Copy)]
pub struct Neighbours<'a, S: Simd> {
    simd: S,
    /// The pixels.
    pub block: Block,
    rows: &'a LineBuffer,
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
        f32x8::from_slice(self.simd, &self.rows.row(self.block.y + dy, channel)[at..at + 8])
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
    let mut rows = LineBuffer::default();
    for (x0, x1) in strips(window.x0, window.x1) {
        rows.start(x0, x1, 1, 4);
        for y in window.y0 - 1..window.y0 + 1 {
            rows.load(simd, view, y);
        }
        for y in window.y0..window.y1 {
            rows.load(simd, view, y + 1);
            let start = 4 * (x0 - window.x0) as usize;
            let target = &mut band.row_mut(0, y)[start..start + 4 * (x1 - x0) as usize];
            for (i, pixels) in target.chunks_mut(32).enumerate() {
                let block = Block::until(x1, x0 + 8 * i as i32, y);
                let around = Neighbours { simd, block, rows: &rows, at: 1 + 8 * i };
                write(f(around), pixels);
            }
        }
    }
}
