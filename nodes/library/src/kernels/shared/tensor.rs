//! Algebra of symmetric positive semidefinite 2x2 tensors (E, F, G): eigenvalues, eigenvectors and
//! anisotropy (§ 2.3.4, 2.6.1). Twin of `shaders/shared/tensor.wgsl`, operation by operation.
//!
//! The eigenanalysis is that of Listing 2.1. Its squares would underflow for weak gradients and
//! overflow for strong ones, so values are first multiplied by a power of two, which is exact.
//! Cost: about 20 operations, two of them square roots and one a division.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*, u32x8};
use isophote_engine::math::Elementary;

/// Eigenvalues and the major eigenvector of eight tensors.
#[derive(Clone, Copy)]
pub struct Eigen<S: Simd> {
    /// The larger eigenvalue.
    pub lambda1: f32x8<S>,
    /// The smaller eigenvalue, never negative.
    pub lambda2: f32x8<S>,
    /// Unit eigenvector of `lambda1`; its sign means nothing.
    pub major: [f32x8<S>; 2],
}

/// 2^-n for 2^n <= v < 2^(n+1), and 2^n.
#[inline(always)]
fn scales<S: Simd>(v: f32x8<S>) -> (f32x8<S>, f32x8<S>) {
    let bits = v.bitcast::<u32x8<S>>() & u32x8::splat(v.simd, 0x7f80_0000);
    ((u32x8::splat(v.simd, 0x7f00_0000) - bits).bitcast(), bits.bitcast())
}

/// sqrt(d^2 + f^2) (2.80) and the major eigenvector (2.82) of tensors with d = (E - G) / 2 and f = F.
#[inline(always)]
pub fn axis<S: Simd>(d: f32x8<S>, f: f32x8<S>) -> (f32x8<S>, [f32x8<S>; 2]) {
    let size = d.abs().at_least(f.abs());
    let zero = size.simd_lt(f32x8::splat(d.simd, f32::MIN_POSITIVE));
    let (scale, unscale) = scales(size);
    let (ds, fs) = (d * scale, f * scale);
    let ff = fs * fs;
    let r = (ds * ds + ff).sqrt();
    // The sum of two positive numbers: nothing cancels, and it is at least 1.
    let n = ds.abs() + r;
    let inverse = f32x8::splat(d.simd, 1.0) / (n * n + ff).sqrt();
    let along = d.simd_ge(f32x8::splat(d.simd, 0.0));
    let x = along.select(n, fs) * inverse;
    let y = along.select(fs, n) * inverse;
    (
        zero.select(f32x8::splat(d.simd, 0.0), r * unscale),
        [zero.select(f32x8::splat(d.simd, 1.0), x), zero.select(f32x8::splat(d.simd, 0.0), y)],
    )
}

