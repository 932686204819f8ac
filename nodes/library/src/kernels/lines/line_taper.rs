//! Lines that run out into a point, as the stroke of a pen does: narrower towards their ends, where a line goes on to one side
//! alone. The thesis has one width.
//!
//! Cost: 36 reads, 16 exponentials and about 250 operations per pixel.

use crate::kernels::lines::flow_dog_gradient::Across;
pub use crate::kernels::shaders::line_taper::Params;
use crate::kernels::simd::pixels::{Block, fetch4, for_blocks, offsets, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(line_taper {
    cpu: |simd, pass, params, band| tapered(simd, pass, &params, band),
    cost: |p| 60.0 + 40.0 * f64::from(p.samples),
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "which pixel along a line is nearest may turn on the last bit of the slope, and new borders are steep",
    },
    fast: Tolerance {
        absolute: 6e-2,
        relative: 1e-2,
        outliers: 2e-2,
        reason: "densities and directions as 16-bit floats, by whose quotients steep borders are found",
    },
});

/// Samples on each side, and the reach, in standard deviations.
const SAMPLES: i32 = 16;
const REACH: f32 = 2.0;

/// Share of a line below which nothing is known of it.
const LEAST_SHARE: f32 = 0.05;
/// Share of a line's own density below which it goes on to no side.
const LEAST_SIDE: f32 = 0.35;

/// What is known of lines.
#[derive(Clone, Copy, Debug)]
pub struct Lines {
    /// 1 = paper, 0 = line.
    pub edges: ImageId,
    /// In the first channel the same, smoothed in all directions.
    pub soft: ImageId,
    /// The least of that within half of a line's width.
    pub darkest: ImageId,
    /// Their directions, (E - G, F).
    pub field: ImageId,
}

/// Lines that end in points, which are about `sigma` pixels long.
pub fn pass(plan: &mut PlanBuilder, lines: &Lines, sigma: f32) -> ImageId {
    let Lines { edges, soft, darkest, field } = *lines;
    let stride = ((REACH * sigma / SAMPLES as f32).round() as i32).max(1);
    let samples = ((REACH * sigma / stride as f32).ceil() as i32).clamp(1, SAMPLES);
    let params = Params { falloff: -0.5 / (sigma * sigma), stride, samples };
    let support = Support::Pixels((stride * samples) as u32);
    plan.pass(&KERNEL, &[edges, soft, darkest, field], &params, Class::Field, support)
}

#[inline(always)]
fn tapered<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [edges, soft, darkest, field] = pass.inputs else { return };
    let one = f32x8::splat(simd, 1.0);
    for_blocks::<1>(
        band,
        #[inline(always)]
        |block, target| {
            let [edge] = block.read(simd, edges);
            let line = one - edge.within(0.0, 1.0);
            let [own, ..]: [f32x8<S>; 4] = block.read(simd, soft);
            let [least, ..]: [f32x8<S>; 4] = block.read(simd, darkest);
            let own = one - own;
            let inside = inside(simd, &block, [soft, field], params, own);
            // 1 on the middle of the line, and about two thirds at its borders.
            let height = own / (one - least).at_least(LEAST_SHARE);
            let border = (one - inside) * 1.02 + inside * 0.6;
            let narrow = ((height - border) * 12.0).within(0.0, 1.0);
            let whole = ((inside - 0.8) * 5.0).within(0.0, 1.0);
            let kept = narrow + (one - narrow) * whole;
            write([one - line * kept], target);
        },
    );
}

/// 0 at the ends of lines, and 1 where they go on to both sides alike.
#[inline(always)]
fn inside<S: Simd>(
    simd: S,
    block: &Block,
    [soft, field]: [&View<'_>; 2],
    params: &Params,
    own: f32x8<S>,
) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let [difference, f]: [f32x8<S>; 2] = block.read(simd, field);
    // Across what is across: along the line.
    let along = Across::new(simd, block, [zero - difference, zero - f]);
    let (mut ahead, mut back, mut weights) = (zero, zero, zero);
    for i in 1..=params.samples {
        let k = i * params.stride;
        let w = (along.step * along.step * params.falloff * k as f32 * k as f32).exp();
        let [a, b] = [along.nearest(k), along.nearest(-k)];
        let [a, ..] = fetch4(simd, soft, offsets(soft, a[0], a[1]));
        let [b, ..] = fetch4(simd, soft, offsets(soft, b[0], b[1]));
        ahead = w.mul_add(one - a, ahead);
        back = w.mul_add(one - b, back);
        weights += w;
    }
    let (ahead, back) = (ahead / weights, back / weights);
    let most = ahead.at_least(back).at_least(own * LEAST_SIDE).at_least(LEAST_SHARE);
    (ahead.at_most(back) * 1.6 / most).within(0.0, 1.0)
}
