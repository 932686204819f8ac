//! Instruction sets that pixel code is compiled for.
//!
//! On x86-64: SSE2, which every machine has, AVX2 with FMA and, in builds without debug assertions,
//! AVX-512 as of Ice Lake. Each makes builds half as long again, so that builds for development do with two.
//! Elsewhere: what fearless_simd chooses.

#[doc(hidden)]
pub use fearless_simd as vectors;
use fearless_simd::{Level, Simd, SimdBase};

/// Runs `$op` with vectors `$simd` of the widest instruction set that `$level` has and this build knows.
///
/// Everything that `$op` calls must be `#[inline(always)]`, or it is compiled for every machine.
#[macro_export]
macro_rules! dispatch {
    (@on $token:expr, $simd:pat => $op:expr) => {{
        let token = $token;
        let $simd = $crate::dispatch::of_any(token);
        $crate::dispatch::vectors::Simd::vectorize(
            token,
            #[inline(always)]
            || $op,
        )
    }};
    ($level:expr, $simd:pat => $op:expr) => {{
        let level: $crate::dispatch::vectors::Level = $level;
        #[cfg(not(target_arch = "x86_64"))]
        let result = $crate::dispatch::vectors::dispatch!(level, $simd => $op);
        #[cfg(target_arch = "x86_64")]
        let result = match (level.as_avx512(), level.as_avx2(), level.as_sse2()) {
            (Some(token), _, _) if $crate::dispatch::IS_FOR_AVX512 => $crate::dispatch!(@on token, $simd => $op),
            (_, Some(token), _) => $crate::dispatch!(@on token, $simd => $op),
            (_, _, Some(token)) => $crate::dispatch!(@on token, $simd => $op),
            (_, _, None) => unreachable!("x86-64 has SSE2"),
        };
        result
    }};
}

/// True in builds that have code for AVX-512. A constant of this crate, since a crate of kernels may be built without debug
/// assertions beside it; code behind it is not compiled where it is false.
#[doc(hidden)]
pub const IS_FOR_AVX512: bool = !cfg!(debug_assertions);

/// Hides which instruction set it is, so that code is written for all.
#[doc(hidden)]
#[inline(always)]
pub fn of_any<S: Simd>(simd: S) -> impl Simd {
    simd
}

/// Runs `$op` as a function of its own by SSE2, and in place by wider instruction sets.
///
/// SSE2 takes several instructions, and calls, for what others do in one. What is inlined by it into the loops of large kernels
/// makes functions that the compiler spends minutes on; a machine without AVX2 can afford the call.
#[macro_export]
macro_rules! apart {
    ($simd:expr, $op:expr $(,)?) => {
        $crate::dispatch::apart(
            $simd,
            #[inline(always)]
            || $op,
        )
    };
}

#[doc(hidden)]
#[inline(always)]
pub fn apart<S: Simd, R>(simd: S, op: impl FnOnce() -> R) -> R {
    // A constant, so that only one of the two is compiled.
    if const { cfg!(target_arch = "x86_64") && <S::f32s as SimdBase<S>>::LEN == 4 } {
        simd.vectorize(op)
    } else {
        op()
    }
}

/// The level, but AVX2 for AVX-512: for code that measurements show to be slower by AVX-512, such as chains of
/// comparisons that wait for each other. The results are the same.
pub fn at_most_avx2(level: Level) -> Level {
    #[cfg(target_arch = "x86_64")]
    if let (Some(_), Some(token)) = (level.as_avx512(), level.as_avx2()) {
        return Level::Avx2(token);
    }
    level
}

/// The instruction sets that this build knows and this machine has, each with its name, from the narrowest to
/// the widest. Code for another one runs as the next narrower one listed here.
pub fn levels() -> Vec<(&'static str, Level)> {
    #[cfg(not(target_arch = "x86_64"))]
    let levels = vec![("the only one", Level::new())];
    #[cfg(target_arch = "x86_64")]
    let levels = {
        let widest = Level::new();
        let mut levels = Vec::new();
        levels.extend(widest.as_sse2().map(|token| ("SSE2", Level::Sse2(token))));
        levels.extend(widest.as_avx2().map(|token| ("AVX2", Level::Avx2(token))));
        if IS_FOR_AVX512 {
            levels.extend(widest.as_avx512().map(|token| ("AVX-512", Level::Avx512(token))));
        }
        levels
    };
    levels
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::f32x8;

    #[test]
    fn every_level_is_dispatched_to() {
        let known = levels();
        assert!(!known.is_empty());
        for (name, level) in known {
            let dispatched = crate::dispatch!(level, simd => {
                let sum = f32x8::splat(simd, 1.5) + f32x8::splat(simd, 0.5);
                (format!("{:?}", simd.level()), sum.as_slice()[7])
            });
            assert_eq!(dispatched, (format!("{level:?}"), 2.0), "{name}");
            let least = if name == "AVX-512" { "Avx2" } else { &format!("{level:?}") };
            assert!(format!("{:?}", at_most_avx2(level)).starts_with(least), "{name}");
        }
    }
}
