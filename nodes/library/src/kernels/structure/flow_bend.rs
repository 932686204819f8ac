//! Tensors bent towards a smoothed [flow field](super::flow_field): by its share w they give way to tensors of the
//! same trace whose tangent is the painted one, so that what the filters know of the picture's strength stays.
//!
//! Cost: about 15 operations.

use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(flow_bend {
    cpu: run,
    cost: |_| 15.0,
    tolerance: Tolerance::of_rounding(1e-7, 2e-6, "a handful of roundings"),
});

/// Trace that painted orientation has where the picture has none: (1/255)^2, one step of eight bits a pixel.
const LEAST_TRACE: f32 = 1.537_870_1e-5;

/// Adds the pass.
pub fn pass(plan: &mut PlanBuilder, tensors: ImageId, flow: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[tensors, flow], &(), Class::Field, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        let own: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let painted: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
        let share = painted[3].within(zero, one);
        let trace = (own[0] + own[2]).at_least(f32x8::splat(simd, LEAST_TRACE));
        let mut bent = [own[3] + (one - own[3]) * share; 4];
        for c in 0..3 {
            bent[c] = (one - share) * own[c] + trace * painted[c];
        }
        write(bent, target);
    }));
}
