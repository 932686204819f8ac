//! The luma of a colour around a strip of pixels, laid out for taps along straight lines of any
//! direction, one pixel at a time along the nearer axis (Fig. 3.9).
//!
//! The two pixels that a tap lies between are neighbours on the other axis. Luma is kept twice, row by
//! row and as pairs of vertical neighbours, so that both are one 64-bit load whichever axis that is.
//! Where neighbouring lines run almost alike, as they do along an edge, their taps lie side by side on a
//! few rows, and are read as whole vectors instead.

use crate::kernels::simd::pixels::{eight, read};
use isophote_engine::fearless_simd::{Simd, f32x8, f64x4, i32x8, mask32x8, prelude::*};
use isophote_engine::{Rect, View};

/// Weights of the Rec. 709 luma.
const LUMA: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Columns of a strip, few enough for its rows to stay in the first-level cache.
pub const STRIP: i32 = 128;

/// Luma, by itself or times coverage, and coverage, around a strip.
#[derive(Debug, Default)]
pub struct LumaTaps {
    x0: i32,
    y0: i32,
    width: usize,
    rows: usize,
    radius: i32,
    opaque: bool,
    /// Index at which coverage begins, laid out as luma is, where not all is opaque.
    coverage: usize,
    data: Vec<f32>,
    scratch: Vec<f32>,
}

/// Taps along eight lines through the centres of eight pixels.
#[derive(Clone, Copy)]
pub struct Line<S: Simd> {
    /// Index of the centres.
    at: i32x8<S>,
    /// One pixel along the nearer axis.
    major: i32x8<S>,
    /// One pixel along the other axis.
    minor: i32x8<S>,
    /// Lanes that step along x.
    pub along_x: mask32x8<S>,
    /// Pixels on the other axis per pixel on the nearer one, -1..=1.
    pub slope: f32x8<S>,
    /// Absolute component of the direction on the nearer axis, 1 / sqrt(2)..=1.
    pub major_share: f32x8<S>,
    /// Index of the first centre, row by row.
    start: i32,
    /// Steps that one pixel along the nearer axis and one on the other add to it, where the lines share them.
    steps: [i32; 2],
    /// Least and greatest slope.
    slopes: [f32; 2],
    /// All lines step along the same axis.
    alike: bool,
    /// Rows that the lines' taps come to lie apart at most; 0 where they are more than [`MOST_ROWS`], or
    /// lie on columns as well.
    rows: usize,
}

/// Rows that are read as vectors at most, beside the first pair.
pub const MOST_ROWS: usize = 3;

impl<S: Simd> Line<S> {
    /// Number of rows in which taps are best read: [`LumaTaps::pair`] wants to know it beforehand. To find it out at
    /// every tap would be a branch that nothing predicts.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The same lines, of which taps are read no farther than `radius` pixels to either side: these lie on fewer
    /// rows.
    #[inline(always)]
    pub fn shortened(&self, radius: i32) -> Self {
        Self { rows: if self.alike { rows_apart(self.slopes, radius) } else { 0 }, ..*self }
    }

    /// The lowest row of taps, floor(along slope + offset), that is read; `ROWS` more follow, the last one of
    /// which lies no farther to the side than `along`.
    #[inline(always)]
    fn lowest<const ROWS: usize>(&self, along: i32, offset: f32) -> i32 {
        let slope = self.slopes[usize::from(along < 0)];
        ((along as f32 * slope + offset).floor() as i32).min(along.abs() - ROWS as i32)
    }
}

/// Rows that taps of lines between the `slopes` come to lie apart over `radius` pixels; 0 for too many.
#[inline(always)]
fn rows_apart(slopes: [f32; 2], radius: i32) -> usize {
    let apart = (radius as f32 * (slopes[1] - slopes[0]) + 1e-3).ceil() as usize;
    if apart <= MOST_ROWS { apart } else { 0 }
}

impl LumaTaps {
    /// Prepares for the pixels of `strip` and lines that reach `radius` pixels to either side.
    ///
    /// Pixels that the view does not hold are never taps with any weight; they repeat the last ones.
    /// `weighted`: luma is multiplied by coverage, to be mixed.
    #[inline(always)]
    pub fn load<S: Simd>(&mut self, simd: S, view: &View<'_>, strip: Rect, radius: i32, weighted: bool) {
        let margin = radius + 1;
        (self.x0, self.y0, self.radius) = (strip.x0 - margin, strip.y0 - margin, radius);
        // Lines of the last block read as if it were full.
        self.width = (strip.width() as usize).next_multiple_of(8) + (2 * margin as usize).next_multiple_of(8);
        self.rows = strip.height() as usize + 2 * margin as usize;
        self.coverage = 3 * self.width * (self.rows + 1);
        self.data.resize(self.coverage, 0.0);
        let one = f32x8::splat(simd, 1.0);
        let mut opaque = true;
        self.plane(
            simd,
            view,
            0,
            #[inline(always)]
            |[r, g, b, alpha]| {
                opaque &= alpha.simd_eq(one).all_true();
                let luma = r * LUMA[0] + g * LUMA[1] + b * LUMA[2];
                if weighted { luma * alpha } else { luma }
            },
        );
        self.opaque = opaque;
        if !opaque {
            self.data.resize(2 * self.coverage, 0.0);
            self.plane(
                simd,
                view,
                self.coverage,
                #[inline(always)]
                |[.., alpha]| alpha,
            );
        }
    }

