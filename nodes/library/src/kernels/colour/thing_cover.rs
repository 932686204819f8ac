//! Share of each pixel that some things cover, by the numbers of objects and by the names of a Cryptomatte.
//!
//! Cost: about 6 operations per pixel for each entry of the table.

pub use crate::kernels::shaders::thing_cover::Params;
use crate::kernels::shared::things::{Entry, HAS_BELOW, MOST, Things, Told};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(thing_cover {
    block: |simd, pass, params| |block| {
        let things = Things::read(simd, pass, params.reads, block);
        let below = if params.reads & HAS_BELOW > 0 {
            let [below] = block.read(simd, &pass.inputs[2]);
            below
        } else {
            f32x8::splat(simd, 0.0)
        };
        [covered(&params, &things, below)]
    },
    cost: |p| f64::from(p.count) * 6.0 + 2.0,
    tolerance: Tolerance::of_rounding(1e-6, 0.0, "a sum of shares"),
});

/// Shares from 0 to 1; none without images that tell things, and of no things.
pub fn pass(plan: &mut PlanBuilder, told: Told, things: &[Entry]) -> Option<ImageId> {
    let ([numbers, names], told) = told.inputs()?;
    let mut below = None;
    for part in things.chunks(MOST) {
        let mut entries = [[0.0; 4]; MOST];
        for (packed, entry) in entries.iter_mut().zip(part) {
            *packed = entry.packed(false);
        }
        let reads = told | if below.is_some() { HAS_BELOW } else { 0 };
        let params = Params { entries, count: part.len() as u32, reads, padding: Default::default() };
        // Where nothing is below no other image is read: any will do.
        let inputs = [numbers, names, below.unwrap_or(numbers)];
        below = Some(plan.pass(&KERNEL, &inputs, &params, Class::Field, Support::Pixels(0)));
    }
    below
}

#[inline(always)]
fn covered<S: Simd>(params: &Params, things: &Things<S>, below: f32x8<S>) -> f32x8<S> {
    let own = params.entries.iter().take(params.count as usize);
    own.fold(below, |share, entry| share + things.covered(*entry)).within(0.0, 1.0)
}
