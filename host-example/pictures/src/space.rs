//! Colour spaces that can be named: the colours that the numbers of a picture stand for.

use clap::ValueEnum;

use crate::primaries::{ADOBE, AP0, AP1, Chromaticities, P3, REC709, REC2020};
use crate::transfer::Transfer;

/// Space of the numbers of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// Gamma-encoded sRGB.
    Srgb,
    /// Linear light, Rec.709 primaries.
    #[value(aliases = ["rec709", "linear-rec709"])]
    Linear,
    /// ACEScg: linear light, AP1 primaries.
    Acescg,
    /// Linear light, P3 primaries, white D65.
    #[value(alias = "linear-p3")]
    P3,
    /// Linear light, Rec.2020 primaries.
    #[value(alias = "linear-rec2020")]
    Rec2020,
    /// ACES2065-1: linear light, AP0 primaries.
    #[value(name = "aces2065-1", aliases = ["aces", "ap0"])]
    Aces,
    /// Display P3: P3 primaries, white D65, the curve of sRGB.
    DisplayP3,
    /// Rec.709 primaries and the curve of cameras of BT.709.
    #[value(name = "encoded-rec709", alias = "bt709")]
    EncodedRec709,
    /// Rec.2020 primaries and the curve of cameras of BT.2020.
    #[value(name = "encoded-rec2020", alias = "bt2020")]
    EncodedRec2020,
    /// Adobe RGB (1998).
    AdobeRgb,
    /// BT.2100 PQ: Rec.2020 primaries, white graphics at 203 candelas a square metre.
    #[value(name = "rec2100-pq", alias = "pq")]
    Pq,
    /// BT.2100 HLG: Rec.2020 primaries, white graphics at 75 %.
    #[value(name = "rec2100-hlg", alias = "hlg")]
    Hlg,
}

impl Space {
    /// The primaries.
    pub fn primaries(self) -> Chromaticities {
        match self {
            Self::Srgb | Self::Linear | Self::EncodedRec709 => REC709,
            Self::Acescg => AP1,
            Self::Aces => AP0,
            Self::P3 | Self::DisplayP3 => P3,
            Self::Rec2020 | Self::EncodedRec2020 | Self::Pq | Self::Hlg => REC2020,
            Self::AdobeRgb => ADOBE,
        }
    }

    /// The relation of numbers to light.
    pub fn transfer(self) -> Transfer {
        match self {
            Self::Linear | Self::Acescg | Self::Aces | Self::P3 | Self::Rec2020 => Transfer::Linear,
            Self::Srgb | Self::DisplayP3 => Transfer::Srgb,
            Self::EncodedRec709 | Self::EncodedRec2020 => Transfer::Rec709,
            // The exact number of the standard.
            Self::AdobeRgb => Transfer::Gamma(563.0 / 256.0),
            Self::Pq => Transfer::Pq,
            Self::Hlg => Transfer::Hlg,
        }
    }

    /// True where numbers are light.
    pub fn is_linear(self) -> bool {
        self.transfer() == Transfer::Linear
    }

    /// The name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}
