//! Properties that a video gives of itself. They hold no text of the file's: numbers, and words of closed lists.

use super::closed::Ratio;
use isophote_pictures::meaning::{Alpha, Matrix, Meaning, Range};
use isophote_pictures::primaries::{P3, REC709, REC2020};
use isophote_pictures::transfer::Transfer;

/// The first stream of pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Stream {
    /// Its number among all streams of the file.
    pub index: u32,
    /// Columns, as they are shown.
    pub width: u32,
    /// Rows, as they are shown.
    pub height: u32,
    /// Frames per second.
    pub rate: Ratio,
    /// Frames per second of which all frames last a whole number; the same as the rate where all last equally long.
    pub grid: Ratio,
    /// Seconds by which its times are told.
    pub tick: Ratio,
    /// The field of its frames that is shown first, `tff` or `bff`; nothing where they are whole.
    pub fields: Option<&'static str>,
    /// The decoder that sees its alpha, where the usual one does not.
    pub decoder: Option<&'static str>,
    /// True for GIF, APNG and WebP, which become what any player shows.
    pub is_animation: bool,
    /// Frames, about; 0 where nobody knows.
    pub frames: u64,
    /// Promise of the container about how much there is of it.
    pub promise: Promise,
    /// Form of its pixels, such as yuv420p.
    pub pixels: &'static str,
    /// Ratio of a pixel's sides.
    pub aspect: Ratio,
    /// From black to white: `tv` or `pc`.
    pub range: &'static str,
    /// The matrix between RGB and luma with chroma, as ffmpeg's filter names it.
    pub matrix: &'static str,
    /// Tags that the file gives of its colours, by the options that give them to another.
    pub tags: Vec<[&'static str; 2]>,
}

/// Promise of a container about how much it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Promise {
    /// It says nothing, or counts what is there.
    None,
    /// So many frames, or a little fewer where it does not know exactly.
    Frames {
        /// Frames.
        count: u64,
        /// Number that may be missing.
        slack: u64,
    },
    /// So many seconds.
    Seconds(f64),
}

impl Stream {
    /// Of frames of our own, as most players take them: so many a second, of an even number of rows and columns.
    pub fn of_frames((width, height): (u32, u32), rate: Ratio) -> Self {
        const HD: &str = "bt709";
        Self {
            index: 0,
            width,
            height,
            rate,
            grid: rate,
            tick: rate.inverse(),
            fields: None,
            decoder: None,
            is_animation: false,
            frames: 0,
            promise: Promise::None,
            pixels: "yuv420p",
            aspect: Ratio::ONE,
            range: "tv",
            matrix: HD,
            tags: vec![
                ["-color_range", "tv"],
                ["-colorspace", HD],
                ["-color_trc", HD],
                ["-color_primaries", HD],
            ],
        }
    }

    /// True where all frames last as long, about.
    pub fn is_steady(&self) -> bool {
        self.rate == self.grid
    }

    /// Frames per second as a number.
    pub fn frames_per_second(&self) -> f64 {
        self.rate.value()
    }

    /// Channels of its frames: with alpha or without.
    pub fn channels(&self) -> u32 {
        if has_alpha(self.pixels) { 4 } else { 3 }
    }

