//! Frames into a video, as raw pictures of 16 bits to a process of ffmpeg.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::container::{WEBP, Y4M, container, is_pipe};
use super::decode::{EXACT, rgb};
use super::form::Form;
use super::opaque::on_black;
use super::process::{self, End, PROTOCOLS, Problem, Process, at, command, file};
use super::recount;
use super::stream::Stream;
use super::timed::{self, Times};
use super::tracks::Tracks;
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_files::output;
use isophote_pictures::pixels::{Pixels, Samples};

/// Advice about an encoder that refuses.
const FIX: &str = "name another kind of video, or other options by --encode";

/// Standard output.
const PIPED: &str = "pipe:1";

/// Containers whose frames all last equally long.
const EVEN: [&str; 6] = ["avi", "mxf", "vob", "dv", "ogv", Y4M];
/// Containers that begin with their first frame.
const AT_ONCE: [&str; 4] = ["mxf", "dv", "ogv", Y4M];
/// Containers that have a scale of their own for the times of frames.
const SCALED: [&str; 4] = ["mp4", "mov", "3gp", "3g2"];
/// Least seconds by which pictures begin later than what else is in a file.
const LEAST_START: f64 = 0.000_5;
/// Least alpha of what is opaque but for rounding.
const OPAQUE: u16 = 0xFF00;
/// Filters that find the best colours of every frame for itself.
const PALETTE: &str = ",split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1";

/// Options by which a video is made.
#[derive(Clone, Copy, Debug)]
pub struct Encoding<'a> {
    /// Size, rate and form of its frames.
    pub stream: &'a Stream,
    /// Channels of the frames that are handed over.
    pub channels: u32,
    /// A file whose sound, subtitles and metadata it takes over.
    pub more: Option<More<'a>>,
    /// Times of frames that do not last equally long.
    pub times: Option<&'a Times>,
    /// The video, which may be `-`; it says which kind of container.
    pub output: &'a Path,
    /// Options of the encoder instead of the usual ones.
    pub options: Option<&'a str>,
}

/// Parts of a file beside the pictures that are taken over.
#[derive(Clone, Copy, Debug)]
pub struct More<'a> {
    /// The file.
    pub path: &'a Path,
    /// Its other tracks.
    pub tracks: &'a Tracks,
    /// Start of the pictures, in seconds from that of the file.
    pub start: f64,
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
    /// True where transparent frames are put on black.
    is_on_black: bool,
    /// True where somebody was told that they are.
    is_told: bool,
    times: Option<Times>,
    /// Seconds that a frame lasts about.
    length: f64,
    /// True where the result has as many frames as are handed over.
    is_counted: bool,
}

impl Encoder {
    /// Starts to encode into the file `place`, or to standard output where the output is `-`.
    ///
    /// # Errors
    /// [`Error::Failure`] without ffmpeg, [`Error::Input`] for options that change how many frames there are.
    pub fn start(encoding: &Encoding<'_>, place: &Path) -> Result<Self> {
        let Encoding { stream, output, .. } = *encoding;
        encoding.options.map_or(Ok(()), check_options)?;
        let place = Some(place).filter(|_| !is_pipe(output));
        if place.is_some() {
            at(recount::check(), output, FIX)?;
        }
        let form = encoding.form();
        encoding.warn(&form);
        let mut process = at(Process::start(&mut encoding.encoder(place)), output, FIX)?;
        let is_on_black = encoding.channels == 4 && !form.has_alpha;
        let channels = if is_on_black { 3 } else { encoding.channels };
        let times = encoding.is_timed().then(|| encoding.times.cloned().unwrap_or_default());
        let header = times
            .as_ref()
            .map_or_else(Vec::new, |_| timed::header((stream.width, stream.height), channels, stream.rate));
        let is_open = process.child().stdin.as_mut().is_some_and(|into| into.write_all(&header).is_ok());
        Ok(Self {
            output: output.to_owned(),
            place: place.map(Path::to_owned),
            process,
            handed: 0,
            is_open,
            is_on_black,
            is_told: false,
            times,
            length: 1.0 / stream.frames_per_second(),
            is_counted: encoding.times.is_none() || !encoding.is_even(),
        })
    }

    /// Hands over a frame of 16 bits, and says whether the encoder takes more; [`Encoder::end`] says why not.
    pub fn put(&mut self, frame: &Pixels) -> bool {
        let opaque = self.is_on_black.then(|| self.opaque(frame));
        let frame = opaque.as_ref().unwrap_or(frame);
        let start = self.times.as_ref().map_or_else(Vec::new, |times| {
            timed::before_frame(times.of(self.handed, self.length), frame.bytes().len())
        });
        self.handed += 1;
        let into = self.process.child().stdin.as_mut();
        let into = into.map(|into| into.write_all(&start).and_then(|()| into.write_all(frame.bytes())));
        self.is_open &= matches!(into, Some(Ok(())));
        self.is_open
    }

