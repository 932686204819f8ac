//! Icons of effects: nested bands of light around a centre, the isophotes of a soft hill. Their form comes
//! from the effect's id and their hue from its group, so that each has its own and keeps it.

use image::{Rgba, RgbaImage};
use std::fmt::Write as _;

/// Side of effects' icons in pixels, and of all drawings in their own units.
pub const SIDE: u32 = 128;
/// Bands, from the outermost in.
const BANDS: usize = 6;
/// Samples of a pixel's side.
const SAMPLES: u32 = 4;
const CORNER: f32 = 20.0;

/// One effect's picture.
#[derive(Debug)]
pub struct Icon {
    /// Lobes of the bands, and how far each kind swings.
    lobes: [(f32, f32, f32); 3],
    centre: [f32; 2],
    colours: [[u8; 3]; BANDS + 1],
}

impl Icon {
    /// The icon of an effect.
    pub fn new(id: &str, group: &str) -> Self {
        let mut state = id
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 40) as f32) / 16_777_216.0
        };
        let lobes = [(2.0, 0.14), (3.0, 0.11), (5.0, 0.05)]
            .map(|(n, swing)| (n, swing * (0.35 + 0.65 * next()), next() * std::f32::consts::TAU));
        let centre = [next(), next()].map(|v| 64.0 + 10.0 * (v - 0.5));
        let hue = match group {
            "structure" => [0.30, 0.62, 0.60],
            "smoothing" => [0.30, 0.50, 0.85],
            "lines" => [0.45, 0.45, 0.50],
            "painting" => [0.86, 0.48, 0.20],
            "coherence" => [0.55, 0.40, 0.78],
            "colour" => [0.80, 0.33, 0.42],
            "time" => [0.72, 0.58, 0.20],
            _ => [0.28, 0.58, 0.32],
        };
        let mut colours = [[0; 3]; BANDS + 1];
        for (band, colour) in colours.iter_mut().enumerate() {
            // From a dark shade of the hue to nearly white.
            let t = band as f32 / BANDS as f32;
            for (c, h) in colour.iter_mut().zip(hue) {
                let v = if t < 0.5 { h * (0.35 + 1.3 * t) } else { h + (1.0 - h) * (2.0 * t - 1.0) * 0.92 };
                *c = (v * 255.0 + 0.5) as u8;
            }
        }
        Self { lobes, centre, colours }
    }

    /// Radius of a band in a direction.
    fn radius(&self, band: usize, angle: f32) -> f32 {
        let size = 56.0 * (1.0 - band as f32 / (BANDS as f32 + 0.4));
        let swing: f32 = self.lobes.iter().map(|(n, a, phase)| a * (n * angle + phase).sin()).sum();
        size * (1.0 + swing)
    }

    /// As so many pixels across and down.
    pub fn raster(&self, side: u32) -> RgbaImage {
        let unit = SIDE as f32 / side as f32;
        RgbaImage::from_fn(side, side, |x, y| {
            let (mut sum, mut covered) = ([0.0_f32; 3], 0.0_f32);
            for sample in 0..SAMPLES * SAMPLES {
                let at = |pixel: u32, n: u32| (pixel as f32 + (n as f32 + 0.5) / SAMPLES as f32) * unit;
                let (x, y) = (at(x, sample % SAMPLES), at(y, sample / SAMPLES));
                if outside(x, y) {
                    continue;
                }
                let (dx, dy) = (x - self.centre[0], y - self.centre[1]);
                let (distance, angle) = (dx.hypot(dy), dy.atan2(dx));
                let inner = (0..BANDS).take_while(|band| distance < self.radius(*band, angle)).count();
                for (s, c) in sum.iter_mut().zip(self.colours[inner]) {
                    *s += f32::from(c);
                }
                covered += 1.0;
            }
            let [r, g, b] = sum.map(|s| (s / covered.max(1.0) + 0.5) as u8);
            Rgba([r, g, b, (255.0 * covered / (SAMPLES * SAMPLES) as f32 + 0.5) as u8])
        })
    }

    /// As drawing.
    pub fn drawing(&self) -> String {
        let fill = |band: usize| {
            let [r, g, b] = self.colours[band];
            format!("#{r:02x}{g:02x}{b:02x}")
        };
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{SIDE}\" height=\"{SIDE}\" viewBox=\"0 0 {SIDE} {SIDE}\">\n\
             <clipPath id=\"frame\"><rect width=\"{SIDE}\" height=\"{SIDE}\" rx=\"{CORNER}\"/></clipPath>\n\
             <g clip-path=\"url(#frame)\">\n<rect width=\"{SIDE}\" height=\"{SIDE}\" fill=\"{}\"/>\n",
            fill(0)
        );
        for band in 0..BANDS {
            let mut points = String::new();
            for step in 0..72 {
                let angle = step as f32 / 72.0 * std::f32::consts::TAU;
                let r = self.radius(band, angle);
                let (x, y) = (self.centre[0] + r * angle.cos(), self.centre[1] + r * angle.sin());
                let _ = write!(points, "{x:.1},{y:.1} ");
            }
            let _ = writeln!(svg, "<polygon fill=\"{}\" points=\"{}\"/>", fill(band + 1), points.trim_end());
        }
        svg + "</g>\n</svg>\n"
    }
}

/// Beyond the rounded frame.
fn outside(x: f32, y: f32) -> bool {
    let side = SIDE as f32;
    let beyond = |v: f32| (CORNER - v).max(v - (side - CORNER)).max(0.0);
    beyond(x).hypot(beyond(y)) > CORNER
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn icons_differ_and_stay() {
        let (a, b) = (Icon::new("gaussian", "smoothing"), Icon::new("cartoon", "styles"));
        assert_ne!(a.raster(SIDE), b.raster(SIDE));
        assert_eq!(a.drawing(), Icon::new("gaussian", "smoothing").drawing());
        for side in [16, SIDE, 512] {
            let picture = a.raster(side);
            // The frame is round, and a pixel of a small picture holds some of it.
            assert!(picture.get_pixel(0, 0)[3] < 64, "{side}");
            assert_eq!(picture.get_pixel(side / 2, side / 2)[3], 255);
        }
    }
}
