//! Papers that ship, made of noise, fibres and the light of a low sun.

use std::f64::consts::TAU;

use super::shipped::{SIDE, Shipped};
use super::surface::{cellular, lit, noise};
use crate::random::Random;

/// The papers.
pub(super) const ALL: [Shipped; 6] = [
    Shipped { name: "cold_press", doc: "Watercolour paper with a rough, pebbled grain.", made: cold_press },
    Shipped { name: "hot_press", doc: "Smooth white drawing paper.", made: hot_press },
    Shipped { name: "laid", doc: "Cream laid paper, with the lines of its mould.", made: laid },
    Shipped { name: "canvas", doc: "Primed linen, in a plain weave.", made: canvas },
    Shipped { name: "kraft", doc: "Brown wrapping paper with fibres.", made: kraft },
    Shipped { name: "washi", doc: "Handmade paper with long fibres.", made: washi },
];

fn cold_press() -> Vec<u8> {
    let (pebbles, lumps, fine) = (cellular(9.0, 1), cellular(17.0, 5), noise(3.0, 9));
    let height = |x: f64, y: f64| -0.30 * pebbles(x, y) - 0.40 * lumps(x, y) + 0.05 * fine(x, y);
    tinted([0.972, 0.966, 0.948], &lit(height))
}

fn hot_press() -> Vec<u8> {
    let (fine, soft) = (noise(2.6, 21), noise(7.0, 22));
    tinted([0.984, 0.980, 0.968], &lit(|x, y| 0.022 * fine(x, y) + 0.05 * soft(x, y)))
}

fn laid() -> Vec<u8> {
    let (fine, soft, uneven) = (noise(2.6, 31), noise(9.0, 32), noise(64.0, 33));
    let height = |x: f64, y: f64| {
        // Wires of the mould, 4 pixels apart, and chains that hold them.
        let wires = 0.014 * (TAU * (y / 4.0 + 0.3 * uneven(x, y))).cos();
        let chain = (x % 64.0 - 32.0) / 1.6;
        wires - 0.035 * (-chain * chain).exp() + 0.03 * fine(x, y) + 0.05 * soft(x, y)
    };
    tinted([0.953, 0.928, 0.866], &lit(height))
}

fn canvas() -> Vec<u8> {
    const THREAD: f64 = 8.0;
    let (thick, fine) = (noise(40.0, 41), noise(2.6, 42));
    let height = |x: f64, y: f64| {
        let (column, row) = ((x / THREAD).floor() as i64, (y / THREAD).floor() as i64);
        let [u, v] = [x, y].map(|t| (t / THREAD).fract() - 0.5);
        // Threads arch where they lie above the others.
        let is_warp = (column + row) % 2 == 0;
        let (along, across) = if is_warp { (v, u) } else { (u, v) };
        let thread = (1.0 - 3.4 * across * across).max(0.0).sqrt() * (0.6 + 0.4 * (TAU / 2.0 * along).cos());
        (0.16 + 0.12 * thick(x, y)) * thread + 0.05 * fine(x, y)
    };
    tinted([0.925, 0.902, 0.848], &lit(height))
}

fn kraft() -> Vec<u8> {
    let (fine, soft, cloud) = (noise(2.6, 51), noise(6.0, 52), noise(48.0, 53));
    let mut light = lit(|x, y| 0.05 * fine(x, y) + 0.07 * soft(x, y) + 0.4 * cloud(x, y));
    fibres(&mut light, &Fibres { count: 900, length: [8.0, 26.0], strength: [-0.16, 0.12], bend: 0.05 });
    tinted([0.733, 0.588, 0.427], &light)
}

fn washi() -> Vec<u8> {
    let (fine, soft) = (noise(2.6, 61), noise(12.0, 62));
    let mut light = lit(|x, y| 0.03 * fine(x, y) + 0.08 * soft(x, y));
    fibres(&mut light, &Fibres { count: 420, length: [40.0, 170.0], strength: [-0.07, 0.045], bend: 0.03 });
    tinted([0.953, 0.944, 0.917], &light)
}

/// Fibres in a sheet.
struct Fibres {
    count: usize,
    /// Shortest and longest, pixels.
    length: [f64; 2],
    /// What the darkest and the lightest change of the light.
    strength: [f64; 2],
    /// Most that they turn in a pixel, radians.
    bend: f64,
}

fn fibres(light: &mut [f64], fibres: &Fibres) {
    let mut random = Random::new(7);
    for _ in 0..fibres.count {
        let (mut x, mut y) = (random.share() * SIDE as f64, random.share() * SIDE as f64);
        let mut angle = random.share() * TAU;
        let length = random.between(fibres.length[0], fibres.length[1]);
        let strength = random.between(fibres.strength[0], fibres.strength[1]);
        let (mut turn, mut gone) = (0.0, 0.0);
        while gone < length {
            // Thinner towards the ends, half a pixel at a time.
            let share = strength * (1.0 - (2.0 * gone / length - 1.0).powi(4)) * 0.5;
            let (left, top) = ((x - 0.5).floor(), (y - 0.5).floor());
            let (u, v) = (x - 0.5 - left, y - 0.5 - top);
            for (i, j, weight) in
                [(0, 0, (1.0 - u) * (1.0 - v)), (1, 0, u * (1.0 - v)), (0, 1, (1.0 - u) * v), (1, 1, u * v)]
            {
                let [i, j] = [(left, i), (top, j)]
                    .map(|(at, more)| (at as i64 + more).rem_euclid(SIDE as i64) as usize);
                light[j * SIDE + i] *= 1.0 + share * weight;
            }
            turn = 0.96 * turn + random.between(-fibres.bend, fibres.bend) * 0.3;
            angle += 0.5 * turn;
            (x, y) = (x + 0.5 * angle.cos(), y + 0.5 * angle.sin());
            gone += 0.5;
        }
    }
}

/// Paper of a colour under this light, 8 bits a channel.
fn tinted(colour: [f64; 3], light: &[f64]) -> Vec<u8> {
    let byte = |v: f64| (v * 255.0).round().clamp(0.0, 255.0) as u8;
    light.iter().flat_map(|light| colour.map(|v| byte(v * light))).collect()
}
