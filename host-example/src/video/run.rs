//! A video from end to end: decoded, filtered and encoded at the same time.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::container::{Y4M, container, is_pipe};
use super::process::{Process, at, command, file};
use super::stream::Stream;
use crate::apply::exr::Picture;
use crate::apply::filter::Filter;
use crate::apply::masks::Masks;
use crate::apply::memory::Budget;
use crate::apply::read::{ImageState, Source};
use crate::apply::reel::{Held, Window};
use crate::apply::report::{Outcome, Report};
use crate::apply::tasks::Task;
use crate::apply::write::Format;
use crate::error::{Error, Result};
use crate::files;
use crate::pixels::{Pixels, Precision, Samples};
use crate::stop::Stop;

/// Frames between a process and the filter.
const AHEAD: usize = 2;

/// How ffmpeg changes between RGB and what videos hold.
const EXACT: &str = "flags=bicubic+accurate_rnd+full_chroma_int+full_chroma_inp";

/// A video that is to be filtered.
#[derive(Debug)]
pub struct Job<'a> {
    /// What is read: a file, or `-`.
    pub input: &'a Path,
    /// What is written: a file, or `-`.
    pub output: &'a Path,
    /// Options of the encoder instead of the usual ones.
    pub encode: Option<&'a str>,
    /// Whether lines of JSON are wanted.
    pub json: bool,
    /// Masks of the frames, which count from 1.
    pub masks: &'a Masks,
    /// Set when the run shall end early.
    pub stop: &'a Stop,
}

/// Filters a video. The output gets its name when it is whole.
///
/// # Errors
/// [`Error::Input`] for what ffmpeg does not read or write; [`Error::Failure`] without ffmpeg, when it or the filter fails,
/// or the run is stopped.
pub fn run(job: &Job<'_>, filter: &mut Filter) -> Result<()> {
    if !is_pipe(job.input) && !job.input.is_file() {
        return Err(Error::file(job.input, "is no file", "name a video"));
    }
    let (stream, header) = match is_pipe(job.input) {
        true => Stream::of_y4m(&mut io::stdin().lock())?,
        false => (Stream::of_file(job.input)?, Vec::new()),
    };
    let report = Report::about(stream.frames, job.json && !is_pipe(job.output));
    let mut work = |place: &Path| job.all(filter, &stream, &header, place, &report);
    let done = if is_pipe(job.output) { work(job.output) } else { files::write_by_path(job.output, work) };
    report.end(done.is_ok() && !is_pipe(job.output));
    done
}

