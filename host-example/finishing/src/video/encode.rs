//! Frames into a video, as raw pictures of 16 bits to a process of ffmpeg.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::container::{Y4M, container, is_pipe};
use super::decode::{EXACT, rgb};
use super::process::{self, End, PROTOCOLS, Problem, Process, at, command, file};
use super::recount;
use super::stream::Stream;
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_pictures::pixels::Pixels;

/// Advice about an encoder that refuses.
const FIX: &str = "name another kind of video, or other options by --encode";

/// Standard output.
const PIPED: &str = "pipe:1";

/// Options by which a video is made.
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
    /// The file for the time being; none where the output is `-`.
    place: Option<PathBuf>,
    process: Process,
    /// Frames that were handed over.
    handed: u64,
    is_open: bool,
}

impl Encoder {
    /// Starts to encode into the file `place`, or to standard output where the output is `-`.
    ///
    /// # Errors
    /// [`Error::Failure`] without ffmpeg, [`Error::Input`] for options that change how many frames there are.
    pub fn start(encoding: &Encoding<'_>, place: &Path) -> Result<Self> {
        let output = encoding.output;
        encoding.options.map_or(Ok(()), check_options)?;
        let place = Some(place).filter(|_| !is_pipe(output));
        if place.is_some() {
            at(recount::check(), output, FIX)?;
        }
        let process = at(Process::start(&mut encoding.encoder(place)), output, FIX)?;
        Ok(Self {
            output: output.to_owned(),
            place: place.map(Path::to_owned),
            process,
            handed: 0,
            is_open: true,
        })
    }

    /// Hands over a frame of 16 bits, and says whether the encoder takes more; [`Encoder::end`] says why not.
    pub fn put(&mut self, frame: &Pixels) -> bool {
        self.handed += 1;
        let into = self.process.child().stdin.as_mut().map(|into| into.write_all(frame.bytes()));
        self.is_open &= matches!(into, Some(Ok(())));
        self.is_open
    }

    /// True where it has taken every frame.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Waits for the end of the video, and makes sure that it holds every frame that was handed over.
    ///
    /// # Errors
    /// [`Error::Input`] where ffmpeg refuses to begin, [`Error::Failure`] for a video that is not whole.
    pub fn end(self) -> Result<()> {
        let Self { output, place, mut process, handed, is_open } = self;
        drop(process.child().stdin.take());
        let end = process.finish();
        // Some ffmpegs end well without a file's last bytes, which they only complain of.
        let name = place.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy());
        let unfinished = end.complaints.naming(name.as_deref().unwrap_or(PIPED));
        if !end.is_good || unfinished.is_some() {
            return Err(failure(&output, place.as_deref(), &end));
        }
        let lost = |problem: String| {
            let fix = "start again; options of --encode must keep all frames";
            Error::failure(format!("{}: {problem}", output.display()), fix)
        };
        if let Some(place) = &place {
            let count = recount::frames(place, &output, handed).map_err(|problem| match problem {
                Problem::Missing(error) => error,
                Problem::Said(text) => lost(format!("cannot be read again: {text}")),
            })?;
            if count != handed {
                return Err(lost(format!("holds {count} frames of {handed} that were written")));
            }
        } else if !is_open {
            return Err(lost(format!("ended before {handed} frames were written")));
        }
        Ok(())
    }
}

/// Error of a video that was not made.
fn failure(output: &Path, place: Option<&Path>, end: &End) -> Error {
    use ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
    let said = end.said();
    match (place, end.trouble()) {
        (Some(_), Some(kind @ (StorageFull | QuotaExceeded | FileTooLarge))) => {
            files::unwritable(output, Some(kind), said)
        }
        (None, Some(_)) => {
            Error::failure(format!("cannot write to standard output: {said}"), "redirect it elsewhere")
        }
        (_, None) if end.is_refusal() => Error::file(output, said, FIX),
        _ => Error::failure(
            format!("{}: is not whole: {said}", output.display()),
            "see that there is room for files and memory, and start again",
        ),
    }
}

/// Refuses options by which fewer or more frames would be written than there are.
fn check_options(options: &str) -> Result<()> {
    const CHANGING: [&str; 9] =
        ["-r", "-t", "-to", "-ss", "-fs", "-frames", "-frames:v", "-vframes", "-shortest"];
    match options.split_whitespace().find(|word| CHANGING.contains(word)) {
        Some(word) => Err(Error::input(
            "--encode",
            format!("{word} changes how many frames there are"),
            "leave it out, and change the video that was written",
        )),
        None => Ok(()),
    }
}

impl Encoding<'_> {
    /// The command that encodes from its standard input.
    pub fn encoder(&self, place: Option<&Path>) -> Command {
        let Stream { width, height, rate, pixels, aspect, range, matrix, tags, .. } = self.stream;
        let container = container(self.output).unwrap_or(Y4M);
        let mut command = command("ffmpeg");
        command.args(["-v", "error", "-y"]).args(PROTOCOLS).args([
            "-f",
            "rawvideo",
            "-pix_fmt",
            rgb(self.channels),
        ]);
        command.args(["-s", &format!("{width}x{height}"), "-framerate", &rate.to_string(), "-i", "pipe:0"]);
        let more = self.more.filter(|_| container != Y4M);
        if let Some(more) = more {
            process::read(&mut command, more);
        }
        command.args(["-map", "0:v:0"]);
        if more.is_some() {
            command.args(["-map", "1:a?", "-map", "1:s?", "-c:a", "copy", "-c:s", "copy"]);
            command.args(["-map_metadata", "1", "-map_chapters", "1"]);
        }
        let change = format!(
            "scale=in_range=pc:out_color_matrix={matrix}:out_range={range}:{EXACT},format={pixels},setsar={aspect}"
        );
        command.args(["-vf", &change]);
        command.args(tags.iter().flatten());
        match self.options {
            Some(options) => command.args(options.split_whitespace()),
            None => command.args(usual(container)),
        };
        command.args(["-f", container]);
        if container == Y4M {
            // Forms of more than 8 bits are no part of the first description of it.
            command.args(["-strict", "-1"]);
        }
        match place {
            Some(place) => command.arg(file(place)).stdout(Stdio::null()),
            None => command.arg(PIPED),
        };
        command.stdin(Stdio::piped());
        command
    }
}

/// Options of the encoder where none are given: little is lost.
fn usual(container: &str) -> &'static [&'static str] {
    match container {
        "mp4" | "mov" => &["-c:v", "libx264", "-crf", "14", "-preset", "medium", "-movflags", "+faststart"],
        "matroska" | "mpegts" => &["-c:v", "libx264", "-crf", "14", "-preset", "medium"],
        "webm" => &["-c:v", "libvpx-vp9", "-crf", "18", "-b:v", "0", "-row-mt", "1"],
        "avi" => &["-c:v", "mpeg4", "-q:v", "2"],
        "mxf" => &["-c:v", "mpeg2video", "-q:v", "2"],
        _ => &[],
    }
}
