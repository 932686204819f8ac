//! Simplified colours, and those of before where the two differ much: what is small and plain to see stays, as letters,
//! eyes and twigs; what is small and faint goes. Differences count against the light that is there.
//!
//! Cost: 25 multiply-adds and a division per pixel.

pub use crate::kernels::shaders::keep_detail::Params;
use isophote_engine::fearless_simd::{f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(keep_detail {
    block: |simd, pass, params| |block| {
        let simple: [f32x8<_>; 4] = block.read(simd, &pass.inputs[0]);
        let v: [f32x8<_>; 4] = block.read(simd, &pass.inputs[1]);
        let d = [v[0] - simple[0], v[1] - simple[1], v[2] - simple[2]];
        let light = (simple[0] * 0.2126 + simple[1] * 0.7152 + simple[2] * 0.0722).within(0.0, 1.0);
        let difference = d[0].abs().at_least(d[1].abs().at_least(d[2].abs())) / (light + 0.35);
        let t = ((difference - params.faint) * params.inverse).within(0.0, 1.0);
        let kept = t * t * (t * -2.0 + 3.0);
        [simple[0] + kept * d[0], simple[1] + kept * d[1], simple[2] + kept * d[2], simple[3]]
    },
    cost: |_| 30.0,
    tolerance: Tolerance::of_rounding(2e-5, 5e-6, "a step magnifies the rounding of differences"),
});

/// `simple` where it differs from `color` by less than `faint`, and `color` where it does by more than `plain`; differences
/// are the greatest of the three channels.
pub fn pass(plan: &mut PlanBuilder, simple: ImageId, color: ImageId, [faint, plain]: [f32; 2]) -> ImageId {
    let params = Params { faint, inverse: 1.0 / (plain - faint).max(1e-3) };
    plan.pass(&KERNEL, &[simple, color], &params, Class::Colour, Support::Pixels(0))
}