impl Job<'_> {
    /// Decodes, filters and encodes to `place`.
    fn all(
        &self,
        filter: &mut Filter,
        stream: &Stream,
        header: &[u8],
        place: &Path,
        report: &Report,
    ) -> Result<()> {
        let mut decoder = at(self.decoder(stream), self.input, "name a video that ffmpeg reads")?;
        let (from, into) = (decoder.child().stdout.take(), decoder.child().stdin.take());
        let Some(mut from) = from else { return Err(broken("decoding")) };
        let budget = Budget::new(u64::MAX);
        let count = std::thread::scope(|scope| {
            if let Some(mut into) = into {
                // It ends with standard input, or with the decoder.
                scope.spawn(move || {
                    into.write_all(header).and_then(|()| io::copy(&mut io::stdin().lock(), &mut into))
                });
            }
            let (send, decoded) = sync_channel(AHEAD);
            let reading = scope.spawn(move || read(stream, &mut from, &send));
            let filtered = self.filter(filter, stream, (decoded, &budget), place, report);
            let read = reading.join().unwrap_or_else(|_| Err(broken("decoding")));
            let count = filtered?;
            read.map(|()| count)
        })?;
        at(decoder.end(), self.input, "name an intact video")?;
        match count {
            0 => Err(Error::file(self.input, "has no frames", "name a video")),
            _ => Ok(()),
        }
    }

    /// Filters and encodes all frames, and returns how many there were.
    fn filter(
        &self,
        filter: &mut Filter,
        stream: &Stream,
        (decoded, budget): (Receiver<Pixels>, &Budget),
        place: &Path,
        report: &Report,
    ) -> Result<i64> {
        let name = self.input.display().to_string();
        let [past, future] = filter.frames()?;
        let hold = |(pixels, number)| {
            let picture = Picture::alone(pixels);
            let state = ImageState::DisplayReferred;
            let mut source = Source { pictures: vec![picture], state, profile: None, exr: None };
            self.masks.add(&mut source, Some(number))?;
            source.check()?;
            Ok::<_, Error>(Arc::new(Held::new(Some(number), source, false, budget.share())))
        };
        let mut decoded = decoded.into_iter().zip(1..).map(hold);
        let mut frames: VecDeque<Arc<Held<'_>>> = VecDeque::new();
        let (mut encoder, mut count) = (None, 0);
        loop {
            if self.stop.is_requested() {
                return Err(Error::failure(format!("stopped after {count} frames"), "start again"));
            }
            let number = count + 1;
            while frames.back().and_then(|last| last.number).is_none_or(|last| last < number + future) {
                let Some(next) = decoded.next().transpose()? else { break };
                frames.push_back(next);
            }
            frames.retain(|held| held.number >= Some(number - past));
            let Some(own) = frames.iter().find(|held| held.number == Some(number)) else { break };
            count = number;
            let window = Window { own: Arc::clone(own), frames: frames.iter().cloned().collect() };
            let filtered = filter.run(&name, &window, None, Format::Png, &mut |_| {})?;
            let Some(result) = filtered.results.into_iter().next() else { return Err(broken("filtering")) };
            let result = result.converted(Precision::U16);
            if encoder.is_none() {
                encoder = Some(at(self.encoder(stream, result.channels(), place), self.output, FIX)?);
            }
            if let Some(process) = &mut encoder {
                let into = process.child().stdin.as_mut().map(|into| into.write_all(result.bytes()));
                if !matches!(into, Some(Ok(()))) {
                    // It has ended, and says why.
                    break;
                }
            }
            let task = Task { frame: Some(count), input: self.input.into(), output: self.output.into() };
            report.frame(&task, &Outcome::Written(filtered.replaced));
        }
        if let Some(mut process) = encoder {
            drop(process.child().stdin.take());
            at(process.end(), self.output, FIX)?;
        }
        Ok(count)
    }

    fn decoder(&self, stream: &Stream) -> std::result::Result<Process, super::process::Problem> {
        let mut command = command("ffmpeg");
        command.args(["-v", "error"]);
        if is_pipe(self.input) {
            command.args(["-f", Y4M, "-i", "pipe:0"]).stdin(Stdio::piped());
        } else {
            command.args(["-nostdin", "-i"]).arg(file(self.input)).stdin(Stdio::null());
        }
        let Stream { rate, range, matrix, .. } = stream;
        let change = format!("scale=in_color_matrix={matrix}:in_range={range}:out_range=pc:{EXACT}");
        command.args(["-map", "0:v:0", "-vf", &change]);
        // Frames of unequal length are repeated or left out to last equally long.
        match stream.is_steady {
            true => command.args(["-fps_mode", "passthrough"]),
            false => command.args(["-fps_mode", "cfr", "-r", rate]),
        };
        command.args(["-pix_fmt", rgb(channels(stream)), "-f", "rawvideo", "pipe:1"]);
        Process::start(command.stdout(Stdio::piped()))
    }

    fn encoder(
        &self,
        stream: &Stream,
        channels: u32,
        place: &Path,
    ) -> std::result::Result<Process, super::process::Problem> {
        let Stream { width, height, rate, pixels, aspect, range, matrix, tags, .. } = stream;
        let container = container(self.output).unwrap_or(Y4M);
        let mut command = command("ffmpeg");
        command.args(["-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", rgb(channels)]);
        command.args(["-s", &format!("{width}x{height}"), "-framerate", rate, "-i", "pipe:0"]);
        let has_more = container != Y4M && !is_pipe(self.input);
        if has_more {
            command.arg("-i").arg(file(self.input));
        }
        command.args(["-map", "0:v:0"]);
        if has_more {
            command.args(["-map", "1:a?", "-map", "1:s?", "-c:a", "copy", "-c:s", "copy"]);
            command.args(["-map_metadata", "1", "-map_chapters", "1"]);
        }
        let change = format!(
            "scale=in_range=pc:out_color_matrix={matrix}:out_range={range}:{EXACT},format={pixels},setsar={}",
            aspect.replace(':', "/")
        );
        command.args(["-vf", &change]);
        command.args(tags.iter().flatten());
        match self.encode {
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

const FIX: &str = "name another kind of video, or other options by --encode";

/// Hands all frames on, until nobody takes them.
fn read(stream: &Stream, from: &mut impl Read, send: &SyncSender<Pixels>) -> Result<()> {
    let channels = channels(stream);
    let length = stream.width as usize * stream.height as usize * channels as usize;
    loop {
        let mut samples = vec![0u16; length];
        // A last frame that is cut short is one of a decoder that failed, which says why.
        if from.read_exact(bytemuck::cast_slice_mut(&mut samples)).is_err() {
            return Ok(());
        }
        let pixels = Pixels::new(stream.width, stream.height, channels, Samples::U16(samples));
        let Some(pixels) = pixels else { return Err(broken("decoding")) };
        if send.send(pixels).is_err() {
            return Ok(());
        }
    }
}

/// Channels of a stream's frames: with alpha or without.
fn channels(stream: &Stream) -> u32 {
    let has_alpha =
        ["yuva", "rgba", "bgra", "argb", "abgr", "gbrap", "ya"].iter().any(|a| stream.pixels.starts_with(a));
    if has_alpha { 4 } else { 3 }
}

/// The raw form of frames of so many channels of 16 bits.
fn rgb(channels: u32) -> &'static str {
    let is_little = cfg!(target_endian = "little");
    match (channels, is_little) {
        (1, true) => "gray16le",
        (1, false) => "gray16be",
        (4, true) => "rgba64le",
        (4, false) => "rgba64be",
        (_, true) => "rgb48le",
        (_, false) => "rgb48be",
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

fn broken(what: &str) -> Error {
    Error::failure(format!("{what} stopped"), "this is a mistake in the program; please report it")
}
