//! Elementary functions and sampling on SIMD vectors, for the CPU twins.
//!
//! Every function is plain arithmetic on lanes: a lane's result never depends on its neighbours,
//! which is what makes tiles equal full frames. Polynomials are those of the Cephes library,
//! relative error below 2e-7 over the stated ranges.

use crate::image::View;
use fearless_simd::{Simd, f32x4, f32x8, f32x16, f64x4, i32x4, i32x8, i32x16, prelude::*};

const LN2_HIGH: f32 = 0.693_359_4;
const LN2_LOW: f32 = -2.121_944_4e-4;

/// exp, exp2, log, pow and tanh on lanes.
pub trait Elementary: Sized {
    /// e^x; 0 below -87.3 and saturated above 88.3.
    fn exp(self) -> Self;
    /// 2^x; saturated below -126 and above 127.
    fn exp2(self) -> Self;
    /// Natural logarithm of a positive, normal number.
    fn ln(self) -> Self;
    /// x^y for positive x; 0 for x <= 0.
    fn powf(self, y: f32) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
}

macro_rules! elementary {
    ($float:ident, $int:ident) => {
        impl<S: Simd> Elementary for $float<S> {
            #[inline(always)]
            fn exp(self) -> Self {
                let simd = self.simd;
                let x = self.min($float::splat(simd, 88.3)).max($float::splat(simd, -88.0));
                let n = (x * $float::splat(simd, std::f32::consts::LOG2_E)).round_ties_even();
                let r = n.mul_add($float::splat(simd, -LN2_HIGH), x);
                let r = n.mul_add($float::splat(simd, -LN2_LOW), r);
                let p = $float::splat(simd, 1.987_569_1e-4);
                let p = p.mul_add(r, $float::splat(simd, 1.398_2e-3));
                let p = p.mul_add(r, $float::splat(simd, 8.333_452e-3));
                let p = p.mul_add(r, $float::splat(simd, 4.166_579_6e-2));
                let p = p.mul_add(r, $float::splat(simd, 1.666_666_5e-1));
                let p = p.mul_add(r, $float::splat(simd, 0.5));
                let p = p.mul_add(r * r, r + $float::splat(simd, 1.0));
                let n: $int<S> = n.to_int();
                let scale: $float<S> = ((n + $int::splat(simd, 127)) << 23).bitcast();
                let result = p * scale;
                self.simd_lt($float::splat(simd, -87.3)).select($float::splat(simd, 0.0), result)
            }

            #[inline(always)]
            fn exp2(self) -> Self {
                let simd = self.simd;
                let x = self.min($float::splat(simd, 127.0)).max($float::splat(simd, -126.0));
                let n = x.round_ties_even();
                let r = x - n;
                let p = $float::splat(simd, 1.535_336_2e-4);
                let p = p.mul_add(r, $float::splat(simd, 1.339_887_4e-3));
                let p = p.mul_add(r, $float::splat(simd, 9.618_437e-3));
                let p = p.mul_add(r, $float::splat(simd, 5.550_332_5e-2));
                let p = p.mul_add(r, $float::splat(simd, 2.402_264_8e-1));
                let p = p.mul_add(r, $float::splat(simd, 6.931_472e-1));
                let p = p.mul_add(r, $float::splat(simd, 1.0));
                let n: $int<S> = n.to_int();
                let scale: $float<S> = ((n + $int::splat(simd, 127)) << 23).bitcast();
                p * scale
            }

            #[inline(always)]
            fn ln(self) -> Self {
                let simd = self.simd;
                let bits: $int<S> = self.bitcast();
                let exponent = (bits >> 23) - $int::splat(simd, 126);
                let mantissa = (bits & $int::splat(simd, 0x007f_ffff)) | $int::splat(simd, 0x3f00_0000);
                let m: $float<S> = mantissa.bitcast();
                let e: $float<S> = exponent.to_float();
                // m lies in [0.5, 1); below sqrt(1/2) it is doubled so that the series stays short.
                let small = m.simd_lt($float::splat(simd, std::f32::consts::FRAC_1_SQRT_2));
                let e = small.select(e - $float::splat(simd, 1.0), e);
                let x = small.select(m + m, m) - $float::splat(simd, 1.0);
                let z = x * x;
                let p = $float::splat(simd, 7.037_683_6e-2);
                let p = p.mul_add(x, $float::splat(simd, -1.151_461e-1));
                let p = p.mul_add(x, $float::splat(simd, 1.167_699_9e-1));
                let p = p.mul_add(x, $float::splat(simd, -1.242_014_1e-1));
                let p = p.mul_add(x, $float::splat(simd, 1.424_932_3e-1));
                let p = p.mul_add(x, $float::splat(simd, -1.666_805_7e-1));
                let p = p.mul_add(x, $float::splat(simd, 2.000_071_5e-1));
                let p = p.mul_add(x, $float::splat(simd, -2.499_999_4e-1));
                let p = p.mul_add(x, $float::splat(simd, 3.333_333_1e-1));
                let y = p * x * z;
                let y = e.mul_add($float::splat(simd, LN2_LOW), y);
                let y = z.mul_add($float::splat(simd, -0.5), y);
                e.mul_add($float::splat(simd, LN2_HIGH), x + y)
            }

            #[inline(always)]
            fn powf(self, y: f32) -> Self {
                let zero = $float::splat(self.simd, 0.0);
                let tiny = $float::splat(self.simd, f32::MIN_POSITIVE);
                let power = (self.max(tiny).ln() * $float::splat(self.simd, y)).exp();
                self.simd_gt(zero).select(power, zero)
            }

            #[inline(always)]
            fn tanh(self) -> Self {
                let simd = self.simd;
                let a = self.abs();
                let z = self * self;
                let p = $float::splat(simd, -5.704_988_7e-3);
                let p = p.mul_add(z, $float::splat(simd, 2.063_908_9e-2));
                let p = p.mul_add(z, $float::splat(simd, -5.373_971_5e-2));
                let p = p.mul_add(z, $float::splat(simd, 1.333_144_2e-1));
                let p = p.mul_add(z, $float::splat(simd, -3.333_328_2e-1));
                let near = (p * z).mul_add(self, self);
                let e = (a + a).min($float::splat(simd, 40.0)).exp();
                let far = ($float::splat(simd, 1.0)
                    - $float::splat(simd, 2.0) / (e + $float::splat(simd, 1.0)))
                .copysign(self);
                a.simd_lt($float::splat(simd, 0.625)).select(near, far)
            }
        }
    };
}