/// Eigenvalues (2.80, 2.81) and major eigenvector; zero tensor: (1, 0). Values must be finite and
/// below 2^127.
#[inline(always)]
pub fn eigen<S: Simd>(e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> Eigen<S> {
    let size = e.at_least(g).at_least(f.abs());
    let zero = size.simd_lt(f32x8::splat(e.simd, f32::MIN_POSITIVE));
    let (scale, unscale) = scales(size);
    let (e, f, g) = (e * scale, f * scale, g * scale);
    let (radius, [x, y]) = axis((e - g) * 0.5, f);
    let lambda1 = (e + g) * 0.5 + radius;
    // Only tensors that are not semidefinite have lambda1 < 1/2 here; the bound keeps them finite.
    let lambda2 =
        (e * g - f * f).at_least(f32x8::splat(e.simd, 0.0)) / lambda1.at_least(f32x8::splat(e.simd, 0.25));
    Eigen {
        lambda1: zero.select(f32x8::splat(e.simd, 0.0), lambda1 * unscale),
        lambda2: zero.select(f32x8::splat(e.simd, 0.0), lambda2 * unscale),
        major: [zero.select(f32x8::splat(e.simd, 1.0), x), zero.select(f32x8::splat(e.simd, 0.0), y)],
    }
}

/// Unit minor eigenvector, along the isophotes; zero tensor: (0, 1). Its sign means nothing.
#[inline(always)]
pub fn tangent<S: Simd>(e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> [f32x8<S>; 2] {
    let (_, [x, y]) = axis((e - g) * 0.5, f);
    [-y, x]
}

/// Squared differences of eigenvalues below this have no direction.
const FLAT: f32 = 1e-36;

/// The unit minor eigenvector of tensors with E - G = `difference` and F = `f`, of the sign that turns less
/// from the unit vector `p`, and the cosine of that turn.
///
/// That is `p` projected on the eigenvector, (I + M / r) p / 2 with M = (-d, -f; -f, d), d = (E - G) / 2
/// and r^2 = d^2 + f^2, and made a unit vector: no sign to choose, and little that waits for each other.
/// Where there is no direction (r at most 1e-18, or above 1e18), `p` goes on straight; where the
/// eigenvector lies straight across, so that its sign cannot be decided, it goes on as well, with a cosine
/// of about 0.
#[inline(always)]
pub fn tangent_along<S: Simd>(
    difference: f32x8<S>,
    f: f32x8<S>,
    [px, py]: [f32x8<S>; 2],
) -> ([f32x8<S>; 2], f32x8<S>) {
    let d = difference * 0.5;
    let rr = d.mul_add(d, f * f);
    let r = rr.sqrt();
    let x = (r - d).mul_add(px, -(f * py));
    let y = (r + d).mul_add(py, -(f * px));
    let size = x.mul_add(x, y * y);
    let one = f32x8::splat(d.simd, 1.0);
    let inverse = size.at_least(f32x8::splat(d.simd, f32::MIN_POSITIVE)).inverse_sqrt();
    let cosine = px.mul_add(x * inverse, py * (y * inverse));
    // False for what has overflowed too.
    let decided = size.simd_gt(rr * 1e-8) & size.simd_le(f32x8::splat(d.simd, f32::MAX));
    let directed = rr.simd_gt(f32x8::splat(d.simd, FLAT));
    // Selected before the product: a choice that replaces `p` in memory would be a masked store, a very slow one.
    let inverse = decided.select(inverse, one);
    ([decided.select(x, px) * inverse, decided.select(y, py) * inverse], directed.select(cosine, one))
}

/// (lambda1 - lambda2) / (lambda1 + lambda2), 0..=1 (2.137); zero tensor: 0.
#[inline(always)]
pub fn anisotropy<S: Simd>(e: f32x8<S>, f: f32x8<S>, g: f32x8<S>) -> f32x8<S> {
    let half_trace = (e + g) * 0.5;
    let zero = half_trace.simd_lt(f32x8::splat(e.simd, f32::MIN_POSITIVE));
    let (radius, _) = axis((e - g) * 0.5, f);
    zero.select(f32x8::splat(e.simd, 0.0), (radius / half_trace).at_most(f32x8::splat(e.simd, 1.0)))
}

/// One tensor at a time, by the same operations.
pub mod scalar {
    fn scales(v: f32) -> (f32, f32) {
        let bits = v.to_bits() & 0x7f80_0000;
        (f32::from_bits(0x7f00_0000_u32.wrapping_sub(bits)), f32::from_bits(bits))
    }

    fn axis(d: f32, f: f32) -> (f32, [f32; 2]) {
        let size = d.abs().max(f.abs());
        if size < f32::MIN_POSITIVE {
            return (0.0, [1.0, 0.0]);
        }
        let (scale, unscale) = scales(size);
        let (ds, fs) = (d * scale, f * scale);
        let ff = fs * fs;
        let r = (ds * ds + ff).sqrt();
        let n = ds.abs() + r;
        let inverse = 1.0 / (n * n + ff).sqrt();
        let [x, y] = if d >= 0.0 { [n, fs] } else { [fs, n] };
        (r * unscale, [x * inverse, y * inverse])
    }

    /// lambda1, lambda2 and the unit eigenvector of lambda1 (Listing 2.1); zero tensor: (0, 0, (1, 0)).
    /// Values must be finite and below 2^127.
    pub fn eigen(e: f32, f: f32, g: f32) -> (f32, f32, [f32; 2]) {
        let size = e.max(g).max(f.abs());
        if size < f32::MIN_POSITIVE {
            return (0.0, 0.0, [1.0, 0.0]);
        }
        let (scale, unscale) = scales(size);
        let (e, f, g) = (e * scale, f * scale, g * scale);
        let (radius, major) = axis((e - g) * 0.5, f);
        let lambda1 = (e + g) * 0.5 + radius;
        let lambda2 = (e * g - f * f).max(0.0) / lambda1.max(0.25);
        (lambda1 * unscale, lambda2 * unscale, major)
    }

    /// Unit minor eigenvector; zero tensor: (0, 1).
    pub fn tangent(e: f32, f: f32, g: f32) -> [f32; 2] {
        let (_, [x, y]) = axis((e - g) * 0.5, f);
        [-y, x]
    }

    /// Anisotropy (2.137); zero tensor: 0.
    pub fn anisotropy(e: f32, f: f32, g: f32) -> f32 {
        let half_trace = (e + g) * 0.5;
        if half_trace < f32::MIN_POSITIVE {
            return 0.0;
        }
        (axis((e - g) * 0.5, f).0 / half_trace).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};

    /// Deterministic numbers in 0..1.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// Tensors of any size between 1e-30 and 1e30, condition numbers up to 1e6, with the angle of the
    /// major eigenvector.
    fn tensors() -> Vec<[f32; 3]> {
        let mut next = numbers(7);
        (0..20_000)
            .map(|_| {
                let (size, condition) = (10f64.powf(next() * 60.0 - 30.0), 10f64.powf(next() * 6.0));
                let (sin, cos) = (next() * std::f64::consts::PI).sin_cos();
                let (l1, l2) = (size, size / condition);
                [
                    (l1 * cos * cos + l2 * sin * sin) as f32,
                    ((l1 - l2) * sin * cos) as f32,
                    (l1 * sin * sin + l2 * cos * cos) as f32,
                ]
            })
            .collect()
    }

    fn exact([e, f, g]: [f32; 3]) -> (f64, f64, f64) {
        let (e, f, g) = (f64::from(e), f64::from(f), f64::from(g));
        let r = ((e - g) / 2.0).hypot(f);
        let l1 = (e + g) / 2.0 + r;
        (l1, (e * g - f * f).max(0.0) / l1, 0.5 * (2.0 * f).atan2(e - g))
    }

    #[test]
    fn eigenvalues_and_axes_are_those_of_double_precision() {
        for t in tensors() {
            let (l1, l2, angle) = exact(t);
            let (lambda1, lambda2, [x, y]) = scalar::eigen(t[0], t[1], t[2]);
            assert!((f64::from(lambda1) / l1 - 1.0).abs() < 3e-7, "{t:?}: lambda1 {lambda1} for {l1}");
            // A determinant in f32 is exact to a few roundings of its largest product.
            assert!((f64::from(lambda2) - l2).abs() < 3e-7 * l1, "{t:?}: lambda2 {lambda2} for {l2}");
            let (sin, cos) = angle.sin_cos();
            let across = f64::from(x) * sin - f64::from(y) * cos;
            assert!(across.abs() < 5e-7 * l1 / (l1 - l2), "{t:?}: angle off by {across:e}");
            assert!((x * x + y * y - 1.0).abs() < 4e-7);
        }
    }

    #[test]
    fn extreme_and_degenerate_tensors_keep_their_axes() {
        let diagonal = std::f32::consts::FRAC_1_SQRT_2;
        for size in [1.0, 1e-36, 1e37] {
            let (lambda1, lambda2, major) = scalar::eigen(size, size, size);
            assert!((lambda1 / size - 2.0).abs() < 1e-6 && lambda2 == 0.0);
            assert!((major[0] - diagonal).abs() < 1e-6 && (major[1] - diagonal).abs() < 1e-6);
            assert_eq!(scalar::eigen(size, 0.0, size), (size, size, [1.0, 0.0]));
            assert_eq!(scalar::eigen(0.0, 0.0, size), (size, 0.0, [0.0, 1.0]));
            assert_eq!(scalar::anisotropy(size, 0.0, size), 0.0);
            assert_eq!(scalar::anisotropy(size, 0.0, 0.0), 1.0);
        }
        assert_eq!(scalar::eigen(0.0, 0.0, 0.0), (0.0, 0.0, [1.0, 0.0]));
        assert_eq!(scalar::tangent(0.0, 0.0, 0.0), [0.0, 1.0]);
        assert_eq!(scalar::anisotropy(0.0, 0.0, 0.0), 0.0);
        // Where E = G exactly, the least F still gives the axis.
        let (_, _, major) = scalar::eigen(1.0, 1e-30, 1.0);
        assert!((major[0] - diagonal).abs() < 1e-6 && (major[1] - diagonal).abs() < 1e-6);
    }

    #[test]
    fn lanes_do_what_the_scalar_form_does() {
        let mut all = tensors();
        all.extend([[0.0; 3], [1.0, 0.0, 1.0], [1e-39, 0.0, 0.0], [0.0, 0.0, 3.0]]);
        all.resize(all.len().next_multiple_of(8), [0.0; 3]);
        for block in all.chunks_exact(8) {
            dispatch!(Level::new(), simd => {
                let lane = |k: usize| f32x8::from_fn(simd, |i| block[i][k]);
                let (e, f, g) = (lane(0), lane(1), lane(2));
                let all = eigen(e, f, g);
                let (t, a) = (tangent(e, f, g), anisotropy(e, f, g));
                for (i, [e, f, g]) in block.iter().copied().enumerate() {
                    let got = (all.lambda1[i], all.lambda2[i], [all.major[0][i], all.major[1][i]]);
                    assert_eq!(got, scalar::eigen(e, f, g));
                    assert_eq!([t[0][i], t[1][i]], scalar::tangent(e, f, g));
                    assert_eq!(a[i], scalar::anisotropy(e, f, g));
                }
            });
        }
    }

    #[test]
    fn the_tangent_along_is_the_tangent_on_that_side() {
        let direction = |angle: f32| [angle.cos(), angle.sin()];
        dispatch!(Level::new(), simd => {
            for (i, [e, f, g]) in tensors().into_iter().enumerate() {
                let [px, py] = direction(i as f32);
                let lanes = |v: f32| f32x8::splat(simd, v);
                let ([x, y], cosine) = tangent_along(lanes(e - g), lanes(f), [lanes(px), lanes(py)]);
                let ([x, y], cosine) = ([x[0], y[0]], cosine[0]);
                let radius = ((e - g) * 0.5).hypot(f);
                if radius < 1e-17 {
                    continue;
                }
                if radius > 1e17 {
                    assert!(x.is_finite() && y.is_finite());
                    continue;
                }
                let [tx, ty] = scalar::tangent(e, f, g);
                let along = tx * px + ty * py;
                // Near the normal the sign hangs on the last bits.
                if along.abs() > 1e-2 {
                    let (tx, ty) = (tx * along.signum(), ty * along.signum());
                    assert!((x - tx).abs() + (y - ty).abs() < 1e-4, "{:?} for {:?}", [x, y], [tx, ty]);
                    assert!((cosine - along.abs()).abs() < 1e-4);
                }
            }
            let (none, p) = (f32x8::splat(simd, 0.0), direction(1.0));
            let ([x, y], cosine) = tangent_along(none, none, p.map(|v| f32x8::splat(simd, v)));
            assert_eq!([x[0], y[0], cosine[0]], [p[0], p[1], 1.0]);
        });
    }
}
