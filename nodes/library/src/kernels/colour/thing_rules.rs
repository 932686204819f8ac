//! A map of what rules say of things, by the numbers of objects.
//!
//! Of several rules for a thing the last one counts, channel by channel. Cost: about 6 operations per pixel for each entry of
//! the table.

pub use crate::kernels::shaders::thing_rules::Params;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(thing_rules {
    block: |simd, pass, params| |block| {
        let [number] = block.read(simd, &pass.inputs[0]);
        let below = if params.has_below > 0 {
            block.read(simd, &pass.inputs[1])
        } else {
            params.start.map(|value| f32x8::splat(simd, value))
        };
        said(&params, number, below)
    },
    cost: |p| f64::from(p.count) * 6.0 + 2.0,
    tolerance: Tolerance::of_rounding(0.0, 0.0, "numbers are compared, and values copied"),
});

/// Most entries of a table.
pub const MOST: usize = 64;

/// Entry of a table: first and last number that it is for, and what a map has there, as far as it says.
pub type Entry = ([f32; 2], [Option<f32>; 4]);

/// What a map has that a table says nothing of.
const NOTHING: f32 = -1.0;

/// The map of a table of any length, which has `start` where no entry says anything.
pub fn pass(plan: &mut PlanBuilder, object_id: ImageId, table: &[Entry], start: [f32; 4]) -> ImageId {
    let mut below = None;
    for part in table.chunks(MOST) {
        let mut entries = [[0.0; 4]; 2 * MOST];
        for (pair, ([first, last], values)) in entries.chunks_exact_mut(2).zip(part) {
            pair[0] = [*first, *last, 0.0, 0.0];
            pair[1] = values.map(|value| value.unwrap_or(NOTHING));
        }
        let (count, has_below) = (part.len() as u32, below.is_some().into());
        let params = Params { entries, start, count, has_below, padding: Default::default() };
        // Where nothing is below no other image is read: any will do.
        let inputs = [object_id, below.unwrap_or(object_id)];
        below = Some(plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0)));
    }
    below.unwrap_or(object_id)
}

#[inline(always)]
fn said<S: Simd>(params: &Params, number: f32x8<S>, below: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(number.simd, 0.0);
    let number = number.abs().simd_le(f32::MAX).select(number, zero);
    let mut value = below;
    for entry in params.entries.as_chunks::<2>().0.iter().take(params.count as usize) {
        let [[first, last, ..], said] = *entry;
        let is_meant = number.simd_ge(first) & number.simd_le(last);
        for (value, said) in value.iter_mut().zip(said) {
            if said >= 0.0 {
                *value = is_meant.select(zero + said, *value);
            }
        }
    }
    value
}
