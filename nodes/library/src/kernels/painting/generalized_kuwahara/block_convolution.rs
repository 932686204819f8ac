//! Convolution of real images with fixed masks by the fast Fourier transform, block by block
//! (overlap-save): blocks lie at fixed places of the picture, so that a tile meets the blocks that the
//! full frame does.

use isophote_engine::memory;
use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection, FftNum, FftPlanner};
use std::sync::Arc;

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
pub trait Number: FftNum + Into<f64> {
    /// The transform of so many, a power of two.
    fn transform(count: usize, direction: FftDirection) -> Arc<dyn Fft<Self>>;
}

impl Number for f32 {
    fn transform(count: usize, direction: FftDirection) -> Arc<dyn Fft<Self>> {
        FftPlanner::new().plan_fft(count, direction)
    }
}

/// For blocks with bright pixels alone. The planner would bring in transforms of all counts by every instruction set, a
/// fifth of all that this crate is compiled of, as rustc estimates it; this one is slower.
impl Number for f64 {
    fn transform(count: usize, direction: FftDirection) -> Arc<dyn Fft<Self>> {
        Arc::new(Radix4::new(count, direction))
    }
}

/// Transforms of one size with the spectra of masks.
pub struct Convolution<T: Number> {
    side: usize,
    forward: Arc<dyn Fft<T>>,
    inverse: Arc<dyn Fft<T>>,
    spectra: Vec<Vec<Complex<T>>>,
    scratch: Vec<Complex<T>>,
    turned: Vec<Complex<T>>,
}

impl<T: Number> Convolution<T> {
    /// Prepares blocks of `side` pixels and the masks.
    pub fn new(side: usize, masks: &[Mask]) -> Self {
        let [forward, inverse] =
            [FftDirection::Forward, FftDirection::Inverse].map(|direction| T::transform(side, direction));
        let zero = Complex::new(T::zero(), T::zero());
        let scratch = forward.get_inplace_scratch_len().max(inverse.get_inplace_scratch_len());
        let mut this = Self {
            side,
            forward,
            inverse,
            spectra: Vec::new(),
            scratch: vec![zero; scratch],
            turned: Vec::new(),
        };
        memory::resize(&mut this.turned, side * side, zero);
        let share = 1.0 / (side * side) as f64;
        for mask in masks {
            let mut image = Vec::new();
            memory::resize(&mut image, side * side, zero);
            for ([dx, dy], weight) in mask {
                // A weight at offset d counts the pixel at x + d: the convolution's kernel is mirrored.
                let (x, y) = ((-dx).rem_euclid(side as i32) as usize, (-dy).rem_euclid(side as i32) as usize);
                let value = T::from_f64(f64::from(*weight) * share).unwrap_or_else(T::zero);
                image[y * side + x] = Complex::new(value, T::zero());
            }
            this.spectrum(&mut image);
            this.spectra.push(image);
        }
        this
    }

    /// The spectrum of a block in place, rows and columns exchanged.
    pub fn spectrum(&mut self, block: &mut Vec<Complex<T>>) {
        self.forward.process_with_scratch(block, &mut self.scratch);
        self.turn(block);
        self.forward.process_with_scratch(block, &mut self.scratch);
    }

    /// The block of `spectrum` convolved with mask `index`, in `out`. Real and imaginary parts stay
    /// apart, since masks are real.
    pub fn convolved(&mut self, spectrum: &[Complex<T>], index: usize, out: &mut Vec<Complex<T>>) {
        out.clear();
        out.extend(spectrum.iter().zip(&self.spectra[index]).map(|(a, b)| *a * *b));
        self.inverse.process_with_scratch(out, &mut self.scratch);
        self.turn(out);
        self.inverse.process_with_scratch(out, &mut self.scratch);
    }

    /// Exchanges rows and columns, in tiles that stay in the first-level cache.
    fn turn(&mut self, block: &mut Vec<Complex<T>>) {
        const TILE: usize = 16;
        let side = self.side;
        for y0 in (0..side).step_by(TILE) {
            for x0 in (0..side).step_by(TILE) {
                for y in y0..y0 + TILE {
                    let row = &mut self.turned[y * side + x0..y * side + x0 + TILE];
                    for (i, value) in row.iter_mut().enumerate() {
                        *value = block[(x0 + i) * side + y];
                    }
                }
            }
        }
        std::mem::swap(block, &mut self.turned);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mask_counts_the_pixels_at_its_offsets() {
        let mut convolution = Convolution::<f64>::new(32, &[vec![([2, -1], 0.5), ([0, 0], 2.0)]]);
        let value = |x: usize, y: usize| ((x * 7 + y * 13) % 11) as f64;
        let mut block: Vec<Complex<f64>> =
            (0..32 * 32).map(|i| Complex::new(value(i % 32, i / 32), -value(i / 32, i % 32))).collect();
        convolution.spectrum(&mut block);
        let mut out = Vec::new();
        convolution.convolved(&block, 0, &mut out);
        for (x, y) in [(3, 4), (20, 9), (29, 30)] {
            let got = out[y * 32 + x];
            let want = 0.5 * value(x + 2, y - 1) + 2.0 * value(x, y);
            let wanted_imaginary = -0.5 * value(y - 1, x + 2) - 2.0 * value(y, x);
            assert!((got.re - want).abs() < 1e-12 && (got.im - wanted_imaginary).abs() < 1e-12);
        }
    }

    #[test]
    fn blocks_grow_with_the_masks() {
        assert!(block_side(3) <= block_side(6) && block_side(6) < block_side(40));
        assert!(block_side(40) > 80 + 8);
    }
}
