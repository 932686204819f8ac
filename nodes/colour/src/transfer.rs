//! Transfer functions: linear light of encoded values, and back.
//!
//! Source: IEC 61966-2-1 (sRGB), Rec. ITU-R BT.709 and BT.2020, BT.2100 (PQ and HLG) with the white of graphics of BT.2408.

use std::sync::Arc;

/// Light of white graphics in PQ and HLG, candelas a square metre (BT.2408): here it is 1.
const WHITE: f32 = 203.0;
/// Light of the brightest PQ value, candelas a square metre.
const PQ_PEAK: f32 = 10_000.0;
/// Light of the brightest HLG value on the display that is meant, candelas a square metre.
const HLG_PEAK: f32 = 1000.0;
/// Exponent of that display beyond the camera's curve.
const HLG_GAMMA: f32 = 1.2;
/// Weights of red, green and blue in the luminance of BT.2100.
const LUMINANCE: [f32; 3] = [0.2627, 0.6780, 0.0593];

/// Relation of numbers to light.
#[derive(Clone, Debug, PartialEq)]
pub enum Transfer {
    /// Numbers are light.
    Linear,
    /// IEC 61966-2-1.
    Srgb,
    /// BT.709, also BT.601 and BT.2020: the camera's curve.
    Rec709,
    /// Light is a power of numbers.
    Gamma(f32),
    /// BT.2100 PQ (SMPTE ST 2084), 1 for white graphics.
    Pq,
    /// BT.2100 HLG on its display of 1000 candelas, 1 for white graphics.
    Hlg,
    /// Curves of a profile for red, green and blue.
    Curves(Arc<[Curve; 3]>),
}

/// Light at values from 0 to 1, equally far apart, that never falls.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve(Vec<f32>);

impl Curve {
    /// A curve through at least two samples; nothing where they fall or say nothing.
    pub fn new(samples: Vec<f32>) -> Option<Self> {
        let is_rising = samples.windows(2).all(|pair| pair[0] <= pair[1]);
        let (first, last) = (*samples.first()?, *samples.last()?);
        (is_rising && first.is_finite() && last.is_finite() && first < last).then_some(Self(samples))
    }

    fn decode(&self, value: f32) -> f32 {
        let at = value.clamp(0.0, 1.0) * (self.0.len() - 1) as f32;
        let before = (at as usize).min(self.0.len() - 2);
        let (low, high) = (self.0[before], self.0[before + 1]);
        low + (high - low) * (at - before as f32)
    }

