//! Tiles of a picture with what lies around them, copied together for kernels that follow lines through
//! them pixel by pixel.
//!
//! In a copy every place is an index of sixteen bits, and arrays hold a pixel for each of their values: places
//! need no comparison with the range before they are read, of which there would be several a tap. The
//! picture's edges are repeated around it, so that places near them are like any other, and what lines
//! reach stays together in the second-level cache.
//!
//! Cost: one copy of (tile + 2 reach)^2 pixels for each tile.

use crate::kernels::shared::coverage::is_opaque;
use crate::kernels::simd::pixels::load_pixels;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::math::{spread, transposed};
use isophote_engine::{Rect, View};

/// Widest copy: a row's length must fit eight bits.
const WIDEST: i32 = u8::MAX as i32;
/// Most pixels in a copy.
const MOST: i32 = 1 << 16;
/// Columns and rows of a tile, unless far-reaching lines leave less room.
const TILE: [i32; 2] = [128, 64];
/// Smaller tiles are not worth what is copied around them.
const LEAST_SIDE: i32 = 8;

/// Places of sixteen bits, one row on by eight more, and the pixel to the right of the last.
const PLACES: usize = (1 << 16) + (1 << 8) + 1;
/// Values of a copy of a two-channel image.
pub const TWO: usize = 2 * PLACES;
/// Values of a copy of a four-channel image.
pub const FOUR: usize = 4 * PLACES;

/// Part of a picture that the copies around one tile hold.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The tile, absolute.
    pub tile: Rect,
    /// Columns and rows that are held, absolute.
    pub window: Rect,
}

impl Frame {
    /// True when lines that reach `reach` pixels far can be followed through copies at all.
    pub fn suits(reach: i32) -> bool {
        WIDEST - 2 * reach >= LEAST_SIDE
    }

    /// The tiles of `window`, with `reach` pixels around each; `reach` must be one that suits.
    pub fn tiles(window: Rect, reach: i32) -> impl Iterator<Item = Self> {
        let [width, height] = TILE.map(|side| side.min(WIDEST - 2 * reach).max(1));
        // As even in height as they can be: around a low tile lies as much as around a high one.
        let height = window.height().div_ceil(window.height().div_ceil(height as u32).max(1)).max(1) as i32;
        (window.y0..window.y1).step_by(height as usize).flat_map(move |y0| {
            (window.x0..window.x1).step_by(width as usize).map(move |x0| {
                let tile = Rect { x0, y0, x1: (x0 + width).min(window.x1), y1: (y0 + height).min(window.y1) };
                let window =
                    Rect { x0: x0 - reach, y0: y0 - reach, x1: tile.x1 + reach, y1: tile.y1 + reach };
                assert!(window.area() <= MOST as u64);
                Self { tile, window }
            })
        })
    }

    /// True when some of what is held lies outside a picture of `full` pixels.
    pub fn meets_edges(&self, full: [i32; 2]) -> bool {
        !Rect { x0: 0, y0: 0, x1: full[0], y1: full[1] }.contains(&self.window)
    }

    #[inline(always)]
    fn stride(&self) -> i32 {
        self.window.x1 - self.window.x0
    }
}

/// Eight places between pixels: the pixels above and to the left of them, and the shares of the next ones.
/// Copies of one frame share them.
#[derive(Clone, Copy)]
pub struct Place<S: Simd> {
    /// Pixels above and to the left, of which sixteen bits count.
    pub at: i32x8<S>,
    /// Share of the pixels to the right, 0..1.
    pub right: f32x8<S>,
    /// Share of the pixels below, 0..1.
    pub below: f32x8<S>,
}

impl<S: Simd> Place<S> {
    /// The places of the absolute positions (x, y).
    #[inline(always)]
    pub fn new(frame: &Frame, x: f32x8<S>, y: f32x8<S>) -> Self {
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (x.floor(), y.floor());
        // Whole numbers below 2^24, exact in floating point: sides are at most 2^16 and strides 2^8 - 1.
        let first = frame.window.y0 * frame.stride() + frame.window.x0;
        let at = top.mul_add(frame.stride() as f32, left - first as f32);
        Self { at: at.to_int(), right: x - left, below: y - top }
    }
}

/// A copy of the part of an image that a frame holds; `VALUES` is [`TWO`] or [`FOUR`].
#[derive(Debug)]
pub struct TileCopy<const VALUES: usize> {
    data: Box<[f32; VALUES]>,
    stride: u8,
    scratch: Vec<f32>,
}

impl<const VALUES: usize> Default for TileCopy<VALUES> {
    fn default() -> Self {
        let data = vec![0.0; VALUES].into_boxed_slice();
        let Ok(data) = data.try_into() else { unreachable!("a vector has the length it is made with") };
        Self { data, stride: 0, scratch: Vec::new() }
    }
}

impl<const VALUES: usize> TileCopy<VALUES> {
    const CHANNELS: usize = VALUES / PLACES;

    /// Copies what `frame` holds of `view`.
    pub fn load(&mut self, view: &View<'_>, frame: &Frame) {
        self.stride = frame.stride() as u8;
        let Rect { x0, y0, x1, y1 } = frame.window;
        let len = Self::CHANNELS * frame.stride() as usize;
        for (y, target) in (y0..y1).zip(self.data.chunks_exact_mut(len)) {
            target.copy_from_slice(view.padded_row(y, x0, x1, &mut self.scratch));
        }
    }

