//! Two paintings of one picture, whose strokes are at different places, faded into one another. The mean of two that have
//! nothing in common would be fainter than each: how far it is from the picture is made as much as that of both, so that
//! paint does not pulsate.
//!
//! Cost: about 40 operations.

pub use crate::kernels::shaders::stroke_fade::Params;
use crate::kernels::simd::pixels::Block;
use isophote_engine::bounds::Bounds;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(stroke_fade {
    cpu: |simd, pass, params, band| fade(simd, pass, &params, band),
    cost: |_| 60.0,
    tolerance: Tolerance::of_rounding(
        2e-3,
        1e-5,
        "where two paintings are nearly opposites, a root of their difference"
    ),
});

/// Adds the pass: the paintings `first` and `second` of `picture`, each in Lab and with the heights of its paint, of which
/// the second has a `share`. Returns the painting and its heights.
pub fn pass(
    plan: &mut PlanBuilder,
    picture: ImageId,
    [first, second]: [[ImageId; 2]; 2],
    share: f32,
) -> [ImageId; 2] {
    let params = Params { share };
    let inputs = [picture, first[0], first[1], second[0], second[1]];
    let classes = [Class::Colour, Class::Field];
    let level = plan.desc(picture).level;
    let painted = plan.pass_reaching(&KERNEL, &inputs, &params, &classes, &[Support::Pixels(0); 5], level);
    [painted, plan.sibling(painted, 1)]
}

/// Height about which paint is.
const MIDDLE: f32 = 0.55;
/// Units of Lab that a unit of height counts.
const HEIGHT: f32 = 20.0;
/// Largest gain of the mean of both, so that half of each shows as much as one alone.
const MOST: f32 = 1.6;

#[inline(always)]
fn fade<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    for y in window.y0..window.y1 {
        for x in (window.x0..window.x1).step_by(8) {
            let block = Block::until(window.x1, x, y);
            let [colours, heights] = faded(simd, pass, params, &block);
            block.write(colours, band, 0);
            block.write(heights, band, 1);
        }
    }
}

#[inline(always)]
fn faded<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: &Block) -> [[f32x8<S>; 4]; 2] {
    let one = f32x8::splat(simd, 1.0);
    let [l, a, b, alpha]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[0]);
    let mut paintings = [[one; 4]; 2];
    for (painting, of) in paintings.iter_mut().zip([1, 3]) {
        let [pl, pa, pb, _]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[of]);
        let [height, ..]: [f32x8<S>; 4] = block.read(simd, &pass.inputs[of + 1]);
        *painting = [pl - l, pa - a, pb - b, (height - MIDDLE) * HEIGHT];
    }
    let square = |v: [f32x8<S>; 4]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3];
    let [first, second] = paintings;
    let (rest, share) = (1.0 - params.share, params.share);
    let mut mean = [one; 4];
    for i in 0..4 {
        mean[i] = first[i] * rest + second[i] * share;
    }
    let wanted = square(first) * rest + square(second) * share;
    let gain = (wanted / square(mean).at_least(one * 1e-6)).sqrt().at_most(one * MOST);
    let height = mean[3] * gain * (1.0 / HEIGHT) + MIDDLE;
    [[l + mean[0] * gain, a + mean[1] * gain, b + mean[2] * gain, alpha], [height, height, height, one]]
}
