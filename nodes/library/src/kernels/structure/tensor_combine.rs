//! One step of the multi-scale estimation from coarse to fine (§ 2.8): the smoothed tensor of a level
//! and the upsampled result of the next coarser one, weighted by their anisotropies (2.172, 2.173). That of the
//! coarser level is upsampled itself: an interpolated tensor is less anisotropic than those that it lies between.
//!
//! Derivatives of a level are per pixel of its own, as in the thesis: a coarse tensor of a smooth place is
//! four times the fine one, and that of noise is not. Counting all in the picture's pixels would let fine
//! noise outvote coarse structure.
//!
//! Cost: 3 bilinear multiply-adds on five channels, five anisotropies, about 110 operations.

use crate::kernels::shared::sampling::fetch4;
use crate::kernels::shared::tensor::anisotropy;
use crate::kernels::simd::pixels::{for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

/// Sum of both anisotropies up to which the finer tensor stays.
const LEAST: f32 = 1e-6;

crate::kernel!(tensor_combine {
    cpu: |simd, pass, band| weighted(simd, pass, band),
    cost: |_| 120.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 1e-4,
        outliers: 0.002,
        reason: "the anisotropy of a nearly isotropic tensor is a difference that loses digits, and two \
                 such ones make a weight",
    },
});

/// Adds the pass; `coarse` lies one level above `fine`.
pub fn pass(plan: &mut PlanBuilder, fine: ImageId, coarse: ImageId) -> ImageId {
    plan.pass(&KERNEL, &[fine, coarse], &(), Class::Field, Support::Pixels(1))
}

#[inline(always)]
fn weighted<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let (fine, coarse) = (&pass.inputs[0], &pass.inputs[1]);
    let c = |v: f32| f32x8::splat(simd, v);
    for_blocks::<4>(
        band,
        #[inline(always)]
        |block, target| {
            let own: [f32x8<S>; 4] = block.read(simd, fine);
            let x = (block.columns(simd).to_float::<f32x8<S>>() + 0.5) * 0.5;
            let [e, f, g, w, above] = upsampled(simd, coarse, x, c(0.5 * (block.y as f32 + 0.5)));
            let other = [e, f, g, w];
            let a = anisotropy(own[0], own[1], own[2]);
            let sum = a + above;
            let alpha = sum.simd_gt(c(LEAST)).select(a / sum, c(1.0));
            let mut result = own;
            for i in 0..4 {
                result[i] = other[i] + (own[i] - other[i]) * alpha;
            }
            write(result, target);
        },
    );
}

/// The tensors at (x, y), and their anisotropies, both interpolated bilinearly.
#[inline(always)]
fn upsampled<S: Simd>(simd: S, coarse: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 5] {
    let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
    let (fx, fy) = (x - 0.5 - left, y - 0.5 - top);
    let (left, top): (i32x8<S>, i32x8<S>) = (left.to_int(), top.to_int());
    let mut corners = [[fx; 5]; 4];
    for (corner, [dx, dy]) in corners.iter_mut().zip([[0, 0], [1, 0], [0, 1], [1, 1]]) {
        let [e, f, g, w] = fetch4(simd, coarse, left + dx, top + dy);
        *corner = [e, f, g, w, anisotropy(e, f, g)];
    }
    let mut result = corners[0];
    for (i, value) in result.iter_mut().enumerate() {
        let [a, b, c, d] = [corners[0][i], corners[1][i], corners[2][i], corners[3][i]];
        let upper = (b - a).mul_add(fx, a);
        let lower = (d - c).mul_add(fx, c);
        *value = (lower - upper).mul_add(fy, upper);
    }
    result
}
