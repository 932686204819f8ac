//! Share of what is around a pixel that is clear structure, in place of texture and blur, and its weight.
//!
//! Across an edge the energy of gradients, a square, falls with the first power of the width over which they are taken, and
//! with the fourth in noise, where neighbours tell nothing of each other; across a soft edge it hardly falls. Their ratio at two
//! scales therefore tells lone edges from texture and from what is out of focus (as edges of scale space do: Lindeberg, *Edge
//! detection and ridge detection with automatic scale selection*, 1998).
//!
//! Cost: a square root and two divisions per pixel.

pub use crate::kernels::shaders::clear_structure::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(clear_structure {
    block: |simd, pass, params| |block| clear(
        &params,
        block.read(simd, &pass.inputs[0]),
        block.read(simd, &pass.inputs[1])
    ),
    cost: |_| 50.0,
    tolerance: Tolerance {
        absolute: 2e-5,
        relative: 2e-5,
        outliers: 1e-3,
        reason: "a ratio of small numbers, in ramps",
    },
});

/// Ratios between which texture becomes structure, and between which structure becomes blur.
const TEXTURE: [f32; 2] = [0.2, 0.65];
const BLUR: [f32; 2] = [1.6, 2.8];

/// Energy that counts at most: that of highlights may be infinite.
const MOST: f32 = 1e6;

/// (weight share, weight) of mean tensors of fine and of coarse gradients, both at the level of the result.
pub fn pass(plan: &mut PlanBuilder, [fine, coarse]: [ImageId; 2], params: &Params) -> ImageId {
    plan.pass(&KERNEL, &[fine, coarse], params, Class::Field, Support::Pixels(0))
}

#[inline(always)]
fn clear<S: Simd>(
    params: &Params,
    [fine_x, _, fine_y, _]: [f32x8<S>; 4],
    [coarse_x, _, coarse_y, _]: [f32x8<S>; 4],
) -> [f32x8<S>; 4] {
    let (zero, one) = (f32x8::splat(fine_x.simd, 0.0), f32x8::splat(fine_x.simd, 1.0));
    let energy = (coarse_x + coarse_y).within(0.0, MOST) * params.area;
    let all = (fine_x + fine_y).within(0.0, MOST);
    let ratio = energy * params.ratio / (all + 1e-9);
    let gradient = energy.sqrt();
    let weight = gradient / (gradient + params.half_gradient);
    let clear = ramp(TEXTURE, ratio) * (one - ramp(BLUR, ratio));
    [weight * clear, weight, zero, one]
}

/// A smooth step from 0 at the first end to 1 at the second.
#[inline(always)]
fn ramp<S: Simd>([from, to]: [f32; 2], x: f32x8<S>) -> f32x8<S> {
    let t = ((x - from) / (to - from)).within(0.0, 1.0);
    t * t * (t * -2.0 + 3.0)
}
