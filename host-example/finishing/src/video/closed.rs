//! Values of videos as numbers and words of closed lists: nothing that a file or a stream says of itself reaches another
//! program, or its filters, as text.

use std::fmt::{self, Display};
use std::num::NonZeroU32;

/// A ratio of two numbers above 0, as small as ffmpeg takes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    above: NonZeroU32,
    below: NonZeroU32,
}

impl Ratio {
    /// Sides of square pixels.
    pub const ONE: Self = Self { above: NonZeroU32::MIN, below: NonZeroU32::MIN };
    /// Seconds of a millisecond.
    pub const THOUSANDTH: Self = Self { above: NonZeroU32::MIN, below: NonZeroU32::MIN.saturating_add(999) };
    /// Frames a second where nobody says how many.
    pub const USUAL_RATE: Self = Self { above: NonZeroU32::MIN.saturating_add(24), below: NonZeroU32::MIN };

    /// Of two numbers, which are not 0.
    pub fn new(above: u32, below: u32) -> Option<Self> {
        let number = |n: u32| NonZeroU32::new(n).filter(|n| n.get() <= i32::MAX as u32);
        Some(Self { above: number(above)?, below: number(below)? })
    }

    /// Of a text with two numbers and this sign between them.
    pub fn parse(text: &str, sign: char) -> Option<Self> {
        let (above, below) = text.split_once(sign)?;
        // A sign before a number is none of a ratio's.
        let number = |text: &str| text.parse().ok().filter(|_| text.bytes().all(|b| b.is_ascii_digit()));
        Self::new(number(above)?, number(below)?)
    }

    /// The same where it is a rate of frames that can be.
    pub fn as_rate(self) -> Option<Self> {
        (0.001..=1e6).contains(&self.value()).then_some(self)
    }

    /// So many frames a second, to a thousandth.
    pub fn of_rate(rate: f64) -> Option<Self> {
        let thousandths = (rate * 1000.0).round();
        // Numbers beyond those of the type become its greatest, and NaN becomes 0.
        Self::new(thousandths as u32, 1000)?.as_rate().filter(|r| (r.value() - rate).abs() <= 0.001)
    }

    /// The sides of a pixel of this aspect, to a ten-thousandth.
    pub fn of_aspect(aspect: f64) -> Option<Self> {
        Self::new((aspect * 10_000.0).round() as u32, 10_000)
    }

    /// Its two numbers the other way round.
    pub fn inverse(self) -> Self {
        Self { above: self.below, below: self.above }
    }

    /// Number of these in 1; nothing where 1 is no whole number of them.
    pub fn parts_of_one(self) -> Option<u32> {
        (self.above.get() == 1).then_some(self.below.get())
    }

    /// As one number.
    pub fn value(self) -> f64 {
        f64::from(self.above.get()) / f64::from(self.below.get())
    }

    /// Its two numbers with a sign between them.
    pub fn with(self, sign: char) -> String {
        format!("{}{sign}{}", self.above, self.below)
    }
}

impl Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.above, self.below)
    }
}