    /// Fills what begins at `start`: rows of `value`, then pairs.
    #[inline(always)]
    fn plane<S: Simd>(
        &mut self,
        simd: S,
        view: &View<'_>,
        start: usize,
        mut value: impl FnMut([f32x8<S>; 4]) -> f32x8<S>,
    ) {
        let (window, width) = (view.window(), self.width);
        let (rows, pairs) = self.data[start..start + self.coverage].split_at_mut(width * (self.rows + 1));
        // Plain loops: adapters of iterators stay calls in code for wide vectors.
        for i in 0..=self.rows {
            let row = &mut rows[i * width..(i + 1) * width];
            let y = (self.y0 + i as i32).clamp(window.y0, window.y1 - 1);
            let source = view.padded_row(y, self.x0, self.x0 + width as i32, &mut self.scratch);
            let source = &source[..4 * width];
            for x in (0..width).step_by(8) {
                value(read(simd, &source[4 * x..4 * x + 32])).store_slice(&mut row[x..x + 8]);
            }
        }
        for i in 0..self.rows {
            let (above, below) = rows[i * width..(i + 2) * width].split_at(width);
            let target = &mut pairs[2 * i * width..2 * (i + 1) * width];
            for x in (0..width).step_by(8) {
                let (above, below) = (eight(simd, above, x), eight(simd, below, x));
                let (low, high) = above.interleave(below);
                low.store_slice(&mut target[2 * x..2 * x + 8]);
                high.store_slice(&mut target[2 * x + 8..2 * x + 16]);
            }
        }
    }

    /// True when every pixel around the strip is opaque.
    pub fn is_opaque(&self) -> bool {
        self.opaque
    }

    /// Luma of the eight pixels from (x, y) on, which lie in the strip or up to seven columns past it.
    #[inline(always)]
    pub fn centre<S: Simd>(&self, simd: S, x: i32, y: i32) -> f32x8<S> {
        let at = (y - self.y0) as usize * self.width + (x - self.x0) as usize;
        eight(simd, &self.data, at)
    }

    /// Coverage of the eight pixels from (x, y) on; only where not all is opaque.
    #[inline(always)]
    pub fn coverage<S: Simd>(&self, simd: S, x: i32, y: i32) -> f32x8<S> {
        let at = self.coverage + (y - self.y0) as usize * self.width + (x - self.x0) as usize;
        eight(simd, &self.data, at)
    }

    /// Lines through the eight pixels from (x, y) on in the directions `n`, unit vectors of either sign.
    #[inline(always)]
    pub fn line<S: Simd>(&self, simd: S, x: i32, y: i32, [nx, ny]: [f32x8<S>; 2]) -> Line<S> {
        let along_x = nx.abs().simd_gt(ny.abs());
        let major = along_x.select(nx, ny);
        let lanes = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        let start = (y - self.y0) * self.width as i32 + x - self.x0;
        let (column, width) = (lanes + start, self.width as i32);
        let slope = along_x.select(ny, nx) / major;
        let slopes = [slope.reduce_min(), slope.reduce_max()];
        let (all, any) = (along_x.all_true(), along_x.any_true());
        Line {
            at: along_x.select(column + column + (self.width * (self.rows + 1)) as i32, column),
            major: along_x.select(i32x8::splat(simd, 2), i32x8::splat(simd, width)),
            minor: along_x.select(i32x8::splat(simd, 2 * width), i32x8::splat(simd, 1)),
            along_x,
            slope,
            major_share: major.abs(),
            start,
            steps: if all { [1, width] } else { [width, 1] },
            slopes,
            alike: all == any,
            rows: if all == any { rows_apart(slopes, self.radius) } else { 0 },
        }
    }

    /// The two pixels `along` steps on at `across` = floor(along slope + `offset`) and `across` + 1 to
    /// the side; `ROWS` is what the line says ([`Line::rows`]).
    #[inline(always)]
    pub fn pair<S: Simd, const ROWS: usize>(
        &self,
        simd: S,
        line: &Line<S>,
        along: i32,
        across: i32x8<S>,
        offset: f32,
    ) -> [f32x8<S>; 2] {
        pair::<_, ROWS>(simd, &self.data, line, along, across, offset)
    }

