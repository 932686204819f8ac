//! Colour around a strip of pixels, channel by channel, for taps along straight lines of any direction,
//! one pixel at a time along the nearer axis (3.6, 3.7).
//!
//! Neighbouring pixels have neighbouring lines: the taps of eight of them lie side by side on a few rows
//! (or columns), which are read as whole vectors. Each row counts in each line by its share 1 - |distance|
//! in the linear interpolation between rows, and not at all farther than one pixel from the tap: products
//! with 0 are exact, so that the rows which only the neighbours need never show. The shares of the tap
//! behind the pixel are those of the tap ahead of it.
//!
//! Cost: per row and pair of taps four operations for the share and two multiply-adds a channel; two or
//! three rows along edges, more where orientation is noise.

use crate::kernels::simd::pixels::load_pixels;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::math::transposed;
use isophote_engine::{Band, Rect, View, memory};

/// Columns of a strip when lines are short: its rows stay in the first-level cache.
const COLUMNS: i32 = 128;

/// Rows of a strip when lines are short.
const ROWS: i32 = 64;

/// Rows that are read at least, for which most taps need no more.
const FEW: i32 = 3;

/// Steps whose rows are found together.
pub const STEPS: usize = 8;

/// Farther than any row that is read.
const FAR: f32 = 1e6;

/// Colours around a strip, by themselves or times coverage, and coverage.
#[derive(Debug, Default)]
pub struct LineTaps {
    x0: i32,
    y0: i32,
    width: usize,
    /// Values of a channel.
    len: usize,
    opaque: bool,
    data: Vec<f32>,
    scratch: Vec<f32>,
}

/// Lines through the centres of eight pixels side by side that step along the same axis.
#[derive(Clone, Copy)]
pub struct Lines<S: Simd> {
    /// Index of the first centre.
    start: i32,
    /// Step that one pixel along the axis adds to it; the next is that of one on the other.
    major: i32,
    minor: i32,
    /// Pixels on the other axis per pixel on this one, -1..=1.
    slope: f32x8<S>,
    /// Steps to the last tap; 0 for lines that step along the other axis.
    steps: f32x8<S>,
    /// Least and greatest slope.
    slopes: [f32; 2],
    /// The most steps of any line.
    most: i32,
}

/// The rows next to which taps lie, at eight numbers of steps: before they are read it must be known how
/// many there are.
#[derive(Clone, Copy, Debug)]
struct RowRanges {
    first: [f32; STEPS],
    index: [i32; STEPS],
    count: [i32; STEPS],
}

/// The taps of eight lines at one number of steps.
#[derive(Clone, Copy)]
pub struct Step<S: Simd> {
    /// Steps from the centres.
    pub distance: f32x8<S>,
    /// Lines that have these taps.
    pub active: mask32x8<S>,
    /// Distance of the taps from the centres on the other axis.
    across: f32x8<S>,
    /// First of the rows next to which taps lie, and their number, at least 2.
    row: f32,
    rows: i32,
    /// Indices of the first tap's place in that row, ahead and behind.
    ahead: i32,
    behind: i32,
    minor: i32,
}

impl<S: Simd> Lines<S> {
    /// Calls `f` with the taps at 1, 2, ... steps from the centres.
    #[inline(always)]
    pub fn for_steps(&self, mut f: impl FnMut(Step<S>)) {
        self.for_blocks(
            &mut (),
            #[inline(always)]
            |(), _, step| f(step),
            |(), _| (),
        );
    }

    /// As [`Lines::for_steps`] with the number of the step in its block of up to [`STEPS`], and calls `done`
    /// with the number of steps after each block. Both are given `state`.
    #[inline(always)]
    pub fn for_blocks<T>(
        &self,
        state: &mut T,
        mut f: impl FnMut(&mut T, usize, Step<S>),
        mut done: impl FnMut(&mut T, usize),
    ) {
        let simd = self.slope.simd;
        let (one, far) = (f32x8::splat(simd, 1.0), f32x8::splat(simd, FAR));
        let (mut distance, mut along) = (f32x8::splat(simd, 0.0), 0);
        let mut k = 0;
        while k < self.most {
            let ranges = self.ranges(k + 1);
            let count = (STEPS as i32).min(self.most - k) as usize;
            for i in 0..count {
                distance += one;
                along += self.major;
                let active = self.steps.simd_ge(distance);
                let across = ranges.index[i];
                let step = Step {
                    distance,
                    active,
                    // Lines that have ended are far from all rows.
                    across: active.select(self.slope * distance, far),
                    row: ranges.first[i],
                    rows: ranges.count[i],
                    ahead: self.start + along + across,
                    behind: self.start - along - across,
                    minor: self.minor,
                };
                f(state, i, step);
            }
            done(state, count);
            k += STEPS as i32;
        }
    }