    /// Meaning of its numbers. Camera curves of usual range are taken as displays show them, which is as sRGB.
    pub fn meaning(&self) -> Meaning {
        let tag = |option| self.tags.iter().find(|[known, _]| *known == option).map(|[_, value]| *value);
        let (primaries, transfer) = (tag("-color_primaries"), tag("-color_trc"));
        Meaning {
            primaries: match primaries {
                Some("bt2020") => REC2020,
                Some("smpte432") => P3,
                _ => REC709,
            },
            transfer: match transfer {
                Some("smpte2084") => Transfer::Pq,
                Some("arib-std-b67") => Transfer::Hlg,
                Some("linear") => Transfer::Linear,
                Some("gamma22") => Transfer::Gamma(2.2),
                Some("gamma28") => Transfer::Gamma(2.8),
                _ => Transfer::Srgb,
            },
            matrix: match self.matrix {
                _ if is_rgb(self.pixels) => Matrix::Rgb,
                "bt709" => Matrix::Bt709,
                "bt2020" => Matrix::Bt2020,
                "smpte240m" => Matrix::Smpte240m,
                _ => Matrix::Bt601,
            },
            range: if self.range == "pc" { Range::Full } else { Range::Limited },
            alpha: if self.channels() == 4 { Alpha::Straight } else { Alpha::None },
            pixel_aspect: self.aspect.value() as f32,
            said_by: primaries.or(transfer).map(|_| "tags"),
            ..Meaning::display()
        }
    }

    /// Samples of a frame as it is decoded.
    pub fn samples(&self) -> usize {
        self.width as usize * self.height as usize * self.channels() as usize
    }
}

/// True where pixels of this form have alpha.
pub fn has_alpha(pixels: &str) -> bool {
    const ALPHA: [&str; 11] =
        ["yuva", "rgba", "bgra", "argb", "abgr", "gbrap", "ya", "vuya", "ayuv", "uyva", "pal8"];
    ALPHA.iter().any(|alpha| pixels.starts_with(alpha))
}

/// True where pixels of this form are red, green and blue.
pub fn is_rgb(pixels: &str) -> bool {
    const OTHERS: [&str; 3] = ["argb", "abgr", "0"];
    let is_other = OTHERS.iter().any(|start| pixels.starts_with(start));
    pixels == "pal8" || is_other || ["rgb", "bgr", "gb", "x2"].iter().any(|start| pixels.starts_with(start))
}

/// Bits of a sample of pixels of this form, about.
pub fn depth(pixels: &str) -> u32 {
    const DEEP: [(&str, u32); 9] = [
        ("48", 16),
        ("64", 16),
        ("f32", 16),
        ("f16", 16),
        ("16", 16),
        ("14", 14),
        ("12", 12),
        ("10", 10),
        ("9", 9),
    ];
    let form = pixels.trim_end_matches("le").trim_end_matches("be");
    DEEP.iter().find(|(end, _)| form.ends_with(end)).map_or(8, |(_, bits)| *bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_say_what_numbers_mean() {
        let mut stream = Stream::of_frames((4, 4), Ratio::USUAL_RATE);
        let usual = stream.meaning();
        assert_eq!((usual.transfer, usual.primaries), (Transfer::Srgb, REC709));
        assert_eq!((usual.range, usual.matrix), (Range::Limited, Matrix::Bt709));
        stream.tags =
            vec![["-color_trc", "smpte2084"], ["-color_primaries", "bt2020"], ["-color_range", "pc"]];
        (stream.pixels, stream.range, stream.matrix) = ("yuva444p12le", "pc", "bt2020");
        stream.aspect = Ratio::new(8, 9).unwrap();
        let wide = stream.meaning();
        assert_eq!((wide.transfer, wide.primaries, wide.matrix), (Transfer::Pq, REC2020, Matrix::Bt2020));
        assert_eq!((wide.range, wide.alpha, wide.pixel_aspect), (Range::Full, Alpha::Straight, 8.0 / 9.0));
    }

    #[test]
    fn forms_of_pixels_are_told_by_their_names() {
        for (pixels, rgb, alpha, bits) in [
            ("yuv420p", false, false, 8),
            ("yuva444p12le", false, true, 12),
            ("gbrp10le", true, false, 10),
            ("gbrap16be", true, true, 16),
            ("rgb48le", true, false, 16),
            ("bgr0", true, false, 8),
            ("argb", true, true, 8),
            ("gray", false, false, 8),
        ] {
            assert_eq!((is_rgb(pixels), has_alpha(pixels), depth(pixels)), (rgb, alpha, bits), "{pixels}");
        }
    }
}
