//! Hatchings that ship: marks that are drawn one after the other until a tone is full, so that the marks of each tone are in
//! all that are darker (E. Praun and others, "Real-time hatching", 2001).

use std::f64::consts::TAU;

use super::shipped::{SIDE, Shipped};
use crate::random::Random;

/// The hatchings.
pub(super) const ALL: [Shipped; 6] = [
    Shipped { name: "pen", doc: "Strokes of a pen, crossed in the darks.", made: pen },
    Shipped {
        name: "cross_hatch",
        doc: "Fine lines in four directions, one for each tone.",
        made: cross_hatch,
    },
    Shipped { name: "stipple", doc: "Dots, as many as the tone is dark.", made: stipple },
    Shipped { name: "engraving", doc: "Long waving lines that swell with the tone.", made: engraving },
    Shipped { name: "scribble", doc: "Loops of a pen that is not lifted.", made: scribble },
    Shipped { name: "gouges", doc: "Tapered cuts, as in a block of wood.", made: gouges },
];

/// Share of the paper that each tone covers.
const TONES: [f64; 4] = [0.14, 0.31, 0.52, 0.76];

/// Most marks of a tone, beyond which nothing would fill it.
const MOST: usize = 200_000;

fn pen() -> Vec<u8> {
    let mut random = Random::new(11);
    nested(|sheet, tone, place| {
        let angle = if tone < 2 { -0.72 } else { -1.75 } + random.between(-0.05, 0.05);
        let pen = Pen { width: random.between(0.65, 1.05), taper: 0.5, bend: random.between(-0.1, 0.1) };
        sheet.stroke(place, angle, random.between(40.0, 95.0), &pen);
    })
}

fn cross_hatch() -> Vec<u8> {
    let mut random = Random::new(12);
    nested(|sheet, tone, place| {
        let angle = [-0.78, 0.78, 0.02, 1.55][tone] + random.between(-0.02, 0.02);
        let pen = Pen { width: random.between(0.5, 0.7), taper: 0.2, bend: random.between(-0.03, 0.03) };
        sheet.stroke(place, angle, random.between(70.0, 150.0), &pen);
    })
}

fn stipple() -> Vec<u8> {
    let mut random = Random::new(13);
    nested(|sheet, _, place| sheet.dot(place, random.between(0.85, 1.35)))
}