    /// The rows at `k` to `k` + 7 steps.
    #[inline(always)]
    fn ranges(&self, k: i32) -> RowRanges {
        let simd = self.slope.simd;
        let lanes = f32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let distance = lanes + k as f32;
        let first = (distance * self.slopes[0]).floor();
        let count = (distance * self.slopes[1]).floor() - first + 2.0;
        let index = first.to_int::<i32x8<S>>() * self.minor;
        RowRanges {
            first: first.to_array(),
            index: index.to_array(),
            count: count.to_int::<i32x8<S>>().to_array(),
        }
    }
}

/// The strips of a band for lines that reach `radius` pixels to either side.
pub fn strips(band: &Band<'_>, radius: i32) -> impl Iterator<Item = Rect> + use<> {
    let window = band.window;
    // Longer than what is read around it, that little is read twice.
    let (columns, rows) = (COLUMNS.max((2 * radius + 7) / 8 * 8), ROWS.max(2 * radius));
    (window.x0..window.x1).step_by(columns as usize).flat_map(move |x0| {
        (window.y0..window.y1).step_by(rows as usize).map(move |y0| Rect {
            x0,
            y0,
            x1: (x0 + columns).min(window.x1),
            y1: (y0 + rows).min(window.y1),
        })
    })
}

impl LineTaps {
    /// Prepares for the pixels of `strip` and lines that reach `radius` pixels to either side.
    ///
    /// Pixels that the view does not hold are never taps with any weight; they repeat the last ones.
    /// `weighted`: colours are multiplied by coverage, to be mixed.
    #[inline(always)]
    pub fn load<S: Simd>(&mut self, simd: S, view: &View<'_>, strip: Rect, radius: i32, weighted: bool) {
        let rows = self.start(strip, radius);
        let (window, one) = (view.window(), f32x8::splat(simd, 1.0));
        let (r, rest) = self.data.split_at_mut(self.len);
        let (g, rest) = rest.split_at_mut(self.len);
        let (b, a) = rest.split_at_mut(self.len);
        let mut opaque = true;
        for row in 0..rows {
            let y = (self.y0 + row as i32).clamp(window.y0, window.y1 - 1);
            let source = view.padded_row(y, self.x0, self.x0 + self.width as i32, &mut self.scratch);
            let target = row * self.width..(row + 1) * self.width;
            let (r, g) = (&mut r[target.clone()], &mut g[target.clone()]);
            let (b, a) = (&mut b[target.clone()], &mut a[target]);
            for i in (0..self.width).step_by(8) {
                let pixels = &source[4 * i..4 * i + 32];
                let [red, green, blue, alpha] = transposed([
                    load_pixels(simd, &pixels[..4], &pixels[16..20]),
                    load_pixels(simd, &pixels[4..8], &pixels[20..24]),
                    load_pixels(simd, &pixels[8..12], &pixels[24..28]),
                    load_pixels(simd, &pixels[12..16], &pixels[28..32]),
                ]);
                opaque &= alpha.simd_eq(one).all_true();
                let factor = if weighted { alpha } else { one };
                (red * factor).store_slice(&mut r[i..i + 8]);
                (green * factor).store_slice(&mut g[i..i + 8]);
                (blue * factor).store_slice(&mut b[i..i + 8]);
                alpha.store_slice(&mut a[i..i + 8]);
            }
        }
        self.opaque = opaque;
    }

    /// As [`LineTaps::load`] from an image of two channels, which are a value times coverage, and coverage.
    #[inline(always)]
    pub fn load2<S: Simd>(&mut self, simd: S, view: &View<'_>, strip: Rect, radius: i32) {
        let rows = self.start(strip, radius);
        let (window, one) = (view.window(), f32x8::splat(simd, 1.0));
        let (values, coverage) = self.data.split_at_mut(self.len);
        let mut opaque = true;
        for row in 0..rows {
            let y = (self.y0 + row as i32).clamp(window.y0, window.y1 - 1);
            let source = view.padded_row(y, self.x0, self.x0 + self.width as i32, &mut self.scratch);
            let target = row * self.width..(row + 1) * self.width;
            let (values, coverage) = (&mut values[target.clone()], &mut coverage[target]);
            for i in (0..self.width).step_by(8) {
                let pixels = &source[2 * i..2 * i + 16];
                let (low, high) =
                    (f32x8::from_slice(simd, &pixels[..8]), f32x8::from_slice(simd, &pixels[8..]));
                let (value, alpha) = low.deinterleave(high);
                opaque &= alpha.simd_eq(one).all_true();
                value.store_slice(&mut values[i..i + 8]);
                alpha.store_slice(&mut coverage[i..i + 8]);
            }
        }
        self.opaque = opaque;
    }

