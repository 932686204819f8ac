//! Colour spaces that can be named: the colours that the numbers of a picture stand for.

use crate::primaries::{ADOBE, AP0, AP1, Chromaticities, P3, REC709, REC2020, same};
use crate::transfer::Transfer;
use std::str::FromStr;

/// Space of the numbers of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Space {
    /// Gamma-encoded sRGB.
    Srgb,
    /// Linear light, Rec.709 primaries.
    Linear,
    /// ACEScg: linear light, AP1 primaries.
    Acescg,
    /// Linear light, P3 primaries, white D65.
    P3,
    /// Linear light, Rec.2020 primaries.
    Rec2020,
    /// ACES2065-1: linear light, AP0 primaries.
    Aces,
    /// Display P3: P3 primaries, white D65, the curve of sRGB.
    DisplayP3,
    /// Rec.709 primaries and the curve of cameras of BT.709.
    EncodedRec709,
    /// Rec.2020 primaries and the curve of cameras of BT.2020.
    EncodedRec2020,
    /// Adobe RGB (1998).
    AdobeRgb,
    /// BT.2100 PQ: Rec.2020 primaries, white graphics at 203 candelas a square metre.
    Pq,
    /// BT.2100 HLG: Rec.2020 primaries, white graphics at 75 %.
    Hlg,
}

/// Names of a space.
struct Names {
    id: &'static str,
    aliases: &'static [&'static str],
    label: &'static str,
    doc: &'static str,
}

impl Space {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 12] = [
        Self::Srgb,
        Self::Linear,
        Self::Acescg,
        Self::P3,
        Self::Rec2020,
        Self::Aces,
        Self::DisplayP3,
        Self::EncodedRec709,
        Self::EncodedRec2020,
        Self::AdobeRgb,
        Self::Pq,
        Self::Hlg,
    ];

    const fn names(self) -> Names {
        let (id, aliases, label, doc): (_, &[_], _, _) = match self {
            Self::Srgb => ("srgb", &[], "sRGB", "Gamma-encoded sRGB."),
            Self::Linear => (
                "linear",
                &["rec709", "linear-rec709"],
                "Linear (Rec. 709)",
                "Linear light, Rec.709 primaries.",
            ),
            Self::Acescg => ("acescg", &[], "ACEScg", "ACEScg: linear light, AP1 primaries."),
            Self::P3 => ("p3", &["linear-p3"], "Linear (P3)", "Linear light, P3 primaries, white D65."),
            Self::Rec2020 => {
                ("rec2020", &["linear-rec2020"], "Linear (Rec. 2020)", "Linear light, Rec.2020 primaries.")
            }
            Self::Aces => {
                ("aces2065-1", &["aces", "ap0"], "ACES2065-1", "ACES2065-1: linear light, AP0 primaries.")
            }
            Self::DisplayP3 => {
                ("display-p3", &[], "Display P3", "Display P3: P3 primaries, white D65, the curve of sRGB.")
            }
            Self::EncodedRec709 => (
                "encoded-rec709",
                &["bt709"],
                "Rec. 709 (camera)",
                "Rec.709 primaries and the curve of cameras of BT.709.",
            ),
            Self::EncodedRec2020 => (
                "encoded-rec2020",
                &["bt2020"],
                "Rec. 2020 (camera)",
                "Rec.2020 primaries and the curve of cameras of BT.2020.",
            ),
            Self::AdobeRgb => ("adobe-rgb", &[], "Adobe RGB", "Adobe RGB (1998)."),
            Self::Pq => (
                "rec2100-pq",
                &["pq"],
                "Rec. 2100 PQ",
                "BT.2100 PQ: Rec.2020 primaries, white graphics at 203 candelas a square metre.",
            ),
            Self::Hlg => (
                "rec2100-hlg",
                &["hlg"],
                "Rec. 2100 HLG",
                "BT.2100 HLG: Rec.2020 primaries, white graphics at 75 %.",
            ),
        };
        Names { id, aliases, label, doc }
    }

    /// Stable name, for scripts and the command line.
    pub const fn id(self) -> &'static str {
        self.names().id
    }

    /// Other names that are understood.
    pub const fn aliases(self) -> &'static [&'static str] {
        self.names().aliases
    }

    /// Name in menus.
    pub const fn label(self) -> &'static str {
        self.names().label
    }

    /// One sentence about it.
    pub const fn doc(self) -> &'static str {
        self.names().doc
    }

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

    /// True for spaces of displays that show more than white.
    pub const fn is_hdr(self) -> bool {
        matches!(self, Self::Pq | Self::Hlg)
    }

    /// The space of the library's three in which pictures of this one are filtered.
    pub fn working(self) -> Self {
        Self::working_for(self.primaries(), &self.transfer())
    }

    /// The space of the library's three (sRGB, linear, ACEScg) in which pictures of such numbers are filtered.
    pub fn working_for(primaries: Chromaticities, transfer: &Transfer) -> Self {
        match transfer {
            Transfer::Srgb if same(primaries, REC709) => Self::Srgb,
            Transfer::Linear if same(primaries, AP1) => Self::Acescg,
            _ => Self::Linear,
        }
    }
}

impl FromStr for Space {
    type Err = String;

    /// The space of this id or alias; an error says which there are.
    fn from_str(name: &str) -> Result<Self, String> {
        let is_named = |space: &Self| space.id() == name || space.aliases().contains(&name);
        Self::ALL.into_iter().find(is_named).ok_or_else(|| {
            let ids = Self::ALL.map(|space| format!("'{}'", space.id()));
            format!("a colour space is {}, not '{name}'", ids.join(" or "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_lead_to_their_space() {
        let mut names = BTreeSet::new();
        for space in Space::ALL {
            for name in space.aliases().iter().chain([&space.id()]) {
                assert_eq!(name.parse(), Ok(space));
                assert!(names.insert(*name), "{name}");
            }
            assert!(names.insert(space.label()) && space.label().len() < 20, "{}", space.label());
        }
        let problem = "srgb2".parse::<Space>().unwrap_err();
        assert!(Space::ALL.iter().all(|space| problem.contains(space.id())), "{problem}");
    }

    #[test]
    fn three_are_worked_in_as_they_are_and_the_others_in_one_of_them() {
        let three = [Space::Srgb, Space::Linear, Space::Acescg];
        for space in Space::ALL {
            assert!(three.contains(&space.working()), "{space:?}");
            assert_eq!(space.working() == space, three.contains(&space), "{space:?}");
        }
    }
}
