//! Colour encodings on lanes; the twin of `shaders/shared/colour.wgsl`.
//!
//! Both curves are extended to values below 0 and above 1 so that they stay monotonic and
//! invertible. CIELAB is relative to D65, L in 0..100.

use isophote_engine::apart;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::math::Elementary;

/// Three channels, eight pixels.
pub type Rgb<S> = [f32x8<S>; 3];

const EPSILON_LAB: f32 = 0.008_856_452;
const SLOPE_LAB: f32 = 7.787_037;
const WHITE_D65: [f32; 3] = [0.950_47, 1.0, 1.088_83];

const LINEAR_TO_XYZ: [[f32; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];
/// Linear Rec. 709 to luminance: the middle row of the matrix to XYZ.
pub const LUMINANCE: [f32; 3] = LINEAR_TO_XYZ[1];
const XYZ_TO_LINEAR: [[f32; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];
/// AP1 (D60) to Rec. 709 (D65), Bradford adaptation.
pub const ACESCG_TO_LINEAR: [[f32; 3]; 3] = [
    [1.705_051, -0.621_792_1, -0.083_258_9],
    [-0.130_256_4, 1.140_804_7, -0.010_548_3],
    [-0.024_003_4, -0.128_969_0, 1.152_972_4],
];
/// The reverse of [`ACESCG_TO_LINEAR`].
pub const LINEAR_TO_ACESCG: [[f32; 3]; 3] = [
    [0.613_097_4, 0.339_523_1, 0.047_379_5],
    [0.070_193_7, 0.916_353_9, 0.013_452_4],
    [0.020_615_6, 0.109_569_8, 0.869_814_6],
];

/// Matrix times colour.
#[inline(always)]
pub fn transform<S: Simd>(m: &[[f32; 3]; 3], c: Rgb<S>) -> Rgb<S> {
    [weighted(&m[0], c), weighted(&m[1], c), weighted(&m[2], c)]
}

#[inline(always)]
fn weighted<S: Simd>(w: &[f32; 3], c: Rgb<S>) -> f32x8<S> {
    let simd = c[0].simd;
    c[2].mul_add(f32x8::splat(simd, w[2]), c[1].mul_add(f32x8::splat(simd, w[1]), c[0] * w[0]))
}

// The curves below are functions of their own, not closures given to `map`: those the compiler leaves
// outside the code for wide vectors, forty times slower.

/// Linear light to the sRGB curve, odd about 0.
#[inline(always)]
pub fn srgb_encode<S: Simd>([r, g, b]: Rgb<S>) -> Rgb<S> {
    [encode(r), encode(g), encode(b)]
}

#[inline(always)]
fn encode<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    apart!(v.simd, {
        let a = v.abs();
        let curve = a.powf(1.0 / 2.4) * 1.055 - 0.055;
        a.simd_le(0.003_130_8).select(a * 12.92, curve).copysign(v)
    })
}

/// The sRGB curve to linear light, odd about 0.
#[inline(always)]
pub fn srgb_decode<S: Simd>([r, g, b]: Rgb<S>) -> Rgb<S> {
    [decode(r), decode(g), decode(b)]
}

#[inline(always)]
fn decode<S: Simd>(v: f32x8<S>) -> f32x8<S> {
    apart!(v.simd, {
        let a = v.abs();
        let curve = power_2_4((a + 0.055) * (1.0 / 1.055));
        a.simd_le(0.040_45).select(a * (1.0 / 12.92), curve).copysign(v)
    })
}

/// x^2.4 of a positive, normal number, relative error below 6e-7: the cube of x times the inverse of its
/// fifth root.
#[inline(always)]
fn power_2_4<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let r = inverse_root(x, 1.0 / 5.0, 0x4c2b_4000);
    let r2 = r * r;
    // At most 0.156; what follows is (1 - e)^(-1/5).
    let e = (-(r2 * r2)).mul_add(x * r, f32x8::splat(x.simd, 1.0));
    let root = x * corrected(r, e, [0.200_000_12, 0.119_986_76, 0.087_963_57, 0.072_159_57, 0.061_620_72]);
    root * root * root
}

