//! Elementary functions and rearrangements on SIMD vectors, for the CPU twins.
//!
//! Every function is plain arithmetic on lanes: a lane's result never depends on its neighbours,
//! which is what makes tiles equal full frames. Polynomials are those of the Cephes library or of
//! least greatest error, their relative error below 3e-7 over the stated ranges.

use crate::apart;
use crate::bounds::Bounds;
#[cfg(target_arch = "x86_64")]
use fearless_simd::Avx2;
use fearless_simd::{Simd, f32x4, f32x8, f32x16, i32x4, i32x8, i32x16, prelude::*};

const LN2_HIGH: f32 = 0.693_359_4;
const LN2_LOW: f32 = -2.121_944_4e-4;
/// 1.5 2^23: the sum with a small number is rounded to a whole one, which stays in its lowest bits.
const WHOLE: f32 = 12_582_912.0;

/// sqrt(a^2 + b^2) of numbers whose squares are finite. The function of the standard library is the C library's, which
/// would have to be of 2022 or newer.
pub fn hypot(a: f32, b: f32) -> f32 {
    (a * a + b * b).sqrt()
}

/// exp, exp2, log, pow and tanh on lanes.
pub trait Elementary: Sized {
    /// e^x; 0 below -87.3 and saturated above 88.3.
    fn exp(self) -> Self;
    /// 2^x; saturated below -126 and above 127.
    fn exp2(self) -> Self;
    /// 2^x for x <= 127, as weights that fall off have it; saturated below -126.
    fn exp2_falling(self) -> Self;
    /// Natural logarithm of a positive, normal number.
    fn ln(self) -> Self;
    /// x^y for positive x; 0 for x <= 0.
    fn powf(self, y: f32) -> Self;
    /// 1 / sqrt(x) of a positive, normal number; relative error below 1e-6, in half the time of the exact root.
    fn inverse_sqrt(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
}

macro_rules! elementary {
    ($float:ident, $int:ident) => {
        impl<S: Simd> Elementary for $float<S> {
            #[inline(always)]
            fn exp(self) -> Self {
                let simd = self.simd;
                apart!(simd, {
                    let x = self.at_most($float::splat(simd, 88.3)).at_least($float::splat(simd, -88.0));
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
                })
            }

            #[inline(always)]
            fn exp2(self) -> Self {
                self.at_most($float::splat(self.simd, 127.0)).exp2_falling()
            }

            #[inline(always)]
            fn exp2_falling(self) -> Self {
                let simd = self.simd;
                apart!(simd, {
                    let x = self.at_least($float::splat(simd, -126.0));
                    let shift = $float::splat(simd, WHOLE);
                    let shifted = x + shift;
                    let r = x - (shifted - shift);
                    // In pairs, so that no more than four operations wait for each other.
                    let rr = r * r;
                    let a = r.mul_add($float::splat(simd, 6.931_469_8e-1), $float::splat(simd, 1.0));
                    let b =
                        r.mul_add($float::splat(simd, 5.550_733_7e-2), $float::splat(simd, 2.402_224_2e-1));
                    let c = r.mul_add($float::splat(simd, 1.326_472_7e-3), $float::splat(simd, 9.671_513e-3));
                    let p = rr.mul_add(c, b).mul_add(rr, a);
                    // The whole part goes to the exponent: p is at least 0.7, so that it does not run over.
                    let n = shifted.bitcast::<$int<S>>() << 23;
                    (p.bitcast::<$int<S>>() + n).bitcast()
                })
            }

            #[inline(always)]
            fn ln(self) -> Self {
                let simd = self.simd;
                apart!(simd, {
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
                })
            }

            #[inline(always)]
            fn powf(self, y: f32) -> Self {
                let simd = self.simd;
                apart!(simd, {
                    let zero = $float::splat(simd, 0.0);
                    let bits: $int<S> = self.at_least($float::splat(simd, f32::MIN_POSITIVE)).bitcast();
                    // The mantissa lies between the roots of 1/2 and 2, so that log2 has no sign to lose.
                    let exponent = (bits - $int::splat(simd, 0x3f35_04f3)) >> 23;
                    let mantissa: $float<S> = (bits - (exponent << 23)).bitcast();
                    let x = mantissa - $float::splat(simd, 1.0);
                    // In pairs, as above.
                    let xx = x * x;
                    let p0 =
                        x.mul_add($float::splat(simd, -7.213_571_7e-1), $float::splat(simd, 1.442_694_8));
                    let p1 =
                        x.mul_add($float::splat(simd, -3.600_871_9e-1), $float::splat(simd, 4.809_394_5e-1));
                    let p2 =
                        x.mul_add($float::splat(simd, -2.500_693e-1), $float::splat(simd, 2.867_075_5e-1));
                    let p3 =
                        x.mul_add($float::splat(simd, -1.457_429_53e-1), $float::splat(simd, 2.368_897_8e-1));
                    let (low, high) = (xx.mul_add(p1, p0), xx.mul_add(p3, p2));
                    let p = (xx * xx).mul_add(high, low);
                    let log2 = p.mul_add(x, exponent.to_float::<$float<S>>());
                    let power = (log2 * $float::splat(simd, y)).exp2();
                    self.simd_gt(zero).select(power, zero)
                })
            }

            #[inline(always)]
            fn inverse_sqrt(self) -> Self {
                let simd = self.simd;
                // Half the exponent, negated, is a first guess; J. Kadlec's step makes the best of it
                // (error 6.5e-4), one of Newton's squares the error. Unlike the instructions for this, all
                // processors agree on it.
                let bits: $int<S> = self.bitcast();
                let y: $float<S> = ($int::splat(simd, 0x5f1f_fff9) - (bits >> 1)).bitcast();
                let xy = self * y;
                let y = (y * 0.703_952_25) * (-xy).mul_add(y, $float::splat(simd, 2.389_244_6));
                let xy = self * y;
                (y * 0.5) * (-xy).mul_add(y, $float::splat(simd, 3.0))
            }

            #[inline(always)]
            fn tanh(self) -> Self {
                let simd = self.simd;
                apart!(simd, {
                    let a = self.abs();
                    let z = self * self;
                    let p = $float::splat(simd, -5.704_988_7e-3);
                    let p = p.mul_add(z, $float::splat(simd, 2.063_908_9e-2));
                    let p = p.mul_add(z, $float::splat(simd, -5.373_971_5e-2));
                    let p = p.mul_add(z, $float::splat(simd, 1.333_144_2e-1));
                    let p = p.mul_add(z, $float::splat(simd, -3.333_328_2e-1));
                    let near = (p * z).mul_add(self, self);
                    let e = (a + a).at_most($float::splat(simd, 40.0)).exp();
                    let far = ($float::splat(simd, 1.0)
                        - $float::splat(simd, 2.0) / (e + $float::splat(simd, 1.0)))
                    .copysign(self);
                    a.simd_lt($float::splat(simd, 0.625)).select(near, far)
                })
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
    transposed([p[0].combine(p[4]), p[1].combine(p[5]), p[2].combine(p[6]), p[3].combine(p[7])])
}

/// One vector per channel from eight pixels, of which vector i holds the pixels i and i + 4.
///
/// Nothing crosses the halves of a vector, which is what wide shuffles are slow at.
#[inline(always)]
pub fn transposed<S: Simd>(p: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let (rg0, ba0) = zip_halves(p[0], p[2]);
    let (rg1, ba1) = zip_halves(p[1], p[3]);
    let (r, g) = zip_halves(rg0, rg1);
    let (b, a) = zip_halves(ba0, ba1);
    [r, g, b, a]
}

/// Interleaves the lower two lanes, and the upper two lanes, of each half.
#[inline(always)]
fn zip_halves<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = a.simd.level().as_avx2() {
        // The compiler would split the vectors and join them again.
        let (simd, a, b) =
            (a.simd, f32x8::simd_from(avx2, a.to_array()), f32x8::simd_from(avx2, b.to_array()));
        let (low, high) = (unpack_low(avx2, a, b), unpack_high(avx2, a, b));
        return (f32x8::simd_from(simd, low.to_array()), f32x8::simd_from(simd, high.to_array()));
    }
    let ((a0, a1), (b0, b1)) = (a.split(), b.split());
    (a0.zip_low(b0).combine(a1.zip_low(b1)), a0.zip_high(b0).combine(a1.zip_high(b1)))
}

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn unpack_low(avx2: Avx2, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2> {
        std::arch::x86_64::_mm256_unpacklo_ps(a.into(), b.into()).simd_into(avx2)
    }
);

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn unpack_high(avx2: Avx2, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2> {
        std::arch::x86_64::_mm256_unpackhi_ps(a.into(), b.into()).simd_into(avx2)
    }
);

/// A factor for each of eight pixels, repeated for their channels; in the order of [`transposed`].
#[inline(always)]
pub fn spread<S: Simd>(factor: f32x8<S>) -> [f32x8<S>; 4] {
    let (low, high) = zip_halves(factor, factor);
    let ((f0, f1), (f2, f3)) = (zip_halves(low, low), zip_halves(high, high));
    [f0, f1, f2, f3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch;
    use crate::dispatch::levels;
    use fearless_simd::Level;

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

    /// A function of sixteen numbers by the vectors of a level.
    macro_rules! on_lanes {
        ($level:expr, $v:ident => $result:expr) => {
            |x: &[f32; 16]| {
                dispatch!($level, simd => {
                    let $v = f32x16::from_slice(simd, x);
                    $result.to_array()
                })
            }
        };
    }

    #[test]
    fn elementary_functions_meet_their_bounds() {
        for (_, level) in levels() {
            apply(|x| f64::from(x).exp(), on_lanes!(level, v => v.exp()), -80.0, 80.0, 3e-7);
            apply(|x| f64::from(x).exp2(), on_lanes!(level, v => v.exp2()), -120.0, 120.0, 3e-7);
            apply(|x| f64::from(x).tanh(), on_lanes!(level, v => v.tanh()), -9.0, -1e-4, 3e-7);
            let power = |x: f32| f64::from(x).powf(1.0 / 2.4);
            apply(power, on_lanes!(level, v => v.powf(1.0 / 2.4)), 1e-5, 9e3, 1e-6);
            apply(|x| f64::from(x).ln(), on_lanes!(level, v => v.ln()), 2.0, 1e6, 3e-7);
            let inverse = |x: f32| f64::from(x).sqrt().recip();
            apply(inverse, on_lanes!(level, v => v.inverse_sqrt()), 1e-3, 7.0, 1e-6);
            apply(inverse, on_lanes!(level, v => v.inverse_sqrt()), 1e-30, 1e33, 1e-6);
        }
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
}
