//! The colour of the pixel at the place of the greatest noise along the stream line of a tensor field (§ 5.1): a
//! one-dimensional dilation of noise, made visible by the picture (Papari and Petkov 2009, continuous
//! glass patterns). Lines that share their greatest noise share its colour, which makes coherent
//! strokes with sharp borders. Places less than half covered lend no colour, and coverage passes.
//!
//! Cost: 2 length steps per pixel, each one noise sample and two tensor samples with their tangents,
//! about 130 operations.

pub use crate::kernels::shaders::flow_dilation::Params;
use crate::kernels::shared::sampling::{fetch4, sample_linear4};
use crate::kernels::shared::stream::{FieldView, Integrator};
use crate::kernels::shared::tensor::{anisotropy, tangent};
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use crate::kernels::trace::{Lines, both_sides};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(flow_dilation {
    cpu: run,
    cost: |p| 2.0 * f64::from(p.length.floor()) * 130.0 + 60.0,
    tolerance: Tolerance {
        absolute: 2e-3,
        relative: 1e-3,
        outliers: 0.03,
        reason: "stream lines add up roundings, and of two almost equal maxima the last bit decides \
                 which is the greater, with another colour at each",
    },
});

/// Looks `length` pixels to both sides for the maximum of the first channel of `noise`; where `adapted`, (1 + A)^2 / 4
/// times as far, A the anisotropy at the centre as in § 6.3.1.
pub fn pass(
    plan: &mut PlanBuilder,
    color: ImageId,
    tensors: ImageId,
    noise: ImageId,
    length: f32,
    adapted: bool,
) -> ImageId {
    let params = Params { length, adapt: adapted.into() };
    plan.pass(
        &KERNEL,
        &[color, tensors, noise],
        &params,
        Class::Colour,
        Support::Pixels(reach(&params) as u32),
    )
}

/// The most pixels that a sample of a line reads away from the centre.
fn reach(params: &Params) -> i32 {
    params.length.floor() as i32 + 1
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    let field = FieldView::new(pass.inputs[1]);
    dispatch!(pass.level, simd => for_blocks::<4>(band, #[inline(always)] |block, target| {
        let own: [_; 4] = block.read(simd, &pass.inputs[0]);
        let at = brightest(simd, &params, &field, &pass.inputs[2], &block);
        let [x, y] = [at[0].floor().to_int(), at[1].floor().to_int()];
        let [r, g, b, alpha] = fetch4(simd, &pass.inputs[0], x, y);
        let seen = alpha.simd_ge(f32x8::splat(simd, 0.5));
        let values = [seen.select(r, own[0]), seen.select(g, own[1]), seen.select(b, own[2]), own[3]];
        write(values, target);
    }));
}

/// The places of the greatest noise along the lines through a block: the pixel itself, then the side
/// against the tangent, then the other one, whichever is first.
#[inline(always)]
fn brightest<S: Simd>(
    simd: S,
    params: &Params,
    field: &FieldView<'_>,
    noise: &View<'_>,
    block: &Block,
) -> [f32x8<S>; 2] {
    let [x, y] = block.centres(simd);
    let [e, f, g, _] = sample_linear4(simd, &field.tensors, x, y);
    let mut limit = f32x8::splat(simd, params.length);
    if params.adapt != 0 {
        let certain = anisotropy(e, f, g) + 1.0;
        limit *= certain * certain * 0.25;
    }
    limit += 1e-3;
    let own = sample_linear4(simd, noise, x, y)[0];
    let mut most = [own; 2];
    let mut place = [[x, y]; 2];
    let sides = both_sides(simd, block, tangent(e, f, g));
    let mut lines = Lines::new(simd, field, Integrator::Midpoint, sides).only([limit.simd_ge(1.0); 2]);
    lines.trace(
        simd,
        field,
        [f32x8::splat(simd, 1.0); 2],
        usize::MAX,
        #[inline(always)]
        |k, side, point| {
            let line = &point.line;
            let value = sample_linear4(simd, noise, line.x, line.y)[0];
            let better = point.active & value.simd_gt(most[side]);
            most[side] = better.select(value, most[side]);
            place[side] = [better.select(line.x, place[side][0]), better.select(line.y, place[side][1])];
            point.active & limit.simd_ge((k + 2) as f32)
        },
    );
    let second = most[1].simd_gt(most[0]);
    [second.select(place[1][0], place[0][0]), second.select(place[1][1], place[0][1])]
}
