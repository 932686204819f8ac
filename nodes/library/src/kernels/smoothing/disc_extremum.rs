//! The greatest or least value of each channel within a disc: dilation or erosion (§ 5.1). Pixels less
//! than half covered lend no colour, and coverage itself passes.
//!
//! A disc is a stack of rows. The extremum of a row of pixels is that of two overlapping ones whose
//! length is a power of two, and these come from each other by doubling; each source row is reduced
//! once for every length that the disc has and then joins the results of all rows that it belongs to.
//!
//! Cost: about 2 radius + 0.6 radius + log2(radius) comparisons per value on the CPU; the shader looks
//! at every pixel of the disc, through workgroup memory: about radius^2 / 16 + radius / 2 + 1 loads.

pub use crate::kernels::shaders::disc_extremum::Params;
use crate::kernels::simd::pixels::eight;
use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::{Band, Class, CpuPass, ImageId, PlanBuilder, Support, Tolerance, memory};

crate::kernel!(disc_extremum {
    cpu: |simd, pass, params, band| extrema(simd, pass, &params, band),
    cost: |p| 3.0 * 3.2 * f64::from(p.limit) + 12.0,
    tolerance: Tolerance::of_rounding(0.0, 0.0, "comparisons are exact"),
});

/// End of the range of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extremum {
    /// Dilation.
    Greatest,
    /// Erosion.
    Least,
}

/// The extremum within a disc of `radius` pixels. Its pixels (x, y) are those with
/// x^2 + y^2 <= radius (radius + 1), which gives rounder discs than radius^2 does.
pub fn pass(plan: &mut PlanBuilder, color: ImageId, radius: f32, extremum: Extremum) -> ImageId {
    let limit = (radius * (radius + 1.0) + 1e-3) as i32;
    let extent = limit.isqrt();
    let sign = if extremum == Extremum::Greatest { 1.0 } else { -1.0 };
    let params = Params { extent, limit, sign };
    plan.pass(&KERNEL, &[color], &params, Class::Colour, Support::Pixels(extent as u32))
}

/// Columns worked through at a time, so that all rows of results stay in the first-level cache.
const STRIP: usize = 128;

/// Least coverage of a pixel that lends its colour.
const COVERED: f32 = 0.5;

/// Rows of a disc that are equally long.
struct Chord {
    /// Pixels on each side of the middle.
    half: usize,
    /// Places of these rows.
    rows: Vec<i32>,
}

/// The rows of a disc, short ones first.
fn chords(params: &Params) -> Vec<Chord> {
    let mut chords: Vec<Chord> = Vec::new();
    for dy in (0..=params.extent).rev() {
        let half = (params.limit - dy * dy).isqrt() as usize;
        let rows = if dy == 0 { vec![0] } else { vec![-dy, dy] };
        match chords.last_mut().filter(|c| c.half == half) {
            Some(chord) => chord.rows.extend(rows),
            None => chords.push(Chord { half, rows }),
        }
    }
    chords
}

/// target = max(target, values). Left to itself the compiler would store under a mask, which is slow.
#[inline(always)]
fn raise<S: Simd>(simd: S, target: &mut [f32], values: &[f32]) {
    let len = target.len().min(values.len());
    let (target, values) = (&mut target[..len], &values[..len]);
    let mut i = 0;
    while i + 8 <= len {
        let v = eight(simd, values, i);
        v.at_least(eight(simd, target, i)).store_slice(&mut target[i..i + 8]);
        i += 8;
    }
    while i < len {
        target[i] = values[i].at_least(target[i]);
        i += 1;
    }
}

/// Extrema of rows of 2 n pixels from those of n = `length`, in place: what is read lies ahead of what is
/// written.
#[inline(always)]
fn double<S: Simd>(simd: S, row: &mut [f32], length: usize) {
    let (len, ahead) = (row.len() - 4 * length, 4 * length);
    let mut i = 0;
    while i + 8 <= len {
        let v = f32x8::from_slice(simd, &row[i + ahead..i + ahead + 8]);
        v.at_least(eight(simd, row, i)).store_slice(&mut row[i..i + 8]);
        i += 8;
    }
    while i < len {
        row[i] = row[i + ahead].at_least(row[i]);
        i += 1;
    }
}

