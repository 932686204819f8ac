//! A video from end to end: decoded, filtered and encoded at the same time.

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::container::is_pipe;
use super::decode;
use super::encode::{Encoder, Encoding};
use super::process::at;
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
use crate::pixels::{Pixels, Precision};
use crate::stop::Stop;

/// Frames between a process and the filter.
const AHEAD: usize = 2;

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
        let mut decoder =
            at(decode::start(self.input, stream, None), self.input, "name a video that ffmpeg reads")?;
        let (from, into) = (decoder.child().stdout.take(), decoder.child().stdin.take());
        let Some(mut from) = from else { return Err(broken("decoding")) };
        let budget = Budget::new(u64::MAX, 1);
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
            let read = reading.join().map_err(|_| broken("decoding"));
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
        let (mut encoder, mut count) = (None::<Encoder>, 0);
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
                let encoding = Encoding {
                    stream,
                    channels: result.channels(),
                    more: Some(self.input).filter(|input| !is_pipe(input)),
                    output: self.output,
                    options: self.encode,
                };
                encoder = Some(Encoder::start(&encoding, place)?);
            }
            if encoder.as_mut().is_some_and(|encoder| !encoder.put(&result)) {
                // It has ended, and says why.
                break;
            }
            let task = Task { frame: Some(count), input: self.input.into(), output: self.output.into() };
            report.frame(&task, &Outcome::Written(filtered.replaced));
        }
        encoder.map_or(Ok(()), Encoder::end)?;
        Ok(count)
    }
}

/// Hands all frames on, until nobody takes them.
fn read(stream: &Stream, from: &mut impl Read, send: &SyncSender<Pixels>) {
    while let Some(pixels) = decode::frame(stream, from) {
        if send.send(pixels).is_err() {
            return;
        }
    }
}

fn broken(what: &str) -> Error {
    Error::failure(format!("{what} stopped"), "this is a mistake in the program; please report it")
}
