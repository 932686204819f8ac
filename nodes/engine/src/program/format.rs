//! Texel formats of a program's textures, and which image has which.

use crate::plan::{Class, ImageDesc};

/// Precision in which a program computes on a graphics device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Every image holds 32-bit floats, as those of the CPU executor do.
    #[default]
    Exact,
    /// Images of class [`Class::Colour`] with two to four channels hold 16-bit floats, those that leave included: half the
    /// bytes, or as many for two, which share textures with the others, and eleven bits for each value up to 65504, where
    /// larger ones are cut. Workgroups hold what they read of such images in as many bits. What enters is the caller's.
    Half,
    /// As `Half`; besides, samplers interpolate them, whose weights have eight bits on common hardware. An input whose format
    /// is [`Format::Rgba16`] is read so, too, and must have a format that the device filters.
    Fast,
}

impl Precision {
    /// True where the rows and the columns of small windows run in one dispatch: the same numbers with fewer bytes and more
    /// arithmetic, which drivers that compute on the CPU are slow at. Those who ask for speed have a graphics card.
    pub(super) const fn fuses_windows(self) -> bool {
        !matches!(self, Self::Exact)
    }
}

/// Format of a texture's texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// One 32-bit float.
    R32,
    /// Two 32-bit floats.
    Rg32,
    /// Four 32-bit floats.
    Rgba32,
    /// Four 16-bit floats.
    Rgba16,
}

impl Format {
    /// That of 32-bit floats with so many channels; three are stored as four.
    pub const fn exact(channels: u32) -> Self {
        match channels {
            1 => Self::R32,
            2 => Self::Rg32,
            _ => Self::Rgba32,
        }
    }

    /// That of a virtual image.
    pub fn of(desc: ImageDesc, precision: Precision) -> Self {
        match Self::exact(desc.channels) {
            Self::Rg32 | Self::Rgba32 if precision != Precision::Exact && desc.class == Class::Colour => {
                Self::Rgba16
            }
            exact => exact,
        }
    }

    /// Values of a texel.
    pub const fn channels(self) -> u32 {
        match self {
            Self::R32 => 1,
            Self::Rg32 => 2,
            Self::Rgba32 | Self::Rgba16 => 4,
        }
    }

    /// Bytes of a value.
    pub const fn sample(self) -> u32 {
        if matches!(self, Self::Rgba16) { 2 } else { 4 }
    }

    /// Bytes of a texel.
    pub const fn texel(self) -> u32 {
        self.channels() * self.sample()
    }

    /// Name in WGSL.
    pub const fn wgsl(self) -> &'static str {
        match self {
            Self::R32 => "r32float",
            Self::Rg32 => "rg32float",
            Self::Rgba32 => "rgba32float",
            Self::Rgba16 => "rgba16float",
        }
    }
}
