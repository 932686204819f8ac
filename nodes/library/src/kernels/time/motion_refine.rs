//! One step of the variational refinement (Kroeger et al. 2016, 3.3; the terms are those of T. Brox et al., *High
//! Accuracy Optical Flow Estimation Based on a Theory for Warping*, 2004): brightness and its gradient stay constant
//! along the motion and the motion is smooth, all of them but for outliers, which count by their distance and not by
//! its square. The constraints are normalised by their gradients (H. Zimmer et al. 2011), so that they are distances.
//!
//! A step is one of Jacobi's with the robust weights of the motion before it. It is extrapolated as by D. Hafner et
//! al., *FSI Schemes: Fast Semi-Iterative Solvers for PDEs and Optimisation Methods*, 2016, which brings n steps as far
//! as n^2 plain ones.
//!
//! Cost: 170 operations, four roots and eleven divisions among them; on GPUs, where each pixel computes all of its sides, 200,
//! with six and thirteen.

pub use crate::kernels::shaders::motion_refine::Params;
use crate::kernels::simd::around::{Around, rows};
use crate::kernels::simd::pixels::{BLOCK, Block, eight, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::memory::resize;
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

/// Weight of the gradient's constancy against that of the brightness.
const GRADIENT: f32 = 2.0;
/// Weight of smoothness against the same.
const SMOOTHNESS: f32 = 3.0;
/// Square of what tells an outlier, in pixels.
const OUTLIER: f32 = 1e-6;
/// Square of what tells a break of the field, in pixels per pixel.
const BREAK: f32 = 1e-4;
/// Added to squared derivatives, levels of brightness: noise below it is no constraint.
const NOISE: f32 = 0.01;

crate::kernel!(motion_refine {
    cpu: |simd, pass, params, band| steps(simd, pass, &params, band),
    cost: |_| 200.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-4,
        outliers: 0.002,
        reason: "the weight of a constraint that is met to the last bit depends on that bit",
    },
});

/// Options of a refinement, and images that it starts from.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The motion that the other picture was warped by.
    pub motion: ImageId,
    /// The derivatives of what that gave ([`brightness_derivatives`](super::brightness_derivatives)).
    pub derivatives: [ImageId; 2],
    /// Steps.
    pub steps: u32,
}

/// Adds all steps of a refinement.
pub fn pass(plan: &mut PlanBuilder, options: &Options) -> ImageId {
    let Options { motion, derivatives: [first, second], steps } = *options;
    let (mut before, mut now) = (motion, motion);
    for step in 0..steps {
        let momentum = (4 * step + 2) as f32 / (2 * step + 3) as f32;
        let inputs = [first, second, motion, before, now];
        let next = plan.pass_at(
            &KERNEL,
            &inputs,
            &Params { momentum },
            &[Class::Field],
            Support::Pixels(1),
            plan.desc(motion).level,
        );
        (before, now) = (now, next);
    }
    now
}

#[inline(always)]
fn steps<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let mut scratch: [Vec<f32>; 3] = Default::default();
    // A side is one of two pixels, with the same weight to the bit.
    let mut below = Vec::new();
    resize(&mut below, window.width().next_multiple_of(BLOCK as u32) as usize, 0.0_f32);
    for y in window.y0..window.y1 {
        let rows = rows(&pass.inputs[4], y, window, &mut scratch);
        let row = band.row_mut(0, y);
        let mut before = None;
        for x in (window.x0..window.x1).step_by(BLOCK) {
            let block = Block::until(window.x1, x, y);
            let at = (x - window.x0) as usize;
            let around = Around { rows, at, len: block.len };
            let origin = block.read(simd, &pass.inputs[2]);
            let above = (y > window.y0).then(|| eight(simd, &below, at));
            let sides = Sides::of(simd, &around, before, above);
            before = Some(sides.right);
            sides.down.store_slice(&mut below[at..at + BLOCK]);
            let smooth = Smoothness::of(simd, &around, &sides, origin);
            let derivatives = [block.read(simd, &pass.inputs[0]), block.read(simd, &pass.inputs[1])];
            let solution = solved(simd, derivatives, &smooth, around.value(simd, 0, 0), origin);
            let before: [f32x8<S>; 2] = block.read(simd, &pass.inputs[3]);
            let mut next = before;
            for c in 0..2 {
                next[c] = (solution[c] - before[c]).mul_add(f32x8::splat(simd, params.momentum), before[c]);
            }
            write(next, &mut row[2 * at..2 * (at + block.len)]);
        }
    }
}

/// Weights of smoothness across the sides of eight pixels.
struct Sides<S: Simd> {
    left: f32x8<S>,
    right: f32x8<S>,
    up: f32x8<S>,
    down: f32x8<S>,
}

