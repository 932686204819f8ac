//! Motion over several frames: what was found so far, and the next step at the place that it leads to.
//!
//! The step is read as it enters the plan, so that frames that are not computed here are read however far away.
//!
//! Cost: one bilinear sample of two channels and about 40 operations.

pub use crate::kernels::shaders::motion_chain::Params;
use crate::kernels::shared::motion::{UNKNOWN, bounded, fetch2, is_inside, is_known};
use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::fearless_simd::{Simd, dispatch, f32x8, i32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, View};

crate::kernel!(motion_chain {
    cpu: run,
    cost: |_| 60.0,
    tolerance: Tolerance {
        absolute: 1e-4,
        relative: 1e-4,
        outliers: 2e-3,
        reason: "the rounding of a position times the differences of neighbours, and what goes to the other side of a \
                 border or a limit on the last bit",
    },
});

/// The motion `so_far`, and then that of `steps` in the frame that it leads to, which may hold anything; `longest` is
/// the longest step that counts, pixels, and `count` the number of steps with this one.
pub fn pass(plan: &mut PlanBuilder, so_far: ImageId, steps: ImageId, longest: f32, count: u32) -> ImageId {
    let reach = (longest * (count - 1) as f32).ceil() as u32 + 1;
    let params = Params { step: longest, limit: longest * count as f32 };
    let supports = [Support::Pixels(0), Support::Pixels(reach)];
    plan.pass_reaching(&KERNEL, &[so_far, steps], &params, &[Class::Field], &supports, 0)
}

fn run(pass: &CpuPass<'_>, band: &mut Band<'_>) {
    let params: Params = pass.params();
    dispatch!(pass.level, simd => for_blocks::<2>(band, #[inline(always)] |block, target| {
        write(chained(simd, pass, block, &params), target);
    }));
}

#[inline(always)]
fn chained<S: Simd>(simd: S, pass: &CpuPass<'_>, block: Block, params: &Params) -> [f32x8<S>; 2] {
    let found: [f32x8<S>; 2] = block.read(simd, &pass.inputs[0]);
    let (zero, known) = (f32x8::splat(simd, 0.0), is_known(found));
    let [cx, cy] = block.centres(simd);
    let (x, y) = (cx + known.select(found[0], zero), cy + known.select(found[1], zero));
    let second = motion_at(simd, &pass.inputs[1], x, y, params.step);
    let whole = bounded([found[0] + second[0], found[1] + second[1]], params.limit);
    let known = known & is_known(second) & is_inside(x, y, pass.inputs[1].full());
    let unknown = f32x8::splat(simd, UNKNOWN);
    whole.map(|v| known.select(v, unknown))
}

/// The motion at positions, as far as it is no longer than `limit`: interpolated where neighbours agree to a pixel,
/// else that of the nearest.
#[inline(always)]
fn motion_at<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>, limit: f32) -> [f32x8<S>; 2] {
    let [w, h] = view.full();
    let place = |p: f32x8<S>, full: i32| (p - 0.5).max(-2.0f32).min(full as f32 + 2.0);
    let (px, py) = (place(x, w), place(y, h));
    let (left, top) = (px.floor(), py.floor());
    let (fx, fy) = (px - left, py - top);
    let (left, top): (i32x8<S>, i32x8<S>) = (left.to_int(), top.to_int());
    let [a, b] = [left, left + 1].map(|column| bounded(fetch2(simd, view, column, top), limit));
    let [c, d] = [left, left + 1].map(|column| bounded(fetch2(simd, view, column, top + 1), limit));
    let near = |p: f32x8<S>, full: i32| p.floor().max(-2.0f32).min(full as f32 + 2.0).to_int::<i32x8<S>>();
    let nearest = bounded(fetch2(simd, view, near(x, w), near(y, h)), limit);
    let spread = |i: usize| a[i].max(b[i]).max(c[i].max(d[i])) - a[i].min(b[i]).min(c[i].min(d[i]));
    let alike = spread(0).max(spread(1)).simd_le(1.0);
    let mut motion = nearest;
    for i in 0..2 {
        let above = (b[i] - a[i]).mul_add(fx, a[i]);
        let below = (d[i] - c[i]).mul_add(fx, c[i]);
        motion[i] = alike.select((below - above).mul_add(fy, above), nearest[i]);
    }
    motion
}
