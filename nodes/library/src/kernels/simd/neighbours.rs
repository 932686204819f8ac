//! The eight neighbours of eight pixels, for kernels of small support.

use crate::kernels::simd::line_buffer::{LineBuffer, STRIP, for_rows};
use crate::kernels::simd::pixels::{BLOCK, Block, write};
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
    for_rows::<S, 4>(
        simd,
        view,
        band,
        [STRIP, 1],
        std::convert::identity,
        #[inline(always)]
        |row, target| {
            for (i, pixels) in target.chunks_mut(4 * BLOCK).enumerate() {
                let at = BLOCK * i;
                let block = Block::until(row.columns[1], row.columns[0] + at as i32, row.y);
                write(f(Neighbours { simd, block, rows: row.buffer, at: 1 + at }), pixels);
            }
        },
    );
}
