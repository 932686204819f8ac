//! What the generalized and the anisotropic Kuwahara filters share: weighting functions over the
//! sectors of a disc, and the mean of sectors weighted by their variance (5.14, 5.15). The twin of
//! `shaders/shared/sectors.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x4, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use std::f64::consts::{PI, SQRT_2};
use std::sync::OnceLock;

/// sigma_r in units of the radius: the disc ends at 2.5 sigma_r (5.20).
pub const SIGMA_R: f64 = 0.4;

/// Squared distance in units of the radius up to which a pixel belongs to the disc. Pixels on the very
/// border, as a whole radius has them, must not hang on the last bit.
pub const INSIDE: f32 = 1.0005;

/// A sector of which less than this share is covered says nothing.
const SEEN: f32 = 1e-3;

/// Parameters of the polynomial weights (5.36).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial {
    /// Overlap of the sectors at the centre (5.40).
    pub zeta: f32,
    /// Overlap of the sectors at their sides (5.42).
    pub eta: f32,
}

impl Polynomial {
    /// zeta = 2 / r, and eta for gamma = 3 pi / (2 N) at that zeta.
    pub fn new(radius: f32, sectors: u32) -> Self {
        let zeta = 2.0 / f64::from(radius.max(MIN_RADIUS));
        let (sin, cos) = (1.5 * PI / f64::from(sectors)).sin_cos();
        Self { zeta: zeta as f32, eta: ((zeta + cos) / (sin * sin)) as f32 }
    }
}

/// Discs below this radius hold their centre alone.
pub const MIN_RADIUS: f32 = 0.25;

/// Nodes on a side of the sampled weighting functions; odd, so that some lie on the axes.
pub const TABLE_SIDE: usize = 43;

/// Sampled weights below this are 0: the smoothing of the sectors has an end as well.
const NEGLIGIBLE: f64 = 1e-4;

/// Rows of a table: those of the lower half mirror them.
const TABLE_ROWS: usize = TABLE_SIDE / 2 + 1;

/// Weights of four sectors a quarter turn apart, starting with h_0, at nodes that span the half y >= 0 of
/// the disc's bounding square, row by row; the last texels are unused. It is what a uniform block can hold
/// on every device.
pub type Table = [[[f32; 4]; 32]; 30];

const _: () = assert!(TABLE_SIDE * TABLE_ROWS <= 32 * 30, "the nodes fit the table");

/// The weighting functions (5.11) for 4 or 8 sectors, sampled. Those between the four are found at
/// positions turned by 45 degrees.
pub fn table(sectors: u32) -> &'static Table {
    static TABLES: [OnceLock<Table>; 2] = [const { OnceLock::new() }; 2];
    TABLES[usize::from(sectors > 4)].get_or_init(|| {
        let mut table = [[[0.0; 4]; 32]; 30];
        let node = |i: usize| 2.0 * i as f64 / (TABLE_SIDE - 1) as f64;
        for (index, texel) in table.as_flattened_mut()[..TABLE_SIDE * TABLE_ROWS].iter_mut().enumerate() {
            let (x, y) = (node(index % TABLE_SIDE) - 1.0, node(index / TABLE_SIDE));
            // Sector k looks along k quarter turns: the point is turned back.
            for (value, (u, v)) in texel.iter_mut().zip([(x, y), (y, -x), (-x, -y), (-y, x)]) {
                let w = weight(u, v, PI / f64::from(sectors));
                *value = if w < NEGLIGIBLE { 0.0 } else { w as f32 };
            }
        }
        table
    })
}

/// h_0 = (chi_0 * G_sigma_s) G_sigma_r at a point of the unit disc, for sectors of `half` angle on each
/// side, not normalised: 1 where the sector is whole and the centre is near.
pub fn weight(x: f64, y: f64, half: f64) -> f64 {
    let sigma = SIGMA_R / 3.0;
    // Along x the convolution of the sector is an integral of the Gaussian; along y it is summed.
    let (steps, reach) = (96, 5.0);
    let mut sum = 0.0;
    let mut norm = 0.0;
    for i in 0..steps {
        let t = reach * (2.0 * (f64::from(i) + 0.5) / f64::from(steps) - 1.0);
        let g = (-0.5 * t * t).exp();
        let border = (y + sigma * t).abs() / half.tan();
        sum += g * 0.5 * (1.0 + erf((x - border) / (sigma * SQRT_2)));
        norm += g;
    }
    sum / norm * (-(x * x + y * y) / (2.0 * SIGMA_R * SIGMA_R)).exp()
}

