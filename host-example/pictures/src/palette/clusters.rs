//! Colours that stand for those of a picture or of a larger palette: clusters in CIELAB by k-means.
//!
//! Sources: S. Lloyd, "Least squares quantization in PCM" (1982); D. Arthur and S. Vassilvitskii, "k-means++: the advantages of
//! careful seeding" (2007). Its random numbers are always the same, so that a file always gives the same colours.

use super::spaces::{Colour, Lab, of_lab, to_lab};
use crate::random::Random;

/// Times that clusters are sought from other beginnings; those with the least error count.
const TRIES: usize = 4;
/// Most steps of a try; most end after twenty.
const STEPS: usize = 60;
/// Bits of a part of a colour by which pixels are gathered before clusters are sought.
const BITS: u32 = 5;
/// Power of the number of pixels of one colour that is its weight. At 1 a sky has half of all colours, and a red coat has none.
const POWER: f32 = 0.5;

/// A colour and how much it counts.
#[derive(Clone, Copy, Debug)]
struct Point {
    lab: Lab,
    weight: f32,
}

/// At most `count` colours that stand for those of pixels, the darkest first.
pub fn found(pixels: &[Colour], count: usize) -> Vec<Colour> {
    let mut middles = clusters(&gathered(pixels), count);
    middles.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut colours: Vec<Colour> = Vec::new();
    for colour in middles.into_iter().map(of_lab) {
        if !colours.contains(&colour) {
            colours.push(colour);
        }
    }
    colours
}

/// At most `count` of some colours, each once, which stand for the others too, in their order.
pub fn reduced(colours: &[Colour], count: usize) -> Vec<Colour> {
    if colours.len() <= count {
        return colours.to_vec();
    }
    let points: Vec<Point> =
        colours.iter().map(|colour| Point { lab: to_lab(*colour), weight: 1.0 }).collect();
    let mut kept: Vec<usize> = Vec::new();
    for middle in clusters(&points, count) {
        let is_free = |at: &usize| !kept.contains(at);
        let far = |at: &usize| distance(points[*at].lab, middle);
        let nearest = (0..points.len()).filter(is_free).min_by(|a, b| far(a).total_cmp(&far(b)));
        kept.extend(nearest);
    }
    kept.sort_unstable();
    kept.into_iter().map(|at| colours[at]).collect()
}

/// Pixels of nearly one colour as one point each.
fn gathered(pixels: &[Colour]) -> Vec<Point> {
    let mut cells = vec![([0.0_f64; 3], 0_u32); 1 << (3 * BITS)];
    for pixel in pixels {
        let cell = pixel.iter().fold(0, |cell, part| cell << BITS | usize::from(part >> (8 - BITS)));
        let (sum, count) = &mut cells[cell];
        sum.iter_mut().zip(to_lab(*pixel)).for_each(|(sum, part)| *sum += f64::from(part));
        *count += 1;
    }
    let full = cells.into_iter().filter(|(_, count)| *count > 0);
    let point = |(sum, count): ([f64; 3], u32)| Point {
        lab: sum.map(|sum| (sum / f64::from(count)) as f32),
        weight: (count as f32).powf(POWER),
    };
    full.map(point).collect()
}

/// Middles of at most `count` clusters.
fn clusters(points: &[Point], count: usize) -> Vec<Lab> {
    if points.len() <= count {
        return points.iter().map(|point| point.lab).collect();
    }
    let mut random = Random::new(0);
    let tries = (0..TRIES).map(|_| settled(points, seeds(points, count, &mut random)));
    tries.min_by(|a, b| a.1.total_cmp(&b.1)).map_or_else(Vec::new, |(middles, _)| middles)
}

/// Beginnings: points by chance, in proportion to their weights and the squares of their distances from those before.
fn seeds(points: &[Point], count: usize, random: &mut Random) -> Vec<Lab> {
    let mut seeds: Vec<Lab> = Vec::new();
    let mut shares: Vec<f32> = points.iter().map(|point| point.weight).collect();
    let mut far = vec![f32::INFINITY; points.len()];
    while seeds.len() < count {
        let mut left = random.share() * shares.iter().map(|share| f64::from(*share)).sum::<f64>();
        let passes = |share: &f32| {
            left -= f64::from(*share);
            *share > 0.0 && left < 0.0
        };
        let at = shares.iter().position(passes).or_else(|| shares.iter().rposition(|share| *share > 0.0));
        let Some(at) = at else { break };
        seeds.push(points[at].lab);
        for ((point, far), share) in points.iter().zip(&mut far).zip(&mut shares) {
            *far = far.min(distance(point.lab, points[at].lab));
            *share = point.weight * *far;
        }
    }
    seeds
}

