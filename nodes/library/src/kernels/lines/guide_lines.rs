//! Adds lines where geometry breaks to the response of the first pass of the flow-based difference of
//! Gaussians, so that the second pass smooths both kinds along the same flow.
//!
//! Across the tangent it measures how much of a Gaussian window lies past a break of normal, depth or
//! object id, and takes that off the response; the result is a line centred on the break, as wide as
//! those of the difference of Gaussians. The thesis has no guides; this is the second derivative test
//! of § 4.5 applied to geometry: 1/z is linear in x and y over any plane, so z0/z+ + z0/z- - 2 is 0 on
//! planes however slanted, and has no scale.
//!
//! Cost: per step (about 3 k sigma_e of them) up to six reads and an exponential.

use crate::kernels::blocks::{fetch1, fetch4, for_blocks, offsets, write2};
use crate::kernels::lines::flow_dog_gradient::{Across, halfwidth};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::math::Elementary;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::params! {
    /// Uniform block.
    pub struct Params for guide_lines {
        /// -1 / (2 sigma^2) of the Gaussian across the line.
        pub narrow: f32,
        /// Cut-off, in pixels.
        pub halfwidth: f32,
        /// Units of response that a window wholly past a break takes off.
        pub amount: f32,
        /// Bit 0: normal, bit 1: depth, bit 2: object id are there.
        pub guides: u32,
    }
}

crate::kernel!(guide_lines {
    cpu: run,
    cost: |params| {
        let p: Params = bytemuck::pod_read_unaligned(params);
        f64::from(p.halfwidth) * 0.88 * 60.0 + 30.0
    },
    tolerance: Tolerance {
        absolute: 1e-3,
        relative: 1e-4,
        outliers: 1e-2,
        reason: "guides are read at the nearest pixel, and which one is nearest, or the last within the \
                 cut-off, may turn on the last bit of the slope",
    },
});

/// Response, in units of L, that a break of geometry takes off at weight 1: next to the break the
/// line is then as dark as at a step of about 12 units of L. Much more would let relief as fine as
/// the lines themselves, such as flutes of a distant column, run together.
const AMOUNT: f32 = 4.0;

/// `response` (u alpha, alpha) with lines of strength `weight` where the guides, that is normal, depth
/// and object id as far as there are any, break; `edge` is the weight of the difference of Gaussians
/// in the response.
pub fn add(
    plan: &mut PlanBuilder,
    response: ImageId,
    field: ImageId,
    guides: [Option<ImageId>; 3],
    sigma: f32,
    k: f32,
    weight: f32,
    edge: f32,
) -> ImageId {
    let halfwidth = halfwidth(sigma, k);
    let params = Params {
        narrow: -0.5 / (sigma * sigma).max(1e-6),
        halfwidth,
        amount: AMOUNT * weight * edge,
        guides: (0..3).map(|i| u32::from(guides[i].is_some()) << i).sum(),
    };
    // A guide that is not there is not read; any image may stand in for it.
    let [normal, depth, id] = guides.map(|guide| guide.unwrap_or(response));
    let support = Support::Pixels(halfwidth as u32 + 1);
    plan.pass(&KERNEL, &[response, field, normal, depth, id], &params, Class::Field, support)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => breaks(simd, pass, &params, band));
}

#[inline(always)]
fn breaks<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let [response, field, normal, depth, object_id] = pass.inputs else { return };
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let has = |bit: u32| params.guides & bit != 0;
    for_blocks::<2>(band, #[inline(always)] |block, target| {
        let orientation = block.read2(simd, field);
        let line = Across::new(simd, &block, orientation);
        let at = line.at;
        let n0 = if has(1) { normals(simd, normal, at) } else { [zero; 3] };
        let z0 = if has(2) { depths(simd, depth, at) } else { zero };
        let id0 = if has(4) { ids(simd, object_id, at) } else { zero };
        let (mut sums, mut weights) = ([zero; 3], one);
        for k in 1..=params.halfwidth as i32 {
            let d = line.step * k as f32;
            let w = d.simd_le(params.halfwidth).select((d * params.narrow * d).exp(), zero);
            weights += w * 2.0;
            let (ahead, behind) = (line.nearest(k), line.nearest(-k));
            if has(1) {
                let a = normal_break(n0, normals(simd, normal, ahead));
                let b = normal_break(n0, normals(simd, normal, behind));
                sums[0] += w * (a + b);
            }
            if has(2) {
                let a = relative_nearness(z0, depths(simd, depth, ahead));
                let b = relative_nearness(z0, depths(simd, depth, behind));
                sums[1] += w * ramp(((a + b - 2.0).abs() - 0.02) * 10.0);
            }
            if has(4) {
                let a = ids(simd, object_id, ahead).simd_eq(id0).select(zero, one);
                let b = ids(simd, object_id, behind).simd_eq(id0).select(zero, one);
                sums[2] += w * (a + b);
            }
        }
        let past = sums[0].max(sums[1]).max(sums[2]) / weights;
        let [u, alpha] = block.read2(simd, response);
        write2([u - past * params.amount * alpha, alpha], target);
    });
}

#[inline(always)]
fn finite<S: Simd>(v: f32x8<S>) -> mask32x8<S> {
    v.abs().simd_le(f32::MAX)
}

/// Normals, all zero where there is none.
#[inline(always)]
fn normals<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> [f32x8<S>; 3] {
    let [x, y, z, w] = fetch4(simd, view, offsets(view, x, y));
    let valid = finite(x) & finite(y) & finite(z) & w.simd_gt(0.5);
    let zero = f32x8::splat(simd, 0.0);
    [valid.select(x, zero), valid.select(y, zero), valid.select(z, zero)]
}

/// Depths, 0 where there is nothing.
#[inline(always)]
fn depths<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> f32x8<S> {
    let z = fetch1(simd, view, offsets(view, x, y));
    (finite(z) & z.simd_gt(0.0)).select(z, f32x8::splat(simd, 0.0))
}

#[inline(always)]
fn ids<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> f32x8<S> {
    let id = fetch1(simd, view, offsets(view, x, y));
    finite(id).select(id, f32x8::splat(simd, 0.0))
}

/// t^2 (3 - 2 t) of t clamped to 0..=1.
#[inline(always)]
fn ramp<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    let t = t.max(0.0).min(1.0);
    t * t * (t * -2.0 + 3.0)
}

/// 0 for equal directions or two missing normals, 1 for perpendicular ones or one that is missing.
/// Below 18 degrees it is relief of the surface, from 41 degrees on an edge.
#[inline(always)]
fn normal_break<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(a[0].simd, 0.0), f32x8::splat(a[0].simd, 1.0));
    let (aa, bb) = (dot(a, a), dot(b, b));
    let (has_a, has_b) = (aa.simd_gt(0.0), bb.simd_gt(0.0));
    let both = has_a & has_b;
    let turn = one - dot(a, b) / both.select(aa * bb, one).sqrt();
    let lone = (has_a | has_b).select(one, zero);
    both.select(ramp((turn - 0.05) * 5.0), lone)
}

#[inline(always)]
fn dot<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Nearness relative to the pixel itself, 0..=2; two empty places are equally near.
#[inline(always)]
fn relative_nearness<S: Simd>(z0: f32x8<S>, z: f32x8<S>) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(z0.simd, 0.0), f32x8::splat(z0.simd, 1.0));
    let there = z.simd_gt(0.0);
    let near = there.select((z0 / there.select(z, one)).min(2.0), zero);
    z0.simd_gt(0.0).select(near, there.select(one + 1.0, one))
}
