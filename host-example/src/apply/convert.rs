//! From the numbers of one family of files to those of the other.

use super::read::Family;
use crate::cli::Space;
use crate::output::srgb_encode;
use crate::pixels::{Pixels, Samples};

/// ACEScg (AP1, white of ACES) to linear Rec.709 (white D65), adapted by the Bradford method.
const REC709_FROM_AP1: [[f32; 3]; 3] = [
    [1.705_050_99, -0.621_792_12, -0.083_258_87],
    [-0.130_256_42, 1.140_804_74, -0.010_548_32],
    [-0.024_003_36, -0.128_968_98, 1.152_972_33],
];

/// Turns colours that a graph gave for a picture of `from` in `space` into what a file of `to` holds. PNG and
/// JPEG become sRGB from whatever EXR held; EXR becomes light of the same primaries.
pub fn between(pixels: Pixels, from: Family, space: Space, to: Family) -> Pixels {
    if from == to {
        return pixels;
    }
    let (width, height, channels) = (pixels.width(), pixels.height(), pixels.channels());
    let mut numbers = pixels.to_f32();
    for pixel in numbers.chunks_exact_mut(channels as usize) {
        let (color, alpha) = match pixel {
            [r, g, b, a] => ([r, g, b], *a),
            [r, g, b] => ([r, g, b], 1.0),
            _ => continue,
        };
        let [r, g, b] = color;
        let mut rgb = [*r, *g, *b];
        match to {
            Family::Display => {
                if alpha > 0.0 {
                    rgb = rgb.map(|v| v / alpha);
                }
                if space == Space::Acescg {
                    rgb = REC709_FROM_AP1.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]);
                }
                if space != Space::Srgb {
                    rgb = rgb.map(srgb_encode);
                }
            }
            Family::Light => {
                if space == Space::Srgb {
                    rgb = rgb.map(srgb_decode);
                }
                rgb = rgb.map(|v| v * alpha);
            }
        }
        [*r, *g, *b] = rgb;
    }
    let samples = Samples::F32(numbers);
    // The number of samples is that of `pixels`.
    Pixels::new(width, height, channels, samples).unwrap_or(pixels)
}

/// Linear light of a gamma-encoded value (IEC 61966-2-1).
fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_where_it_was() {
        let numbers: Vec<f32> =
            (0..8 * 4).map(|i| [0.0f32, 0.02, 0.5, 1.0][i % 4].max(0.01 * i as f32)).collect();
        let picture = Pixels::new(8, 1, 4, Samples::F32(numbers.clone())).unwrap();
        let light = between(picture.clone(), Family::Display, Space::Srgb, Family::Light);
        assert_ne!(light, picture);
        let back = between(light, Family::Light, Space::Linear, Family::Display).to_f32();
        for (a, b) in back.iter().zip(&numbers) {
            assert!((a - b).abs() < 1e-5, "{a} {b}");
        }
    }

    #[test]
    fn white_stays_white_and_primaries_widen() {
        let aces = Pixels::new(2, 1, 3, Samples::F32(vec![1.0, 1.0, 1.0, 0.0, 1.0, 0.0])).unwrap();
        let display = between(aces, Family::Light, Space::Acescg, Family::Display).to_f32();
        assert!(display[..3].iter().all(|v| (v - 1.0).abs() < 1e-6));
        assert!(display[3] < 0.0 && display[4] > 1.0);
    }
}
