//! A video of which any frame is wanted at any time, as players and windows do.
//!
//! Frames are those, and have the numbers, that a run over the whole video has: the first is number 1. Where the container
//! tells the time of every frame, the decoder is sent to the key frame before the one that is wanted; elsewhere it goes on
//! from where it is, or starts again.

use std::path::{Path, PathBuf};
use std::process::ChildStdout;
use std::thread::Builder;

use super::container::{container, is_moving_webp};
use super::decode;
use super::decode::{OnError, Origin};
use super::packets::Packets;
use super::probe::probe;
use super::process::{Process, at};
use super::stream::Stream;
use super::webp::Webp;
use isophote_files::error::{Error, Result};
use isophote_pictures::pixels::Pixels;

/// Containers whose frames are found by their times.
const TIMED: [&str; 3] = ["mp4", "mov", "matroska"];
/// The same, by the name of a container that holds less.
const WEBM: &str = "webm";
/// Frames that are rather decoded than left out by sending the decoder elsewhere.
const NEAR: i64 = 24;
/// Advice about a video that cannot be decoded.
const FIX: &str = "name an intact video that ffmpeg reads";

/// A video file.
#[derive(Debug)]
pub struct Clip {
    path: PathBuf,
    stream: Stream,
    /// Frames that ffmpeg does not read by itself.
    webp: Option<Webp>,
    /// Times at which frames are shown, in seconds from where the file begins and in order; empty where they are not found so.
    times: Vec<f64>,
    /// Frames, about where that is not known exactly.
    count: i64,
    decoder: Option<Decoder>,
}

/// A decoder and the number of the frame that it gives next.
#[derive(Debug)]
struct Decoder {
    process: Process,
    from: ChildStdout,
    next: i64,
}

impl Clip {
    /// Opens a file.
    ///
    /// # Errors
    /// [`Error::Input`] for files without pictures, [`Error::Failure`] where there is no ffmpeg.
    pub fn open(path: &Path) -> Result<Self> {
        if !path.is_file() {
            return Err(Error::file(path, "is no file", "name a video"));
        }
        let webp = is_moving_webp(path).then(|| Webp::open(path)).transpose()?;
        let stream = webp.as_ref().map_or_else(|| probe(path), |webp| Ok(webp.stream()))?;
        let times = if webp.is_none() { Packets::of(path, &stream)?.times() } else { Vec::new() };
        let count = if times.is_empty() { stream.frames.max(1) } else { times.len() as u64 };
        let count = i64::try_from(count).unwrap_or(i64::MAX);
        let is_timed = container(path).is_some_and(|kind| TIMED.contains(&kind) || kind == WEBM);
        let times = if is_timed { times } else { Vec::new() };
        Ok(Self { path: path.to_owned(), stream, webp, times, count, decoder: None })
    }

    /// Properties that it gives of itself.
    pub fn stream(&self) -> &Stream {
        &self.stream
    }

    /// Number of its last frame; about, where no container tells and the end was not reached yet.
    pub fn last(&self) -> i64 {
        self.count
    }

    /// Goes to a frame, so that [`Clip::take`] gives it or one a little before it.
    ///
    /// # Errors
    /// As [`Clip::open`].
    pub fn go_to(&mut self, number: i64) -> Result<()> {
        let next = self.decoder.as_ref().map(|decoder| decoder.next);
        let can_seek = !self.times.is_empty();
        let is_ahead = next.is_some_and(|next| next <= number && (number - next <= NEAR || !can_seek));
        if is_ahead {
            return Ok(());
        }
        self.decoder = None;
        let first = if can_seek { number.clamp(1, self.count) } else { 1 };
        // Whoever looks at a damaged video wants to see what there is.
        let origin = self.webp.as_ref().map_or(Origin::File(&self.path), |webp| Origin::Raw(webp.size()));
        let mut decoder = decode::decoder(origin, &self.stream, self.before(first), OnError::Skip);
        let mut process = at(Process::start(&mut decoder), &self.path, FIX)?;
        if let Some((webp, mut into)) = self.webp.clone().zip(process.child().stdin.take()) {
            // It ends with the file, or with the decoder.
            let relay = move || drop(webp.relay(&mut into));
            let started = Builder::new().name("frames".into()).spawn(relay);
            started.map_err(|e| Error::failure(format!("a thread cannot be started: {e}"), "try again"))?;
        }
        if let Some(from) = process.child().stdout.take() {
            self.decoder = Some(Decoder { process, from, next: first });
        }
        Ok(())
    }

    /// The next frame with its number; nothing at the end.
    ///
    /// # Errors
    /// [`Error::Input`] with what ffmpeg complains of.
    pub fn take(&mut self) -> Result<Option<(i64, Pixels)>> {
        let Some(decoder) = &mut self.decoder else { return Ok(None) };
        if let Some(pixels) = decode::frame(&self.stream, &mut decoder.from) {
            let number = decoder.next;
            decoder.next += 1;
            self.count = self.count.max(number);
            return Ok(Some((number, pixels)));
        }
        let end = decoder.next - 1;
        if let Some(decoder) = self.decoder.take() {
            at(decoder.process.end(), &self.path, FIX)?;
        }
        self.count = end.max(1);
        Ok(None)
    }

    /// A time between those of a frame and the one before it; nothing for the first.
    fn before(&self, number: i64) -> Option<f64> {
        let at = usize::try_from(number - 1).ok().filter(|at| *at > 0)?;
        Some((self.times.get(at - 1)? + self.times.get(at)?) / 2.0)
    }
}