    /// [`load`](Self::load), where the colours of an image of four channels are multiplied by their alpha.
    pub fn load_covered(&mut self, view: &View<'_>, frame: &Frame) {
        self.load(view, frame);
        if Self::CHANNELS != 4 {
            return;
        }
        let pixels = &mut self.data[..4 * frame.window.area() as usize];
        // The product with 1 is exact: whether it is left out never shows.
        if !is_opaque(pixels) {
            for [r, g, b, alpha] in pixels.as_chunks_mut::<4>().0 {
                (*r, *g, *b) = (*r * *alpha, *g * *alpha, *b * *alpha);
            }
        }
    }

    /// Eight values from pixel `at` on, and from the pixel below it.
    #[inline(always)]
    pub fn both_rows<S: Simd>(&self, simd: S, at: u16) -> [f32x8<S>; 2] {
        let upper = Self::CHANNELS * usize::from(at);
        let lower = Self::CHANNELS * (usize::from(at) + usize::from(self.stride));
        [
            f32x8::from_slice(simd, &self.data[upper..upper + 8]),
            f32x8::from_slice(simd, &self.data[lower..lower + 8]),
        ]
    }
}

impl TileCopy<TWO> {
    /// Bilinear samples, by the arithmetic of `sample_linear2`.
    #[inline(always)]
    pub fn sample<S: Simd>(&self, simd: S, place: &Place<S>) -> [f32x8<S>; 2] {
        let (at, below, mut pixels) =
            (place.at.to_array(), spread(place.below), [f32x8::splat(simd, 0.0); 4]);
        let row = 2 * usize::from(self.stride);
        for i in 0..4 {
            let (low, high) = (2 * usize::from(at[i] as u16), 2 * usize::from(at[i + 4] as u16));
            let a = load_pixels(simd, &self.data[low..low + 4], &self.data[high..high + 4]);
            let b = load_pixels(
                simd,
                &self.data[low + row..low + row + 4],
                &self.data[high + row..high + row + 4],
            );
            pixels[i] = (b - a).mul_add(below[i], a);
        }
        let [l0, l1, r0, r1] = transposed(pixels);
        [(r0 - l0).mul_add(place.right, l0), (r1 - l1).mul_add(place.right, l1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::shared::sampling::{sample_linear2, sample_linear4};
    use isophote_engine::Image;
    use isophote_engine::fearless_simd::{Level, dispatch};

    #[test]
    fn samples_of_a_copy_are_those_of_the_picture() {
        let values = |channels: u32| (0..90 * 70 * channels).map(|i| ((i * 7919) % 1013) as f32 / 7.0);
        let [two, four] =
            [2, 4].map(|channels| Image::from_vec(90, 70, channels, values(channels).collect()).unwrap());
        let (two, four) = (View::new(&two, [90, 70]), View::new(&four, [90, 70]));
        let frames: Vec<_> = Frame::tiles(Rect { x0: 0, y0: 0, x1: 90, y1: 70 }, 9).collect();
        assert_eq!(frames.iter().map(|f| f.tile.area()).sum::<u64>(), 90 * 70);
        let (mut pairs, mut colors) = (TileCopy::<TWO>::default(), TileCopy::<FOUR>::default());
        for frame in &frames {
            pairs.load(&two, frame);
            colors.load(&four, frame);
            let Rect { x0, y0, x1, y1 } = frame.tile;
            dispatch!(Level::new(), simd => {
                // From the middle to beyond all sides, as far as lines may go.
                let share = f32x8::from_slice(simd, &[0.0, 0.13, 0.31, 0.5, 0.66, 0.75, 0.98, 1.0]);
                let x = share * (x1 - x0 + 16) as f32 + (x0 - 8) as f32;
                let y = -share * (y1 - y0 + 16) as f32 + (y1 + 8) as f32;
                let (place, bits) = (Place::new(frame, x, y), |v: f32x8<_>| v.to_array());
                assert_eq!(pairs.sample(simd, &place).map(bits), sample_linear2(simd, &two, x, y).map(bits));
                let want = sample_linear4(simd, &four, x, y).map(bits);
                for lane in 0..8 {
                    let [above, below] = colors.both_rows(simd, place.at[lane] as u16).map(bits);
                    let (right, lower) = (place.right[lane], place.below[lane]);
                    for c in 0..4 {
                        let top = (above[c + 4] - above[c]).mul_add(right, above[c]);
                        let bottom = (below[c + 4] - below[c]).mul_add(right, below[c]);
                        let got = (bottom - top).mul_add(lower, top);
                        assert!((got - want[c][lane]).abs() < 1e-3, "{got} for {} at lane {lane}", want[c][lane]);
                    }
                }
            });
        }
    }

    #[test]
    fn far_reaching_lines_get_smaller_tiles_or_none() {
        let all = Rect { x0: -3, y0: 5, x1: 300, y1: 205 };
        for reach in [0, 13, 95, 110, 123] {
            assert!(Frame::suits(reach));
            let frames: Vec<_> = Frame::tiles(all, reach).collect();
            assert_eq!(frames.iter().map(|f| f.tile.area()).sum::<u64>(), all.area());
            assert!(frames.iter().all(|f| f.window.width() <= 255 && f.window.area() <= 1 << 16));
        }
        assert!(!Frame::suits(124));
    }
}
