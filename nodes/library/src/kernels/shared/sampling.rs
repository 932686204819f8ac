//! Bilinear samples of images at eight positions at once. Twin of `shaders/shared/sampling.wgsl`.
//!
//! Positions are absolute with pixel centres at +0.5 and clamp to the edge.

use crate::kernels::simd::pixels::{load_pixel, load_pixels};
use isophote_engine::View;
use isophote_engine::apart;
use isophote_engine::fearless_simd::{Simd, f32x8, f64x4, i32x8, prelude::*};
use isophote_engine::math::{spread, transposed};

/// Bilinear sample of a four-channel image at eight positions (absolute, pixel centres at +0.5,
/// clamped to the edge), one vector per channel.
///
/// Each lane takes four 128-bit loads; hardware gathers would take sixteen times as many.
#[inline(always)]
pub fn sample_linear4<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 4] {
    apart!(simd, {
        let ([w, h], window, data) = (view.full(), view.window(), view.data());
        let (columns, fx) = floor_and_share(x, w);
        let (rows, fy) = floor_and_share(y, h);
        let inside = columns.simd_ge(0) & columns.simd_lt(w - 1) & rows.simd_ge(0) & rows.simd_lt(h - 1);
        let (fx, fy) = (spread(fx), spread(fy));
        let mut pixels = [f32x8::splat(simd, 0.0); 4];
        if inside.all_true() {
            // Away from the edges the right neighbour is the next pixel: a fourth of the places to look up.
            let stride = view.stride() as u32 as usize;
            let at = ((rows - window.y0) * stride as i32 + (columns - window.x0) * 4).to_array();
            for i in 0..4 {
                let (low, high) = (at[i] as u32 as usize, at[i + 4] as u32 as usize);
                let (low, high) = (&data[low..low + stride + 8], &data[high..high + stride + 8]);
                let a = load_pixels(simd, low, high);
                let b = load_pixels(simd, &low[4..], &high[4..]);
                let c = load_pixels(simd, &low[stride..], &high[stride..]);
                let d = load_pixels(simd, &low[stride + 4..], &high[stride + 4..]);
                pixels[i] = bilinear([a, b, c, d], fx[i], fy[i]);
            }
        } else {
            let taps = LinearTaps::new(simd, view, x, y);
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let mut corners = [f32x8::splat(simd, 0.0); 4];
                for (corner, at) in corners.iter_mut().zip(&taps.at) {
                    *corner = load_pixel(simd, data, at[i]).combine(load_pixel(simd, data, at[i + 4]));
                }
                *pixel = bilinear(corners, fx[i], fy[i]);
            }
        }
        transposed(pixels)
    })
}

/// The pixels of a four-channel image at eight places, clamped to the picture, one vector per channel.
#[inline(always)]
pub fn fetch4<S: Simd>(simd: S, view: &View<'_>, x: i32x8<S>, y: i32x8<S>) -> [f32x8<S>; 4] {
    apart!(simd, {
        let ([w, h], window) = (view.full(), view.window());
        let zero = i32x8::splat(simd, 0);
        let x = x.within(zero, i32x8::splat(simd, w - 1)) - window.x0;
        let y = y.within(zero, i32x8::splat(simd, h - 1)) - window.y0;
        let at = (y * view.stride() as i32 + x * 4).to_array();
        let data = view.data();
        let mut pixels = [f32x8::splat(simd, 0.0); 4];
        for (i, pixel) in pixels.iter_mut().enumerate() {
            *pixel = load_pixel(simd, data, at[i]).combine(load_pixel(simd, data, at[i + 4]));
        }
        transposed(pixels)
    })
}

#[inline(always)]
fn bilinear<S: Simd>([a, b, c, d]: [f32x8<S>; 4], fx: f32x8<S>, fy: f32x8<S>) -> f32x8<S> {
    let top = (b - a).mul_add(fx, a);
    let bottom = (d - c).mul_add(fx, c);
    (bottom - top).mul_add(fy, top)
}

