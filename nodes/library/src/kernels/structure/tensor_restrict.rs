//! One level of the pyramid of valid tensors up: the mean of the valid among four pixels, and whether
//! there was any (§ 2.7.3, Listing 2.4). At odd sizes the missing children count for nothing. With all
//! counted as valid it is the mean of four.
//!
//! Cost: 4 additions and a division on four channels.

pub use crate::kernels::shaders::tensor_restrict::Params;
use crate::kernels::simd::children::for_children;
use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tensor_restrict {
    cpu: |simd, pass, params, band| means(simd, pass, &params, band),
    cost: |_| 24.0,
    tolerance: Tolerance::of_rounding(1e-7, 2e-6, "three additions in the same order and a division"),
});

/// Adds the pass: from the image's level to the next coarser one, ceil(n / 2) pixels on a side.
pub fn pass(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    coarser(plan, tensor, 1.0)
}

/// Adds the pass that takes the mean of all four, valid or not, also of w.
pub fn pass_mean(plan: &mut PlanBuilder, tensor: ImageId) -> ImageId {
    coarser(plan, tensor, -1.0)
}

fn coarser(plan: &mut PlanBuilder, tensor: ImageId, kept: f32) -> ImageId {
    let level = plan.desc(tensor).level + 1;
    plan.pass_at(&KERNEL, &[tensor], &Params { kept }, &[Class::Field], Support::Pixels(0), level)
}

#[inline(always)]
fn means<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    for_children(
        &pass.inputs[0],
        band,
        #[inline(always)]
        |upper, lower, target| {
            let (mut sum, mut count) = (f32x4::splat(simd, 0.0), 0.0);
            for t in upper.chunks_exact(4).chain(lower.chunks_exact(4)) {
                if t[3] >= params.kept {
                    sum += f32x4::from_slice(simd, t);
                    count += 1.0f32;
                }
            }
            (sum / count.max(1.0)).store_slice(target);
        },
    );
}
