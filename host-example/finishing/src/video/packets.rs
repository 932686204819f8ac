//! Packets that lie in a video, compared with what its container promises, and the times of frames.

use std::path::Path;

use super::process::{self, Process, at};
use super::stream::{Promise, Stream};
use isophote_files::error::Result;

/// Advice about a video whose packets cannot be read.
const FIX: &str = "name an intact video that ffmpeg reads";
/// Seconds by which times are rounded.
const ROUNDED: f64 = 0.05;
/// Share of a frame by which the times of frames that last equally long are off at most, beside what is rounded.
const UNEVEN: f64 = 0.02;

/// Packets of the first stream of pictures, in the order of the file.
#[derive(Debug, Default, PartialEq)]
pub struct Packets {
    /// All of them.
    total: u64,
    /// Times at which those are shown that are not only decoded, in seconds from where the file begins; nothing where it does not tell.
    shown: Vec<Option<f64>>,
    /// Time at which the last one has been shown, in seconds.
    end: f64,
    /// Start of the file, in seconds.
    start: f64,
    /// Complaint of ffmpeg, also about sound and whatever else lies in the file.
    complaint: Option<String>,
}

impl Packets {
    /// Reads them.
    ///
    /// # Errors
    /// The complaint of ffmpeg.
    pub fn of(path: &Path, stream: &Stream) -> Result<Self> {
        Self::read(path, stream, &[])
    }

    fn read(path: &Path, stream: &Stream, more: &[&str]) -> Result<Self> {
        let mut command = process::command("ffprobe");
        // All streams, so that sound that is missing is noticed as well.
        command.args(["-v", "error", "-of", "csv"]).args(more).arg("-show_entries");
        command.arg("packet=stream_index,pts_time,duration_time,flags:format=start_time");
        process::read(&mut command, path);
        let (text, complaints) = at(Process::heard(&mut command), path, FIX)?;
        Ok(Self { complaint: complaints.first(), ..Self::understand(&text, stream.index) })
    }

    /// Takes what ffprobe prints for numbers.
    fn understand(text: &str, stream: u32) -> Self {
        let seconds = |text: &str| text.trim().parse::<f64>().ok().filter(|seconds| seconds.is_finite());
        let start = text.lines().find_map(|line| seconds(line.strip_prefix("format,")?)).unwrap_or(0.0);
        let mut packets = Self { start, ..Self::default() };
        for line in text.lines().filter_map(|line| line.strip_prefix("packet,")) {
            let mut fields = line.split(',');
            let mut field = || fields.next().unwrap_or_default();
            if field().parse() != Ok(stream) {
                continue;
            }
            let (at, length, flags) = (seconds(field()), seconds(field()), field());
            packets.total += 1;
            packets.end = packets.end.max(at.unwrap_or(0.0) + length.unwrap_or(0.0));
            // What is marked by D is decoded and not shown.
            if !flags.contains('D') {
                packets.shown.push(at.map(|at| at - start));
            }
        }
        packets
    }

    /// Times at which frames are shown, in order; nothing where the file does not tell of all.
    pub fn times(&self) -> Vec<f64> {
        let mut times = self.shown.iter().copied().collect::<Option<Vec<f64>>>().unwrap_or_default();
        times.sort_unstable_by(f64::total_cmp);
        times
    }

