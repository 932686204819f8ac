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
    /// True where all frames last as long.
    pub is_steady: bool,
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
            is_steady: true,
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
        const ALPHA: [&str; 11] =
            ["yuva", "rgba", "bgra", "argb", "abgr", "gbrap", "ya", "vuya", "ayuv", "uyva", "pal8"];
        if ALPHA.iter().any(|a| self.pixels.starts_with(a)) { 4 } else { 3 }
    }

    /// Samples of a frame as it is decoded.
    pub fn samples(&self) -> usize {
        self.width as usize * self.height as usize * self.channels() as usize
    }
}
