//! Convolution of real images with fixed masks by the fast Fourier transform, block by block
//! (overlap-save): blocks lie at fixed places of the picture, so that a tile meets the blocks that the
//! full frame does.
//!
//! The transform is that of Cooley and Tukey (1965) down the columns of a block, as many side by side as a
//! vector has lanes: every column is added up in one order, whatever the processor. Forwards it leaves frequencies in the
//! order of their reversed bits, and backwards it takes them so (decimation in frequency, and in time).

use isophote_engine::fearless_simd::{Simd, prelude::*};
use isophote_engine::memory;
use std::f64::consts::TAU;
use std::iter::successors;
use std::ops::Range;

/// A mask: its weights by offset from the pixel, at most `reach` along either axis.
pub type Mask = Vec<([i32; 2], f32)>;

/// Side of the blocks, a power of two, that costs least for masks that reach so far: the transform of a
/// block per pixel that it yields.
pub fn block_side(reach: i32) -> usize {
    let cost = |side: usize| {
        let kept = side as f64 - 2.0 * f64::from(reach);
        let values = (side * side) as f64;
        if kept < 8.0 { f64::INFINITY } else { values * values.log2() / (kept * kept) }
    };
    [32, 64, 128, 256, 512].into_iter().min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(512)
}

/// Numbers that are transformed.
pub trait Real: Copy + Default + Into<f64> {
    /// The nearest one to a number.
    fn near(value: f64) -> Self;
}

impl Real for f32 {
    fn near(value: f64) -> Self {
        value as Self
    }
}

impl Real for f64 {
    fn near(value: f64) -> Self {
        value
    }
}

/// Complex numbers of a square, row by row.
pub struct Square<T> {
    pub real: Vec<T>,
    pub imaginary: Vec<T>,
}

impl<T: Real> Square<T> {
    /// Zeros.
    pub fn new(side: usize) -> Self {
        let mut this = Self { real: Vec::new(), imaginary: Vec::new() };
        memory::resize(&mut this.real, side * side, T::default());
        memory::resize(&mut this.imaginary, side * side, T::default());
        this
    }

    /// Real and imaginary parts from `at` on.
    #[inline(always)]
    fn vectors<S: Simd, V: SimdFloat<S, Element = T>>(&self, simd: S, at: usize) -> [V; 2] {
        let range = at..at + V::LEN;
        [V::from_slice(simd, &self.real[range.clone()]), V::from_slice(simd, &self.imaginary[range])]
    }
}

/// Vectors of such numbers.
pub trait Reals<S: Simd>: SimdFloat<S, Element: Real> {}

impl<S: Simd, V: SimdFloat<S, Element: Real>> Reals<S> for V {}

/// Transforms of one size with the spectra of masks.
pub struct Convolution<S: Simd, V: Reals<S>> {
    simd: S,
    columns: Columns<S, V>,
    /// Rows and columns of spectra are exchanged.
    spectra: Vec<Square<V::Element>>,
    turned: Square<V::Element>,
}

impl<S: Simd, V: Reals<S>> Convolution<S, V> {
    /// Prepares blocks of `side` pixels and the masks.
    #[inline(always)]
    pub fn new(simd: S, side: usize, masks: &[Mask]) -> Self {
        let columns = Columns::new(simd, side);
        let mut this = Self { simd, columns, spectra: Vec::new(), turned: Square::new(side) };
        let share = 1.0 / (side * side) as f64;
        for mask in masks {
            let mut image = Square::new(side);
            for ([dx, dy], weight) in mask {
                // A weight at offset d counts the pixel at x + d: the convolution's kernel is mirrored.
                let (x, y) = ((-dx).rem_euclid(side as i32) as usize, (-dy).rem_euclid(side as i32) as usize);
                image.real[y * side + x] = V::Element::near(f64::from(*weight) * share);
            }
            this.spectrum(&mut image);
            this.spectra.push(image);
        }
        this
    }

    /// The spectrum of a block in place.
    #[inline(always)]
    pub fn spectrum(&mut self, block: &mut Square<V::Element>) {
        let (simd, turned) = (self.simd, &mut self.turned);
        let all = 0..self.columns.rows.len();
        self.columns.transform::<false, true>(
            all.clone(),
            #[inline(always)]
            |at| block.vectors(simd, at),
            turned,
        );
        self.columns.transform::<false, false>(
            all,
            #[inline(always)]
            |at| turned.vectors(simd, at),
            block,
        );
    }

