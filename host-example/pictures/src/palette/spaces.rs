//! Colours of palettes, and the spaces that files have them in.
//!
//! Sources: CIE 15 (CIELAB); B. Lindbloom, "RGB/XYZ matrices" (sRGB adapted to D50 by Bradford's method), which is the white
//! that Adobe's programs and ICC profiles mean by Lab.

use crate::transfer::{srgb_decode, srgb_encode};

/// A colour: gamma-encoded sRGB, 8 bits each.
pub type Colour = [u8; 3];

/// A colour in CIELAB with the white of D50: L in 0..100, a, b.
pub type Lab = [f32; 3];

/// White of D50, X, Y, Z.
const WHITE: [f32; 3] = [0.964_22, 1.0, 0.825_21];
/// Linear sRGB to XYZ of D50.
const TO_XYZ: [[f32; 3]; 3] = [
    [0.436_074_7, 0.385_064_9, 0.143_080_4],
    [0.222_504_5, 0.716_878_6, 0.060_616_9],
    [0.013_932_2, 0.097_104_5, 0.714_173_3],
];
/// XYZ of D50 to linear sRGB.
const FROM_XYZ: [[f32; 3]; 3] = [
    [3.133_856_1, -1.616_866_7, -0.490_614_6],
    [-0.978_768_4, 1.916_141_5, 0.033_454],
    [0.071_945_3, -0.228_991_4, 1.405_242_7],
];
/// Bounds of the linear part of CIELAB, (6/29)^3, and its slope, (29/3)^3 / 116 (CIE 15).
const LINEAR: f32 = 216.0 / 24389.0;
const SLOPE: f32 = 24389.0 / 27.0 / 116.0;

/// A colour of numbers from 0 to 1, rounded to the nearest; what is beyond is bounded.
pub fn rounded(rgb: [f32; 3]) -> Colour {
    rgb.map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

/// A colour as presets and `--set` write it: `#rrggbb`.
pub fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A colour in CIELAB.
pub fn to_lab(colour: Colour) -> Lab {
    let linear = colour.map(|v| srgb_decode(f32::from(v) / 255.0));
    let bent = |row: [f32; 3], white: f32| {
        let v = dot(row, linear) / white;
        if v > LINEAR { v.cbrt() } else { SLOPE * v + 16.0 / 116.0 }
    };
    let [x, y, z] = [0, 1, 2].map(|i: usize| bent(TO_XYZ[i], WHITE[i]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The nearest colour of sRGB, part by part, to one of CIELAB; what no file can mean is bounded.
pub fn of_lab([l, a, b]: Lab) -> Colour {
    let (l, [a, b]) = (l.clamp(0.0, 100.0), [a, b].map(|v| v.clamp(-128.0, 128.0)));
    let y = (l + 16.0) / 116.0;
    let unbent = |v: f32| {
        let cube = v * v * v;
        if cube > LINEAR { cube } else { (v - 16.0 / 116.0) / SLOPE }
    };
    let bent = [y + a / 500.0, y, y - b / 200.0];
    let xyz = [0, 1, 2].map(|i: usize| unbent(bent[i]) * WHITE[i]);
    rounded(FROM_XYZ.map(|row| srgb_encode(dot(row, xyz).clamp(0.0, 1.0))))
}

/// A colour of inks from 0 to 1, as if each took its share of one of the three lights; no profile is known of a palette.
pub fn of_inks([c, m, y, k]: [f32; 4]) -> Colour {
    rounded([c, m, y].map(|ink| (1.0 - ink) * (1.0 - k)))
}

/// A colour of hue in turns, saturation and brightness, each from 0 to 1 (A. R. Smith, 1978: the hexcone).
pub fn of_hsb([hue, saturation, brightness]: [f32; 3]) -> Colour {
    let share = |shift: f32| {
        let place = (hue * 6.0 + shift).rem_euclid(6.0);
        let away = place.min(4.0 - place).clamp(0.0, 1.0);
        brightness * (1.0 - saturation * away)
    };
    rounded([5.0, 3.0, 1.0].map(share))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_colours_come_back_from_cielab() {
        for i in 0..=32_u32.pow(3) {
            let colour = [i % 32, i / 32 % 32, i / 1024].map(|v| (v * 255 / 32) as u8);
            assert_eq!(of_lab(to_lab(colour)), colour);
        }
    }

    #[test]
    fn known_colours_have_their_numbers() {
        // Lindbloom's calculator: sRGB to Lab, D50.
        for (colour, lab) in [
            ([255, 255, 255], [100.0, 0.0, 0.0]),
            ([0, 0, 0], [0.0, 0.0, 0.0]),
            ([255, 0, 0], [54.29, 80.81, 69.89]),
            ([0, 0, 255], [29.57, 68.30, -112.03]),
        ] {
            let found = to_lab(colour);
            assert!(
                found.iter().zip(lab).all(|(a, b): (&f32, f32)| (a - b).abs() < 0.05),
                "{found:?} {lab:?}"
            );
        }
        assert_eq!(of_lab([50.0, 0.0, 0.0]), [119; 3]);
        assert_eq!(of_lab([1e9, 0.0, 0.0]), [255; 3]);
    }

    #[test]
    fn hues_and_inks_are_the_usual_ones() {
        for (turn, colour) in [
            (0.0, [255, 0, 0]),
            (60.0, [255, 255, 0]),
            (120.0, [0, 255, 0]),
            (180.0, [0, 255, 255]),
            (240.0, [0, 0, 255]),
            (300.0, [255, 0, 255]),
            (360.0, [255, 0, 0]),
            (210.0, [0, 128, 255]),
        ] {
            assert_eq!(of_hsb([turn / 360.0, 1.0, 1.0]), colour, "{turn}");
        }
        assert_eq!(of_hsb([0.3, 0.0, 0.5]), [128; 3]);
        assert_eq!(of_hsb([0.0, 0.5, 1.0]), [255, 128, 128]);
        assert_eq!(of_inks([1.0, 0.0, 0.0, 0.0]), [0, 255, 255]);
        assert_eq!(of_inks([0.0, 0.5, 1.0, 0.0]), [255, 128, 0]);
        assert_eq!(of_inks([0.0, 0.0, 0.0, 1.0]), [0; 3]);
    }
}
