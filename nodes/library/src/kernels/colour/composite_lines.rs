//! Draws lines over a picture, or over paper in its place (§ 4.6); coverage stays.
//!
//! Cost: eight multiply-adds per pixel.

pub use crate::kernels::shaders::composite_lines::Params;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(composite_lines {
    cpu: run,
    cost: |_| 10.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "a few roundings"),
});

/// Draws the `edges` (1 = paper, 0 = line) over `color`. The alpha of `line` is the opacity of lines,
/// that of `paper` how much of the picture the paper covers.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, edges: ImageId, params: &Params) -> ImageId {
    plan.pass(&KERNEL, &[color, edges], params, Class::Colour, Support::Pixels(0))
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let (source, edges) = (&pass.inputs[0], &pass.inputs[1]);
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let [r, g, b, a] = block.read(simd, source);
        let [edge] = block.read(simd, edges);
        let ink = (f32x8::splat(simd, 1.0) - edge.within(0.0, 1.0)) * params.line[3];
        let [r, g, b] = [over(r, ink, &params, 0), over(g, ink, &params, 1), over(b, ink, &params, 2)];
        write([r, g, b, a], target);
    }));
}

/// Channel `i` of the paper and then the line over `v`.
#[inline(always)]
fn over<S: Simd>(v: f32x8<S>, ink: f32x8<S>, params: &Params, i: usize) -> f32x8<S> {
    let (line, paper) = (f32x8::splat(v.simd, params.line[i]), f32x8::splat(v.simd, params.paper[i]));
    let base = v + (paper - v) * params.paper[3];
    base + ink * (line - base)
}
