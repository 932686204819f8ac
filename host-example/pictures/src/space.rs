//! Colour spaces: the colours that the numbers of a picture stand for.

use clap::ValueEnum;

use crate::primaries::{AP1, Chromaticities, P3, REC2020};
use crate::transfer::Transfer;

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
    /// The relation of numbers to light.
    pub fn transfer(self) -> Transfer {
        match self {
            Self::Srgb => Transfer::Srgb,
            Self::Linear | Self::Acescg | Self::P3 | Self::Rec2020 => Transfer::Linear,
        }
    }
}
