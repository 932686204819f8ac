//! Densification (Kroeger et al. 2016, eq. 3): the mean of the motions of the four patches that hold a pixel, each the
//! less the more the brightness differs that it takes the pixel to.
//!
//! Four pixels in a row and in a column share their four patches, and with each the place between the pixels that it
//! takes them to.
//!
//! Cost: 80 operations.

use isophote_engine::fearless_simd::{Simd, f32x4, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

/// Pixels from patch to patch.
const STRIDE: i32 = 4;
/// Levels of brightness to 1; differences of one level or less count alike.
const LEVELS: f32 = 255.0;

crate::kernel!(patch_vote {
    cpu: |simd, pass, band| votes(simd, pass, band),
    cost: |_| 80.0,
    tolerance: Tolerance::of_rounding(
        1e-4,
        1e-5,
        "a mean of four by weights that grow with differences of brightness in levels of 1/255"
    ),
});

/// The motion of every pixel of `here`, from those of patches ([`inverse_search`](super::inverse_search)) that are at
/// most `reach` pixels long along x and along y.
pub fn pass(plan: &mut PlanBuilder, [here, there]: [ImageId; 2], patches: ImageId, reach: u32) -> ImageId {
    // The four pixels that are computed together, and one for the interpolation.
    let support = Support::Pixels(reach + STRIDE as u32 + 1);
    plan.pass(&KERNEL, &[here, there, patches], &(), Class::Field, support)
}

#[inline(always)]
fn votes<S: Simd>(simd: S, pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let window = band.window;
    let [here, there, patches] = [&pass.inputs[0], &pass.inputs[1], &pass.inputs[2]];
    // The first pixel whose patches are those of pixel x; patches hold the pixels 4 i - 2 to 4 i + 5.
    let first = |x: i32| ((x - 2) >> 2) * STRIDE + 2;
    let mut scratch = Vec::new();
    for y in window.y0..window.y1 {
        let start = first(window.x0);
        let end = first(window.x1 - 1) + STRIDE;
        let origins = here.padded_row(y, start, end, &mut scratch);
        let row = band.row_mut(0, y);
        for x in (start..end).step_by(STRIDE as usize) {
            let origin = f32x4::from_slice(simd, &origins[(x - start) as usize..][..4]);
            let [across, along] = [(x - 2) >> 2, (y - 2) >> 2];
            let zero = f32x4::splat(simd, 0.0);
            let (mut sums, mut weights) = ([zero; 2], zero);
            for i in 0..4 {
                let at = patches.offset(across + (i & 1), along + (i >> 1));
                let motion = [patches.data()[at], patches.data()[at + 1]];
                let off = (brightness(simd, there, [x, y], motion) - origin).abs();
                let weight = f32x4::splat(simd, 1.0) / (off * LEVELS).at_least(1.0f32);
                sums = [weight.mul_add(motion[0], sums[0]), weight.mul_add(motion[1], sums[1])];
                weights += weight;
            }
            let [u, v] = [(sums[0] / weights).to_array(), (sums[1] / weights).to_array()];
            for i in 0..STRIDE {
                if (window.x0..window.x1).contains(&(x + i)) {
                    let at = 2 * (x + i - window.x0) as usize;
                    row[at..at + 2].copy_from_slice(&[u[i as usize], v[i as usize]]);
                }
            }
        }
    }
}

/// The brightness that a motion takes four pixels in a row to, the first one at (x, y).
#[inline(always)]
fn brightness<S: Simd>(simd: S, view: &View<'_>, [x, y]: [i32; 2], motion: [f32; 2]) -> f32x4<S> {
    let whole = motion.map(f32::floor);
    let (x, y, window) = (x + whole[0] as i32, y + whole[1] as i32, view.window());
    let mut copy = [0.0; 10];
    let inside = x >= window.x0 && y >= window.y0 && x + 5 <= window.x1 && y + 2 <= window.y1;
    let (pixels, stride) = if inside {
        (&view.data()[view.offset(x, y)..], view.stride())
    } else {
        for i in 0..5 {
            copy[i as usize] = view.pixel1(x + i, y);
            copy[5 + i as usize] = view.pixel1(x + i, y + 1);
        }
        (copy.as_slice(), 5)
    };
    let (fx, fy) = (motion[0] - whole[0], motion[1] - whole[1]);
    let top = between(simd, pixels, fx);
    let bottom = between(simd, &pixels[stride..], fx);
    (bottom - top).mul_add(f32x4::splat(simd, fy), top)
}

/// Four values, each between two neighbours of a row.
#[inline(always)]
fn between<S: Simd>(simd: S, row: &[f32], share: f32) -> f32x4<S> {
    let (left, right) = (f32x4::from_slice(simd, &row[..4]), f32x4::from_slice(simd, &row[1..5]));
    (right - left).mul_add(f32x4::splat(simd, share), left)
}
