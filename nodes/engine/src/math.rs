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
                let c = |v: f32| $float::splat(simd, v);
                let x = self.min(c(88.3)).max(c(-88.0));
                let n = (x * c(std::f32::consts::LOG2_E)).round_ties_even();
                let r = n.mul_add(c(-LN2_HIGH), x);
                let r = n.mul_add(c(-LN2_LOW), r);
                let p = c(1.987_569_1e-4);
                let p = p.mul_add(r, c(1.398_2e-3));
                let p = p.mul_add(r, c(8.333_452e-3));
                let p = p.mul_add(r, c(4.166_579_6e-2));
                let p = p.mul_add(r, c(1.666_666_5e-1));
                let p = p.mul_add(r, c(0.5));
                let p = p.mul_add(r * r, r + c(1.0));
                let n: $int<S> = n.to_int();
                let scale: $float<S> = ((n + $int::splat(simd, 127)) << 23).bitcast();
                let result = p * scale;
                self.simd_lt(c(-87.3)).select(c(0.0), result)
            }

            #[inline(always)]
            fn exp2(self) -> Self {
                let simd = self.simd;
                let c = |v: f32| $float::splat(simd, v);
                let x = self.min(c(127.0)).max(c(-126.0));
                let n = x.round_ties_even();
                let r = x - n;
                let p = c(1.535_336_2e-4);
                let p = p.mul_add(r, c(1.339_887_4e-3));
                let p = p.mul_add(r, c(9.618_437e-3));
                let p = p.mul_add(r, c(5.550_332_5e-2));
                let p = p.mul_add(r, c(2.402_264_8e-1));
                let p = p.mul_add(r, c(6.931_472e-1));
                let p = p.mul_add(r, c(1.0));
                let n: $int<S> = n.to_int();
                let scale: $float<S> = ((n + $int::splat(simd, 127)) << 23).bitcast();
                p * scale
            }

            #[inline(always)]
            fn ln(self) -> Self {
                let simd = self.simd;
                let c = |v: f32| $float::splat(simd, v);
                let bits: $int<S> = self.bitcast();
                let exponent = (bits >> 23) - $int::splat(simd, 126);
                let mantissa = (bits & $int::splat(simd, 0x007f_ffff)) | $int::splat(simd, 0x3f00_0000);
                let m: $float<S> = mantissa.bitcast();
                let e: $float<S> = exponent.to_float();
                // m lies in [0.5, 1); below sqrt(1/2) it is doubled so that the series stays short.
                let small = m.simd_lt(c(std::f32::consts::FRAC_1_SQRT_2));
                let e = small.select(e - c(1.0), e);
                let x = small.select(m + m, m) - c(1.0);
                let z = x * x;
                let p = c(7.037_683_6e-2);
                let p = p.mul_add(x, c(-1.151_461e-1));
                let p = p.mul_add(x, c(1.167_699_9e-1));
                let p = p.mul_add(x, c(-1.242_014_1e-1));
                let p = p.mul_add(x, c(1.424_932_3e-1));
                let p = p.mul_add(x, c(-1.666_805_7e-1));
                let p = p.mul_add(x, c(2.000_071_5e-1));
                let p = p.mul_add(x, c(-2.499_999_4e-1));
                let p = p.mul_add(x, c(3.333_333_1e-1));
                let y = p * x * z;
                let y = e.mul_add(c(LN2_LOW), y);
                let y = z.mul_add(c(-0.5), y);
                e.mul_add(c(LN2_HIGH), x + y)
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
                let c = |v: f32| $float::splat(simd, v);
                let a = self.abs();
                let z = self * self;
                let p = c(-5.704_988_7e-3);
                let p = p.mul_add(z, c(2.063_908_9e-2));
                let p = p.mul_add(z, c(-5.373_971_5e-2));
                let p = p.mul_add(z, c(1.333_144_2e-1));
                let p = p.mul_add(z, c(-3.333_328_2e-1));
                let near = (p * z).mul_add(self, self);
                let e = (a + a).min(c(40.0)).exp();
                let far = (c(1.0) - c(2.0) / (e + c(1.0))).copysign(self);
                a.simd_lt(c(0.625)).select(near, far)
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
    for (part, values) in [p0, p1, p2, p3].iter().zip(rgba.chunks_exact_mut(V::LEN)) {
        part.store_slice(values);
    }
}

