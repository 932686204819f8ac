//! Motion over several frames: what was found so far, and the next step at the place that it leads to.
//!
//! The step is read as it enters the plan, so that frames that are not computed here are read however far away.
//!
//! Cost: one bilinear sample of two channels and about 40 operations.

pub use crate::kernels::shaders::motion_chain::Params;
use crate::kernels::shared::motion::{UNKNOWN, bounded, is_inside, is_known, motion_at};
use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(motion_chain {
    block: |simd, pass, params| |block| chained(simd, pass, block, &params),
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the differences of neighbours, and what goes to the other side of a \
                 border or a limit on the last bit",
    },
});

/// The motion `so_far`, and then that of `steps` in the frame that it leads to, which may hold anything; `longest` is
/// the longest step that counts, pixels, and `count` the number of steps with this one.
pub fn pass(plan: &mut PlanBuilder, so_far: ImageId, steps: ImageId, longest: f32, count: u32) -> ImageId {
    let reach = (longest * (count - 1) as f32).ceil() as u32 + 1;
    let params = Params { step: longest, limit: longest * count as f32 };
    let supports = [Support::Pixels(0), Support::Pixels(reach)];
    plan.pass_reaching(&KERNEL, &[so_far, steps], &params, &[Class::Field], &supports, 0)
}

#[inline(always)]
fn chained<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block, params: &Params) -> [f32x8<S>; 2] {
    let found: [f32x8<S>; 2] = block.read(simd, &pass.inputs[0]);
    let (zero, known) = (f32x8::splat(simd, 0.0), is_known(found));
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + known.select(found[0], zero), cy + known.select(found[1], zero));
    let second = motion_at(simd, &pass.inputs[1], x, y, params.step);
    let whole = bounded([found[0] + second[0], found[1] + second[1]], params.limit);
    let (going_on, inside) = (is_known(second), is_inside(x, y, pass.inputs[1].full()));
    let unknown = f32x8::splat(simd, UNKNOWN);
    let mut result = whole;
    for v in &mut result {
        *v = known.select(going_on.select(inside.select(*v, unknown), unknown), unknown);
    }
    result
}