elementary!(f32x4, i32x4);
elementary!(f32x8, i32x8);
elementary!(f32x16, i32x16);

/// Reads `V::LEN` interleaved RGBA pixels into one vector per channel.
#[inline(always)]
pub fn load4<S: Simd, V: SimdBase<S, Element = f32>>(simd: S, rgba: &[f32]) -> [V; 4] {
    let part = |i: usize| V::from_slice(simd, &rgba[i * V::LEN..(i + 1) * V::LEN]);
    let (rb0, ga0) = part(0).deinterleave(part(1));
    let (rb1, ga1) = part(2).deinterleave(part(3));
    let (r, b) = rb0.deinterleave(rb1);
    let (g, a) = ga0.deinterleave(ga1);
    [r, g, b, a]
}

/// Writes one vector per channel as `V::LEN` interleaved RGBA pixels; the reverse of [`load4`].
#[inline(always)]
pub fn store4<S: Simd, V: SimdBase<S, Element = f32>>([r, g, b, a]: [V; 4], rgba: &mut [f32]) {
    let (rb0, rb1) = r.interleave(b);
    let (ga0, ga1) = g.interleave(a);
    let (p0, p1) = rb0.interleave(ga0);
    let (p2, p3) = rb1.interleave(ga1);
    // One by one: the compiler keeps an iterator over the parts out of the code for wide vectors.
    let n = V::LEN;
    p0.store_slice(&mut rgba[..n]);
    p1.store_slice(&mut rgba[n..2 * n]);
    p2.store_slice(&mut rgba[2 * n..3 * n]);
    p3.store_slice(&mut rgba[3 * n..4 * n]);
}

