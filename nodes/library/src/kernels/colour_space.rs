//! Colour encodings on lanes; the twin of `shaders/shared/colour.wgsl`.
//!
//! Both curves are extended to values below 0 and above 1 so that they stay monotonic and
//! invertible. CIELAB is relative to D65, L in 0..100.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
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
    m.map(|row| {
        let s = |v: f32| f32x8::splat(c[0].simd, v);
        c[2].mul_add(s(row[2]), c[1].mul_add(s(row[1]), c[0] * s(row[0])))
    })
}

/// Linear light to the sRGB curve, odd about 0.
#[inline(always)]
pub fn srgb_encode<S: Simd>(c: Rgb<S>) -> Rgb<S> {
    c.map(|v| {
        let a = v.abs();
        let curve = a.powf(1.0 / 2.4) * 1.055 - 0.055;
        a.simd_le(0.003_130_8).select(a * 12.92, curve).copysign(v)
    })
}

/// The sRGB curve to linear light, odd about 0.
#[inline(always)]
pub fn srgb_decode<S: Simd>(c: Rgb<S>) -> Rgb<S> {
    c.map(|v| {
        let a = v.abs();
        let curve = ((a + 0.055) / 1.055).powf(2.4);
        a.simd_le(0.040_45).select(a / 12.92, curve).copysign(v)
    })
}

/// f(t) of CIELAB: a cube root with a straight line towards 0.
#[inline(always)]
pub fn lab_curve<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    t.simd_le(EPSILON_LAB).select(t * SLOPE_LAB + 16.0 / 116.0, t.powf(1.0 / 3.0))
}

/// Linear Rec. 709 to CIELAB.
#[inline(always)]
pub fn linear_to_lab<S: Simd>(c: Rgb<S>) -> Rgb<S> {
    let xyz = transform(&LINEAR_TO_XYZ, c);
    let [x, y, z] = std::array::from_fn(|i| {
        lab_curve(xyz[i] / WHITE_D65[i])
    });
    [y * 116.0 - 16.0, (x - y) * 500.0, (y - z) * 200.0]
}

/// CIELAB to linear Rec. 709.
#[inline(always)]
pub fn lab_to_linear<S: Simd>([l, a, b]: Rgb<S>) -> Rgb<S> {
    let y = (l + 16.0) / 116.0;
    let f = [y + a / 500.0, y, y - b / 200.0];
    let xyz = std::array::from_fn(|i| {
        let f = f[i];
        f.simd_le(6.0 / 29.0).select((f - 16.0 / 116.0) / SLOPE_LAB, f * f * f) * WHITE_D65[i]
    });
    transform(&XYZ_TO_LINEAR, xyz)
}
