//! The colour spaces of pictures that enter and leave.

/// Colour space of the numbers of a picture. All have their primaries' own encoding extended to
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

/// Encoding of a host's colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoding {
    /// Its space.
    pub space: ColourSpace,
    /// True when it is multiplied by alpha.
    pub premultiplied: bool,
    /// True when its light beyond coverage is taken apart.
    pub emission: bool,
}

impl Encoding {
    /// Number by which shaders know alpha: 0 straight, 1 premultiplied, 2 premultiplied with the light beyond coverage
    /// taken out.
    pub const fn alpha(self) -> u32 {
        if self.premultiplied { 1 + self.emission as u32 } else { 0 }
    }
}

impl ColourSpace {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Srgb, Self::Linear, Self::AcesCg];
}
