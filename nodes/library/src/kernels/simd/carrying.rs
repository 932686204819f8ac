//! Kernels that take a neighbouring frame, carried here along motion, into an average: the pass and the loop that they
//! share. What they read are the average, the motion that leads to the other frame, the shares that it counts
//! ([`carried_share`](crate::kernels::time::carried_share)), and that frame's values.

use crate::kernels::simd::pixels::{Block, for_blocks, write};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, Kernel, PlanBuilder, Support};

/// Adds a pass of `kernel` that takes `theirs` into `average`; it reads motions as far around a pixel as the first of
/// `reaches` says, and values of the other frame as far as the second.
pub fn pass(
    plan: &mut PlanBuilder,
    kernel: &'static Kernel,
    [average, theirs]: [ImageId; 2],
    [motion, shares]: [ImageId; 2],
    class: Class,
    reaches: [u32; 2],
) -> ImageId {
    let (here, [around, there]) = (Support::Pixels(0), reaches.map(Support::Pixels));
    let inputs = [average, motion, shares, theirs];
    plan.pass_reaching(kernel, &inputs, &(), &[class], &[here, around, here, there], 0)
}

/// Eight pixels of an average that another frame is taken into.
pub struct Carried<S: Simd, const N: usize> {
    /// Their place.
    pub block: Block,
    /// The average.
    pub own: [f32x8<S>; N],
    /// Share of the other frame; it counts for nothing where that is not above zero.
    pub share: f32x8<S>,
    /// The motion that leads there.
    pub motion: [f32x8<S>; 2],
    /// Place to which it leads, absolute.
    pub place: [f32x8<S>; 2],
}

/// Fills a band with the average and, where the other frame counts for something, with what `mixed` makes of both: a closure
/// that is inlined, since a function handed over stays a call.
#[inline(always)]
pub fn take_in<S: Simd, const N: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    band: &mut Band<'_>,
    mixed: impl Fn(&Carried<S, N>) -> [f32x8<S>; N],
) {
    let zero = f32x8::splat(simd, 0.0);
    for_blocks::<N>(
        band,
        #[inline(always)]
        |block, target| {
            let own: [f32x8<S>; N] = block.read(simd, &pass.inputs[0]);
            let [share, _]: [f32x8<S>; 2] = block.read(simd, &pass.inputs[2]);
            let counts = share.simd_gt(zero);
            if !counts.any_true() {
                return write(own, target);
            }
            let motion: [f32x8<S>; 2] = block.read(simd, &pass.inputs[1]);
            let [x, y] = block.centres(simd);
            let place = [x + counts.select(motion[0], zero), y + counts.select(motion[1], zero)];
            let mixed = mixed(&Carried { block, own, share, motion, place });
            let mut result = own;
            for c in 0..N {
                result[c] = counts.select(mixed[c], own[c]);
            }
            write(result, target);
        },
    );
}
