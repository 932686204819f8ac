//! A video from end to end: decoded, filtered and encoded, or written as pictures, at the same time.

use std::collections::VecDeque;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::container::{Y4M, container, is_pipe};
use super::decode::{self, OnError};
use super::encode::{Encoder, Encoding, More};
use super::input::Input;
use super::process::{End, Process, at};
use super::results::{Numbered, Results, Turn};
use super::stream::{Stream, depth};
use super::tracks::Tracks;
use crate::apply::filter::Filter;
use crate::apply::frame_cache::{CachedFrame, Window};
use crate::apply::masks::Masks;
use crate::apply::memory::Budget;
use crate::apply::report::{Outcome, Report};
use crate::apply::square;
use crate::apply::tasks::Task;
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::output;
use isophote_files::stop::Stop;
use isophote_pictures::pixels::{Pixels, Precision};
use isophote_pictures::read::Source;
use isophote_pictures::resize::Resize;

/// Advice about a video that is damaged.
const DAMAGED: &str = "use an intact file, or give --on-error skip to write what can be read";
/// Frames between a process and the filter.
const AHEAD: usize = 2;

/// A video that is to be filtered.
#[derive(Debug)]
pub struct VideoJob<'a> {
    /// Input: a file, or `-`.
    pub input: &'a Path,
    /// Output: a file, or `-`, or the pattern of pictures.
    pub output: &'a Path,
    /// Pictures that are written instead of a video.
    pub pictures: Option<Numbered<'a>>,
    /// Treatment of a file that is there.
    pub existing: Existing,
    /// Options of the encoder instead of the usual ones.
    pub encode: Option<&'a str>,
    /// Size of the frames of a video, where it is another; sides are even then.
    pub resize: Option<Resize>,
    /// Treatment of a damaged input.
    pub on_error: OnError,
    /// True where lines of JSON are wanted.
    pub json: bool,
    /// True where nothing is said of what goes well.
    pub quiet: bool,
    /// Masks of the frames, which count from 1.
    pub masks: &'a Masks,
    /// Set when the run shall end early.
    pub stop: &'a Stop,
}

/// Filters a video. The output, or each of its pictures, gets its name when it is whole.
///
/// # Errors
/// [`Error::Input`] for what ffmpeg does not read or write; [`Error::Failure`] without ffmpeg, when it or the filter fails,
/// the video is damaged or the disk full, or the run is stopped.
pub fn run(job: &VideoJob<'_>, filter: &mut Filter) -> Result<()> {
    let mut input = Input::open(job.input)?;
    let missing = input.missing()?;
    if let Some(missing) = missing.as_ref().filter(|_| job.on_error == OnError::Fail) {
        return Err(job.damaged(missing));
    }
    let wanted = job.pictures.and_then(|pictures| pictures.frames).map(|list| list.frames().len());
    let frames = wanted.unwrap_or_else(|| usize::try_from(input.stream.frames).unwrap_or(usize::MAX));
    let report = Report::about(frames, job.json && !is_pipe(job.output));
    let report = report.quietly(job.quiet).of_result(job.output, None);
    let work = |place: &Path| job.all(filter, &mut input, missing, place, &report);
    let done = if is_pipe(job.output) || job.pictures.is_some() {
        work(job.output)
    } else {
        files::write_by_path(job.output, job.existing, work)
    };
    if done.is_err() && job.pictures.is_none() {
        report.nothing_written();
    }
    report.end(done.is_ok() && !is_pipe(job.output));
    done
}

