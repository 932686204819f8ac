//! Animated WebP, which ffmpeg does not read: its frames are decoded here and handed to ffmpeg as raw pictures.

use std::io::Write;
use std::path::Path;

use super::closed::Ratio;
use super::stream::{Promise, Stream};
use super::timed::Times;
use isophote_files::error::Result;
use isophote_pictures::webp::MovingWebp;

/// An animated WebP file as a video.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Webp {
    file: MovingWebp,
}

impl Webp {
    /// Reads how large its frames are, and how long they last.
    ///
    /// # Errors
    /// As [`MovingWebp::open`].
    pub fn open(path: &Path) -> Result<Self> {
        MovingWebp::open(path).map(|file| Self { file })
    }

    /// Properties of its pictures.
    pub fn stream(&self) -> Stream {
        let (total, count) =
            (self.file.lengths.iter().map(|l| u64::from(*l)).sum::<u64>(), self.file.lengths.len());
        let same = self.file.lengths.iter().all(|length| *length == self.file.lengths[0]);
        let exact = Ratio::new(1000, self.file.lengths[0]).filter(|_| same);
        let rate = exact.or_else(|| Ratio::of_rate(count as f64 * 1000.0 / total as f64));
        Stream {
            pixels: "rgba",
            range: "pc",
            tags: vec![["-color_range", "pc"]],
            frames: count as u64,
            promise: Promise::Frames { count: count as u64, slack: 0 },
            tick: Ratio::THOUSANDTH,
            is_animation: true,
            ..Stream::of_frames(self.file.size, rate.unwrap_or(Ratio::USUAL_RATE))
        }
    }

    /// Times of its frames where they do not last equally long.
    pub fn times(&self) -> Option<Times> {
        let seconds = |length: &u32| f64::from(*length) / 1000.0;
        let shown = self.file.lengths.iter().scan(0.0, |time, length| {
            let now = *time;
            *time += seconds(length);
            Some(now)
        });
        let is_even = self.file.lengths.iter().all(|length| *length == self.file.lengths[0]);
        (!is_even).then(|| Times { shown: shown.collect(), last: self.file.lengths.last().map(seconds) })
    }

    /// Size of its frames.
    pub fn size(&self) -> (u32, u32) {
        self.file.size
    }

    /// Hands all frames on; see [`MovingWebp::relay`].
    pub fn relay(&self, into: &mut impl Write) -> Option<String> {
        self.file.relay(into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_their_times() {
        let of = |lengths: &[u32]| Webp {
            file: MovingWebp { path: Default::default(), size: (160, 90), lengths: lengths.to_vec() },
        };
        let webp = of(&[40, 100, 80]);
        assert_eq!(webp.times(), Some(Times { shown: vec![0.0, 0.04, 0.14], last: Some(0.08) }));
        assert_eq!(webp.stream().rate.to_string(), "13636/1000");
        let even = of(&[40; 3]);
        assert_eq!((even.times(), even.stream().rate.to_string().as_str()), (None, "1000/40"));
    }
}
