//! Breaks of geometry between neighbouring pixels. Twin of `shaders/shared/breaks.wgsl`.
//!
//! 1/z is linear in x and y over any plane, so z0/z+ + z0/z- - 2 is 0 on planes however slanted, and has no scale.

use crate::kernels::simd::pixels::{fetch1, fetch4, offsets};
use isophote_engine::View;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};

#[inline(always)]
fn finite<S: Simd>(v: f32x8<S>) -> mask32x8<S> {
    v.abs().simd_le(f32::MAX)
}

/// Normals, all zero where there is none.
#[inline(always)]
pub fn normals<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> [f32x8<S>; 3] {
    let [x, y, z, w] = fetch4(simd, view, offsets(view, x, y));
    let valid = finite(x) & finite(y) & finite(z) & w.simd_gt(0.5);
    let zero = f32x8::splat(simd, 0.0);
    [valid.select(x, zero), valid.select(y, zero), valid.select(z, zero)]
}

/// Depths, 0 where there is nothing.
#[inline(always)]
pub fn depths<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> f32x8<S> {
    let z = fetch1(simd, view, offsets(view, x, y));
    (finite(z) & z.simd_gt(0.0)).select(z, f32x8::splat(simd, 0.0))
}

/// Object numbers, 0 where there is none.
#[inline(always)]
pub fn ids<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32x8<S>; 2]) -> f32x8<S> {
    let id = fetch1(simd, view, offsets(view, x, y));
    finite(id).select(id, f32x8::splat(simd, 0.0))
}

/// t^2 (3 - 2 t) of t clamped to 0..=1.
#[inline(always)]
fn ramp<S: Simd>(t: f32x8<S>) -> f32x8<S> {
    let t = t.within(0.0, 1.0);
    t * t * (t * -2.0 + 3.0)
}

/// Difference of two directions, 0 for equal and 1 for perpendicular ones, and 1 where one is missing and the other
/// not. Below 10 degrees a pixel it is relief of the surface, from 31 degrees on an edge.
#[inline(always)]
pub fn normal_break<S: Simd>(a: [f32x8<S>; 3], b: [f32x8<S>; 3]) -> [f32x8<S>; 2] {
    let (zero, one) = (f32x8::splat(a[0].simd, 0.0), f32x8::splat(a[0].simd, 1.0));
    let (aa, bb) = (dot(a, a), dot(b, b));
    let (has_a, has_b) = (aa.simd_gt(0.0), bb.simd_gt(0.0));
    let both = has_a & has_b;
    let turn = one - dot(a, b) / both.select(aa * bb, one).sqrt();
    let lone = (has_a | has_b).select(one, zero);
    [both.select(ramp((turn - 0.015) * 8.0), zero), both.select(zero, lone)]
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
    let near = there.select((z0 / there.select(z, one)).at_most(2.0), zero);
    z0.simd_gt(0.0).select(near, there.select(one + 1.0, one))
}

/// Distance of the depth at the middle one of three pixels from a plane through its neighbours; both pixels
/// at a jump are.
#[inline(always)]
pub fn depth_bend<S: Simd>(before: f32x8<S>, z0: f32x8<S>, after: f32x8<S>) -> f32x8<S> {
    (relative_nearness(z0, before) + relative_nearness(z0, after) - 2.0).abs()
}

/// Break of depth between two pixels off the planes of their neighbours, 0..=1: both at a jump are. A step of 2 % is relief,
/// one of 12 % an edge.
#[inline(always)]
pub fn depth_break<S: Simd>(bend: f32x8<S>, next_bend: f32x8<S>) -> f32x8<S> {
    ramp((bend.at_most(next_bend) - 0.02) * 10.0)
}

/// 1/z, 0 where there is nothing.
#[inline(always)]
pub fn nearness<S: Simd>(z: f32x8<S>) -> f32x8<S> {
    let (zero, one) = (f32x8::splat(z.simd, 0.0), f32x8::splat(z.simd, 1.0));
    z.simd_gt(0.0).select(one / z.at_least(1e-30), zero)
}

/// Relative jump of nearness from which on two surfaces do not touch.
pub const APART: f32 = 0.06;

/// Distance in depth of two surfaces half-way between two pixels that are three apart: relative jump of 1/z from the plane
/// through the first of them and one two pixels before it to that through the others. Depth may be smoothed between them.
#[inline(always)]
pub fn depth_apart<S: Simd>([first, second, third, fourth]: [f32x8<S>; 4]) -> f32x8<S> {
    let before = second + (second - first) * 0.75;
    let after = third + (third - fourth) * 0.75;
    (after - before).abs() / before.abs().at_least(after.abs()).at_least(1e-30)
}
