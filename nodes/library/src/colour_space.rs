//! The colour spaces of pictures that enter and leave.

/// What the numbers of a colour picture mean. All have their primaries' own encoding extended to
/// values below 0 and above 1. Shaders know them by these numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColourSpace {
    /// Gamma-encoded sRGB.
    #[default]
    Srgb = 0,
    /// Linear light, Rec. 709 primaries.
    Linear = 1,
    /// ACEScg: linear light, AP1 primaries.
    AcesCg = 2,
}

/// How a host's colour is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoding {
    /// Its space.
    pub space: ColourSpace,
    /// True when it is multiplied by alpha.
    pub premultiplied: bool,
}

impl ColourSpace {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Srgb, Self::Linear, Self::AcesCg];
}