/// Middles of clusters when they no longer move, and their error: the sum of squares of distances.
fn settled(points: &[Point], mut middles: Vec<Lab>) -> (Vec<Lab>, f64) {
    let mut error = f64::INFINITY;
    for _ in 0..STEPS {
        let mut sums = vec![([0.0_f64; 3], 0.0_f64); middles.len()];
        let mut now = 0.0;
        for point in points {
            let (at, far) = nearest(&middles, point.lab);
            let (sum, weight) = &mut sums[at];
            let own = f64::from(point.weight);
            sum.iter_mut().zip(point.lab).for_each(|(sum, part)| *sum += f64::from(part) * own);
            *weight += own;
            now += f64::from(far) * own;
        }
        if now >= error {
            break;
        }
        error = now;
        for (middle, (sum, weight)) in middles.iter_mut().zip(sums) {
            if weight > 0.0 {
                *middle = sum.map(|sum| (sum / weight) as f32);
            }
        }
    }
    (middles, error)
}

/// The middle that is nearest to a colour, and the square of its distance.
fn nearest(middles: &[Lab], lab: Lab) -> (usize, f32) {
    let mut found = (0, f32::INFINITY);
    for (at, middle) in middles.iter().enumerate() {
        let far = distance(*middle, lab);
        if far < found.1 {
            found = (at, far);
        }
    }
    found
}

/// The square of the distance of two colours.
fn distance(a: Lab, b: Lab) -> f32 {
    let [l, x, y] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l * l + x * x + y * y
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLAT: [Colour; 3] = [[16, 32, 48], [176, 64, 40], [240, 232, 216]];

    #[test]
    fn flat_colours_are_found_exactly_whatever_their_areas() {
        let pixels: Vec<Colour> = (0..3000).map(|i| FLAT[[2, 2, 2, 0, 0, 1][i % 6]]).collect();
        for count in [3, 4, 16] {
            assert_eq!(found(&pixels, count), FLAT, "{count}");
        }
        assert_eq!(found(&pixels, 2).len(), 2);
        assert_eq!(found(&[], 8), Vec::<Colour>::new());
    }

    #[test]
    fn clusters_with_noise_have_their_middles_every_time() {
        let noise = |i: usize, part: usize| (i * (7 + part * 4) % 13) as i16 - 6;
        let pixel = |i: usize| {
            let colour = FLAT[i % 3];
            [0, 1, 2].map(|part: usize| (i16::from(colour[part]) + noise(i / 3, part)) as u8)
        };
        let pixels: Vec<Colour> = (0..6000).map(pixel).collect();
        let first = found(&pixels, 3);
        for (found, flat) in first.iter().zip(FLAT) {
            assert!(found.iter().zip(flat).all(|(a, b)| a.abs_diff(b) <= 3), "{first:?}");
        }
        assert_eq!(found(&pixels, 3), first);
        let reversed: Vec<Colour> = pixels.iter().rev().copied().collect();
        assert_eq!(found(&reversed, 3), first);
    }

    #[test]
    fn a_small_vivid_area_is_found_beside_a_large_grey_one() {
        let grey = (0..60_000).map(|i| [(i % 180 + 40) as u8; 3]);
        let pixels: Vec<Colour> = grey.chain(std::iter::repeat_n([220, 30, 30], 300)).collect();
        assert!(found(&pixels, 6).contains(&[220, 30, 30]), "{:?}", found(&pixels, 6));
    }

    #[test]
    fn reduced_palettes_keep_colours_of_their_own_in_their_order() {
        let many: Vec<Colour> = (0..64_u8).map(|i| [i % 4 * 85, i / 4 % 4 * 85, i / 16 * 85]).collect();
        let few = reduced(&many, 16);
        assert_eq!(few.len(), 16);
        let places: Vec<usize> =
            few.iter().map(|own| many.iter().position(|colour| colour == own).unwrap()).collect();
        assert!(places.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(reduced(&FLAT, 16), FLAT);
        assert_eq!(reduced(&[[9; 3], [9; 3], [9; 3]], 2), [[9; 3]]);
    }
}