/// The error function to 1.5e-7 (Abramowitz and Stegun 7.1.26).
fn erf(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let p = [1.061_405_429, -1.453_152_027, 1.421_413_741, -0.284_496_736, 0.254_829_592];
    let series = p.iter().fold(0.0, |sum, c| (sum + c) * t);
    (1.0 - series * (-x * x).exp()).copysign(x)
}

/// The four weights of a table at a point of the unit disc, interpolated.
#[inline(always)]
pub fn sample<S: Simd>(simd: S, table: &Table, x: f32, y: f32) -> f32x4<S> {
    const SCALE: f32 = 0.5 * (TABLE_SIDE - 1) as f32;
    const LAST: [f32; 2] = [(TABLE_SIDE - 2) as f32, (TABLE_ROWS - 2) as f32];
    let (u, v) = (((x + 1.0) * SCALE).max(0.0), y.abs() * SCALE);
    // Positive: the conversion cuts as floor does.
    let (i, j) = (u.min(LAST[0]) as u32, v.min(LAST[1]) as u32);
    let fx = f32x4::splat(simd, (u - i as f32).min(1.0));
    let fy = f32x4::splat(simd, (v - j as f32).min(1.0));
    let texels = &table.as_flattened()[j as usize * TABLE_SIDE + i as usize..][..TABLE_SIDE + 2];
    let (a, b) = (f32x4::from_slice(simd, &texels[0]), f32x4::from_slice(simd, &texels[1]));
    let c = f32x4::from_slice(simd, &texels[TABLE_SIDE]);
    let d = f32x4::from_slice(simd, &texels[TABLE_SIDE + 1]);
    let top = (b - a).mul_add(fx, a);
    let bottom = (d - c).mul_add(fx, c);
    let weights = (bottom - top).mul_add(fy, top);
    if y < 0.0 {
        // The lower half mirrors the upper one: the second and the fourth sector change places.
        let [h0, h1, h2, h3] = weights.to_array();
        return f32x4::simd_from(simd, [h0, h3, h2, h1]);
    }
    weights
}

/// What eight pixels found in one of their sectors.
#[derive(Clone, Copy, Debug)]
pub struct Sector<S: Simd> {
    mean: [f32x8<S>; 3],
    /// Sum over the channels.
    variance: f32x8<S>,
    /// Share of the sector that is covered; 0 when too little is.
    cover: f32x8<S>,
}

impl<S: Simd> Sector<S> {
    /// From sums of weights times a r, a g, a b, a (r^2 + g^2 + b^2) and a, and the sum of the weights.
    #[inline(always)]
    pub fn new([r, g, b, q, a]: [f32x8<S>; 5], weights: f32x8<S>) -> Self {
        let zero = f32x8::splat(weights.simd, 0.0);
        let cover = a / weights.max(f32x8::splat(weights.simd, 1e-20));
        let seen = cover.simd_gt(f32x8::splat(weights.simd, SEEN));
        let n = seen.select(f32x8::splat(weights.simd, 1.0) / a, zero);
        Self::of([r, g, b, q], n, seen.select(cover, zero))
    }

    /// Of opaque pixels: their coverage is the sum of the weights. A sector is never without weight, since
    /// all share the centre.
    #[inline(always)]
    pub fn opaque(sums: [f32x8<S>; 4], weights: f32x8<S>) -> Self {
        let one = f32x8::splat(weights.simd, 1.0);
        Self::of(sums, one / weights, one)
    }

    #[inline(always)]
    fn of([r, g, b, q]: [f32x8<S>; 4], n: f32x8<S>, cover: f32x8<S>) -> Self {
        let mean = [r * n, g * n, b * n];
        let square = mean[2].mul_add(mean[2], mean[1].mul_add(mean[1], mean[0] * mean[0]));
        Self { mean, variance: (q * n - square).max(0.0), cover }
    }
}

/// How sectors are weighed against each other.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// tau_s of (5.15).
    pub threshold: f32,
    /// Exponent q.
    pub q: f32,
    /// tau_w: least standard deviation of a sector in the sum over sectors.
    pub floor: f32,
}