    /// The block of `spectrum` convolved with mask `index`, in `out`, whose columns but for the `kept` ones may hold anything.
    /// Real and imaginary parts stay apart, since masks are real.
    #[inline(always)]
    pub fn convolved(
        &mut self,
        spectrum: &Square<V::Element>,
        index: usize,
        kept: Range<usize>,
        out: &mut Square<V::Element>,
    ) {
        let (simd, mask, turned) = (self.simd, &self.spectra[index], &mut self.turned);
        let all = 0..self.columns.rows.len();
        self.columns.transform::<true, true>(
            all,
            #[inline(always)]
            |at| {
                let [[a, b], [c, d]]: [[V; 2]; 2] = [spectrum.vectors(simd, at), mask.vectors(simd, at)];
                [a * c - b * d, a * d + b * c]
            },
            turned,
        );
        self.columns.transform::<true, false>(
            kept,
            #[inline(always)]
            |at| turned.vectors(simd, at),
            out,
        );
    }
}

/// Powers of a root of unity that a step of a transform multiplies by: for the k-th of each four rows w^k, w^2k and w^3k,
/// where w is e^(-2 pi i / rows).
type Step<T> = Vec<[[T; 2]; 3]>;

/// Transforms of columns, as many side by side as a vector has lanes.
struct Columns<S: Simd, V: Reals<S>> {
    /// The widest first.
    steps: Vec<Step<V::Element>>,
    /// Rows of the columns: real parts, and imaginary ones.
    rows: Vec<[V; 2]>,
}

impl<S: Simd, V: Reals<S>> Columns<S, V> {
    #[inline(always)]
    fn new(simd: S, side: usize) -> Self {
        let root = |k: usize, rows: usize| {
            let (sin, cos) = (-TAU * k as f64 / rows as f64).sin_cos();
            [V::Element::near(cos), V::Element::near(sin)]
        };
        let widths = successors(Some(side), |rows| Some(rows / 4)).take_while(|rows| *rows >= 4);
        let step =
            |rows| (0..rows / 4).map(|k| [root(k, rows), root(2 * k, rows), root(3 * k, rows)]).collect();
        let zero = V::splat(simd, V::Element::default());
        Self { steps: widths.map(step).collect(), rows: vec![[zero; 2]; side] }
    }

    /// Transforms each of the `columns` of `given`, which says the numbers of a block from an index on, into a column of
    /// `out`, or into a row where it is `TURNED`.
    #[inline(always)]
    fn transform<const INVERSE: bool, const TURNED: bool>(
        &mut self,
        columns: Range<usize>,
        given: impl Fn(usize) -> [V; 2],
        out: &mut Square<V::Element>,
    ) {
        let side = self.rows.len();
        for x in (columns.start / V::LEN * V::LEN..columns.end).step_by(V::LEN) {
            for (y, row) in self.rows.iter_mut().enumerate() {
                *row = given(y * side + x);
            }
            if INVERSE {
                join(&mut self.rows, &self.steps);
            } else {
                split(&mut self.rows, &self.steps);
            }
            if TURNED {
                for lane in 0..V::LEN {
                    let row = (x + lane) * side..(x + lane + 1) * side;
                    let parts = out.real[row.clone()].iter_mut().zip(&mut out.imaginary[row]);
                    for ((real, imaginary), [re, im]) in parts.zip(&self.rows) {
                        (*real, *imaginary) = (re[lane], im[lane]);
                    }
                }
            } else {
                for (y, [re, im]) in self.rows.iter().enumerate() {
                    let at = y * side + x;
                    re.store_slice(&mut out.real[at..at + V::LEN]);
                    im.store_slice(&mut out.imaginary[at..at + V::LEN]);
                }
            }
        }
    }
}

/// The forward transform of columns, in steps of four rows and a last one of two; frequencies come in the order of their
/// reversed bits.
#[inline(always)]
fn split<S: Simd, V: Reals<S>>(columns: &mut [[V; 2]], steps: &[Step<V::Element>]) {
    for step in steps {
        for group in columns.chunks_exact_mut(4 * step.len()) {
            let [a, b, c, d] = quarters(group);
            for ((((a, b), c), d), [once, twice, thrice]) in a.iter_mut().zip(b).zip(c).zip(d).zip(step) {
                let [even, odd] = [sum(*a, *c), sum(*b, *d)];
                let [first, [re, im]] = [difference(*a, *c), difference(*b, *d)];
                *a = sum(even, odd);
                *b = times(difference(even, odd), *twice);
                *c = times([first[0] + im, first[1] - re], *once);
                *d = times([first[0] - im, first[1] + re], *thrice);
            }
        }
    }
    if columns.len().ilog2() % 2 == 1 {
        pairs(columns);
    }
}