    /// Time of the first frame, in seconds from the start of the file.
    pub fn first(&self) -> f64 {
        self.shown.iter().flatten().copied().min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// Seconds that the last frame lasts; nothing where that is not told.
    pub fn last_length(&self) -> Option<f64> {
        let last = self.shown.iter().flatten().copied().max_by(f64::total_cmp)?;
        Some(self.end - self.start - last).filter(|length| *length > 0.0)
    }

    /// Times of frames that do not last equally long, in seconds from the first; nothing for others.
    ///
    /// # Errors
    /// The complaint of ffmpeg.
    pub fn uneven(&self, path: &Path, stream: &Stream) -> Result<Option<Vec<f64>>> {
        if !is_uneven(&self.times(), stream) {
            return Ok(None);
        }
        // Some packets show nothing, and there are those that show two frames.
        let mut command = process::command("ffprobe");
        command.args(["-v", "quiet", "-select_streams", "V:0", "-of", "csv=p=0"]);
        command.args(["-show_entries", "frame=best_effort_timestamp_time"]);
        if let Some(decoder) = stream.decoder {
            command.args(["-c:v", decoder]);
        }
        process::read(&mut command, path);
        let text = at(Process::output(&mut command), path, FIX)?;
        let lines = text.lines().map(|line| line.trim_end_matches(',')).filter(|line| !line.is_empty());
        let told = lines.map(|line| line.parse().ok());
        let times: Vec<f64> = told.collect::<Option<_>>().unwrap_or_default();
        let first = times.first().copied().unwrap_or(0.0);
        let times: Vec<f64> = times.iter().map(|time| time - first).collect();
        Ok(Some(times).filter(|times| is_uneven(times, stream)))
    }

    /// Part that is missing of what the container promises, in words.
    ///
    /// # Errors
    /// As [`Packets::of`].
    pub fn missing(&self, path: &Path, stream: &Stream) -> Result<Option<String>> {
        let complaint = || self.complaint.as_ref().map(|said| format!("is damaged or cut short: {said}"));
        let is_short = |packets: &Self| match stream.promise {
            Promise::None => false,
            Promise::Frames { count, slack } => packets.total + slack < count,
            Promise::Seconds(seconds) => packets.end + ROUNDED + 2.0 / stream.frames_per_second() < seconds,
        };
        if !is_short(self) {
            return Ok(complaint());
        }
        // Frames that the file itself leaves out are there nevertheless.
        let is_trimmed = matches!(stream.promise, Promise::Frames { slack: 0, .. })
            && !is_short(&Self::read(path, stream, &["-ignore_editlist", "1"])?);
        let about = if matches!(stream.promise, Promise::Seconds(_)) { "about " } else { "" };
        let said =
            || format!("is damaged or cut short: it holds {} of {about}{} frames", self.total, stream.frames);
        Ok(if is_trimmed { complaint() } else { Some(said()) })
    }

    /// True where that many decoded frames are fewer than are shown, where the container counts exactly.
    pub fn lacks(&self, stream: &Stream, decoded: u64) -> bool {
        let shown = self.shown.len() as u64;
        let slack = match stream.promise {
            Promise::Frames { slack, .. } => slack,
            _ => return false,
        };
        decoded + slack < shown
    }
}

/// True for times in order that are not those of frames that last equally long.
fn is_uneven(times: &[f64], stream: &Stream) -> bool {
    let length = 1.0 / stream.frames_per_second();
    let off = 1.1 * stream.tick.value() + UNEVEN * length;
    let is_even = |(index, time): (usize, &f64)| (time - times[0] - index as f64 * length).abs() <= off;
    times.windows(2).all(|two| two[0] < two[1]) && !times.iter().enumerate().all(is_even)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::video::closed::Ratio;

    const TEXT: &str = "packet,1,1.500000,0.500000,K_\npacket,1,2.500000,0.500000,__\npacket,1,2.000000,0.500000,__\n\
        packet,0,8.000000,0.500000,K_\npacket,1,1.000000,0.500000,_D\nformat,1.000000\n";

    #[test]
    fn packets_are_counted_and_timed() {
        let packets = Packets::understand(TEXT, 1);
        assert_eq!((packets.total, packets.end), (4, 3.0));
        assert_eq!(packets.times(), [0.5, 1.0, 1.5]);
        let untimed = Packets::understand("packet,0,0.000000,0.040000,K_\npacket,0,N/A,0.040000,__\n", 0);
        assert_eq!((untimed.total, untimed.times().len()), (2, 0));
    }

    #[test]
    fn what_is_missing_is_told_in_numbers() {
        let packets = Packets::understand(TEXT, 1);
        let mut stream = Stream::of_frames((4, 4), Ratio::new(2, 1).unwrap());
        let mut missing = |promise| {
            (stream.promise, stream.frames) = (promise, 9);
            packets.missing(Path::new("none"), &stream).unwrap()
        };
        for whole in [
            Promise::None,
            Promise::Frames { count: 4, slack: 0 },
            Promise::Frames { count: 5, slack: 1 },
            Promise::Seconds(4.0),
        ] {
            assert_eq!(missing(whole), None, "{whole:?}");
        }
        let said = missing(Promise::Frames { count: 6, slack: 1 });
        assert_eq!(said.as_deref(), Some("is damaged or cut short: it holds 4 of 9 frames"));
        assert!(missing(Promise::Seconds(4.1)).is_some_and(|s| s.contains("of about 9 frames")));
        stream.promise = Promise::Frames { count: 4, slack: 0 };
        assert!(packets.lacks(&stream, 2) && !packets.lacks(&stream, 3));
    }

    #[test]
    fn frames_are_uneven_beyond_what_is_rounded() {
        let mut stream = Stream::of_frames((4, 4), Ratio::new(30000, 1001).unwrap());
        stream.tick = Ratio::new(1, 1000).unwrap();
        let rounded: Vec<f64> = (0..100).map(|i| (f64::from(i) * 1001.0 / 30.0).round() / 1000.0).collect();
        assert!(!is_uneven(&rounded, &stream) && !is_uneven(&[], &stream));
        let mut left_out = rounded.clone();
        left_out.remove(50);
        assert!(is_uneven(&left_out, &stream));
        // Times that are there twice tell nothing.
        left_out[7] = left_out[8];
        assert!(!is_uneven(&left_out, &stream));
    }
}