/// Cube root of a positive, normal number, relative error below 3e-7: x times the square of the inverse
/// root.
#[inline(always)]
fn cube_root<S: Simd>(x: f32x8<S>) -> f32x8<S> {
    let r = inverse_root(x, 1.0 / 3.0, 0x54a1_f000);
    // At most 0.103; what follows is (1 - e)^(-1/3).
    let e = (-(r * r)).mul_add(x * r, f32x8::splat(x.simd, 1.0));
    let r = corrected(r, e, [0.333_333_35, 0.222_216_78, 0.172_825, 0.145_687_32, 0.127_130_79]);
    x * (r * r)
}

/// `r` times 1 + c0 e + c1 e^2 + ..., where it misses an inverse root by `e` = 1 - x r^n.
#[inline(always)]
fn corrected<S: Simd>(r: f32x8<S>, e: f32x8<S>, c: [f32; 5]) -> f32x8<S> {
    let ee = e * e;
    let low = e.mul_add(f32x8::splat(e.simd, c[1]), f32x8::splat(e.simd, c[0]));
    let high = e.mul_add(f32x8::splat(e.simd, c[3]), f32x8::splat(e.simd, c[2]));
    let high = ee.mul_add(f32x8::splat(e.simd, c[4]), high);
    (r * e).mul_add(ee.mul_add(high, low), r)
}

/// About x^-`exponent`: the bits of a float are nearly its logarithm. `offset` is chosen for the least error.
#[inline(always)]
fn inverse_root<S: Simd>(x: f32x8<S>, exponent: f32, offset: i32) -> f32x8<S> {
    let logarithm = x.bitcast::<i32x8<S>>().to_float::<f32x8<S>>() * exponent;
    (i32x8::splat(x.simd, offset) - logarithm.to_int::<i32x8<S>>()).bitcast()
}

/// f(t) of CIELAB: a cube root with a straight line towards 0.
#[inline(always)]
pub fn lab_curve<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    apart!(t.simd, t.simd_le(EPSILON_LAB).select(t * SLOPE_LAB + 16.0 / 116.0, cube_root(t)))
}

/// Linear Rec. 709 to CIELAB.
#[inline(always)]
pub fn linear_to_lab<S: Simd>(c: Rgb<S>) -> Rgb<S> {
    let [x, y, z] = transform(&LINEAR_TO_XYZ, c);
    let (x, z) = (x * (1.0 / WHITE_D65[0]), z * (1.0 / WHITE_D65[2]));
    let (x, y, z) = (lab_curve(x), lab_curve(y), lab_curve(z));
    [y * 116.0 - 16.0, (x - y) * 500.0, (y - z) * 200.0]
}

/// CIELAB to linear Rec. 709.
#[inline(always)]
pub fn lab_to_linear<S: Simd>([l, a, b]: Rgb<S>) -> Rgb<S> {
    let y = (l + 16.0) * (1.0 / 116.0);
    let (x, z) = (y + a * (1.0 / 500.0), y - b * (1.0 / 200.0));
    let xyz = [
        lab_curve_inverse(x) * WHITE_D65[0],
        lab_curve_inverse(y) * WHITE_D65[1],
        lab_curve_inverse(z) * WHITE_D65[2],
    ];
    transform(&XYZ_TO_LINEAR, xyz)
}

/// The reverse of [`lab_curve`].
#[inline(always)]
pub fn lab_curve_inverse<S: Simd>(f: f32x8<S>) -> f32x8<S> {
    f.simd_le(6.0 / 29.0).select((f - 16.0 / 116.0) * (1.0 / SLOPE_LAB), f * f * f)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};

    #[test]
    fn roots_meet_their_bounds() {
        dispatch!(Level::new(), simd => {
            // From the dark ends of the curves to far beyond the brightest pixels.
            for i in 0..11_000 {
                let x = 0.005 * 1.003f32.powi(i);
                let wide = f32x8::splat(simd, x);
                for (got, want, bound) in [
                    (power_2_4(wide)[0], f64::from(x).powf(2.4), 6e-7),
                    (cube_root(wide)[0], f64::from(x).cbrt(), 3e-7),
                ] {
                    let error = (f64::from(got) / want - 1.0).abs();
                    assert!(error < bound, "{got} for {want} at {x}");
                }
            }
        });
    }
}
