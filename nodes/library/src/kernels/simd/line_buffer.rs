//! A line buffer for kernels that look at a small neighbourhood: a ring of the rows around the one at hand.
//! Each row is clamped to the edge, mapped once and kept channel by channel, ready for vectors that start at
//! any column.

use crate::kernels::simd::pixels::{eight, read};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, View, memory};

/// Columns of a strip. Bands are worked through in strips so that their rows stay in the first-level
/// cache.
pub const STRIP: i32 = 256;

/// Columns of a strip for passes that do little with a pixel and wait for it: memory gives long rows faster than
/// short ones, and a few such rows still stay in the second-level cache.
pub const WIDE_STRIP: i32 = 960;

/// Rows y - radius ..= y + radius of a strip of columns, by channel.
#[derive(Debug, Default)]
pub struct LineBuffer {
    first: i32,
    columns: usize,
    len: usize,
    count: usize,
    channels: usize,
    data: Vec<f32>,
    scratch: Vec<f32>,
}

impl LineBuffer {
    /// Prepares for columns `x0..x1` with `radius` pixels on every side.
    pub fn start(&mut self, x0: i32, x1: i32, radius: i32, channels: usize) {
        self.first = x0 - radius;
        self.columns = (x1 - x0 + 2 * radius) as usize;
        // The last vector of the output and its neighbours to the right.
        self.len = ((x1 - x0) as usize).next_multiple_of(8) + (2 * radius as usize).next_multiple_of(8);
        self.count = 2 * radius as usize + 1;
        self.channels = channels;
        memory::resize(&mut self.data, self.len * self.count * channels, 0.0);
    }

    /// Values of one channel of a row, padding included; a multiple of eight.
    pub fn stride(&self) -> usize {
        self.len
    }

    /// One channel of row `y`, from `radius` pixels before the strip.
    #[inline(always)]
    pub fn row(&self, y: i32, channel: usize) -> &[f32] {
        let start = (y.rem_euclid(self.count as i32) as usize * self.channels + channel) * self.len;
        &self.data[start..start + self.len]
    }

    /// The four channels of row `y`, from `radius` pixels before the strip.
    #[inline(always)]
    pub fn channels(&self, y: i32) -> [&[f32]; 4] {
        [self.row(y, 0), self.row(y, 1), self.row(y, 2), self.row(y, 3)]
    }

    /// Takes in row `y` of a four-channel image, which replaces the oldest.
    #[inline(always)]
    pub fn load<S: Simd>(&mut self, simd: S, view: &View<'_>, y: i32) {
        self.load_mapped(
            simd,
            view,
            y,
            #[inline(always)]
            |pixels| pixels,
        );
    }

    /// As [`LineBuffer::load`], after `map`.
    #[inline(always)]
    pub fn load_mapped<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        y: i32,
        mut map: impl FnMut([f32x8<S>; 4]) -> [f32x8<S>; 4],
    ) {
        let at = y.rem_euclid(self.count as i32) as usize * self.channels * self.len;
        let last = self.first + self.columns as i32;
        let source = view.padded_row(y, self.first, last, &mut self.scratch);
        let target = &mut self.data[at..at + 4 * self.len];
        // A plain loop: adapters of iterators stay calls in code for wide vectors.
        for i in 0..source.len().div_ceil(32) {
            let rest = &source[32 * i..];
            let values = map(read(simd, rest));
            for channel in 0..4 {
                values[channel].store_slice(&mut target[channel * self.len + 8 * i..][..8]);
            }
        }
    }

    /// Takes in row `y` of a one-channel image, which replaces the oldest.
    #[inline(always)]
    pub fn load1<S: Simd>(&mut self, simd: S, view: &View<'_>, y: i32, map: impl Fn(f32x8<S>) -> f32x8<S>) {
        let at = y.rem_euclid(self.count as i32) as usize * self.channels * self.len;
        let last = self.first + self.columns as i32;
        let source = view.padded_row(y, self.first, last, &mut self.scratch);
        let target = &mut self.data[at..at + self.len];
        for (block, target) in source.chunks(8).zip(target.chunks_exact_mut(8)) {
            let mut padded = [0.0; 8];
            padded[..block.len()].copy_from_slice(block);
            map(f32x8::from_slice(simd, &padded)).store_slice(target);
        }
    }
}

/// Eight pixels of the four channels of a row, from index `at` on.
#[inline(always)]
pub fn pixels<S: Simd>(simd: S, channels: &[&[f32]; 4], at: usize) -> [f32x8<S>; 4] {
    let mut values = [f32x8::splat(simd, 0.0); 4];
    for c in 0..4 {
        values[c] = eight(simd, channels[c], at);
    }
    values
}

/// A row of a strip, whose neighbourhood a line buffer holds.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// The rows around it.
    pub buffer: &'a LineBuffer,
    /// Columns of the strip, the second one exclusive.
    pub columns: [i32; 2],
    /// The row.
    pub y: i32,
}

/// Runs `f` on every row of a band in strips of `width` columns, with the rows up to `radius` pixels around it
/// in a line buffer, each after `map`; `f` is given the values of output 0 to fill, `N` a pixel.
#[inline(always)]
pub fn for_rows<S: Simd, const N: usize>(
    simd: S,
    view: &View<'_>,
    band: &mut Band<'_>,
    [width, radius]: [i32; 2],
    map: impl Fn([f32x8<S>; 4]) -> [f32x8<S>; 4] + Copy,
    mut f: impl FnMut(Row<'_>, &mut [f32]),
) {
    let window = band.window;
    let mut buffer = LineBuffer::default();
    for (x0, x1) in strips_of(width, window.x0, window.x1) {
        buffer.start(x0, x1, radius, 4);
        for y in window.y0 - radius..window.y0 + radius {
            buffer.load_mapped(simd, view, y, map);
        }
        for y in window.y0..window.y1 {
            buffer.load_mapped(simd, view, y + radius, map);
            let start = N * (x0 - window.x0) as usize;
            let target = &mut band.row_mut(0, y)[start..start + N * (x1 - x0) as usize];
            f(Row { buffer: &buffer, columns: [x0, x1], y }, target);
        }
    }
}

/// The strips of columns `x0..x1`.
pub fn strips(x0: i32, x1: i32) -> impl Iterator<Item = (i32, i32)> {
    strips_of(STRIP, x0, x1)
}

/// The strips of columns `x0..x1`, `width` wide.
pub fn strips_of(width: i32, x0: i32, x1: i32) -> impl Iterator<Item = (i32, i32)> {
    (x0..x1).step_by(width as usize).map(move |x| (x, (x + width).min(x1)))
}