#[inline(always)]
fn extrema<S: Simd>(simd: S, pass: &CpuPass<'_>, params: &Params, band: &mut Band<'_>) {
    let window = band.window;
    let view = &pass.inputs[0];
    let chords = chords(params);
    let extent = params.extent;
    let (mut scratch, mut reduced, mut chord_row, mut results) = (vec![], vec![], vec![], vec![]);
    let count = 2 * extent + 1;
    for x0 in (window.x0..window.x1).step_by(STRIP) {
        let x1 = (x0 + STRIP as i32).min(window.x1);
        let len = 4 * (x1 - x0) as usize;
        chord_row.resize(len, 0.0f32);
        results.clear();
        memory::resize(&mut results, len * count as usize, f32::NEG_INFINITY);
        let mut opaque = true;
        for y in window.y0 - extent..window.y1 + extent {
            let source = view.padded_row(y, x0 - extent, x1 + extent, &mut scratch);
            opaque &= source.chunks_exact(4).all(|p| p[3] == 1.0);
            take_in(simd, source, params.sign, opaque, &mut reduced);
            // Extrema of rows of `length` pixels begin at every value of `reduced`.
            let mut length = 1;
            for chord in &chords {
                while 2 * length <= 2 * chord.half + 1 {
                    double(simd, &mut reduced, length);
                    length *= 2;
                }
                let first = 4 * (extent as usize - chord.half);
                let second = 4 * (extent as usize + chord.half + 1 - length);
                chord_row.copy_from_slice(&reduced[first..first + len]);
                raise(simd, &mut chord_row, &reduced[second..second + len]);
                for dy in &chord.rows {
                    let at = (y + dy).rem_euclid(count) as usize * len;
                    raise(simd, &mut results[at..at + len], &chord_row);
                }
            }
            // Row y - extent has now met all of its disc.
            let done = y - extent;
            let best = &mut results[done.rem_euclid(count) as usize * len..][..len];
            if done >= window.y0 {
                let from = 4 * (x0 - window.x0) as usize;
                let origin = view.offset(x0, done);
                let origin = &view.data()[origin..origin + len];
                let target = &mut band.row_mut(0, done)[from..from + len];
                give_out(simd, best, origin, params.sign, opaque, target);
            }
            best.fill(f32::NEG_INFINITY);
        }
    }
}

/// A row with its sign, nothing where it is not covered.
#[inline(always)]
fn take_in<S: Simd>(simd: S, source: &[f32], sign: f32, opaque: bool, target: &mut Vec<f32>) {
    target.resize(source.len(), 0.0);
    if opaque {
        signed(simd, source, sign, target);
        return;
    }
    for (s, t) in source.chunks_exact(4).zip(target.chunks_exact_mut(4)) {
        let covered = s[3] >= COVERED;
        for c in 0..4 {
            t[c] = if covered { sign * s[c] } else { f32::NEG_INFINITY };
        }
    }
}

/// The extrema with their sign; where the disc held nothing, the pixel's own colour.
#[inline(always)]
fn give_out<S: Simd>(simd: S, best: &[f32], origin: &[f32], sign: f32, opaque: bool, target: &mut [f32]) {
    if opaque {
        // Alphas of 1 have come through as 1.
        signed(simd, best, sign, target);
        return;
    }
    for ((b, o), t) in best.chunks_exact(4).zip(origin.chunks_exact(4)).zip(target.chunks_exact_mut(4)) {
        for c in 0..3 {
            t[c] = if b[c] == f32::NEG_INFINITY { o[c] } else { sign * b[c] };
        }
        t[3] = o[3];
    }
}

#[inline(always)]
fn signed<S: Simd>(simd: S, source: &[f32], sign: f32, target: &mut [f32]) {
    let len = source.len().min(target.len());
    let (source, target) = (&source[..len], &mut target[..len]);
    let mut i = 0;
    while i + 8 <= len {
        (eight(simd, source, i) * sign).store_slice(&mut target[i..i + 8]);
        i += 8;
    }
    while i < len {
        target[i] = source[i] * sign;
        i += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discs_are_round_and_hold_their_rows_once() {
        for (radius, pixels) in [(0, 1), (1, 9), (2, 21), (3, 37), (7, 177)] {
            let limit = radius * (radius + 1);
            let params = Params { extent: i32::isqrt(limit), limit, sign: 1.0 };
            let chords = chords(&params);
            let area: usize = chords.iter().map(|c| (2 * c.half + 1) * c.rows.len()).sum();
            assert_eq!((area, params.extent), (pixels, radius));
            assert!(chords.windows(2).all(|c| c[0].half < c[1].half));
        }
    }
}