    /// The frame without its alpha, which is told once where there is any.
    fn opaque(&mut self, frame: &Pixels) -> Pixels {
        if let (Samples::U16(samples), false) = (frame.samples(), self.is_told)
            && samples.as_chunks::<4>().0.iter().any(|pixel| pixel[3] < OPAQUE)
        {
            self.is_told = true;
            output::warn(format_args!(
                "{}: cannot hold alpha, and what is transparent is put on black (.mov, .mkv and .webm can)",
                self.output.display()
            ));
        }
        on_black(frame)
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
        let Self { output, place, mut process, handed, is_open, is_counted, .. } = self;
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
            if (is_counted && count != handed) || count == 0 {
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
    fn container(&self) -> &'static str {
        container(self.output).unwrap_or(Y4M)
    }

    /// Pixels as the encoder gets them.
    fn form(&self) -> Form {
        Form::of(self.container(), self.stream, self.channels, self.options)
    }

    /// True where all frames of the result last equally long.
    fn is_even(&self) -> bool {
        EVEN.contains(&self.container())
    }

    /// Warns of everything that the result cannot hold.
    fn warn(&self, form: &Form) {
        let output = self.output.display();
        if self.times.is_some() && self.is_even() {
            let rate = self.stream.grid.value();
            output::warn(format_args!(
                "{output}: cannot hold frames that last unequally long, and has {rate:.3} frames a second, some of them twice \
                 (.mp4, .mov, .mkv and .webm can)"
            ));
        }
        let Stream { width, height, .. } = self.stream;
        if form.size != (*width, *height) {
            let (across, down) = form.size;
            output::warn(format_args!(
                "{output}: cannot hold {width}x{height} pixels, and has {across}x{down}, without the last column or row"
            ));
        }
    }

    /// The command that encodes from its standard input.
    pub fn encoder(&self, place: Option<&Path>) -> Command {
        let container = self.container();
        let form = self.form();
        let mut command = command("ffmpeg");
        command.args(["-v", "error", "-y"]);
        self.read_frames(&mut command, &form);
        let more = self.more.filter(|_| container != Y4M);
        if let Some(more) = more {
            process::read(&mut command, more.path);
        }
        command.args(["-map", "0:v:0"]);
        if let Some(more) = more {
            command.args(&more.tracks.options);
        }
        command.args(["-vf", &self.filters(&form)]);
        command.args(form.tags.iter().flatten());
        self.keep_times(&mut command);
        command.args(&form.options);
        command.args(self.muxing());
        command.args(self.options.into_iter().flat_map(str::split_whitespace));
        command.args(["-f", container]);
        match place {
            Some(place) => command.arg(file(place)).stdout(Stdio::null()),
            None => command.arg(PIPED),
        };
        command.stdin(Stdio::piped());
        command
    }

    /// Options of the first input, which are the frames.
    fn read_frames(&self, command: &mut Command, form: &Form) {
        let Stream { width, height, rate, .. } = self.stream;
        let start = self.start();
        if start != 0.0 {
            command.args(["-itsoffset", &format!("{start:.6}")]);
        }
        command.args(PROTOCOLS);
        if self.is_timed() {
            command.args(["-f", "matroska"]);
        } else {
            let channels = if form.has_alpha || self.channels != 4 { self.channels } else { 3 };
            command.args(["-f", "rawvideo", "-pix_fmt", rgb(channels), "-s", &format!("{width}x{height}")]);
            command.args(["-framerate", &rate.to_string()]);
        }
        command.args(["-i", "pipe:0"]);
    }

    /// True where frames are handed over with their times.
    fn is_timed(&self) -> bool {
        self.times.is_some() || (self.start() != 0.0 && !self.is_even())
    }

    /// Start of the pictures, in seconds from that of the sound or the subtitles.
    fn start(&self) -> f64 {
        let start = self.more.map_or(0.0, |more| more.start);
        if AT_ONCE.contains(&self.container()) || start.abs() < LEAST_START { 0.0 } else { start }
    }

    fn filters(&self, form: &Form) -> String {
        let Form { pixels, range, matrix, size: (width, height), .. } = form;
        let aspect = self.stream.aspect;
        let cut = match (*width, *height) == (self.stream.width, self.stream.height) {
            true => String::new(),
            false => format!("crop={width}:{height}:0:0,"),
        };
        let palette = if self.container() == "gif" && self.options.is_none() { PALETTE } else { "" };
        let unsaid = form.unsaid();
        format!(
            "{cut}scale=in_range=pc:out_color_matrix={matrix}:out_range={range}:{EXACT},format={pixels},{unsaid},setsar={aspect}{palette}"
        )
    }

    /// Options by which frames are shown when they are to be.
    fn keep_times(&self, command: &mut Command) {
        let Stream { grid, tick, .. } = self.stream;
        if self.times.is_some() && self.is_even() {
            command.args(["-fps_mode", "cfr", "-r", &grid.to_string()]);
            return;
        }
        command.args(["-fps_mode", "passthrough"]);
        if self.is_timed() {
            command.args(["-enc_time_base", &tick.with(':')]);
            if let Some(scale) = tick.parts_of_one().filter(|_| SCALED.contains(&self.container())) {
                command.args(["-video_track_timescale", &scale.to_string()]);
            }
        }
    }

    /// Options of the container.
    fn muxing(&self) -> Vec<String> {
        let words = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
        let last = self.times.and_then(|times| times.last);
        match self.container() {
            "mp4" | "mov" if self.options.is_none() => words(&["-movflags", "+faststart"]),
            "mpegts" if self.output.extension().is_some_and(|e| !e.eq_ignore_ascii_case("ts")) => {
                words(&["-mpegts_m2ts_mode", "1"])
            }
            "gif" => {
                let last = last.map_or(-1.0, |seconds| (seconds * 100.0).round());
                vec!["-loop".into(), "0".into(), "-final_delay".into(), format!("{last}")]
            }
            "apng" => words(&["-plays", "0"]),
            WEBP => words(&["-loop", "0"]),
            // Forms of more than 8 bits are no part of the first description of it.
            Y4M => words(&["-strict", "-1"]),
            _ => Vec::new(),
        }
    }
}
