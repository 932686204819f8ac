//! Things of a pixel by a table of rules. Twin of `shaders/shared/things.wgsl`.

use crate::kernels::simd::pixels::Block;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{CpuPass, ImageId};

/// Most entries of a table.
pub const MOST: usize = 64;

/// Inputs that there are, as bits.
const HAS_NUMBERS: u32 = 1;
const HAS_NAMES: u32 = 2;
/// Bit of the map of the entries before, for the kernels that read one.
pub const HAS_BELOW: u32 = 4;

/// Things that an entry of a table is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    /// Objects, by the first and the last of their numbers.
    Numbers([f32; 2]),
    /// Things of a name, by its id in a Cryptomatte.
    Name(f32),
}

impl Entry {
    /// The entry as kernels have it; `is_last` says whether the rule that it is of ends with it.
    pub fn packed(self, is_last: bool) -> [f32; 4] {
        let last = if is_last { 1.0 } else { 0.0 };
        match self {
            Self::Numbers([from, to]) => [from, to, 0.0, last],
            Self::Name(id) => [id, id, 1.0, last],
        }
    }
}

/// Images that tell things: numbers of objects, and the two that cover most of a pixel by a Cryptomatte.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    /// Numbers of objects.
    pub numbers: Option<ImageId>,
    /// Id and coverage of each of the two.
    pub names: Option<ImageId>,
}

impl Told {
    /// The images in the order of inputs, with one that there is in the place of each that there is not, and which there are; none
    /// where nothing is told.
    pub fn inputs(self) -> Option<([ImageId; 2], u32)> {
        let any = self.numbers.or(self.names)?;
        let bit = |image: Option<ImageId>, bit| if image.is_some() { bit } else { 0 };
        let reads = bit(self.numbers, HAS_NUMBERS) | bit(self.names, HAS_NAMES);
        Some(([self.numbers.unwrap_or(any), self.names.unwrap_or(any)], reads))
    }
}

/// Things of the pixels of a block.
#[derive(Clone, Copy)]
pub struct Things<S: Simd> {
    number: f32x8<S>,
    matte: [f32x8<S>; 4],
}

impl<S: Simd> Things<S> {
    /// Reads them of the first two inputs of a pass.
    #[inline(always)]
    pub fn read(simd: S, pass: &CpuPass<'_>, reads: u32, block: Block) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        let finite = |value: f32x8<S>| value.abs().simd_le(f32::MAX).select(value, zero);
        let [number] = if reads & HAS_NUMBERS > 0 { block.read(simd, &pass.inputs[0]) } else { [zero] };
        let matte = if reads & HAS_NAMES > 0 { block.read(simd, &pass.inputs[1]) } else { [zero; 4] };
        // No number of an object without numbers, and no id is one of a name.
        let number = if reads & HAS_NUMBERS > 0 { finite(number) } else { zero - 1.0 };
        Self { number, matte: [matte[0], finite(matte[1]), matte[2], finite(matte[3])] }
    }

    /// Share of each pixel, 0 to 1, whose things a packed entry is for.
    #[inline(always)]
    pub fn covered(&self, [first, last, is_name, _]: [f32; 4]) -> f32x8<S> {
        let zero = f32x8::splat(self.number.simd, 0.0);
        if is_name > 0.0 {
            let [a, of_a, b, of_b] = self.matte;
            let share = a.simd_eq(first).select(of_a, zero) + b.simd_eq(first).select(of_b, zero);
            return share.within(0.0, 1.0);
        }
        (self.number.simd_ge(first) & self.number.simd_le(last)).select(zero + 1.0, zero)
    }
}
