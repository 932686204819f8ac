//! One level of the pyramid down: tensors that are not valid take those of the coarser level,
//! interpolated bilinearly; valid ones stay (§ 2.7.3, Listing 2.5).
//!
//! Cost: 3 multiply-adds on four channels, one of them shared by the pixels between two coarse ones.

pub use crate::kernels::shaders::tensor_interpolate::Params;
use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(tensor_interpolate {
    cpu: |simd, pass, params, band| fill(simd, pass, &params, band),
    cost: |_| 16.0,
    tolerance: Tolerance::of_rounding(
        1e-6,
        4e-6,
        "three interpolations with exact weights, along y and along x first"
    ),
});

/// Adds the pass; `coarse` lies one level above `fine`.
pub fn pass(plan: &mut PlanBuilder, fine: ImageId, coarse: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[fine, coarse], &Params { kept: 1.0 }, Class::Field, Support::Pixels(1))
}

/// Adds the pass: `coarse` at the level of `fine`, one below, whose values do not matter.
pub fn pass_to(plan: &mut PlanBuilder, fine: ImageId, coarse: ImageId) -> ImageId {
    let params = Params { kept: f32::MAX };
    plan.pass(&KERNEL, &[fine, coarse], &params, Class::Field, Support::Pixels(1))
}

#[inline(always)]
fn fill<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let (fine, coarse) = (&pass.inputs[0], &pass.inputs[1]);
    // The coarse pixel before position (x + 1/2) / 2, and how far beyond its centre that lies.
    let corner = |x: i32| (x - 1) >> 1;
    let fraction = |x: i32| if x & 1 == 0 { 0.75f32 } else { 0.25 };
    let (first, last) = (corner(window.x0), corner(window.x1 - 1) + 2);
    let (mut above, mut below) = (Vec::new(), Vec::new());
    let mut between = vec![0.0; 4 * (last - first) as usize];
    let tensor = f32x4::simd_from(simd, [1.0, 1.0, 1.0, 0.0]);
    for y in window.y0..window.y1 {
        let above = coarse.padded_row(corner(y), first, last, &mut above);
        let below = coarse.padded_row(corner(y) + 1, first, last, &mut below);
        let fy = f32x4::splat(simd, fraction(y));
        // Plain loops: adapters of iterators stay calls in code for wide vectors.
        for i in (0..between.len()).step_by(4) {
            let (a, b) = (load(simd, above, i), load(simd, below, i));
            (b - a).mul_add(fy, a).store_slice(&mut between[i..i + 4]);
        }
        let at = fine.offset(window.x0, y);
        let source = &fine.data()[at..at + 4 * window.width() as usize];
        let target = &mut band.row_mut(0, y)[..source.len()];
        for n in (0..source.len()).step_by(4) {
            let x = window.x0 + n as i32 / 4;
            let i = 4 * (corner(x) - first) as usize;
            let (a, b) = (load(simd, &between, i), load(simd, &between, i + 4));
            let mixed = (b - a).mul_add(f32x4::splat(simd, fraction(x)), a) * tensor;
            // A selection of values: branches on validity would be mispredicted.
            let valid = f32x4::splat(simd, source[n + 3]).simd_ge(params.kept);
            valid.select(load(simd, source, n), mixed).store_slice(&mut target[n..n + 4]);
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &[f32], i: usize) -> f32x4<S> {
    f32x4::from_slice(simd, &row[i..i + 4])
}
