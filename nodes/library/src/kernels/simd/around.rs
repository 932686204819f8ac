//! The rows above, at and below a band's, for kernels that read pixels and all around them of images without colours.

use crate::kernels::simd::pixels::read;
use isophote_engine::fearless_simd::{Simd, f32x8};
use isophote_engine::{Rect, View};

/// The rows above, at and below `y`, from the pixel to the left of a band's window to that to its right.
#[inline(always)]
pub fn rows<'a>(view: &'a View<'_>, y: i32, window: Rect, scratch: &'a mut [Vec<f32>; 3]) -> [&'a [f32]; 3] {
    let (first, last) = (window.x0 - 1, window.x1 + 1);
    let [s0, s1, s2] = scratch;
    [(y - 1, s0), (y, s1), (y + 1, s2)].map(|(y, s)| view.padded_row(y, first, last, s))
}

/// A block of an image of `N` channels and what surrounds it.
#[derive(Clone, Copy)]
pub struct Around<'a, const N: usize> {
    /// Its [`rows`].
    pub rows: [&'a [f32]; 3],
    /// Index of the pixel to the left of the block.
    pub at: usize,
    /// Pixels of the block.
    pub len: usize,
}

impl<const N: usize> Around<'_, N> {
    /// The block's neighbours at (dx, dy), -1..=1.
    #[inline(always)]
    pub fn value<S: Simd>(&self, simd: S, dx: i32, dy: i32) -> [f32x8<S>; N] {
        let at = (self.at as i32 + 1 + dx) as usize;
        read(simd, &self.rows[(dy + 1) as usize][N * at..N * (at + self.len)])
    }
}