/// One vector per channel from eight pixels.
#[inline(always)]
pub fn channels<S: Simd>(p: [f32x4<S>; 8]) -> [f32x8<S>; 4] {
    // Joined in registers: a wide load of what narrow stores have just written would stall.
    let (rb0, ga0) = p[0].combine(p[1]).deinterleave(p[2].combine(p[3]));
    let (rb1, ga1) = p[4].combine(p[5]).deinterleave(p[6].combine(p[7]));
    let (r, b) = rb0.deinterleave(rb1);
    let (g, a) = ga0.deinterleave(ga1);
    [r, g, b, a]
}

/// Bilinear sample of a four-channel image at eight positions (absolute, pixel centres at +0.5,
/// clamped to the edge), one vector per channel.
///
/// Each lane takes four 128-bit loads; hardware gathers would take sixteen times as many.
#[inline(always)]
pub fn sample_linear4<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 4] {
    let ([w, h], held, data) = (view.full(), view.window(), view.data());
    let (columns, fx) = floor_and_share(x, w);
    let (rows, fy) = floor_and_share(y, h);
    let inside = columns.simd_ge(0) & columns.simd_lt(w - 1) & rows.simd_ge(0) & rows.simd_lt(h - 1);
    let mut pixels = [f32x4::splat(simd, 0.0); 8];
    let (fx, fy) = (fx.to_array(), fy.to_array());
    if inside.all_true() {
        // Away from the edges the right neighbour is the next pixel: half as many places to look up.
        let stride = view.stride() as u32 as usize;
        let at = ((rows - held.y0) * stride as i32 + (columns - held.x0) * 4).to_array();
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            let at = at[lane] as u32 as usize;
            let (top, bottom) = (&data[at..at + 8], &data[at + stride..at + stride + 8]);
            let (a, b) = (f32x4::from_slice(simd, &top[..4]), f32x4::from_slice(simd, &top[4..]));
            let (c, d) = (f32x4::from_slice(simd, &bottom[..4]), f32x4::from_slice(simd, &bottom[4..]));
            *pixel = bilinear(a, b, c, d, fx[lane], fy[lane]);
        }
    } else {
        let taps = LinearTaps::new(simd, view, x, y);
        for (lane, pixel) in pixels.iter_mut().enumerate() {
            let a = load_pixel(simd, data, taps.at[0][lane]);
            let b = load_pixel(simd, data, taps.at[1][lane]);
            let c = load_pixel(simd, data, taps.at[2][lane]);
            let d = load_pixel(simd, data, taps.at[3][lane]);
            *pixel = bilinear(a, b, c, d, fx[lane], fy[lane]);
        }
    }
    channels(pixels)
}

#[inline(always)]
fn bilinear<S: Simd>(a: f32x4<S>, b: f32x4<S>, c: f32x4<S>, d: f32x4<S>, fx: f32, fy: f32) -> f32x4<S> {
    let x = f32x4::splat(a.simd, fx);
    let top = (b - a).mul_add(x, a);
    let bottom = (d - c).mul_add(x, c);
    (bottom - top).mul_add(f32x4::splat(a.simd, fy), top)
}

/// The pixel before a position, on one axis of a picture of `full` pixels, and the next one's share.
#[inline(always)]
fn floor_and_share<S: Simd>(position: f32x8<S>, full: i32) -> (i32x8<S>, f32x8<S>) {
    // Far outside, the integer conversion would saturate or wrap: keep positions near the picture.
    let position = (position - 0.5).max(-2.0f32).min(full as f32 + 2.0);
    let floor = position.floor();
    (floor.to_int(), position - floor)
}

/// The four values from offset `at` on.
#[inline(always)]
pub fn load_pixel<S: Simd>(simd: S, data: &[f32], at: i32) -> f32x4<S> {
    // Through u32 one comparison is enough to check the range.
    let at = at as u32 as usize;
    f32x4::from_slice(simd, &data[at..at + 4])
}

/// Bilinear sample of a one-channel image at eight positions; see [`sample_linear4`].
#[inline(always)]
pub fn sample_linear1<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
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
}