    /// Coverage of what [`LumaTaps::pair`] gives; only where not all is opaque.
    #[inline(always)]
    pub fn pair_coverage<S: Simd, const ROWS: usize>(
        &self,
        simd: S,
        line: &Line<S>,
        along: i32,
        across: i32x8<S>,
        offset: f32,
    ) -> [f32x8<S>; 2] {
        pair::<_, ROWS>(simd, &self.data[self.coverage..], line, along, across, offset)
    }

    /// Pairs of [`LumaTaps::pair`] with no offset, plus the pixels opposite to them, `along` > 0 steps
    /// back.
    #[inline(always)]
    pub fn opposite_pairs<S: Simd, const ROWS: usize>(
        &self,
        simd: S,
        line: &Line<S>,
        along: i32,
        across: i32x8<S>,
    ) -> [f32x8<S>; 2] {
        opposite_pairs::<_, ROWS>(simd, &self.data, line, along, across)
    }

    /// Coverage of what [`LumaTaps::opposite_pairs`] gives; only where not all is opaque.
    #[inline(always)]
    pub fn opposite_coverage<S: Simd, const ROWS: usize>(
        &self,
        simd: S,
        line: &Line<S>,
        along: i32,
        across: i32x8<S>,
    ) -> [f32x8<S>; 2] {
        opposite_pairs::<_, ROWS>(simd, &self.data[self.coverage..], line, along, across)
    }
}

#[inline(always)]
fn pair<S: Simd, const ROWS: usize>(
    simd: S,
    data: &[f32],
    line: &Line<S>,
    along: i32,
    across: i32x8<S>,
    offset: f32,
) -> [f32x8<S>; 2] {
    if ROWS == 0 {
        return gathered(simd, data, line.at + line.major * along + line.minor * across);
    }
    let [major, minor] = line.steps;
    let low = line.lowest::<ROWS>(along, offset);
    let at = line.start + along * major + low * minor;
    let (mut first, mut second) = (row(simd, data, at), row(simd, data, at + minor));
    for i in 1..=ROWS as i32 {
        let beyond = across.simd_ge(low + i);
        let next = row(simd, data, at + (i + 1) * minor);
        first = beyond.select(row(simd, data, at + i * minor), first);
        second = beyond.select(next, second);
    }
    [first, second]
}

#[inline(always)]
fn opposite_pairs<S: Simd, const ROWS: usize>(
    simd: S,
    data: &[f32],
    line: &Line<S>,
    along: i32,
    across: i32x8<S>,
) -> [f32x8<S>; 2] {
    if ROWS == 0 {
        let way = line.major * along + line.minor * across;
        let [first, second] = gathered(simd, data, line.at + way);
        // The left one of two opposite neighbours lies across from the right one.
        let [right, left] = gathered(simd, data, line.at - way - line.minor);
        return [first + left, second + right];
    }
    let [major, minor] = line.steps;
    let low = line.lowest::<ROWS>(along, 0.0);
    let way = along * major + low * minor;
    let (on, back) = (line.start + way, line.start - way);
    let mut next = row(simd, data, on + minor) + row(simd, data, back - minor);
    let (mut first, mut second) = (row(simd, data, on) + row(simd, data, back), next);
    for i in 1..=ROWS as i32 {
        let beyond = across.simd_ge(low + i);
        first = beyond.select(next, first);
        next = row(simd, data, on + (i + 1) * minor) + row(simd, data, back - (i + 1) * minor);
        second = beyond.select(next, second);
    }
    [first, second]
}

/// Values at eight places and the ones after them.
#[inline(always)]
fn gathered<S: Simd>(simd: S, data: &[f32], at: i32x8<S>) -> [f32x8<S>; 2] {
    let at = at.to_array();
    let low = [two(data, at[0]), two(data, at[1]), two(data, at[2]), two(data, at[3])];
    let high = [two(data, at[4]), two(data, at[5]), two(data, at[6]), two(data, at[7])];
    let (low, high) = (f64x4::simd_from(simd, low), f64x4::simd_from(simd, high));
    let (low, high): (f32x8<S>, f32x8<S>) = (low.bitcast(), high.bitcast());
    low.deinterleave(high).into()
}

/// Two neighbouring values in one register: collected in memory, they would stall the wide load.
#[inline(always)]
fn two(data: &[f32], at: i32) -> f64 {
    let at = at as u32 as usize;
    let values = &data[at..at + 2];
    f64::from_bits(u64::from(values[0].to_bits()) | u64::from(values[1].to_bits()) << 32)
}

/// Eight values from index `at` on.
#[inline(always)]
fn row<S: Simd>(simd: S, data: &[f32], at: i32) -> f32x8<S> {
    let at = at as u32 as usize;
    eight(simd, data, at)
}
