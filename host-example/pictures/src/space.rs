//! Colour spaces: the colours that the numbers of a picture stand for.

use clap::ValueEnum;

use crate::primaries::{AP1, Chromaticities, P3, REC2020};

/// Space of the numbers of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// Gamma-encoded sRGB.
    Srgb,
    /// Linear light, Rec.709 primaries.
    #[value(alias = "rec709")]
    Linear,
    /// ACEScg: linear light, AP1 primaries.
    Acescg,
    /// Linear light, P3 primaries, white D65.
    #[value(alias = "linear-p3")]
    P3,
    /// Linear light, Rec.2020 primaries.
    #[value(alias = "linear-rec2020")]
    Rec2020,
}

impl Space {
    /// The primaries, unless they are Rec.709's.
    pub fn primaries(self) -> Option<Chromaticities> {
        match self {
            Self::Srgb | Self::Linear => None,
            Self::Acescg => Some(AP1),
            Self::P3 => Some(P3),
            Self::Rec2020 => Some(REC2020),
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
