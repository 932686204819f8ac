//! Weighted sums of colours along the lines of two blocks, some steps at a time.
//!
//! First to trace and then to add up keeps the long chains of the one, where everything waits, from the
//! many independent loads of the other, and both in registers.

use crate::kernels::simd::pixels::BLOCK;
use crate::kernels::trace::tile_copy::{FOUR, Place, TileCopy};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::math::load4;

/// Steps between two visits to the colours: no more than the usual lines have.
pub const RUN: usize = 12;

/// By line, step and pixel, for both sides of two blocks.
type PerTap<T> = [[[T; BLOCK]; RUN]; 4];

/// Steps of four times eight lines whose colours are not added up yet.
#[derive(Default)]
pub struct ColourTaps {
    /// The pixels above and to the left of a tap.
    at: PerTap<i32>,
    /// Weights of the row above the tap.
    above: PerTap<f32>,
    /// Weights of the row below.
    below: PerTap<f32>,
    /// Shares of the column to the right.
    right: PerTap<f32>,
}

/// Sums of two blocks, a pixel at a time: of left and right pixels, and the same times the shares of the right
/// ones. The left ones' shares are what is missing to one.
pub struct Sums<S: Simd>([[f32x8<S>; 2]; 2 * BLOCK]);

impl<S: Simd> Sums<S> {
    /// None yet.
    #[inline(always)]
    pub fn zero(simd: S) -> Self {
        Self([[f32x8::splat(simd, 0.0); 2]; 2 * BLOCK])
    }

    /// The channels of both blocks.
    #[inline(always)]
    pub fn channels(&self, simd: S) -> [[f32x8<S>; 4]; 2] {
        let mut sums = [[0.0; 4 * BLOCK]; 2];
        for i in 0..2 * BLOCK {
            let ((all, _), (left, right)) = (self.0[i][0].split(), self.0[i][1].split());
            (all - left + right).store_slice(&mut sums[i / BLOCK][4 * (i % BLOCK)..][..4]);
        }
        [load4(simd, &sums[0]), load4(simd, &sums[1])]
    }
}

impl ColourTaps {
    /// Puts step `k` of `line`, one of four.
    #[inline(always)]
    pub fn put<S: Simd>(&mut self, k: usize, line: usize, weight: f32x8<S>, place: &Place<S>) {
        let below = weight * place.below;
        place.at.store_slice(&mut self.at[line][k]);
        (weight - below).store_slice(&mut self.above[line][k]);
        below.store_slice(&mut self.below[line][k]);
        place.right.store_slice(&mut self.right[line][k]);
    }

    /// Adds up the first steps of all pixels, of each block as many as its greatest of `counts`.
    #[inline(always)]
    pub fn add_up<S: Simd>(
        &self,
        simd: S,
        colours: &TileCopy<FOUR>,
        counts: [i32x8<S>; 2],
        sums: &mut Sums<S>,
    ) {
        for i in 0..2 {
            // As many for all: where the longest line ends is easier to predict than where each does.
            let count = counts[i].reduce_max() as usize;
            for lane in 0..BLOCK {
                self.add(simd, colours, [2 * i, lane], count, &mut sums.0[i * BLOCK + lane]);
            }
        }
    }

    /// Adds `count` steps to both sides of one pixel.
    #[inline(always)]
    fn add<S: Simd>(
        &self,
        simd: S,
        colours: &TileCopy<FOUR>,
        [first, lane]: [usize; 2],
        count: usize,
        sums: &mut [f32x8<S>; 2],
    ) {
        let mut sides = [*sums, [f32x8::splat(simd, 0.0); 2]];
        for k in 0..count.min(RUN) {
            for (side, [all, right]) in sides.iter_mut().enumerate() {
                let line = first + side;
                let [above, below] = colours.both_rows(simd, self.at[line][k][lane] as u16);
                let above = above * self.above[line][k][lane];
                let pair = below.mul_add(f32x8::splat(simd, self.below[line][k][lane]), above);
                *all += pair;
                *right = pair.mul_add(f32x8::splat(simd, self.right[line][k][lane]), *right);
            }
        }
        *sums = [sides[0][0] + sides[1][0], sides[0][1] + sides[1][1]];
    }
}
