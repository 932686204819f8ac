//! Thresholds of ordered dither: Bayer's matrix, and blue noise by void and cluster.
//!
//! Both are made of additions, products and comparisons alone, in one order, so that they are the same on every machine.

use crate::declare::choice::choice;
use crate::kernels::colour::palette_colours::{Pattern, SIDE};
use std::sync::LazyLock;

choice! {
    /// Ordered dither.
    pub(super) enum Dither {
        /// Areas of one colour, each the nearest of the palette.
        None ("none", "None"),
        /// A woven pattern of crosses and checks, as old screens show it.
        Bayer ("bayer", "Bayer pattern"),
        /// Even grain without a pattern.
        Noise ("noise", "Blue noise"),
    }
}

impl Dither {
    /// Its thresholds; none where there is no dither.
    pub(super) fn pattern(self) -> Option<&'static Pattern> {
        match self {
            Self::None => None,
            Self::Bayer => Some(&BAYER),
            Self::Noise => Some(&NOISE),
        }
    }
}

/// Thresholds of Bayer's matrix of 8 x 8 (1973).
pub(super) static BAYER: LazyLock<Pattern> = LazyLock::new(|| pattern(bayer));
/// Thresholds of blue noise.
static NOISE: LazyLock<Pattern> = LazyLock::new(|| {
    let ranks = void_and_cluster();
    pattern(|x, y| (f32::from(ranks[y * SIDE + x]) + 0.5) / CELLS as f32)
});

/// Thresholds of a pattern.
const CELLS: usize = SIDE * SIDE;

fn pattern(threshold: impl Fn(usize, usize) -> f32) -> Pattern {
    let mut pattern = [[0.0; 4]; CELLS / 4];
    for (at, value) in pattern.as_flattened_mut().iter_mut().enumerate() {
        *value = threshold(at % SIDE, at / SIDE);
    }
    pattern
}

/// Bayer's matrix: bits of x ^ y and of y in turn, those of the finest checks first.
fn bayer(x: usize, y: usize) -> f32 {
    let mut rank = 0;
    for bit in 0..3 {
        rank = 4 * rank + 2 * ((x ^ y) >> bit & 1) + (y >> bit & 1);
    }
    (rank as f32 + 0.5) / 64.0
}

/// Share of a neighbour one pixel away in what makes a place crowded, a Gaussian of 1.5 pixels: exp(-1 / (2 1.5^2)).
const NEIGHBOUR: f64 = 0.800_737_402_916_808;

/// Places that are tried for points of the first pattern: a tenth of the cells, of which some come twice.
const FIRST: usize = CELLS / 10;

/// How crowded each place is: the sum of Gaussians around points of a pattern that repeats itself.
#[derive(Clone)]
struct Crowd {
    weights: [f64; CELLS],
    around: [f64; CELLS],
    points: [bool; CELLS],
}

impl Crowd {
    fn new() -> Self {
        let mut weights = [0.0; CELLS];
        for (at, weight) in weights.iter_mut().enumerate() {
            let [x, y] = [at % SIDE, at / SIDE].map(|v| v.min(SIDE - v));
            *weight = 1.0;
            for _ in 0..x * x + y * y {
                *weight *= NEIGHBOUR;
            }
        }
        Self { weights, around: [0.0; CELLS], points: [false; CELLS] }
    }

    /// Sets a point, or takes it away.
    fn set(&mut self, point: usize, is_there: bool) {
        self.points[point] = is_there;
        let (px, py) = (point % SIDE, point / SIDE);
        for (at, around) in self.around.iter_mut().enumerate() {
            let (x, y) = ((at + SIDE - px) % SIDE, (at / SIDE + SIDE - py) % SIDE);
            let weight = self.weights[y * SIDE + x];
            *around += if is_there { weight } else { -weight };
        }
    }

    /// The point with the most points around, the first of several.
    fn tightest(&self) -> usize {
        self.best(true, |at, best| at > best)
    }

    /// The place without a point that has the fewest around, the first of several.
    fn emptiest(&self) -> usize {
        self.best(false, |at, best| at < best)
    }

    /// The best place, by what is around it, of those with points or of those without.
    fn best(&self, has_point: bool, is_better: impl Fn(f64, f64) -> bool) -> usize {
        let mut places = (0..CELLS).filter(|at| self.points[*at] == has_point);
        let first = places.next().unwrap_or(0);
        places.fold(first, |best, at| if is_better(self.around[at], self.around[best]) { at } else { best })
    }
}

/// Ranks of cells by the void-and-cluster method (Ulichney 1993): points are spread evenly, then taken away where they are
/// tightest for the ranks below, and set where most room is for those above.
fn void_and_cluster() -> [u16; CELLS] {
    let mut crowd = Crowd::new();
    // Any uneven places will do; these are by the generator of Numerical Recipes.
    let mut state = 1u32;
    for _ in 0..FIRST {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let place = (state >> 16) as usize % CELLS;
        if !crowd.points[place] {
            crowd.set(place, true);
        }
    }
    let count = crowd.points.iter().filter(|point| **point).count();
    // Far fewer moves are enough; the bound is for what rounding might do.
    for _ in 0..CELLS {
        let point = crowd.tightest();
        crowd.set(point, false);
        let place = crowd.emptiest();
        crowd.set(place, true);
        if place == point {
            break;
        }
    }
    let mut ranks = [0; CELLS];
    let mut rest = crowd.clone();
    for rank in (0..count).rev() {
        let point = rest.tightest();
        rest.set(point, false);
        ranks[point] = rank as u16;
    }
    for rank in count..CELLS {
        let place = crowd.emptiest();
        crowd.set(place, true);
        ranks[place] = rank as u16;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_threshold_stands_once_and_their_mean_is_the_middle() {
        for (pattern, times) in [(&*BAYER, 16), (&*NOISE, 1)] {
            let mut values = pattern.as_flattened().to_vec();
            values.sort_by(f32::total_cmp);
            let levels = CELLS / times;
            for (at, value) in values.iter().enumerate() {
                assert_eq!(*value, ((at / times) as f32 + 0.5) / levels as f32);
            }
        }
        // The matrix of two by two is in the first columns and rows.
        assert_eq!(
            [bayer(0, 0), bayer(1, 0), bayer(0, 1), bayer(1, 1)].map(|v| (4.0 * v) as u32),
            [0, 2, 3, 1]
        );
    }

    /// Variance of the means of `side` x `side` cells against that of as many independent ones.
    fn clumps(pattern: &Pattern, side: usize) -> f64 {
        let values = pattern.as_flattened();
        let mut sum = 0.0;
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let cells = (0..side * side).map(|i| (x + i % side) % SIDE + (y + i / side) % SIDE * SIDE);
            let mean = cells.map(|at| f64::from(values[at])).sum::<f64>() / (side * side) as f64;
            sum += (mean - 0.5).powi(2);
        }
        sum / CELLS as f64 * 12.0 * (side * side) as f64
    }

    #[test]
    fn blue_noise_has_no_clumps() {
        for (side, most) in [(2, 0.35), (4, 0.22), (8, 0.11)] {
            let found = clumps(&NOISE, side);
            assert!(found < most, "{found:.3} of white noise in {side} x {side}");
        }
    }
}