    fn encode(&self, light: f32) -> f32 {
        let after = self.0.partition_point(|sample| *sample < light).clamp(1, self.0.len() - 1);
        let (low, high) = (self.0[after - 1], self.0[after]);
        let share = if high > low { ((light - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        ((after - 1) as f32 + share) / (self.0.len() - 1) as f32
    }
}

impl Transfer {
    /// Light of a colour.
    pub fn decode(&self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Linear => rgb,
            Self::Srgb => rgb.map(srgb_decode),
            Self::Rec709 => rgb.map(rec709_decode),
            Self::Gamma(gamma) => rgb.map(|v| v.abs().powf(*gamma).copysign(v)),
            Self::Pq => rgb.map(pq_decode),
            Self::Hlg => hlg_decode(rgb),
            Self::Curves(curves) => [0, 1, 2].map(|c: usize| curves[c].decode(rgb[c])),
        }
    }

    /// The colour of light.
    pub fn encode(&self, light: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Linear => light,
            Self::Srgb => light.map(srgb_encode),
            Self::Rec709 => light.map(rec709_encode),
            Self::Gamma(gamma) => light.map(|v| v.abs().powf(1.0 / gamma).copysign(v)),
            Self::Pq => light.map(pq_encode),
            Self::Hlg => hlg_encode(light),
            Self::Curves(curves) => [0, 1, 2].map(|c: usize| curves[c].encode(light[c])),
        }
    }
}

/// Encodes linear light in [0, 1] for sRGB displays (IEC 61966-2-1).
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Linear light of a gamma-encoded value (IEC 61966-2-1).
pub fn srgb_decode(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

fn rec709_encode(light: f32) -> f32 {
    if light < 0.018_053_97 { 4.5 * light } else { 1.099_296_8 * light.powf(0.45) - 0.099_296_8 }
}

fn rec709_decode(value: f32) -> f32 {
    if value < 0.081_242_86 { value / 4.5 } else { ((value + 0.099_296_8) / 1.099_296_8).powf(1.0 / 0.45) }
}

const PQ_M: [f32; 2] = [2610.0 / 16384.0, 2523.0 / 4096.0 * 128.0];
const PQ_C: [f32; 3] = [3424.0 / 4096.0, 2413.0 / 4096.0 * 32.0, 2392.0 / 4096.0 * 32.0];

fn pq_decode(value: f32) -> f32 {
    let root = value.clamp(0.0, 1.0).powf(1.0 / PQ_M[1]);
    let light = ((root - PQ_C[0]).max(0.0) / (PQ_C[1] - PQ_C[2] * root)).powf(1.0 / PQ_M[0]);
    light * PQ_PEAK / WHITE
}

fn pq_encode(light: f32) -> f32 {
    let power = (light * WHITE / PQ_PEAK).clamp(0.0, 1.0).powf(PQ_M[0]);
    ((PQ_C[0] + PQ_C[1] * power) / (1.0 + PQ_C[2] * power)).powf(PQ_M[1])
}

const HLG: [f32; 3] = [0.178_832_77, 0.284_668_92, 0.559_910_73];

fn luminance(rgb: [f32; 3]) -> f32 {
    rgb.iter().zip(LUMINANCE).map(|(value, weight)| value * weight).sum()
}

fn hlg_decode(rgb: [f32; 3]) -> [f32; 3] {
    let [a, b, c] = HLG;
    let scene = rgb.map(|v| {
        let v = v.clamp(0.0, 1.0);
        if v <= 0.5 { v * v / 3.0 } else { (((v - c) / a).exp() + b) / 12.0 }
    });
    let factor = luminance(scene).powf(HLG_GAMMA - 1.0) * HLG_PEAK / WHITE;
    scene.map(|v| v * factor)
}

fn hlg_encode(light: [f32; 3]) -> [f32; 3] {
    let [a, b, c] = HLG;
    let shown = light.map(|v| (v * WHITE / HLG_PEAK).max(0.0));
    let total = luminance(shown);
    let factor = if total > 0.0 { total.powf((1.0 - HLG_GAMMA) / HLG_GAMMA) } else { 0.0 };
    shown.map(|v| {
        let scene = (v * factor).min(1.0);
        if scene <= 1.0 / 12.0 { (3.0 * scene).sqrt() } else { a * (12.0 * scene - b).ln() + c }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_is_where_it_was() {
        let samples: Vec<f32> = (0..1024).map(|i| (i as f32 / 1023.0).powf(1.8)).collect();
        let curve = Curve::new(samples).unwrap();
        let all = [
            Transfer::Linear,
            Transfer::Srgb,
            Transfer::Rec709,
            Transfer::Gamma(2.2),
            Transfer::Pq,
            Transfer::Hlg,
            Transfer::Curves(Arc::new([curve.clone(), curve.clone(), curve])),
        ];
        for transfer in all {
            for value in 0..=255 {
                let value = value as f32 / 255.0;
                let rgb = [value, 1.0 - value, 0.25];
                let back = transfer.encode(transfer.decode(rgb));
                let is_near = back.iter().zip(rgb).all(|(a, b)| (a - b).abs() < 5e-4);
                assert!(is_near, "{transfer:?} {rgb:?} {back:?}");
            }
        }
        assert_eq!(Curve::new(vec![0.0, 1.0, 0.5]), None);
        assert_eq!(Curve::new(vec![1.0; 4]), None);
    }

    #[test]
    fn white_graphics_are_where_the_standard_puts_them() {
        // BT.2408: 58 % of PQ and 75 % of HLG.
        let near = |rgb: [f32; 3]| rgb.iter().all(|v| (v - 1.0).abs() < 0.02);
        assert!(near(Transfer::Pq.decode([0.5807; 3])), "{:?}", Transfer::Pq.decode([0.5807; 3]));
        assert!(near(Transfer::Hlg.decode([0.75; 3])), "{:?}", Transfer::Hlg.decode([0.75; 3]));
        let brightest = Transfer::Pq.decode([1.0; 3])[0];
        assert!((brightest - 10_000.0 / 203.0).abs() < 1e-2, "{brightest}");
    }
}
