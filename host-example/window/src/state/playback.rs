//! A picture, sequence or video as it is looked at: which frame, and whether time passes.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use super::document::frame::Frame;
use super::document::{Frames, Info, reduce};
use isophote_files::error::Result;

/// Pixels of the small copy of a picture, which is shown while something moves where the processor draws.
const SMALL: f32 = 400_000.0;
/// Most pixels across and down; larger pictures are shown smaller.
const MOST: u32 = 8192;

/// Pictures that are shown.
#[derive(Debug)]
pub struct Playback {
    /// True while time passes.
    pub playing: bool,
    /// Frames per second.
    pub rate: f64,
    info: Arc<Info>,
    frames: Option<Frames>,
    number: i64,
    frame: Option<Arc<Frame>>,
    small: Option<Arc<Frame>>,
    /// Size of the picture in the file.
    size: (u32, u32),
    ticked: Instant,
}

impl Playback {
    /// The frames of a document, at the first, which is `whole`.
    pub fn new(info: &Arc<Info>, frames: Option<Frames>, whole: &Arc<Frame>) -> Self {
        let number = frames.as_ref().map_or(1, Frames::first);
        let size = (whole.width, whole.height);
        let too_large = whole.width.max(whole.height).div_ceil(MOST);
        let frame = if too_large > 1 { Arc::new(reduced(whole, too_large)) } else { Arc::clone(whole) };
        let factor = ((size.0 as f32 * size.1 as f32 / SMALL).sqrt().ceil() as u32).max(1);
        let small = (frames.is_none() && factor > 1).then(|| Arc::new(reduced(whole, factor)));
        Self {
            playing: false,
            rate: frames.as_ref().map_or(24.0, |frames| frames.rate),
            info: Arc::clone(info),
            frames,
            number,
            frame: Some(frame),
            small,
            size,
            ticked: Instant::now(),
        }
    }

    /// Properties of the document.
    pub fn info(&self) -> &Arc<Info> {
        &self.info
    }

    /// The frame that is shown, or a small copy of it where there is one, and its size over that of the file's.
    pub fn frame(&self, small: bool) -> Option<(&Arc<Frame>, f32)> {
        let frame = self.small.as_ref().filter(|_| small).or(self.frame.as_ref())?;
        Some((frame, frame.width as f32 / self.size.0 as f32))
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Number of the frame.
    pub fn number(&self) -> i64 {
        self.number
    }

    /// The frames; none of pictures.
    pub fn frames(&self) -> Option<&Frames> {
        self.frames.as_ref()
    }

    /// True where the frame that is wanted is not yet shown.
    pub fn is_waiting(&self) -> bool {
        self.frames().is_some()
            && self.frame.as_ref().and_then(|frame| frame.number).is_some_and(|shown| shown != self.number)
    }

    /// Starts or stops time.
    pub fn toggle_playing(&mut self) {
        self.playing = !self.playing && self.frames().is_some_and(|frames| frames.numbers.len() > 1);
        self.ticked = Instant::now();
    }

    /// Goes to a frame and stays there.
    pub fn seek(&mut self, number: i64) {
        self.playing = false;
        self.number = number;
    }

    /// Goes so many frames on.
    pub fn step(&mut self, by: i64) {
        let Some(Frames { numbers, .. }) = self.frames() else { return };
        let at = numbers.partition_point(|number| *number < self.number) as i64;
        let at = (at + by).rem_euclid(numbers.len().max(1) as i64);
        if let Some(number) = numbers.get(at as usize).copied() {
            self.seek(number);
        }
    }

    /// Lets time pass.
    pub fn advance(&mut self) {
        let is_due = self.ticked.elapsed().as_secs_f64() * self.rate >= 1.0;
        if self.playing && !self.is_waiting() && is_due {
            self.step(1);
            self.playing = true;
            self.ticked = Instant::now();
        }
    }

    /// Takes over which frames there are, and the one that is wanted when it has been read.
    ///
    /// # Errors
    /// The reason why the frame cannot be shown; the one before stays.
    pub fn take(&mut self, frames: Frames, frame: Option<Result<Arc<Frame>>>) -> Result<()> {
        self.frames = Some(frames);
        let Some(frame) = frame else { return Ok(()) };
        let frame = frame.inspect_err(|_| self.playing = false)?;
        let too_large = frame.width.max(frame.height).div_ceil(MOST);
        if too_large <= 1 {
            self.size = (frame.width, frame.height);
            self.frame = Some(frame);
        } else if self.is_waiting() {
            self.frame = Some(Arc::new(reduced(&frame, too_large)));
        }
        Ok(())
    }

    /// The file, or the pattern of the files.
    pub fn path(&self) -> &Path {
        &self.info.path
    }
}

/// A copy whose sides are shorter by a whole factor.
fn reduced(frame: &Frame, factor: u32) -> Frame {
    let size = ((frame.width / factor).max(1), (frame.height / factor).max(1));
    reduce::reduced(frame, size, reduce::whole(size))
}