    /// Makes room for the pixels around a strip and returns the number of their rows.
    fn start(&mut self, strip: Rect, radius: i32) -> usize {
        let margin = radius + FEW;
        (self.x0, self.y0) = (strip.x0 - margin, strip.y0 - margin);
        // Lines of the last block read as if it were full.
        self.width = (strip.width() as usize).next_multiple_of(8) + (2 * margin as usize).next_multiple_of(8);
        let rows = strip.height() as usize + 2 * margin as usize;
        self.len = self.width * rows;
        memory::resize(&mut self.data, 4 * self.len, 0.0);
        rows
    }

    /// True when every pixel around the strip is opaque: taps of weighted colours are then colours, to the
    /// bit, since the shares of a tap sum to 1 exactly.
    pub fn is_opaque(&self) -> bool {
        self.opaque
    }

    /// The first `N` channels of the eight pixels from (x, y) on.
    #[inline(always)]
    pub fn centres<S: Simd, const N: usize>(&self, simd: S, [x, y]: [i32; 2]) -> [f32x8<S>; N] {
        let at = (y - self.y0) * self.width as i32 + x - self.x0;
        let mut centres = [f32x8::splat(simd, 0.0); N];
        let channels = self.channels();
        // A plain loop: adapters of iterators stay calls in code for wide vectors.
        for c in 0..N {
            centres[c] = eight(simd, channels[c], at);
        }
        centres
    }

    /// Taps of the lines through the eight pixels from (x, y) on that step along an axis, x or y. `along`
    /// are these lines, and there is one; `slope` and `steps` are those of all.
    #[inline(always)]
    pub fn lines<S: Simd>(
        &self,
        [x, y]: [i32; 2],
        along_x: bool,
        along: mask32x8<S>,
        slope: f32x8<S>,
        steps: f32x8<S>,
    ) -> Lines<S> {
        let simd = slope.simd;
        let (zero, two) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 2.0));
        // Lines without a step, and what is not a number, have no part in the range of slopes.
        let along = along & steps.simd_ge(1.0);
        let steps = along.select(steps, zero);
        let width = self.width as i32;
        let (major, minor) = if along_x { (1, width) } else { (width, 1) };
        Lines {
            start: (y - self.y0) * width + x - self.x0,
            major,
            minor,
            slope,
            steps,
            slopes: [along.select(slope, two).reduce_min(), along.select(slope, -two).reduce_max()],
            most: steps.reduce_max() as i32,
        }
    }

    /// The channels, of one length.
    #[inline(always)]
    fn channels(&self) -> [&[f32]; 4] {
        let (r, rest) = self.data[..4 * self.len].split_at(self.len);
        let (g, rest) = rest.split_at(self.len);
        let (b, a) = rest.split_at(self.len);
        [r, g, b, &a[..self.len]]
    }

    /// Calls `f` with every row that a tap lies next to: the row's shares in the taps, and what the row has
    /// ahead and behind, the first `N` channels.
    #[inline(always)]
    pub fn for_rows<S: Simd, const N: usize>(
        &self,
        step: &Step<S>,
        f: impl FnMut(f32x8<S>, [[f32x8<S>; N]; 2]),
    ) {
        self.rows_from::<S, N>(step, 0, f);
    }

    /// The interpolated taps ahead and behind, the first `N` channels.
    #[inline(always)]
    pub fn taps<S: Simd, const N: usize>(&self, step: &Step<S>) -> [[f32x8<S>; N]; 2] {
        let simd = step.across.simd;
        // How many rows there are changes from step to step and is hard to predict, but most often three
        // are enough.
        let minor = step.minor as u32 as usize;
        let (ahead, behind) = (step.ahead as u32 as usize, (step.behind - 2 * step.minor) as u32 as usize);
        let place = f32x8::splat(simd, step.row);
        // No tap lies before the first row.
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let first = (one - (step.across - place)).at_least(zero);
        let shares = [first, step.share(place + 1.0), step.share(place + 2.0)];
        let mut taps = [[f32x8::splat(simd, 0.0); N]; 2];
        let channels = self.channels();
        for c in 0..N {
            let values = channels[c];
            taps[0][c] = few(&values[ahead..ahead + 2 * minor + 8], [0, minor, 2 * minor], shares);
            taps[1][c] = few(&values[behind..behind + 2 * minor + 8], [2 * minor, minor, 0], shares);
        }
        self.rows_from::<S, N>(
            step,
            FEW,
            #[inline(always)]
            |share, values| {
                for side in 0..2 {
                    for channel in 0..N {
                        taps[side][channel] = share.mul_add(values[side][channel], taps[side][channel]);
                    }
                }
            },
        );
        taps
    }

    /// As [`LineTaps::for_rows`], from row `first` on.
    #[inline(always)]
    fn rows_from<S: Simd, const N: usize>(
        &self,
        step: &Step<S>,
        first: i32,
        mut f: impl FnMut(f32x8<S>, [[f32x8<S>; N]; 2]),
    ) {
        let simd = step.across.simd;
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let channels = self.channels();
        let mut place = f32x8::splat(simd, step.row) + first as f32;
        let (mut ahead, mut behind) = (step.ahead + first * step.minor, step.behind - first * step.minor);
        for _ in first..step.rows {
            let mut values = [[zero; N]; 2];
            for channel in 0..N {
                values[0][channel] = eight(simd, channels[channel], ahead);
                values[1][channel] = eight(simd, channels[channel], behind);
            }
            f(step.share(place), values);
            place += one;
            ahead += step.minor;
            behind -= step.minor;
        }
    }
}