/// The inverse of [`split`], times the number of rows.
#[inline(always)]
fn join<S: Simd, V: Reals<S>>(columns: &mut [[V; 2]], steps: &[Step<V::Element>]) {
    if columns.len().ilog2() % 2 == 1 {
        pairs(columns);
    }
    for step in steps.iter().rev() {
        for group in columns.chunks_exact_mut(4 * step.len()) {
            let [a, b, c, d] = quarters(group);
            for ((((a, b), c), d), [once, twice, thrice]) in a.iter_mut().zip(b).zip(c).zip(d).zip(step) {
                let second = over(*b, *twice);
                let [even, odd] = [sum(*a, second), difference(*a, second)];
                let [third, fourth] = [over(*c, *once), over(*d, *thrice)];
                let [first, [re, im]] = [sum(third, fourth), difference(third, fourth)];
                *a = sum(even, first);
                *b = [odd[0] - im, odd[1] + re];
                *c = difference(even, first);
                *d = [odd[0] + im, odd[1] - re];
            }
        }
    }
}

/// The transform of every two rows, which is its own inverse, times two.
#[inline(always)]
fn pairs<S: Simd, V: Reals<S>>(columns: &mut [[V; 2]]) {
    for pair in columns.chunks_exact_mut(2) {
        (pair[0], pair[1]) = (sum(pair[0], pair[1]), difference(pair[0], pair[1]));
    }
}

fn quarters<T>(group: &mut [T]) -> [&mut [T]; 4] {
    let quarter = group.len() / 4;
    let (upper, lower) = group.split_at_mut(2 * quarter);
    let ((a, b), (c, d)) = (upper.split_at_mut(quarter), lower.split_at_mut(quarter));
    [a, b, c, d]
}

#[inline(always)]
fn sum<S: Simd, V: Reals<S>>(a: [V; 2], b: [V; 2]) -> [V; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
fn difference<S: Simd, V: Reals<S>>(a: [V; 2], b: [V; 2]) -> [V; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
fn times<S: Simd, V: Reals<S>>([re, im]: [V; 2], [cos, sin]: [V::Element; 2]) -> [V; 2] {
    [re * cos - im * sin, re * sin + im * cos]
}

/// Times the inverse of a root.
#[inline(always)]
fn over<S: Simd, V: Reals<S>>([re, im]: [V; 2], [cos, sin]: [V::Element; 2]) -> [V; 2] {
    [re * cos + im * sin, im * cos - re * sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch, f64x4};

    #[test]
    fn a_mask_counts_the_pixels_at_its_offsets() {
        let masks = [vec![([2, -1], 0.5), ([0, 0], 2.0)]];
        let value = |x: usize, y: usize| ((x * 7 + y * 13) % 11) as f64;
        let mut block = Square {
            real: (0..32 * 32).map(|i| value(i % 32, i / 32)).collect(),
            imaginary: (0..32 * 32).map(|i| -value(i / 32, i % 32)).collect(),
        };
        let mut out = Square::new(32);
        dispatch!(Level::new(), simd => {
            let mut convolution = Convolution::<_, f64x4<_>>::new(simd, 32, &masks);
            convolution.spectrum(&mut block);
            convolution.convolved(&block, 0, 3..31, &mut out);
        });
        for (x, y) in [(3, 4), (20, 9), (29, 30)] {
            let (real, imaginary) = (out.real[y * 32 + x], out.imaginary[y * 32 + x]);
            let want = 0.5 * value(x + 2, y - 1) + 2.0 * value(x, y);
            let wanted_imaginary = -0.5 * value(y - 1, x + 2) - 2.0 * value(y, x);
            assert!((real - want).abs() < 1e-12 && (imaginary - wanted_imaginary).abs() < 1e-12);
        }
    }

    #[test]
    fn blocks_grow_with_the_masks() {
        assert!(block_side(3) <= block_side(6) && block_side(6) < block_side(40));
        assert!(block_side(40) > 80 + 8);
    }
}