/// Bilinear sample of a two-channel image at eight positions, one vector per channel; see
/// [`sample_linear4`].
///
/// The two pixels of a row are neighbours in memory too, so a lane takes two 128-bit loads.
#[inline(always)]
pub fn sample_linear2<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
    let ([w, h], window) = (view.full(), view.window());
    if w < 2 {
        return sample_column2(simd, view, x, y);
    }
    let rows = Axis { full: h, start: window.y0, stride: view.stride() as i32 };
    let (top, bottom, fy) = rows.taps(simd, y);
    // At the right edge the left pixel is the last but one, with all the weight on the last.
    let column = (x - 0.5).max(0.0f32).min((w - 1) as f32);
    let left = column.floor().min((w - 2) as f32);
    let fx = column - left;
    let left = (left.to_int::<i32x8<S>>() - i32x8::splat(simd, window.x0)) * 2;
    let (top, bottom, fy) = ((top + left).to_array(), (bottom + left).to_array(), fy.to_array());
    let data = view.data();
    let mut pixels = [f32x4::splat(simd, 0.0); 8];
    for (lane, pixel) in pixels.iter_mut().enumerate() {
        let a = load_pixel(simd, data, top[lane]);
        let b = load_pixel(simd, data, bottom[lane]);
        *pixel = (b - a).mul_add(f32x4::splat(simd, fy[lane]), a);
    }
    let [l0, l1, r0, r1] = channels(pixels);
    [(r0 - l0).mul_add(fx, l0), (r1 - l1).mul_add(fx, l1)]
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

/// What one axis of an image says about positions on it.
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
        let first = (i.max(zero).min(last) - start) * stride;
        let second = ((i + 1).max(zero).min(last) - start) * stride;
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
    use crate::image::Image;
    use fearless_simd::{Level, dispatch};

    fn apply(
        f: impl Fn(f32) -> f64,
        simd: impl Fn(&[f32; 16]) -> [f32; 16],
        low: f32,
        high: f32,
        bound: f64,
    ) {
        for i in 0..2000 {
            let x = std::array::from_fn(|k| low + (high - low) * (i * 16 + k) as f32 / 32000.0);
            for (x, got) in x.iter().zip(simd(&x)) {
                let want = f(*x);
                let error = (f64::from(got) - want).abs() / want.abs().max(1e-30);
                assert!(error < bound, "at {x}: {got} for {want}, relative error {error:e}");
            }
        }
    }

    fn on_lanes(
        x: &[f32; 16],
        f: impl Fn(f32x16<fearless_simd::Avx2>) -> f32x16<fearless_simd::Avx2>,
    ) -> Option<[f32; 16]> {
        let simd = Level::new().as_avx2()?;
        Some(simd.vectorize(
            #[inline(always)]
            || f(f32x16::from_slice(simd, x)).to_array(),
        ))
    }

    #[test]
    fn elementary_functions_meet_their_bounds() {
        if Level::new().as_avx2().is_none() {
            return;
        }
        let run = |f: fn(f32x16<fearless_simd::Avx2>) -> f32x16<fearless_simd::Avx2>| {
            move |x: &[f32; 16]| on_lanes(x, f).unwrap()
        };
        apply(|x| f64::from(x).exp(), run(|v| v.exp()), -80.0, 80.0, 3e-7);
        apply(|x| f64::from(x).exp2(), run(|v| v.exp2()), -120.0, 120.0, 3e-7);
        apply(|x| f64::from(x).tanh(), run(|v| v.tanh()), -9.0, -1e-4, 3e-7);
        apply(|x| f64::from(x).powf(1.0 / 2.4), run(|v| v.powf(1.0 / 2.4)), 1e-5, 9e3, 1e-6);
        apply(|x| f64::from(x).ln(), run(|v| v.ln()), 2.0, 1e6, 3e-7);
    }

    #[test]
    fn channels_separate_and_join() {
        let rgba: Vec<f32> = (0..64).map(|v| v as f32).collect();
        let mut back = vec![0.0; 64];
        dispatch!(Level::new(), simd => {
            let channels: [f32x16<_>; 4] = load4(simd, &rgba);
            assert_eq!(channels[1].to_array()[2], 9.0);
            store4(channels, &mut back);
        });
        assert_eq!(back, rgba);
    }

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
