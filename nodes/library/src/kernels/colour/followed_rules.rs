//! A map of rules for things as lines and paint follow it: beside a nearer thing its values count, since a line between two
//! things lies on both, and what an artist painted refines them.
//!
//! Cost: 2 reach + 3 reads per pixel.

use super::nearest_across::known;
pub use crate::kernels::shaders::followed_rules::Params;
use crate::kernels::simd::pixels::{Block, fetch4, offsets, read};
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, prelude::*};
use isophote_engine::{Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(followed_rules {
    block: |simd, pass, params| |block| followed(simd, pass, &params, block),
    cost: |p| f64::from(2 * p.reach + 1) * 6.0 + 20.0,
    tolerance: Tolerance {
        absolute: 1e-6,
        relative: 0.0,
        outliers: 1e-3,
        reason: "sums and a quotient; what is just as much nearer as counts is in front or is not",
    },
});

/// Part of a depth from which on something is farther away.
const BEHIND: f32 = 0.01;

/// What an artist painted over the map of rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Painted {
    /// A control map: factors multiply, and where there are to be no lines there are none.
    Control(ImageId),
    /// Colours of lines, which cover those of rules.
    Colours(ImageId),
}

/// The map of rules as it is followed: by depth, with its [nearest points across](super::nearest_across) of the same reach, where there is
/// one, and by what was painted.
pub fn pass(
    plan: &mut PlanBuilder,
    rules: ImageId,
    depth: Option<([ImageId; 2], u32)>,
    painted: Option<Painted>,
) -> ImageId {
    let ([depth, across], reach) = depth.unwrap_or(([rules; 2], 0));
    let (painted, kind) = match painted {
        None => (rules, 0),
        Some(Painted::Control(image)) => (image, 1),
        Some(Painted::Colours(image)) => (image, 2),
    };
    let params = Params { reach, painted: kind };
    plan.pass(&KERNEL, &[rules, depth, across, painted], &params, Class::Colour, Support::Pixels(reach))
}

#[inline(always)]
fn followed<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, block: Block) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(simd, 0.0);
    let mut value = if params.reach > 0 {
        of_things(simd, pass, params.reach as i32, block)
    } else {
        block.read(simd, &pass.inputs[0])
    };
    if params.painted == 1 {
        let painted: [f32x8<S>; 4] = block.read(simd, &pass.inputs[3]);
        let no_lines = value[2].simd_eq(0.0);
        for (value, painted) in value.iter_mut().zip(painted) {
            let hand = painted.abs().simd_le(f32::MAX).select(painted.within(0.0, 1.0), zero + 0.5);
            *value = (*value + hand - 0.5).within(0.0, 1.0);
        }
        value[2] = no_lines.select(zero, value[2]);
    } else if params.painted == 2 {
        let [r, g, b, a] = block.read(simd, &pass.inputs[3]);
        let share = a.within(0.0, 1.0);
        let rest = value[3] * (zero + 1.0 - share);
        let alpha = share + rest;
        let has = alpha.simd_gt(0.0);
        let inverse = (zero + 1.0) / has.select(alpha, zero + 1.0);
        for (value, hand) in value.iter_mut().zip([r, g, b]) {
            *value = has.select((hand * share + *value * rest) * inverse, *value);
        }
        value[3] = alpha;
    }
    value
}

/// The map where the nearest thing is within reach of pixels.
#[inline(always)]
fn of_things<S: Simd>(simd: S, pass: &CpuPass<'_>, reach: i32, block: Block) -> [f32x8<S>; 4] {
    let [rules, depth, across] = [0, 1, 2].map(|input| &pass.inputs[input]);
    let zero = f32x8::splat(simd, 0.0);
    let bottom = across.full()[1] - 1;
    let row = |by: i32| -> [f32x8<S>; 2] {
        let at = across.offset(block.x, (block.y + by).clamp(0, bottom));
        read(simd, &across.data()[at..at + 2 * block.len])
    };
    let [mut z, mut right] = row(0);
    let mut down = zero;
    for by in 1..=reach {
        for side in [-by, by] {
            let [other, columns] = row(side);
            let is_nearer = other.simd_lt(z);
            z = is_nearer.select(other, z);
            right = is_nearer.select(columns, right);
            down = is_nearer.select(zero + side as f32, down);
        }
    }
    let (x, y) = (block.columns(simd), i32x8::splat(simd, block.y));
    let is_behind = z.simd_lt(known(depth, [x, y]) * (1.0 - BEHIND));
    let [right, down] = [right, down].map(|by| is_behind.select(by, zero).to_int::<i32x8<S>>());
    fetch4(simd, rules, offsets(rules, x + right, y + down))
}