/// The pixel before a position, on one axis of a picture of `full` pixels, and the next one's share.
#[inline(always)]
fn floor_and_share<S: Simd>(position: f32x8<S>, full: i32) -> (i32x8<S>, f32x8<S>) {
    // Far outside, the integer conversion would saturate or wrap: keep positions near the picture.
    let position = (position - 0.5).within(-2.0f32, full as f32 + 2.0);
    let floor = position.floor();
    (floor.to_int(), position - floor)
}

/// Bilinear sample of a one-channel image at eight positions; see [`sample_linear4`].
#[inline(always)]
pub fn sample_linear1<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    apart!(simd, {
        let taps = LinearTaps::new(simd, view, x, y);
        let data = view.data();
        let mut corners = [[0.0f32; 8]; 4];
        for (values, at) in corners.iter_mut().zip(&taps.at) {
            for (value, at) in values.iter_mut().zip(at) {
                *value = data[*at as usize];
            }
        }
        let [a, b, c, d] = corners;
        let (a, b) = (f32x8::simd_from(simd, a), f32x8::simd_from(simd, b));
        let (c, d) = (f32x8::simd_from(simd, c), f32x8::simd_from(simd, d));
        let (fx, fy) = (f32x8::simd_from(simd, taps.fx), f32x8::simd_from(simd, taps.fy));
        let top = (b - a).mul_add(fx, a);
        let bottom = (d - c).mul_add(fx, c);
        (bottom - top).mul_add(fy, top)
    })
}

/// Bilinear sample of a two-channel image at eight positions, one vector per channel; see
/// [`sample_linear4`].
///
/// The two pixels of a row are neighbours in memory too, so a lane takes two 128-bit loads.
#[inline(always)]
pub fn sample_linear2<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
    apart!(simd, {
        let ([w, h], window) = (view.full(), view.window());
        if w < 2 {
            return sample_column2(simd, view, x, y);
        }
        let rows = Axis { full: h, start: window.y0, stride: view.stride() as i32 };
        let (top, bottom, fy) = rows.taps(simd, y);
        // At the right edge the left pixel is the last but one, with all the weight on the last.
        let column = (x - 0.5).within(0.0f32, (w - 1) as f32);
        let left = column.floor().at_most((w - 2) as f32);
        let fx = column - left;
        let left = (left.to_int::<i32x8<S>>() - i32x8::splat(simd, window.x0)) * 2;
        let fy = spread(fy);
        let data = view.data();
        let mut pixels = [f32x8::splat(simd, 0.0); 4];
        let stride = view.stride() as u32 as usize;
        if (bottom - top).simd_eq(stride as i32).all_true() {
            let at = (top + left).to_array();
            for i in 0..4 {
                let (low, high) = (at[i] as u32 as usize, at[i + 4] as u32 as usize);
                let (low, high) = (&data[low..low + stride + 4], &data[high..high + stride + 4]);
                let (a, b) =
                    (load_pixels(simd, low, high), load_pixels(simd, &low[stride..], &high[stride..]));
                pixels[i] = (b - a).mul_add(fy[i], a);
            }
        } else {
            let (top, bottom) = ((top + left).to_array(), (bottom + left).to_array());
            for (i, pixel) in pixels.iter_mut().enumerate() {
                let a = load_pixel(simd, data, top[i]).combine(load_pixel(simd, data, top[i + 4]));
                let b = load_pixel(simd, data, bottom[i]).combine(load_pixel(simd, data, bottom[i + 4]));
                *pixel = (b - a).mul_add(fy[i], a);
            }
        }
        let [l0, l1, r0, r1] = transposed(pixels);
        [(r0 - l0).mul_add(fx, l0), (r1 - l1).mul_add(fx, l1)]
    })
}

/// [`sample_linear2`] of a picture one pixel wide, whose columns have no neighbour.
#[inline(always)]
fn sample_column2<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
    let taps = LinearTaps::new(simd, view, x, y);
    let fy = f32x8::simd_from(simd, taps.fy);
    let (a, b) = (load_pairs(simd, view.data(), taps.at[0]), load_pairs(simd, view.data(), taps.at[2]));
    let (a0, a1) = a[0].deinterleave(a[1]);
    let (b0, b1) = b[0].deinterleave(b[1]);
    [(b0 - a0).mul_add(fy, a0), (b1 - a1).mul_add(fy, a1)]
}

