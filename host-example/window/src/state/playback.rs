//! A picture, sequence or video as it is looked at: which frame, and whether time passes.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use super::document::frame::{Frame, GuideImage};
use super::document::kind::Kind;
use super::document::{Frames, Info, reduce};
use super::painted::key_frames::KeyFrames;
use super::painted::maps::Maps;
use super::things::Things;
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
    frame: Option<Shown>,
    small: Option<Shown>,
    /// What is painted over the pictures.
    keys: Option<Arc<KeyFrames>>,
    /// The map of the frame that was shown last, as frames of its size have it.
    laid: Option<Laid>,
    /// Size of the picture in the file.
    size: (u32, u32),
    ticked: Instant,
}

/// A frame as it was read, and with what is painted over it.
#[derive(Debug)]
struct Shown {
    read: Arc<Frame>,
    painted: Arc<Frame>,
}

/// Everything that is painted over a document, as files of its frames have it.
#[derive(Clone, Debug)]
pub struct PaintedOver {
    /// The maps.
    pub keys: Arc<KeyFrames>,
    /// Size of the picture in the file.
    pub size: (u32, u32),
    /// Numbers of the frames, in order; one of pictures.
    pub numbers: Arc<[i64]>,
}

/// Maps in the size of frames.
#[derive(Clone, Debug)]
struct Laid {
    maps: Arc<Maps>,
    size: (u32, u32),
    control: Option<Arc<GuideImage>>,
    mask: Option<Arc<Vec<f32>>>,
}

impl Shown {
    fn plain(read: Arc<Frame>) -> Self {
        Self { painted: Arc::clone(&read), read }
    }
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
            frame: Some(Shown::plain(frame)),
            small: small.map(Shown::plain),
            keys: None,
            laid: None,
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
        let Shown { painted, .. } = self.small.as_ref().filter(|_| small).or(self.frame.as_ref())?;
        Some((painted, painted.width as f32 / self.size.0 as f32))
    }

    /// The frame that is shown as it was read, without what is painted over it.
    pub fn read(&self) -> Option<&Arc<Frame>> {
        self.frame.as_ref().map(|shown| &shown.read)
    }

    /// Maps of all frames that were painted on.
    pub fn keys(&self) -> Option<&Arc<KeyFrames>> {
        self.keys.as_ref()
    }

    /// The map that lies on the frame that is shown.
    pub fn maps(&self) -> Option<&Arc<Maps>> {
        self.keys.as_ref()?.seen(self.key())
    }

    /// Number of the frame that is painted on: the one that is shown of a sequence. Pictures and videos are painted on as a whole.
    pub fn key(&self) -> i64 {
        self.key_of(self.read().and_then(|frame| frame.number))
    }

    fn key_of(&self, shown: Option<i64>) -> i64 {
        let first = self.frames.as_ref().map_or(1, Frames::first);
        shown.filter(|_| self.has_key_frames()).unwrap_or(first)
    }

    /// True where each frame may have a map of its own.
    pub fn has_key_frames(&self) -> bool {
        self.info.kind == Kind::Sequence && self.frames.is_some()
    }

    /// Everything that is painted over the document, for files.
    pub fn painted(&self) -> Option<PaintedOver> {
        let numbers = self
            .frames
            .as_ref()
            .map_or_else(|| Arc::from([self.key()]), |frames| Arc::clone(&frames.numbers));
        Some(PaintedOver { keys: self.keys.clone()?, size: self.file_size(), numbers })
    }

    /// Paints these over the pictures from now on.
    pub fn paint(&mut self, keys: Option<Arc<KeyFrames>>) {
        (self.keys, self.laid) = (keys, None);
        let (small, frame) = (self.small.take(), self.frame.take());
        self.small = small.map(|shown| self.lay(shown.read));
        // After it, so that what has the frame's size is kept for the next one.
        self.frame = frame.map(|shown| self.lay(shown.read));
    }

    /// A frame with what is painted over it.
    fn lay(&mut self, read: Arc<Frame>) -> Shown {
        let seen = self.keys.as_ref().and_then(|keys| keys.seen(self.key_of(read.number)));
        let Some(maps) = seen else { return Shown::plain(read) };
        let size = (read.width, read.height);
        let known = self.laid.take().filter(|laid| laid.size == size && Arc::ptr_eq(&laid.maps, maps));
        let laid = known.unwrap_or_else(|| Laid {
            maps: Arc::clone(maps),
            size,
            control: maps.control(size).map(Arc::new),
            mask: maps.mask(size).map(Arc::new),
        });
        let Laid { control, mask, .. } = self.laid.insert(laid).clone();
        match (control, mask) {
            (None, None) => Shown::plain(read),
            (control, mask) => Shown { painted: Arc::new(read.painted(control, mask)), read },
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Pixels across and down of the picture in its file, whose pixels need not be square.
    pub fn file_size(&self) -> (u32, u32) {
        self.read().map_or(self.size, |read| read.file_size)
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
            && self.read().and_then(|frame| frame.number).is_some_and(|shown| shown != self.number)
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
            if self.read().is_none_or(|read| !Arc::ptr_eq(read, &frame)) {
                self.frame = Some(self.lay(frame));
            }
        } else if self.is_waiting() {
            self.frame = Some(self.lay(Arc::new(reduced(&frame, too_large))));
        }
        Ok(())
    }

    /// Things in the frame that is shown, where its file says what they cover.
    pub fn things(&self) -> Option<Things> {
        let number = self.read().and_then(|frame| frame.number);
        self.info.has_things().then(|| Things::File { info: Arc::clone(&self.info), number })
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