/// The word of a list that is this text.
pub fn word(list: &[&'static str], text: &str) -> Option<&'static str> {
    list.iter().find(|word| **word == text).copied()
}

/// The second word of the pair whose first is this text.
pub fn second(list: &[(&str, &'static str)], text: &str) -> Option<&'static str> {
    list.iter().find(|(first, _)| *first == text).map(|(_, second)| *second)
}

/// Forms of pixels that hold colours, as ffmpeg names them.
#[rustfmt::skip]
pub const PIXELS: [&str; 229] = [
    "yuv420p", "yuyv422", "rgb24", "bgr24", "yuv422p", "yuv444p", "yuv410p", "yuv411p", "gray", "monow", "monob",
    "yuvj420p", "yuvj422p", "yuvj444p", "uyvy422", "uyyvyy411", "bgr8", "bgr4", "bgr4_byte", "rgb8", "rgb4",
    "rgb4_byte", "nv12", "nv21", "argb", "rgba", "abgr", "bgra", "gray16be", "gray16le", "yuv440p", "yuvj440p",
    "yuva420p", "rgb48be", "rgb48le", "rgb565be", "rgb565le", "rgb555be", "rgb555le", "bgr565be", "bgr565le",
    "bgr555be", "bgr555le", "yuv420p16le", "yuv420p16be", "yuv422p16le", "yuv422p16be", "yuv444p16le", "yuv444p16be",
    "rgb444le", "rgb444be", "bgr444le", "bgr444be", "ya8", "bgr48be", "bgr48le", "yuv420p9be", "yuv420p9le",
    "yuv420p10be", "yuv420p10le", "yuv422p10be", "yuv422p10le", "yuv444p9be", "yuv444p9le", "yuv444p10be",
    "yuv444p10le", "yuv422p9be", "yuv422p9le", "gbrp", "gbrp9be", "gbrp9le", "gbrp10be", "gbrp10le", "gbrp16be",
    "gbrp16le", "yuva422p", "yuva444p", "yuva420p9be", "yuva420p9le", "yuva422p9be", "yuva422p9le", "yuva444p9be",
    "yuva444p9le", "yuva420p10be", "yuva420p10le", "yuva422p10be", "yuva422p10le", "yuva444p10be", "yuva444p10le",
    "yuva420p16be", "yuva420p16le", "yuva422p16be", "yuva422p16le", "yuva444p16be", "yuva444p16le", "xyz12le",
    "xyz12be", "nv16", "nv20le", "nv20be", "rgba64be", "rgba64le", "bgra64be", "bgra64le", "yvyu422", "ya16be",
    "ya16le", "gbrap", "gbrap16be", "gbrap16le", "0rgb", "rgb0", "0bgr", "bgr0", "yuv420p12be", "yuv420p12le",
    "yuv420p14be", "yuv420p14le", "yuv422p12be", "yuv422p12le", "yuv422p14be", "yuv422p14le", "yuv444p12be",
    "yuv444p12le", "yuv444p14be", "yuv444p14le", "gbrp12be", "gbrp12le", "gbrp14be", "gbrp14le", "yuvj411p",
    "bayer_bggr8", "bayer_rggb8", "bayer_gbrg8", "bayer_grbg8", "bayer_bggr16le", "bayer_bggr16be", "bayer_rggb16le",
    "bayer_rggb16be", "bayer_gbrg16le", "bayer_gbrg16be", "bayer_grbg16le", "bayer_grbg16be", "yuv440p10le",
    "yuv440p10be", "yuv440p12le", "yuv440p12be", "ayuv64le", "ayuv64be", "p010le", "p010be", "gbrap12be", "gbrap12le",
    "gbrap10be", "gbrap10le", "gray12be", "gray12le", "gray10be", "gray10le", "p016le", "p016be", "gray9be", "gray9le",
    "gbrpf32be", "gbrpf32le", "gbrapf32be", "gbrapf32le", "gray14be", "gray14le", "grayf32be", "grayf32le",
    "yuva422p12be", "yuva422p12le", "yuva444p12be", "yuva444p12le", "nv24", "nv42", "y210be", "y210le", "x2rgb10le",
    "x2rgb10be", "x2bgr10le", "x2bgr10be", "p210be", "p210le", "p410be", "p410le", "p216be", "p216le", "p416be",
    "p416le", "pal8", "p012le", "p012be", "y212le", "y212be", "xv30le", "xv30be", "xv36le", "xv36be", "vuya", "vuyx",
    "ayuv", "uyva", "vyu444", "v30xle", "v30xbe", "rgbf32le", "rgbf32be", "rgbaf32le", "rgbaf32be", "rgbf16le",
    "rgbf16be", "rgbaf16le", "rgbaf16be", "gbrpf16le", "gbrpf16be", "gbrapf16le", "gbrapf16be", "gbrap14le",
    "gbrap14be", "grayf16le", "grayf16be", "xv48le", "xv48be", "y216le", "y216be", "p412le", "p412be",
];

/// Matrices between RGB and luma with chroma: names in files, and those of the option that says so.
pub const SPACES: [(&str, &str); 13] = [
    ("gbr", "rgb"),
    ("bt709", "bt709"),
    ("fcc", "fcc"),
    ("bt470bg", "bt470bg"),
    ("smpte170m", "smpte170m"),
    ("smpte240m", "smpte240m"),
    ("ycgco", "ycgco"),
    ("bt2020nc", "bt2020nc"),
    ("bt2020c", "bt2020c"),
    ("smpte2085", "smpte2085"),
    ("chroma-derived-nc", "chroma-derived-nc"),
    ("chroma-derived-c", "chroma-derived-c"),
    ("ictcp", "ictcp"),
];

/// The same of transfer functions.
pub const TRANSFERS: [(&str, &str); 17] = [
    ("bt709", "bt709"),
    ("bt470m", "gamma22"),
    ("bt470bg", "gamma28"),
    ("smpte170m", "smpte170m"),
    ("smpte240m", "smpte240m"),
    ("linear", "linear"),
    ("log100", "log100"),
    ("log316", "log316"),
    ("iec61966-2-4", "iec61966-2-4"),
    ("bt1361e", "bt1361e"),
    ("iec61966-2-1", "iec61966-2-1"),
    ("bt2020-10", "bt2020-10"),
    ("bt2020-12", "bt2020-12"),
    ("smpte2084", "smpte2084"),
    ("smpte428", "smpte428"),
    ("smpte428_1", "smpte428"),
    ("arib-std-b67", "arib-std-b67"),
];

/// The same of primaries.
pub const PRIMARIES: [(&str, &str); 13] = [
    ("bt709", "bt709"),
    ("bt470m", "bt470m"),
    ("bt470bg", "bt470bg"),
    ("smpte170m", "smpte170m"),
    ("smpte240m", "smpte240m"),
    ("film", "film"),
    ("bt2020", "bt2020"),
    ("smpte428", "smpte428"),
    ("smpte428_1", "smpte428"),
    ("smpte431", "smpte431"),
    ("smpte432", "smpte432"),
    ("jedec-p22", "jedec-p22"),
    ("ebu3213", "jedec-p22"),
];

/// The same of the range from black to white.
pub const RANGES: [(&str, &str); 2] = [("tv", "tv"), ("pc", "pc")];

/// Matrices as ffmpeg's filter names them, by names in files.
pub const MATRICES: [(&str, &str); 7] = [
    ("bt709", "bt709"),
    ("fcc", "fcc"),
    ("bt470bg", "smpte170m"),
    ("smpte170m", "smpte170m"),
    ("smpte240m", "smpte240m"),
    ("bt2020nc", "bt2020"),
    ("bt2020c", "bt2020"),
];

/// Orders of the fields of frames: names in files, and those of ffmpeg's filters.
pub const FIELDS: [(&str, &str); 4] = [("tt", "tff"), ("tb", "tff"), ("bb", "bff"), ("bt", "bff")];

/// Codecs that hold alpha beside the pixels that their usual decoders see, with a decoder that sees it.
pub const HIDDEN_ALPHA: [(&str, &str); 2] = [("vp9", "libvpx-vp9"), ("vp8", "libvpx")];

/// The matrix that players take for pictures of so many rows where a file names none.
pub fn usual_matrix(height: u32) -> &'static str {
    if height >= 720 { "bt709" } else { "smpte170m" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_numbers_within_bounds() {
        assert_eq!(Ratio::parse("30000:1001", ':').map(|r| r.to_string()).as_deref(), Some("30000/1001"));
        assert_eq!(Ratio::new(25, 1), Some(Ratio::USUAL_RATE));
        for bad in
            ["", "1", "1:", ":1", "0:1", "1:0", "-1:1", "+1:1", "1:1,null", " 1:1", "2147483648:1", "1:1:1"]
        {
            assert_eq!(Ratio::parse(bad, ':'), None, "{bad}");
        }
        assert_eq!(Ratio::of_rate(23.976).map(|r| r.to_string()).as_deref(), Some("23976/1000"));
        for bad in [0.0, -1.0, 0.000_4, 1e30, f64::NAN, f64::INFINITY] {
            assert_eq!(Ratio::of_rate(bad), None, "{bad}");
        }
        assert!(Ratio::parse("1:2147483647", ':').is_some_and(|r| r.as_rate().is_none()));
    }

    #[test]
    fn words_are_of_their_lists() {
        assert_eq!(word(&PIXELS, "yuv420p"), Some("yuv420p"));
        assert_eq!(word(&PIXELS, "yuv420p,null"), None);
        assert_eq!(second(&TRANSFERS, "bt470bg"), Some("gamma28"));
        assert_eq!(second(&SPACES, "unknown"), None);
    }
}
