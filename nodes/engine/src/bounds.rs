//! The greater and the lesser of two numbers, the same to the bit on every processor.
//!
//! The processors' own instructions for it differ where one number is a NaN, or both are zeros of unlike sign: those of
//! x86 give the second one, those of ARM the NaN, and of the zeros the one that is greater or less. NaNs arise where
//! numbers run over, as the difference of two infinities, so that a bound has to say what becomes of them.

use fearless_simd::{Simd, f32x4, f32x8, f32x16, i32x8, prelude::*};

/// Bounds of numbers, lane by lane.
pub trait Bounds<Bound = Self>: Sized {
    /// `self` where it is greater than `least`, else `least`, which is thus in the place of a NaN.
    fn at_least(self, least: Bound) -> Self;

    /// `self` where it is less than `most`, else `most`, which is thus in the place of a NaN.
    fn at_most(self, most: Bound) -> Self;

    /// `self` where it lies between `least` and `most`, else the nearer of them; `least` in the place of a NaN.
    #[inline(always)]
    fn within(self, least: Bound, most: Bound) -> Self {
        self.at_least(least).at_most(most)
    }
}

impl Bounds for f32 {
    #[inline(always)]
    fn at_least(self, least: Self) -> Self {
        if self > least { self } else { least }
    }

    #[inline(always)]
    fn at_most(self, most: Self) -> Self {
        if self < most { self } else { most }
    }
}

macro_rules! bounds {
    ($($vector:ident of $element:ident,)*) => { $(
        #[expect(clippy::disallowed_methods, reason = "this is what stands in their place")]
        impl<S: Simd> Bounds for $vector<S> {
            #[inline(always)]
            fn at_least(self, least: Self) -> Self {
                // One instruction of x86 does just this.
                if cfg!(target_arch = "x86_64") { self.max(least) } else { self.simd_gt(least).select(self, least) }
            }

            #[inline(always)]
            fn at_most(self, most: Self) -> Self {
                if cfg!(target_arch = "x86_64") { self.min(most) } else { self.simd_lt(most).select(self, most) }
            }
        }

        impl<S: Simd> Bounds<$element> for $vector<S> {
            #[inline(always)]
            fn at_least(self, least: $element) -> Self {
                self.at_least(Self::splat(self.simd, least))
            }

            #[inline(always)]
            fn at_most(self, most: $element) -> Self {
                self.at_most(Self::splat(self.simd, most))
            }
        }
    )* };
}

bounds! {
    f32x4 of f32,
    f32x8 of f32,
    f32x16 of f32,
    i32x8 of i32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch;
    use crate::dispatch::levels;

    const NUMBERS: [f32; 11] = [
        f32::NAN,
        -f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        0.0,
        -0.0,
        1.0,
        -1.0,
        -f32::MIN_POSITIVE / 8.0,
    ];

    /// Results of both on two numbers, as bits, by vectors of every width.
    fn by_vectors(level: fearless_simd::Level, a: f32, b: f32) -> Vec<[u32; 2]> {
        dispatch!(level, simd => {
            let (x, y, z) = (f32x4::splat(simd, a), f32x8::splat(simd, a), f32x16::splat(simd, a));
            let results = [
                [x.at_least(b)[0], x.at_most(b)[0]],
                [y.at_least(b)[7], y.at_most(b)[7]],
                [z.at_least(b)[15], z.at_most(b)[15]],
            ];
            results.map(|both| both.map(f32::to_bits)).to_vec()
        })
    }

    #[test]
    fn every_level_gives_the_second_number_unless_the_first_one_is_beyond_it() {
        for (name, level) in levels() {
            for a in NUMBERS {
                for b in NUMBERS {
                    let want = [if a > b { a } else { b }, if a < b { a } else { b }].map(f32::to_bits);
                    assert_eq!(by_vectors(level, a, b), vec![want; 3], "{a:?} and {b:?} by {name}");
                    assert_eq!([a.at_least(b), a.at_most(b)].map(f32::to_bits), want, "{a:?} and {b:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_a_number_is_within_bounds_as_well() {
        assert_eq!([-2.0, f32::NAN, 0.25, f32::INFINITY].map(|v| v.within(0.0, 1.0)), [0.0, 0.0, 0.25, 1.0]);
        dispatch!(fearless_simd::Level::new(), simd => {
            let whole = i32x8::from_slice(simd, &[-9, -1, 0, 1, 2, 3, 9, i32::MAX]);
            assert_eq!(whole.within(0, 3).to_array(), [0, 0, 0, 1, 2, 3, 3, 3]);
        });
    }
}
