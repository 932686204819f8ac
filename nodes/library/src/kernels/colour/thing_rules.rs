//! A map of what rules say of things, by the numbers of objects and by the names of a Cryptomatte.
//!
//! Of several rules for a thing the last one counts, channel by channel, as much as its things cover of a pixel. Cost: about 10
//! operations per pixel for each entry of the table.

pub use crate::kernels::shaders::thing_rules::Params;
use crate::kernels::shared::coverage::{premultiply, unpremultiply};
use crate::kernels::shared::things::{Entry, HAS_BELOW, MOST, Things, Told};
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Class, ImageId, PlanBuilder, Support, Tolerance};

crate::kernel!(thing_rules {
    block: |simd, pass, params| |block| {
        let things = Things::read(simd, pass, params.reads, block);
        let below = if params.reads & HAS_BELOW > 0 {
            block.read(simd, &pass.inputs[2])
        } else {
            params.start.map(|value| f32x8::splat(simd, value))
        };
        said(&params, &things, below)
    },
    cost: |p| f64::from(p.count) * 10.0 + 2.0,
    tolerance: Tolerance::of_rounding(1e-6, 2e-6, "mixtures by coverage; whole things copy values"),
});

/// What a rule says: the things that it is for, and what a map has there, as far as it says.
pub type Said = (Vec<Entry>, [Option<f32>; 4]);

/// What a map has that a table says nothing of.
const NOTHING: f32 = -1.0;

/// The map of rules, which has `start` where none says anything; none without images that tell things. Colours, where `is_paint`, are
/// mixed by their coverage. A rule for more things than a table has entries counts for each part of them by itself.
pub fn pass(
    plan: &mut PlanBuilder,
    told: Told,
    rules: &[Said],
    start: [f32; 4],
    is_paint: bool,
) -> Option<ImageId> {
    let ([numbers, names], told) = told.inputs()?;
    let mut below = None;
    for part in tables(rules) {
        let mut entries = [[0.0; 4]; 2 * MOST];
        for (pair, row) in entries.chunks_exact_mut(2).zip(&part) {
            pair[0] = row.entry.packed(row.is_last);
            pair[1] = row.values.map(|value| value.unwrap_or(NOTHING));
        }
        let reads = told | if below.is_some() { HAS_BELOW } else { 0 };
        let (count, is_paint) = (part.len() as u32, is_paint.into());
        let params = Params { entries, start, count, reads, is_paint, padding: Default::default() };
        // Where nothing is below no other image is read: any will do.
        let inputs = [numbers, names, below.unwrap_or(numbers)];
        below = Some(plan.pass(&KERNEL, &inputs, &params, Class::Colour, Support::Pixels(0)));
    }
    below
}

/// Entry of a table with what its rule says, and whether the rule ends with it.
struct Row {
    entry: Entry,
    is_last: bool,
    values: [Option<f32>; 4],
}

/// The entries of rules in parts that a table takes.
fn tables(rules: &[Said]) -> Vec<Vec<Row>> {
    let mut tables: Vec<Vec<Row>> = Vec::new();
    let parts =
        rules.iter().flat_map(|(entries, values)| entries.chunks(MOST).map(move |part| (part, *values)));
    for (part, values) in parts {
        let rows = (1..).zip(part).map(|(number, entry)| Row {
            entry: *entry,
            is_last: number == part.len(),
            values,
        });
        match tables.last_mut().filter(|table| table.len() + part.len() <= MOST) {
            Some(table) => table.extend(rows),
            None => tables.push(rows.collect()),
        }
    }
    tables
}

#[inline(always)]
fn said<S: Simd>(params: &Params, things: &Things<S>, below: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let zero = f32x8::splat(below[0].simd, 0.0);
    let (mut value, mut share) = (below, zero);
    for entry in params.entries.as_chunks::<2>().0.iter().take(params.count as usize) {
        share += things.covered(entry[0]);
        if entry[0][3] > 0.0 {
            value = laid_over(value, entry[1], share.within(0.0, 1.0), params.is_paint > 0);
            share = zero;
        }
    }
    value
}

/// Values with what a rule says over them, which counts by `share`.
#[inline(always)]
fn laid_over<S: Simd>(
    value: [f32x8<S>; 4],
    said: [f32; 4],
    share: f32x8<S>,
    is_paint: bool,
) -> [f32x8<S>; 4] {
    let said_of = said.map(|said| f32x8::splat(share.simd, said));
    let mix = |from: [f32x8<S>; 4], to: [f32x8<S>; 4]| {
        let mut mixed = from;
        for (mixed, to) in mixed.iter_mut().zip(to) {
            *mixed += (to - *mixed) * share;
        }
        mixed
    };
    let mixed = if is_paint {
        unpremultiply(mix(premultiply(value), premultiply(said_of)))
    } else {
        mix(value, said_of)
    };
    let (counts, is_whole) = (share.simd_gt(0.0), share.simd_ge(1.0));
    let mut result = value;
    for c in 0..4 {
        if said[c] >= 0.0 {
            result[c] = counts.select(is_whole.select(said_of[c], mixed[c]), value[c]);
        }
    }
    result
}