impl Response {
    /// The response (5.14), the original where nothing is covered, and the sum of the sectors' standard
    /// deviations, each at least `floor` (§ 5.5.2), as of eight sectors.
    ///
    /// Weights are taken relative to that of the flattest sector, so that no exponent overflows, and
    /// times the share of the sector that is covered.
    #[inline(always)]
    pub fn of<S: Simd, const N: usize>(
        &self,
        sectors: &[Sector<S>; N],
        original: [f32x8<S>; 4],
    ) -> ([f32x8<S>; 4], f32x8<S>) {
        let simd = original[3].simd;
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let threshold = f32x8::splat(simd, self.threshold * self.threshold);
        let floor = f32x8::splat(simd, self.floor);
        let mut least = f32x8::splat(simd, f32::MAX);
        let mut deviation = zero;
        for sector in sectors {
            let bounded = sector.variance.max(threshold);
            least = sector.cover.simd_gt(zero).select(least.min(bounded), least);
            deviation += sector.variance.sqrt().max(floor);
        }
        let mut alphas = [one; N];
        for k in 0..N {
            // Sectors without coverage may lie below the least of the others.
            alphas[k] = (least / sectors[k].variance.max(threshold)).min(one);
        }
        power(&mut alphas, self.q);
        let mut sum = [zero; 4];
        for k in 0..N {
            let alpha = alphas[k] * sectors[k].cover;
            for channel in 0..3 {
                sum[channel] = alpha.mul_add(sectors[k].mean[channel], sum[channel]);
            }
            sum[3] += alpha;
        }
        let seen = sum[3].simd_gt(zero);
        let n = one / seen.select(sum[3], one);
        let colour = [
            seen.select(sum[0] * n, original[0]),
            seen.select(sum[1] * n, original[1]),
            seen.select(sum[2] * n, original[2]),
            original[3],
        ];
        (colour, deviation * (8.0 / N as f32))
    }
}

/// x^(q/2) for x in 0..=1; by repeated squaring for whole q.
#[inline(always)]
fn power<S: Simd, const N: usize>(x: &mut [f32x8<S>; N], q: f32) {
    if q.fract() != 0.0 {
        for x in x {
            *x = x.powf(0.5 * q);
        }
        return;
    }
    let whole = q as u32;
    let (mut rest, mut squares) = (whole >> 1, *x);
    for x in &mut *x {
        *x = if whole & 1 != 0 { x.sqrt() } else { f32x8::splat(x.simd, 1.0) };
    }
    while rest != 0 {
        if rest & 1 != 0 {
            for k in 0..N {
                x[k] *= squares[k];
            }
        }
        for square in &mut squares {
            *square *= *square;
        }
        rest >>= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};

    fn sampled(table: &Table, x: f32, y: f32) -> [f32; 4] {
        dispatch!(Level::baseline(), simd => sample(simd, table, x, y).to_array())
    }

    #[test]
    fn sampled_sectors_are_those_of_the_definition() {
        for (x, y) in [(0.0, 0.0), (0.52, 0.31), (-0.3, -0.64), (0.1, -0.97), (-0.88, 0.02)] {
            let got = sampled(table(8), x, y);
            let (x, y) = (f64::from(x), f64::from(y));
            let want = [(x, y), (y, -x), (-x, -y), (-y, x)].map(|(u, v)| weight(u, v, PI / 8.0));
            for (got, want) in got.into_iter().zip(want) {
                assert!((f64::from(got) - want).abs() < 0.004, "at {x}, {y}: {got} for {want}");
            }
        }
    }

    #[test]
    fn the_sampled_sectors_sum_to_the_gaussian() {
        for sectors in [4, 8] {
            let table = table(sectors);
            for (x, y) in [(0.0, 0.0), (0.31, -0.2), (0.7, 0.69), (-0.05, 0.93), (-0.4, 0.1)] {
                let h = std::f32::consts::FRAC_1_SQRT_2;
                let mut sum: f32 = sampled(table, x, y).iter().sum();
                if sectors == 8 {
                    sum += sampled(table, (x + y) * h, (y - x) * h).iter().sum::<f32>();
                }
                let gaussian = (-3.125 * (x * x + y * y)).exp();
                assert!((sum - gaussian).abs() < 0.006, "{sectors} at {x}, {y}: {sum} for {gaussian}");
            }
        }
    }

    #[test]
    fn eta_is_that_of_the_thesis_at_radius_six() {
        assert!((Polynomial::new(6.0, 4).eta - 0.84).abs() < 0.005);
        assert!((Polynomial::new(6.0, 8).eta - 3.77).abs() < 0.005);
    }
}