impl<S: Simd> Step<S> {
    /// The shares of the row at `place` in the taps.
    #[inline(always)]
    fn share(&self, place: f32x8<S>) -> f32x8<S> {
        let (zero, one) = (f32x8::splat(place.simd, 0.0), f32x8::splat(place.simd, 1.0));
        (one - (self.across - place).abs()).at_least(zero)
    }
}

/// The sum of the rows that begin at `at`, weighted.
#[inline(always)]
fn few<S: Simd>(values: &[f32], at: [usize; FEW as usize], shares: [f32x8<S>; FEW as usize]) -> f32x8<S> {
    let simd = shares[0].simd;
    let mut sum = f32x8::from_slice(simd, &values[at[0]..at[0] + 8]) * shares[0];
    for i in 1..FEW as usize {
        sum = f32x8::from_slice(simd, &values[at[i]..at[i] + 8]).mul_add(shares[i], sum);
    }
    sum
}

/// Eight values from index `at` on.
#[inline(always)]
fn eight<S: Simd>(simd: S, values: &[f32], at: i32) -> f32x8<S> {
    let at = at as u32 as usize;
    f32x8::from_slice(simd, &values[at..at + 8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::Image;
    use isophote_engine::fearless_simd::{Level, dispatch};

    #[test]
    fn taps_are_interpolated_whatever_the_lines_beside_them() {
        let values = (0..48 * 40 * 4).map(|i| ((i * 7919) % 1013) as f32 / 97.0);
        let image = Image::from_vec(48, 40, 4, values.collect()).unwrap();
        let strip = Rect { x0: 16, y0: 16, x1: 24, y1: 24 };
        let slopes = [0.9, -0.7, 0.1, 0.33, -0.02, 0.5, -1.0, 0.8];
        dispatch!(Level::new(), simd => {
            let view = View::new(&image, [48, 40]);
            let mut colours = LineTaps::default();
            colours.load(simd, &view, strip, 6, false);
            let taps = |slopes: [f32; 8]| {
                let (slope, steps) = (f32x8::simd_from(simd, slopes), f32x8::splat(simd, 6.0));
                let lines = colours.lines([16, 20], true, mask32x8::splat(simd, true), slope, steps);
                let mut all = Vec::new();
                lines.for_steps(|step| {
                    let [ahead, behind] = colours.taps::<_, 1>(&step);
                    all.push([ahead[0].to_array(), behind[0].to_array()]);
                });
                all
            };
            let together = taps(slopes);
            for (lane, slope) in slopes.into_iter().enumerate() {
                let alone = taps([slope; 8]);
                for (i, (ours, own)) in together.iter().zip(&alone).enumerate() {
                    let k = i as i32 + 1;
                    for (side, k) in [k, -k].into_iter().enumerate() {
                        let got = ours[side][lane];
                        assert_eq!(got, own[side][lane]);
                        let (x, y) = (16 + lane as i32 + k, 20.0 + slope * k as f32);
                        let [a, b] = [0, 1].map(|row| view.pixel4(x, y.floor() as i32 + row)[0]);
                        assert!((a + (b - a) * y.fract() - got).abs() < 1e-4);
                    }
                }
            }
        });
    }
}
