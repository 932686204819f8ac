//! The anisotropic Kuwahara filter with sampled weighting functions (§ 5.4.2, Listings 5.2, 5.3): the
//! weights are those of the generalized filter, pulled back to the ellipse (5.33).
//!
//! One pixel after the other, with its sectors side by side in a vector: a texel holds the weights of
//! four sectors, and lookups along an ellipse are the pixel's own. Two pixels opposite each other share
//! one lookup; the second's sums are kept apart and go to the opposite sectors in the end.
//!
//! Cost: pi radius^2 pixels, each half of two table lookups of 40 operations and 11 vector operations.
//! The shader reads them through workgroup memory, about (1 + elongation)^2 radius^2 / 4 loads a pixel, up to an
//! elongation of 2.

use crate::kernels::painting::anisotropic_kuwahara::{Options, put_response, reach};
pub use crate::kernels::shaders::anisotropic_kuwahara_texture::Params;
use crate::kernels::shared::sampled_sectors::{Table, sample, table};
use crate::kernels::shared::sectors::{INSIDE, MIN_RADIUS, Response, Sector};
use crate::kernels::shared::tensor::scalar::{anisotropy, tangent};
use crate::kernels::simd::moment_buffer::{CHANNELS, MomentBuffer, for_rows};
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, dispatch, f32x4, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};
use std::f32::consts::FRAC_1_SQRT_2;

crate::kernel!(anisotropic_kuwahara_texture {
    cpu: run,
    cost: |p| 60.0 + std::f64::consts::PI * f64::from(p.radius).powi(2) * 90.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.03,
        reason: "the last bit decides whether a pixel on the border of the ellipse belongs to it, where the \
                 tensor is nearly isotropic its direction turns by many roundings, and the brightest pixels \
                 round the variances of all sectors",
    },
});

/// Filters a colour. The second output (`sibling` 1) is the sum of the standard deviations of the
/// sectors, as of eight.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, tensors: ImageId, options: &Options) -> ImageId {
    let params = Params {
        radius: options.radius.max(MIN_RADIUS),
        elongation: 1.0 / options.alpha,
        threshold: options.threshold,
        q: options.q,
        deviation_floor: options.deviation_floor,
        sectors: options.sectors,
        padding: Default::default(),
        weights: *table(options.sectors),
    };
    let level = plan.desc(color).level;
    let support = Support::Pixels(reach(params.radius, params.elongation) as u32);
    plan.pass_at(&KERNEL, &[color, tensors], &params, &[Class::Colour, Class::Field], support, level)
}

/// Sums of eight pixels: per channel, and last without regard to coverage, per sector (even ones first).
type Gathered = [[[f32; 8]; 8]; CHANNELS + 1];

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    if params.sectors == 8 {
        dispatch!(pass.level, simd => filter::<_, 8>(simd, pass, &params, band));
    } else {
        dispatch!(pass.level, simd => filter::<_, 4>(simd, pass, &params, band));
    }
}

#[inline(always)]
fn filter<S: Simd, const N: usize>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let reach = reach(params.radius, params.elongation);
    let response = Response { threshold: params.threshold, q: params.q, floor: params.deviation_floor };
    let color = &pass.inputs[0];
    let zero = f32x8::splat(simd, 0.0);
    for_rows(
        simd,
        color,
        reach,
        band,
        #[inline(always)]
        |planes, [x0, x1], y, band| {
            for x in (x0..x1).step_by(8) {
                let end = x1.min(x + 8);
                let mut gathered: Gathered = [[[0.0; 8]; 8]; CHANNELS + 1];
                for (lane, x) in (x..end).enumerate() {
                    let tensor = pass.inputs[1].pixel4(x, y);
                    gather::<S, N>(simd, planes, params, tensor, [x, y], lane, &mut gathered);
                }
                let mut sectors = [Sector::new([zero; 5], zero); N];
                for (k, sector) in sectors.iter_mut().enumerate() {
                    let mut sums = [zero; CHANNELS];
                    for (channel, sum) in sums.iter_mut().enumerate() {
                        *sum = f32x8::from_slice(simd, &gathered[channel][k]);
                    }
                    *sector = Sector::new(sums, f32x8::from_slice(simd, &gathered[CHANNELS][k]));
                }
                let original = Block::until(x1, x, y).read(simd, color);
                put_response(response.of(&sectors, original), [x, end], y, band);
            }
        },
    );
}