/// One vector per channel from eight pixels.
#[inline(always)]
pub fn channels<S: Simd>(pixels: [f32x4<S>; 8]) -> [f32x8<S>; 4] {
    // Joined in registers: a wide load of what narrow stores have just written would stall.
    let pair = |i: usize| pixels[2 * i].combine(pixels[2 * i + 1]);
    let (rb0, ga0) = pair(0).deinterleave(pair(1));
    let (rb1, ga1) = pair(2).deinterleave(pair(3));
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
    let taps = LinearTaps::new(simd, view, x, y);
    let data = view.data();
    let load = |at: i32| f32x4::from_slice(simd, &data[at as usize..at as usize + 4]);
    let (fx, fy) = (taps.fx.to_array(), taps.fy.to_array());
    let at = taps.at.map(|a| a.to_array());
    channels(std::array::from_fn(|lane| {
        let (a, b) = (load(at[0][lane]), load(at[1][lane]));
        let (c, d) = (load(at[2][lane]), load(at[3][lane]));
        let x = f32x4::splat(simd, fx[lane]);
        let top = (b - a).mul_add(x, a);
        let bottom = (d - c).mul_add(x, c);
        (bottom - top).mul_add(f32x4::splat(simd, fy[lane]), top)
    }))
}

/// Bilinear sample of a one-channel image at eight positions; see [`sample_linear4`].
#[inline(always)]
pub fn sample_linear1<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    let taps = LinearTaps::new(simd, view, x, y);
    let data = view.data();
    let load = |corner: usize| f32x8::from_fn(simd, |lane| data[taps.at[corner][lane] as usize]);
    let (a, b, c, d) = (load(0), load(1), load(2), load(3));
    let top = (b - a).mul_add(taps.fx, a);
    let bottom = (d - c).mul_add(taps.fx, c);
    (bottom - top).mul_add(taps.fy, top)
}

/// Bilinear sample of a two-channel image at eight positions, one vector per channel; see
/// [`sample_linear4`].
#[inline(always)]
pub fn sample_linear2<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
    let taps = LinearTaps::new(simd, view, x, y);
    let [a, b, c, d] = taps.at.map(|at| load_pairs(simd, view.data(), at));
    let (fx, fy) = (taps.fx.interleave(taps.fx), taps.fy.interleave(taps.fy));
    let mix = |i: usize, fx: f32x8<S>, fy: f32x8<S>| {
        let top = (b[i] - a[i]).mul_add(fx, a[i]);
        let bottom = (d[i] - c[i]).mul_add(fx, c[i]);
        (bottom - top).mul_add(fy, top)
    };
    mix(0, fx.0, fy.0).deinterleave(mix(1, fx.1, fy.1)).into()
}

/// Eight pairs of neighbouring values, from where `at` says, four pairs to a vector: one 64-bit load
/// each.
#[inline(always)]
pub fn load_pairs<S: Simd>(simd: S, data: &[f32], at: i32x8<S>) -> [f32x8<S>; 2] {
    let pair = |lane: usize| {
        let start = at[lane] as usize;
        let pair = &data[start..start + 2];
        f64::from_bits(u64::from(pair[0].to_bits()) | u64::from(pair[1].to_bits()) << 32)
    };
    [
        f64x4::from_fn(simd, |lane| pair(lane)).bitcast(),
        f64x4::from_fn(simd, |lane| pair(lane + 4)).bitcast(),
    ]
}

/// Offsets and weights of the four pixels around eight positions.
struct LinearTaps<S: Simd> {
    at: [i32x8<S>; 4],
    fx: f32x8<S>,
    fy: f32x8<S>,
}

impl<S: Simd> LinearTaps<S> {
    #[inline(always)]
    fn new(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> Self {
        let c = |v: i32| i32x8::splat(simd, v);
        let half = f32x8::splat(simd, 0.5);
        let [w, h] = view.full();
        // Far outside, the integer conversion would saturate or wrap: keep positions near the picture.
        let limit = |v: f32x8<S>, n: i32| v.max(-2.0f32).min(n as f32 + 2.0);
        let (x, y) = (limit(x - half, w), limit(y - half, h));
        let (x0, y0) = (x.floor(), y.floor());
        let (ix, iy): (i32x8<S>, i32x8<S>) = (x0.to_int(), y0.to_int());
        let window = view.window();
        let columns = |v: i32x8<S>| (v.max(c(0)).min(c(w - 1)) - c(window.x0)) * c(view.channels() as i32);
        let rows = |v: i32x8<S>| (v.max(c(0)).min(c(h - 1)) - c(window.y0)) * c(view.stride() as i32);
        let (left, right) = (columns(ix), columns(ix + c(1)));
        let (top, bottom) = (rows(iy), rows(iy + c(1)));
        Self { at: [top + left, top + right, bottom + left, bottom + right], fx: x - x0, fy: y - y0 }
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
