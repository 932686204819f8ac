//! A line buffer of what means and variances are made of, for the Kuwahara filters: a ring of rows that hold
//! colours times coverage, their squares and the coverage, channel by channel, ready for vectors that start
//! at any column.

use crate::kernels::simd::line_buffer::strips;
use crate::kernels::simd::pixels::read;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, View, memory};

/// Channels of a row: a r, a g, a b, a (r^2 + g^2 + b^2), a.
pub const CHANNELS: usize = 5;

/// Rows of a strip of columns, clamped to the picture's edge.
#[derive(Debug, Default)]
pub struct MomentBuffer {
    first: i32,
    columns: usize,
    len: usize,
    count: i32,
    data: Vec<f32>,
    /// Per row: all coverage is 1.
    opaque: Vec<bool>,
    scratch: Vec<f32>,
}

impl MomentBuffer {
    /// Prepares for `rows` rows of columns `x0..x1` with `reach` pixels on both sides.
    pub fn start(&mut self, x0: i32, x1: i32, reach: i32, rows: i32) {
        self.first = x0 - reach;
        self.columns = (x1 - x0 + 2 * reach) as usize;
        // The last vectors of the output and their neighbours to the right.
        self.len = ((x1 - x0) as usize).next_multiple_of(16) + (2 * reach as usize).next_multiple_of(8);
        self.count = rows;
        memory::resize(&mut self.data, self.len * self.count as usize * CHANNELS, 0.0);
        self.opaque.clear();
        self.opaque.resize(self.count as usize, true);
    }

    /// Index of column `x` in a row.
    #[inline(always)]
    pub fn column(&self, x: i32) -> usize {
        (x - self.first) as usize
    }

    /// The place of row `y` in the ring.
    // Neither this nor the slice below may become a call, around which all vectors would be saved.
    #[inline(always)]
    fn slot(&self, y: i32) -> usize {
        let rest = y % self.count;
        (if rest < 0 { rest + self.count } else { rest }) as usize
    }

    /// The channels of row `y`.
    #[inline(always)]
    pub fn row(&self, y: i32) -> [&[f32]; CHANNELS] {
        let start = self.slot(y) * CHANNELS * self.len;
        let row = &self.data.as_slice()[start..start + CHANNELS * self.len];
        let (r, rest) = row.split_at(self.len);
        let (g, rest) = rest.split_at(self.len);
        let (b, rest) = rest.split_at(self.len);
        let (q, a) = rest.split_at(self.len);
        [r, g, b, q, a]
    }

    /// True when every pixel of the ring is opaque.
    pub fn is_opaque(&self) -> bool {
        self.opaque.iter().all(|o| *o)
    }

    /// Takes in row `y` of a colour image, which replaces the oldest.
    #[inline(always)]
    pub fn load<S: Simd>(&mut self, simd: S, view: &View<'_>, y: i32) {
        let slot = self.slot(y);
        let last = self.first + self.columns as i32;
        let source = view.padded_row(y, self.first, last, &mut self.scratch);
        let target = &mut self.data[slot * CHANNELS * self.len..][..CHANNELS * self.len];
        let one = f32x8::splat(simd, 1.0);
        let mut least = one;
        for (i, block) in source.chunks(32).enumerate() {
            let [r, g, b, a] = read(simd, block);
            least = least.at_most(a);
            let square = b.mul_add(b, g.mul_add(g, r * r));
            let values = [r * a, g * a, b * a, square * a, a];
            // By number: adapters of iterators over vectors would be calls.
            for channel in 0..CHANNELS {
                values[channel].store_slice(&mut target[channel * self.len + 8 * i..][..8]);
            }
        }
        self.opaque[slot] = least.simd_ge(one).all_true();
    }
}

/// Runs `f` on every row of a band, strip by strip, with what lies up to `reach` pixels around it: it is given the
/// rows, the first column of the strip and the one after its last, and the row.
#[inline(always)]
pub fn for_rows<S: Simd>(
    simd: S,
    view: &View<'_>,
    reach: i32,
    band: &mut Band<'_>,
    mut f: impl FnMut(&MomentBuffer, [i32; 2], i32, &mut Band<'_>),
) {
    let window = band.window;
    let mut planes = MomentBuffer::default();
    for (x0, x1) in strips(window.x0, window.x1) {
        planes.start(x0, x1, reach, 2 * reach + 1);
        for y in window.y0 - reach..window.y0 + reach {
            planes.load(simd, view, y);
        }
        for y in window.y0..window.y1 {
            planes.load(simd, view, y + reach);
            f(&planes, [x0, x1], y, band);
        }
    }
}
