//! Properties that a video gives of itself. They hold no text of the file's: numbers, and words of closed lists.

use super::closed::Ratio;

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
    /// Which field of its frames is shown first, `tff` or `bff`; nothing where they are whole.
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

    /// Frames per second as a number.
    pub fn frames_per_second(&self) -> f64 {
        self.rate.value()
    }

    /// Channels of its frames: with alpha or without.
    pub fn channels(&self) -> u32 {
        if has_alpha(self.pixels) { 4 } else { 3 }
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
