//! Surfaces of tiles: noise whose period is the tile's side, and heights in the light of a low sun.

use super::shipped::SIDE;

/// Smooth noise in cells of about `cell` pixels, of which whole numbers fit the tile, 0..=1.
pub(super) fn noise(cell: f64, seed: u32) -> impl Fn(f64, f64) -> f64 {
    let cells = (SIDE as f64 / cell).round().max(1.0);
    let count = cells as i64;
    move |x, y| {
        let (x, y) = (x / SIDE as f64 * cells, y / SIDE as f64 * cells);
        let at = |x: i64, y: i64| hash(x.rem_euclid(count) as u32, y.rem_euclid(count) as u32, seed);
        let (left, top) = (x.floor(), y.floor());
        let [u, v] = [x - left, y - top].map(|t| t * t * (3.0 - 2.0 * t));
        let (i, j) = (left as i64, top as i64);
        let upper = at(i, j) + u * (at(i + 1, j) - at(i, j));
        let lower = at(i, j + 1) + u * (at(i + 1, j + 1) - at(i, j + 1));
        upper + v * (lower - upper)
    }
}

/// Distance to the nearest of points by chance, one in each cell of about `cell` pixels, in cells (S. Worley, "A cellular
/// texture basis function", 1996).
pub(super) fn cellular(cell: f64, seed: u32) -> impl Fn(f64, f64) -> f64 {
    let cells = (SIDE as f64 / cell).round().max(1.0);
    let count = cells as i64;
    move |x, y| {
        let (x, y) = (x / SIDE as f64 * cells, y / SIDE as f64 * cells);
        let (left, top) = (x.floor() as i64, y.floor() as i64);
        let mut nearest = f64::INFINITY;
        for j in top - 1..=top + 1 {
            for i in left - 1..=left + 1 {
                let own = |n: u32| hash(i.rem_euclid(count) as u32, j.rem_euclid(count) as u32, seed + n);
                nearest = nearest.min((i as f64 + own(0) - x).hypot(j as f64 + own(1) - y));
            }
        }
        nearest
    }
}

/// A number from 0 to 1 for a cell.
fn hash(x: u32, y: u32, seed: u32) -> f64 {
    let mut h = x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ seed.wrapping_mul(0xcb1a_b31f);
    h = (h ^ h >> 16).wrapping_mul(0x7feb_352d);
    h = (h ^ h >> 15).wrapping_mul(0x846c_a68b);
    f64::from(h ^ h >> 16) / f64::from(u32::MAX)
}

/// Factor on the light of each pixel of a surface of these heights, in pixels, under a sun at the upper left.
pub(super) fn lit(height: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let heights: Vec<f64> =
        (0..SIDE * SIDE).map(|i| height((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5)).collect();
    let at = |x: usize, y: usize| heights[y % SIDE * SIDE + x % SIDE];
    let slope = |i: usize| {
        let (x, y) = (i % SIDE + SIDE, i / SIDE + SIDE);
        0.5 * (at(x + 1, y) - at(x - 1, y) + at(x, y + 1) - at(x, y - 1))
    };
    // Towards the sun it is lighter.
    (0..SIDE * SIDE).map(|i| 1.0 + slope(i)).collect()
}