fn engraving() -> Vec<u8> {
    // Lines 8 pixels apart, whose width is the tone's.
    const APART: f64 = 8.0;
    let mut random = Random::new(14);
    let phases: Vec<f64> = (0..SIDE / 8).map(|_| random.share()).collect();
    let covered = |x: f64, y: f64, tone: f64| {
        let wave = 1.6 * (TAU * x / 256.0).sin() + 0.7 * (TAU * x / 128.0 + 1.0).sin();
        let line = (y - wave) / APART;
        let own = phases[(line.floor() as i64).rem_euclid(phases.len() as i64) as usize];
        let width = tone * APART * (1.0 + 0.1 * (TAU * (x / 128.0 + own)).sin());
        let far = ((line - line.floor()) - 0.5).abs() * APART;
        (0.5 * width - far + 0.5).clamp(0.0, 1.0)
    };
    let mut samples = Vec::with_capacity(SIDE * SIDE * 4);
    for i in 0..SIDE * SIDE {
        let (x, y) = ((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5);
        samples.extend(TONES.map(|tone| byte(1.0 - covered(x, y, tone))));
    }
    samples
}

fn scribble() -> Vec<u8> {
    let mut random = Random::new(15);
    nested(|sheet, _, [x, y]| {
        // Some loops of one movement.
        let (along, radius, from) =
            (random.between(-0.5, 0.5), random.between(4.5, 9.0), random.share() * TAU);
        let (turns, width) = (random.between(3.0, 7.0), random.between(0.5, 0.75));
        let mut turn = 0.0;
        while turn < turns * TAU {
            let (forward, angle) = (1.7 * turn - 0.85 * turns * TAU, from + turn);
            let [u, v] = [forward + radius * angle.cos(), 1.3 * radius * angle.sin()];
            sheet.dot([x + u * along.cos() - v * along.sin(), y + u * along.sin() + v * along.cos()], width);
            turn += 0.5 / radius;
        }
    })
}

fn gouges() -> Vec<u8> {
    let mut random = Random::new(16);
    nested(|sheet, tone, place| {
        let pen = Pen {
            width: random.between(1.3, 2.0 + 0.2 * tone as f64),
            taper: 1.0,
            bend: random.between(-0.12, 0.12),
        };
        sheet.stroke(place, -0.35 + random.between(-0.09, 0.09), random.between(26.0, 60.0), &pen);
    })
}

/// Tool of a stroke.
struct Pen {
    /// Half of the width in the middle, pixels.
    width: f64,
    /// Share of that by which the ends are thinner, 0..=1.
    taper: f64,
    /// Turn over the whole length, radians.
    bend: f64,
}

/// Ink on a tile.
struct Sheet {
    /// Share of each pixel that it covers.
    ink: Vec<f64>,
    sum: f64,
}

impl Sheet {
    /// A stroke about its middle.
    fn stroke(&mut self, [x, y]: [f64; 2], angle: f64, length: f64, pen: &Pen) {
        let steps = (length / 0.5).ceil();
        let (mut x, mut y) = (x - 0.5 * length * angle.cos(), y - 0.5 * length * angle.sin());
        for step in 0..=steps as usize {
            let t = 2.0 * step as f64 / steps - 1.0;
            let angle = angle + 0.5 * pen.bend * t;
            self.dot([x, y], pen.width * (1.0 - pen.taper * t * t));
            (x, y) = (x + length / steps * angle.cos(), y + length / steps * angle.sin());
        }
    }

    /// A round dot.
    fn dot(&mut self, [x, y]: [f64; 2], radius: f64) {
        let reach = radius + 0.5;
        let range = |at: f64| (at - reach - 0.5).floor() as i64..=(at + reach - 0.5).ceil() as i64;
        for j in range(y) {
            for i in range(x) {
                let far = (i as f64 + 0.5 - x).hypot(j as f64 + 0.5 - y);
                let [column, row] = [i, j].map(|at| at.rem_euclid(SIDE as i64) as usize);
                let ink = &mut self.ink[row * SIDE + column];
                // A dot thinner than a pixel is fainter.
                let more = ((radius - far + 0.5).clamp(0.0, 1.0) * (2.0 * radius).min(1.0) - *ink).max(0.0);
                *ink += more;
                self.sum += more;
            }
        }
    }
}

/// Four tones of marks, which `mark` draws for a tone at a place. Places are spread evenly, however many there are (M. Roberts,
/// "The unreasonable effectiveness of quasirandom sequences", 2018), and each a little aside.
fn nested(mut mark: impl FnMut(&mut Sheet, usize, [f64; 2])) -> Vec<u8> {
    const STEP: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let mut random = Random::new(3);
    let mut sheet = Sheet { ink: vec![0.0; SIDE * SIDE], sum: 0.0 };
    let mut tones: Vec<Vec<f64>> = Vec::new();
    let mut count = 0;
    for (tone, share) in TONES.into_iter().enumerate() {
        let first = count;
        while count - first < MOST && sheet.sum < share * (SIDE * SIDE) as f64 {
            let place = STEP
                .map(|step| (step * (count + 1) as f64).fract() * SIDE as f64 + random.between(-2.0, 2.0));
            mark(&mut sheet, tone, place);
            count += 1;
        }
        tones.push(sheet.ink.clone());
    }
    (0..SIDE * SIDE * 4).map(|i| byte(1.0 - tones[i % 4][i / 4])).collect()
}

fn byte(v: f64) -> u8 {
    (v * 255.0).round().clamp(0.0, 255.0) as u8
}
