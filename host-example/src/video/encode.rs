//! Frames into a video, as raw pictures of 16 bits to a process of ffmpeg.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use super::container::{Y4M, container, is_pipe};
use super::decode::{EXACT, rgb};
use super::process::{Problem, Process, at, command, file};
use super::stream::Stream;
use crate::error::Result;
use crate::pixels::Pixels;

/// What to do about an encoder that refuses.
const FIX: &str = "name another kind of video, or other options by --encode";

/// How a video is made.
#[derive(Clone, Copy, Debug)]
pub struct Encoding<'a> {
    /// Size, rate and form of its frames.
    pub stream: &'a Stream,
    /// Channels of the frames that are handed over.
    pub channels: u32,
    /// A file whose sound, subtitles and metadata it takes over.
    pub more: Option<&'a Path>,
    /// The video, which may be `-`; it says which kind of container.
    pub output: &'a Path,
    /// Options of the encoder instead of the usual ones.
    pub options: Option<&'a str>,
}

/// An encoder at work.
#[derive(Debug)]
pub struct Encoder {
    output: PathBuf,
    process: Process,
}

impl Encoder {
    /// Starts to encode into the file `place`, or to standard output where the output is `-`.
    ///
    /// # Errors
    /// [`Error::Failure`](crate::error::Error::Failure) without ffmpeg.
    pub fn start(encoding: &Encoding<'_>, place: &Path) -> Result<Self> {
        let process = at(encoding.start(place), encoding.output, FIX)?;
        Ok(Self { output: encoding.output.to_owned(), process })
    }

    /// Hands over a frame of 16 bits, and says whether the encoder takes more; [`Encoder::end`] says why not.
    pub fn put(&mut self, frame: &Pixels) -> bool {
        let into = self.process.child().stdin.as_mut().map(|into| into.write_all(frame.bytes()));
        matches!(into, Some(Ok(())))
    }

    /// Waits for the end of the video.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) with what ffmpeg complains of.
    pub fn end(mut self) -> Result<()> {
        drop(self.process.child().stdin.take());
        at(self.process.end(), &self.output, FIX)
    }
}

impl Encoding<'_> {
    fn start(&self, place: &Path) -> std::result::Result<Process, Problem> {
        let Stream { width, height, rate, pixels, aspect, range, matrix, tags, .. } = self.stream;
        let container = container(self.output).unwrap_or(Y4M);
        let mut command = command("ffmpeg");
        command.args(["-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", rgb(self.channels)]);
        command.args(["-s", &format!("{width}x{height}"), "-framerate", rate, "-i", "pipe:0"]);
        let more = self.more.filter(|_| container != Y4M);
        if let Some(more) = more {
            command.arg("-i").arg(file(more));
        }
        command.args(["-map", "0:v:0"]);
        if more.is_some() {
            command.args(["-map", "1:a?", "-map", "1:s?", "-c:a", "copy", "-c:s", "copy"]);
            command.args(["-map_metadata", "1", "-map_chapters", "1"]);
        }
        let change = format!(
            "scale=in_range=pc:out_color_matrix={matrix}:out_range={range}:{EXACT},format={pixels},setsar={}",
            aspect.replace(':', "/")
        );
        command.args(["-vf", &change]);
        command.args(tags.iter().flatten());
        match self.options {
            Some(options) => command.args(options.split_whitespace()),
            None => command.args(usual(container)),
        };
        command.args(["-f", container]);
        if is_pipe(self.output) {
            command.args(["-strict", "-1", "pipe:1"]);
        } else {
            command.arg(file(place)).stdout(Stdio::null());
        }
        Process::start(command.stdin(Stdio::piped()))
    }
}

/// Options of the encoder where none are given: little is lost.
fn usual(container: &str) -> &'static [&'static str] {
    match container {
        "mp4" | "mov" => &["-c:v", "libx264", "-crf", "14", "-preset", "medium", "-movflags", "+faststart"],
        "matroska" | "mpegts" => &["-c:v", "libx264", "-crf", "14", "-preset", "medium"],
        "webm" => &["-c:v", "libvpx-vp9", "-crf", "18", "-b:v", "0", "-row-mt", "1"],
        "avi" | "mxf" => &["-c:v", "mpeg4", "-q:v", "2"],
        _ => &[],
    }
}