/// Eight pairs of neighbouring values, from where `at` says, four pairs to a vector: one 64-bit load
/// each.
#[inline(always)]
pub fn load_pairs<S: Simd>(simd: S, data: &[f32], at: [i32; 8]) -> [f32x8<S>; 2] {
    let mut pairs = [0.0f64; 8];
    for (pair, at) in pairs.iter_mut().zip(at) {
        let values = &data[at as usize..at as usize + 2];
        *pair = f64::from_bits(u64::from(values[0].to_bits()) | u64::from(values[1].to_bits()) << 32);
    }
    let [a, b, c, d, e, f, g, h] = pairs;
    [f64x4::simd_from(simd, [a, b, c, d]).bitcast(), f64x4::simd_from(simd, [e, f, g, h]).bitcast()]
}

/// Offsets and weights of the four pixels around eight positions.
struct LinearTaps {
    at: [[i32; 8]; 4],
    fx: [f32; 8],
    fy: [f32; 8],
}

/// Extent of one axis of an image, for positions on it.
struct Axis {
    full: i32,
    start: i32,
    stride: i32,
}

impl Axis {
    /// Offsets of the pixels on both sides of a position, and the second one's share.
    // A function, since the compiler does not inline closures dependably, and a call from a function
    // for wide vectors into one without is what SIMD code can least afford.
    #[inline(always)]
    fn taps<S: Simd>(&self, simd: S, position: f32x8<S>) -> (i32x8<S>, i32x8<S>, f32x8<S>) {
        let last = i32x8::splat(simd, self.full - 1);
        let (zero, start) = (i32x8::splat(simd, 0), i32x8::splat(simd, self.start));
        let stride = i32x8::splat(simd, self.stride);
        let (i, share) = floor_and_share(position, self.full);
        let first = (i.within(zero, last) - start) * stride;
        let second = ((i + 1).within(zero, last) - start) * stride;
        (first, second, share)
    }
}

impl LinearTaps {
    #[inline(always)]
    fn new<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> Self {
        let ([w, h], window) = (view.full(), view.window());
        let columns = Axis { full: w, start: window.x0, stride: view.channels() as i32 };
        let rows = Axis { full: h, start: window.y0, stride: view.stride() as i32 };
        let (left, right, fx) = columns.taps(simd, x);
        let (top, bottom, fy) = rows.taps(simd, y);
        let at = [
            (top + left).to_array(),
            (top + right).to_array(),
            (bottom + left).to_array(),
            (bottom + right).to_array(),
        ];
        Self { at, fx: fx.to_array(), fy: fy.to_array() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::Image;
    use isophote_engine::fearless_simd::{Level, dispatch};

    #[test]
    fn sampling_interpolates_and_clamps() {
        let image = Image::from_vec(2, 2, 1, vec![0.0, 1.0, 2.0, 3.0]).unwrap();
        let view = View::new(&image, [2, 2]);
        let got = dispatch!(Level::new(), simd => {
            let x = f32x8::from_slice(simd, &[0.5, 1.0, 1.5, 1.0, -9.0, 99.0, 1.0, 0.75]);
            let y = f32x8::from_slice(simd, &[0.5, 0.5, 1.5, 1.0, -9.0, 1.0, 1e9, 0.5]);
            sample_linear1(simd, &view, x, y).to_array()
        });
        assert_eq!(got, [0.0, 0.5, 3.0, 1.5, 0.0, 2.0, 2.5, 0.25]);
        let pairs = Image::from_vec(2, 2, 2, vec![0.0, 9.0, 1.0, 8.0, 2.0, 7.0, 3.0, 6.0]).unwrap();
        let view = View::new(&pairs, [2, 2]);
        let [first, second] = dispatch!(Level::new(), simd => {
            let x = f32x8::from_slice(simd, &[0.5, 1.0, 1.5, 1.0, -9.0, 99.0, 1.0, 0.75]);
            let y = f32x8::from_slice(simd, &[0.5, 0.5, 1.5, 1.0, -9.0, 1.0, 1e9, 0.5]);
            sample_linear2(simd, &view, x, y).map(|v| v.to_array())
        });
        assert_eq!(first, got);
        assert_eq!(second, got.map(|v| 9.0 - v));
    }
}