#[inline(always)]
fn gather<S: Simd, const N: usize>(
    simd: S,
    planes: &MomentBuffer,
    params: &Params,
    tensor: [f32; 4],
    [x, y]: [i32; 2],
    lane: usize,
    out: &mut Gathered,
) {
    let ellipse = Ellipse::new(params, tensor);
    // Towards and away: the second pixel of each pair counts for the opposite sectors.
    let mut towards = [f32x8::splat(simd, 0.0); CHANNELS];
    let mut away = towards;
    let mut full = texels::<S, N>(simd, &params.weights, 0.0, 0.0);
    let at = planes.column(x);
    for (sum, plane) in towards.iter_mut().zip(planes.row(y)) {
        *sum = full * plane[at];
    }
    // Half of what both pixels of a pair add to the weights.
    let mut pairs = f32x8::splat(simd, 0.0);
    for j in 0..=ellipse.rows {
        let [first, last] = ellipse.columns(j);
        let (below, above) = (planes.row(y + j), planes.row(y - j));
        for i in first..=last {
            let [u, v] = ellipse.in_disc(i, j);
            if u * u + v * v > INSIDE {
                continue;
            }
            let w = texels::<S, N>(simd, &params.weights, u, v);
            let (near, far) = ((at as i32 + i) as usize, (at as i32 - i) as usize);
            for channel in 0..CHANNELS {
                towards[channel] = w.mul_add(f32x8::splat(simd, below[channel][near]), towards[channel]);
                away[channel] = w.mul_add(f32x8::splat(simd, above[channel][far]), away[channel]);
            }
            pairs += w;
        }
    }
    let opposite = |k: usize| if k < 4 { (k + 2) % 4 } else { 4 + (k + 2) % 4 };
    for channel in 0..CHANNELS {
        let (towards, away) = (towards[channel].to_array(), away[channel].to_array());
        for k in 0..N {
            out[channel][k][lane] = towards[k] + away[opposite(k)];
        }
    }
    full += pairs;
    let (full, pairs) = (full.to_array(), pairs.to_array());
    for k in 0..N {
        out[CHANNELS][k][lane] = full[k] + pairs[opposite(k)];
    }
}

/// The mapping S R_-phi (5.32) of one pixel for a disc of radius 1, and its ellipse
/// a i^2 + 2 b i j + c j^2 <= 1.
struct Ellipse {
    along: [f32; 2],
    across: [f32; 2],
    a: f32,
    b: f32,
    /// a c - b^2.
    area: f32,
    /// Rows below the centre that hold a pixel.
    rows: i32,
}

impl Ellipse {
    #[inline(always)]
    fn new(params: &Params, [e, f, g, _]: [f32; 4]) -> Self {
        let [tx, ty] = tangent(e, f, g);
        let stretch = 1.0 + params.elongation * anisotropy(e, f, g);
        let (long, short) = (1.0 / (params.radius * stretch), stretch / params.radius);
        let (along, across) = ([tx * long, ty * long], [-ty * short, tx * short]);
        let a = along[0] * along[0] + across[0] * across[0];
        let b = along[0] * along[1] + across[0] * across[1];
        let area = params.radius.powi(4).recip();
        Self { along, across, a, b, area, rows: (INSIDE * a / area).sqrt() as i32 }
    }

    /// First and last columns of row `j` that hold a pixel, or all but do by rounding; of the centre's row those
    /// to its right.
    #[inline(always)]
    fn columns(&self, j: i32) -> [i32; 2] {
        let (a, b, dy) = (self.a, self.b, j as f32);
        let half = (INSIDE * a - self.area * dy * dy).max(0.0).sqrt() / a;
        let first = if j == 0 { 1 } else { (-b * dy / a - half - 1e-3).ceil() as i32 };
        [first, (-b * dy / a + half + 1e-3).floor() as i32]
    }

    /// Position of a pixel in the disc.
    #[inline(always)]
    fn in_disc(&self, i: i32, j: i32) -> [f32; 2] {
        let (dx, dy) = (i as f32, j as f32);
        [dx.mul_add(self.along[0], dy * self.along[1]), dx.mul_add(self.across[0], dy * self.across[1])]
    }
}

/// The weights of all sectors at a point of the unit disc, interpolated; the even ones first.
#[inline(always)]
fn texels<S: Simd, const N: usize>(simd: S, table: &Table, u: f32, v: f32) -> f32x8<S> {
    let even = sample(simd, table, u, v);
    if N == 4 {
        return even.combine(f32x4::splat(simd, 0.0));
    }
    even.combine(sample(simd, table, (u + v) * FRAC_1_SQRT_2, (v - u) * FRAC_1_SQRT_2))
}
