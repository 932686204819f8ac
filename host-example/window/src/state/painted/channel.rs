//! Numbers that are painted, and the maps that they are of.

/// Greatest number of a control map. Its half is within what counts as no change, and alpha never is 1 everywhere, which
/// files have in which nobody painted it.
pub const MOST: u8 = 254;

/// Map as a file holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Four channels that direct places.
    Control,
    /// The share of the look.
    Mask,
}

impl Kind {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Control, Self::Mask];

    /// Name for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Control => "control map",
            Self::Mask => "mask",
        }
    }

    /// Name of the option of `apply` that takes its file.
    pub const fn option(self) -> &'static str {
        match self {
            Self::Control => "control",
            Self::Mask => "mask",
        }
    }
}

/// Number a pixel that a brush paints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Detail of the look.
    Detail,
    /// Width of its lines.
    LineWidth,
    /// Amount of its lines.
    LineAmount,
    /// Strength of its medium.
    Medium,
    /// The share of the look.
    Mask,
}

impl Channel {
    /// All of them, those of the control map in its order first.
    pub const ALL: [Self; 5] = [Self::Detail, Self::LineWidth, Self::LineAmount, Self::Medium, Self::Mask];

    /// Name for people.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Detail => "Detail",
            Self::LineWidth => "Width of lines",
            Self::LineAmount => "Amount of lines",
            Self::Medium => "Strength of marks and paint",
            Self::Mask => "Mask of the look",
        }
    }

    /// The map that it is of.
    pub const fn kind(self) -> Kind {
        match self {
            Self::Mask => Kind::Mask,
            _ => Kind::Control,
        }
    }

    /// Number where nothing is painted: no change, and all of the look.
    pub const fn plain(self) -> u8 {
        match self {
            Self::Mask => u8::MAX,
            _ => MOST / 2,
        }
    }

    /// The byte of a number as files have it; plain where it is none.
    pub fn stored(self, number: f32) -> u8 {
        if number.is_nan() {
            return self.plain();
        }
        let byte = (number.clamp(0.0, 1.0) * 255.0).round() as u8;
        match self {
            Self::Mask => byte,
            // Eight bits have no exact half, and both bytes beside it change nothing.
            _ if byte == 128 => self.plain(),
            _ => byte.min(MOST),
        }
    }

    /// The byte of a strength of -1 to 1.
    pub fn painted(self, strength: f32) -> u8 {
        let most = if self == Self::Mask { u8::MAX } else { MOST };
        ((strength.clamp(-1.0, 1.0) + 1.0) * 0.5 * f32::from(most)).round() as u8
    }
}