impl VideoJob<'_> {
    /// Decodes, filters and encodes to `place`, or to pictures. Of the input something may be missing, in words.
    fn all(
        &self,
        filter: &mut Filter,
        input: &mut Input<'_>,
        missing: Option<String>,
        place: &Path,
        report: &Report,
    ) -> Result<()> {
        let stream = &input.stream.clone();
        let mut decoder = decode::decoder(input.origin(), stream, None, self.on_error);
        let mut decoder = at(Process::start(&mut decoder), self.input, "name a video that ffmpeg reads")?;
        let (from, into) = (decoder.child().stdout.take(), decoder.child().stdin.take());
        let Some(mut from) = from else { return Err(broken("decoding")) };
        let budget = Budget::new(u64::MAX, 1);
        let complaints = decoder.complaints();
        // Frames after a complaint are of no use where the run is to fail.
        let fails = self.on_error == OnError::Fail;
        let is_over = || fails && complaints.first().is_some();
        let (more, times) = (input.more(), input.times()?);
        let container = container(self.output).unwrap_or(Y4M);
        let tracks = more.map_or(Ok(Tracks::default()), |(path, _)| Tracks::of(path, container))?;
        tracks.warn(self.input, self.output);
        let more = more.map(|(path, start)| More { path, tracks: &tracks, start });
        let (width, height) = self.size(stream)?;
        let written = &Stream { width, height, ..stream.clone() };
        let encoder = |channels| {
            let (output, options, times, stream) = (self.output, self.encode, times.as_ref(), written);
            Encoder::start(&Encoding { stream, channels, more, times, output, options }, place)
        };
        if times.is_some() && self.pictures.is_some() {
            output::warn(format_args!(
                "{}: its frames last unequally long, and pictures do not tell how long",
                self.name()
            ));
        }
        let mut results = match self.pictures {
            Some(pictures) => Results::Pictures(pictures, self.input),
            None => Results::Video(&encoder, (width, height), None),
        };
        let ((count, is_over), cut) = std::thread::scope(|scope| {
            // It ends with the stream, or with the decoder.
            let relaying = input.pipe().zip(into).map(|(pipe, into)| scope.spawn(move || pipe.relay(into)));
            let (send, decoded) = sync_channel(AHEAD);
            let reading = scope.spawn(move || read(stream, &mut from, &send, &is_over));
            let filtered = self.filter(filter, (decoded, &budget, stream), &mut results, report);
            let read = reading.join().map_err(|_| broken("decoding"));
            let cut = relaying.map_or(Ok(None), |relaying| relaying.join().map_err(|_| broken("reading")));
            let filtered = filtered?;
            read?;
            Ok::<_, Error>((filtered, cut?))
        })?;
        if results.is_open() && !is_over {
            self.check(input, count.unsigned_abs(), missing.or(cut), &decoder.finish(), report)?;
        }
        results.end(count, self.input)
    }

    /// Checks that all frames of the input were decoded well; where what is damaged is skipped, says what it was.
    fn check(
        &self,
        input: &Input<'_>,
        count: u64,
        missing: Option<String>,
        end: &End,
        report: &Report,
    ) -> Result<()> {
        let said = end.complaints.first().or_else(|| (!end.is_good).then(|| end.said()));
        if missing.is_none() && said.is_none() && !input.lacks(count) {
            return Ok(());
        }
        let of_all = match (&missing, input.stream.frames) {
            (None, 1..) => format!(" of {}", input.stream.frames),
            _ => String::new(),
        };
        let mut problem =
            missing.unwrap_or_else(|| if count == 0 { "cannot be decoded" } else { "is damaged" }.to_owned());
        problem += &format!(", and {count}{of_all} frames could be decoded");
        problem += &said.map_or_else(String::new, |said| format!(": {said}"));
        match self.on_error {
            OnError::Fail => Err(self.damaged(&problem)),
            OnError::Skip => {
                report.warn(&format!("{}: {problem}", self.name()));
                Ok(())
            }
        }
    }

    /// Size of the frames of the result.
    fn size(&self, stream: &Stream) -> Result<(u32, u32)> {
        let size = (stream.width, stream.height);
        let Some(resize) = self.resize else { return Ok(size) };
        let (width, height) =
            resize.of(size).map_err(|problem| Error::input("--resize", problem, "ask for a smaller size"))?;
        // Most videos have no odd ones.
        Ok((width.next_multiple_of(2), height.next_multiple_of(2)))
    }

    fn damaged(&self, problem: &str) -> Error {
        Error::failure(format!("{}: {problem}", self.name()), DAMAGED)
    }

    /// The input's name for people.
    fn name(&self) -> String {
        if is_pipe(self.input) { "standard input".to_owned() } else { self.input.display().to_string() }
    }

    /// Filters all frames and hands the results on. Returns how many frames there were, and whether there may be more that
    /// nobody wants.
    fn filter(
        &self,
        filter: &mut Filter,
        (decoded, budget, stream): (Receiver<Pixels>, &Budget, &Stream),
        results: &mut Results<'_>,
        report: &Report,
    ) -> Result<(i64, bool)> {
        let name = self.input.display().to_string();
        let [past, future] = filter.frames()?;
        let (library, meaning) = (filter.library(), stream.meaning());
        // Pictures have no more bits than the video.
        let is_rounded = self.pictures.is_some() && depth(stream.pixels) <= 8;
        let hold = |(pixels, number): (Pixels, i64)| {
            let pixels = if is_rounded { pixels.converted(Precision::U8) } else { pixels };
            let mut source = Source::alone(pixels, meaning.clone());
            self.masks.add(&mut source, Some(number))?;
            square::make(&library, &name, &mut source)?;
            source.check()?;
            Ok::<_, Error>(Arc::new(CachedFrame::new(Some(number), source, false, budget.share())))
        };
        let mut decoded = decoded.into_iter().zip(1..).map(hold);
        let mut frames: VecDeque<Arc<CachedFrame<'_>>> = VecDeque::new();
        let mut count = 0;
        loop {
            if self.stop.is_requested() {
                let fix = self.pictures.map_or("start again", |all| all.consent.resuming());
                return Err(Error::failure(format!("stopped after {count} frames"), fix));
            }
            let number = count + 1;
            let turn = results.turn(number);
            if turn == Turn::Over {
                return Ok((count, true));
            }
            while frames.back().and_then(|last| last.number).is_none_or(|last| last < number + future) {
                let Some(next) = decoded.next().transpose()? else { break };
                frames.push_back(next);
            }
            frames.retain(|held| held.number >= Some(number - past));
            let Some(own) = frames.iter().find(|held| held.number == Some(number)) else { break };
            count = number;
            let output = self.pictures.map_or_else(|| self.output.into(), |all| all.pattern.file(count));
            let task = Task { frame: Some(count), input: self.input.into(), output };
            if turn == Turn::There {
                report.frame(&task, &Outcome::Skipped);
            }
            if turn != Turn::Made {
                continue;
            }
            let window = Window { own: Arc::clone(own), frames: frames.iter().cloned().collect() };
            let filtered = filter.run(&name, &window, None, results.format(), &mut |_| {})?;
            let replaced = filtered.replaced;
            if !results.put(count, filtered, &own.source)? {
                // The encoder has ended, and says why.
                break;
            }
            report.frame(&task, &Outcome::Written(replaced));
        }
        Ok((count, false))
    }
}

/// Hands all frames on, until nobody takes them or it is over.
fn read(stream: &Stream, from: &mut impl Read, send: &SyncSender<Pixels>, is_over: &impl Fn() -> bool) {
    while let Some(pixels) = decode::frame(stream, from).filter(|_| !is_over()) {
        if send.send(pixels).is_err() {
            return;
        }
    }
}

fn broken(what: &str) -> Error {
    Error::failure(format!("{what} stopped"), "this is a mistake in the program; please report it")
}
