//! Lengths of parameters: pixels of the picture, or of one of a fixed height.

use serde::{Deserialize, Serialize};

/// Meaning of the lengths of parameters, which are given in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Lengths {
    /// Pixels of a picture 1080 lines high: pictures of all sizes get the same look.
    #[default]
    Relative,
    /// Pixels of the picture itself.
    Pixels,
}

/// Lines of the picture that relative lengths are meant for.
const REFERENCE: u32 = 1080;

impl Lengths {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Relative, Self::Pixels];

    /// The word for it in presets.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Pixels => "pixels",
        }
    }

    /// The lengths that a word stands for.
    pub fn of(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|lengths| lengths.id() == id)
    }

    /// The reference height of a request; 0: lengths are pixels of the picture.
    pub const fn reference_height(self) -> u32 {
        match self {
            Self::Relative => REFERENCE,
            Self::Pixels => 0,
        }
    }
}
