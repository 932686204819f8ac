//! Points of undeformed objects, as renderers write them beside a picture; the twin of
//! `shaders/shared/rest_position.wgsl`.

use isophote_engine::fearless_simd::{Simd, f32x8, mask32x8, prelude::*};

/// Footprints that are not known; those that are lie far below.
pub const NO_FOOTPRINT: f32 = 1e9;

/// Mask of footprints that are known.
#[inline(always)]
pub fn has_footprint<S: Simd>(footprint: f32x8<S>) -> mask32x8<S> {
    footprint.simd_lt(1e8)
}

/// Mask of pixels that show a point of an object.
#[inline(always)]
pub fn is_at_rest<S: Simd>([x, y, z, validity]: [f32x8<S>; 4]) -> mask32x8<S> {
    // Comparisons with what is no number are false. Squares of coordinates must stay finite.
    let is_small = x.abs().simd_lt(1e15) & y.abs().simd_lt(1e15) & z.abs().simd_lt(1e15);
    is_small & validity.simd_gt(0.5) & validity.simd_le(f32::MAX)
}