impl<S: Simd> Sides<S> {
    /// The weights, from those across the right sides of the block to the left, and across the lower sides of the block above,
    /// where these are known.
    #[inline(always)]
    fn of(simd: S, around: &Around<'_, 2>, before: Option<f32x8<S>>, above: Option<f32x8<S>>) -> Self {
        let [centre, left, right] =
            [around.value(simd, 0, 0), around.value(simd, -1, 0), around.value(simd, 1, 0)];
        let [up, down] = [around.value(simd, 0, -1), around.value(simd, 0, 1)];
        let (along_y, along_x) = (less(down, up), less(right, left));
        let far_right = less(around.value(simd, 1, 1), around.value(simd, 1, -1));
        let far_down = less(around.value(simd, 1, 1), around.value(simd, -1, 1));
        let right_side = across(simd, less(right, centre), plus(along_y, far_right));
        let down_side = across(simd, less(down, centre), plus(along_x, far_down));
        let left_side = match before {
            Some(before) => before.slide::<7>(right_side),
            None => across(
                simd,
                less(left, centre),
                plus(along_y, less(around.value(simd, -1, 1), around.value(simd, -1, -1))),
            ),
        };
        let up_side = match above {
            Some(above) => above,
            None => across(
                simd,
                less(up, centre),
                plus(along_x, less(around.value(simd, 1, -1), around.value(simd, -1, -1))),
            ),
        };
        Self { left: left_side, right: right_side, up: up_side, down: down_side }
    }
}

/// Terms that smoothness adds at eight pixels.
struct Smoothness<S: Simd> {
    /// Sum of the neighbours' weights.
    weight: f32x8<S>,
    /// Sum of the neighbours, relative to the motion at the start, by their weights.
    pull: [f32x8<S>; 2],
}

impl<S: Simd> Smoothness<S> {
    #[inline(always)]
    fn of(simd: S, around: &Around<'_, 2>, sides: &Sides<S>, origin: [f32x8<S>; 2]) -> Self {
        let [left, right] = [around.value(simd, -1, 0), around.value(simd, 1, 0)];
        let [up, down] = [around.value(simd, 0, -1), around.value(simd, 0, 1)];
        let weights = [sides.left, sides.right, sides.up, sides.down];
        let mut pull = origin;
        for c in 0..2 {
            let row = weights[0] * (left[c] - origin[c]) + weights[1] * (right[c] - origin[c]);
            pull[c] = row + (weights[2] * (up[c] - origin[c]) + weights[3] * (down[c] - origin[c]));
        }
        Self { weight: (weights[0] + weights[1]) + (weights[2] + weights[3]), pull }
    }
}

#[inline(always)]
fn less<S: Simd>(a: [f32x8<S>; 2], b: [f32x8<S>; 2]) -> [f32x8<S>; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
fn plus<S: Simd>(a: [f32x8<S>; 2], b: [f32x8<S>; 2]) -> [f32x8<S>; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Weight of smoothness across one side of a pixel, from the difference across it and the sum of four along it.
#[inline(always)]
fn across<S: Simd>(simd: S, difference: [f32x8<S>; 2], along: [f32x8<S>; 2]) -> f32x8<S> {
    let [x, y] = [along[0] * 0.25, along[1] * 0.25];
    let squares = difference[0] * difference[0] + difference[1] * difference[1] + (x * x + y * y) + BREAK;
    f32x8::splat(simd, SMOOTHNESS) / squares.sqrt()
}

/// The motion that solves Jacobi's equations, from the derivatives x, y, z, xx and xy, yy, xz, yz.
#[inline(always)]
fn solved<S: Simd>(
    simd: S,
    [[ax, ay, az, axx], [bxy, byy, bxz, byz]]: [[f32x8<S>; 4]; 2],
    smooth: &Smoothness<S>,
    centre: [f32x8<S>; 2],
    origin: [f32x8<S>; 2],
) -> [f32x8<S>; 2] {
    let one = f32x8::splat(simd, 1.0);
    let [dx, dy] = less(centre, origin);
    let steep = ax * ax + ay * ay + NOISE;
    let steep_x = axx * axx + bxy * bxy + NOISE;
    let steep_y = bxy * bxy + byy * byy + NOISE;
    let off = az + ax * dx + ay * dy;
    let off_x = bxz + axx * dx + bxy * dy;
    let off_y = byz + bxy * dx + byy * dy;
    let brightness = one / ((off * off / steep + OUTLIER).sqrt() * steep);
    let gradient = one * GRADIENT / (off_x * off_x / steep_x + off_y * off_y / steep_y + OUTLIER).sqrt();
    let (gradient_x, gradient_y) = (gradient / steep_x, gradient / steep_y);

    let xx = brightness * ax * ax + gradient_x * axx * axx + gradient_y * bxy * bxy + smooth.weight;
    let xy = brightness * ax * ay + gradient_x * axx * bxy + gradient_y * bxy * byy;
    let yy = brightness * ay * ay + gradient_x * bxy * bxy + gradient_y * byy * byy + smooth.weight;
    let x = smooth.pull[0] - (brightness * ax * az + gradient_x * axx * bxz + gradient_y * bxy * byz);
    let y = smooth.pull[1] - (brightness * ay * az + gradient_x * bxy * bxz + gradient_y * byy * byz);
    let determinant = xx * yy - xy * xy;
    [origin[0] + (yy * x - xy * y) / determinant, origin[1] + (xx * y - xy * x) / determinant]
}
