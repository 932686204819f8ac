//! Colour spaces that can be named: the colours that the numbers of a picture stand for.

use crate::primaries::{ADOBE, AP0, AP1, Chromaticities, P3, REC709, REC2020, same};
use crate::transfer::Transfer;
use std::str::FromStr;

macro_rules! spaces {
    ($($space:ident: $id:literal $aliases:tt, $label:literal, $primaries:ident, $transfer:expr, $doc:literal;)+) => {
        /// Space of the numbers of a picture.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Space {
            $(#[doc = $doc] $space,)+
        }

        impl Space {
            /// All of them, in the order in which they are listed.
            pub const ALL: [Self; [$(Space::$space),+].len()] = [$(Space::$space),+];

            /// Stable name, for scripts and the command line.
            pub const fn id(self) -> &'static str {
                match self { $(Self::$space => $id,)+ }
            }

            /// Other names that are understood.
            pub const fn aliases(self) -> &'static [&'static str] {
                match self { $(Self::$space => &$aliases,)+ }
            }

            /// Name in menus.
            pub const fn label(self) -> &'static str {
                match self { $(Self::$space => $label,)+ }
            }

            /// One sentence about it.
            pub const fn doc(self) -> &'static str {
                match self { $(Self::$space => $doc,)+ }
            }

            /// The primaries.
            pub const fn primaries(self) -> Chromaticities {
                match self { $(Self::$space => $primaries,)+ }
            }

            /// The relation of numbers to light.
            pub const fn transfer(self) -> Transfer {
                match self { $(Self::$space => $transfer,)+ }
            }
        }
    };
}

// Id and aliases, label, primaries, transfer, sentence. The exponent of Adobe RGB is the exact number of its standard.
spaces! {
    Srgb: "srgb" [], "sRGB", REC709, Transfer::Srgb,
        "Gamma-encoded sRGB.";
    Linear: "linear" ["rec709", "linear-rec709"], "Linear (Rec. 709)", REC709, Transfer::Linear,
        "Linear light, Rec.709 primaries.";
    Acescg: "acescg" [], "ACEScg", AP1, Transfer::Linear,
        "ACEScg: linear light, AP1 primaries.";
    P3: "p3" ["linear-p3"], "Linear (P3)", P3, Transfer::Linear,
        "Linear light, P3 primaries, white D65.";
    Rec2020: "rec2020" ["linear-rec2020"], "Linear (Rec. 2020)", REC2020, Transfer::Linear,
        "Linear light, Rec.2020 primaries.";
    Aces: "aces2065-1" ["aces", "ap0"], "ACES2065-1", AP0, Transfer::Linear,
        "ACES2065-1: linear light, AP0 primaries.";
    DisplayP3: "display-p3" [], "Display P3", P3, Transfer::Srgb,
        "Display P3: P3 primaries, white D65, the curve of sRGB.";
    EncodedRec709: "encoded-rec709" ["bt709"], "Rec. 709 (camera)", REC709, Transfer::Rec709,
        "Rec.709 primaries and the curve of cameras of BT.709.";
    EncodedRec2020: "encoded-rec2020" ["bt2020"], "Rec. 2020 (camera)", REC2020, Transfer::Rec709,
        "Rec.2020 primaries and the curve of cameras of BT.2020.";
    AdobeRgb: "adobe-rgb" [], "Adobe RGB", ADOBE, Transfer::Gamma(563.0 / 256.0),
        "Adobe RGB (1998).";
    Pq: "rec2100-pq" ["pq"], "Rec. 2100 PQ", REC2020, Transfer::Pq,
        "BT.2100 PQ: Rec.2020 primaries, white graphics at 203 candelas a square metre.";
    Hlg: "rec2100-hlg" ["hlg"], "Rec. 2100 HLG", REC2020, Transfer::Hlg,
        "BT.2100 HLG: Rec.2020 primaries, white graphics at 75 %.";
}

impl Space {
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
