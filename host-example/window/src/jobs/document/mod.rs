//! The document that the window shows: a scene, a picture, a sequence or a video, opened as `apply` opens it.
//!
//! Pictures come as [`Frame`]s, which hold what `apply` would hand to the library. Nothing is read on the thread of the
//! window: a document is opened by [`Document::begin`], and frames are read by a thread of its own, a little before they are
//! shown, within a bound of memory. A frame that cannot be read is an error of that frame alone.

pub mod loading;
mod player;
mod reader;
mod store;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::loading::Loading;
use self::player::Player;
use self::reader::{FrameReader, Reading};
use self::store::Store;
use crate::state::document::frame::Frame;
use crate::state::document::kind::Kind;
use crate::state::document::{Frames, Info};
use crate::state::playback::Playback;
use isophote_files::error::{Error, Result};
use isophote_files::frames::Pattern;
use isophote_finishing::apply::materials::Laid;
use isophote_finishing::apply::memory;
use isophote_finishing::video::Clip;
use isophote_pictures::exr::{Guide, Offers, Selection};
use isophote_pictures::material::MaterialKind;
use isophote_pictures::read;
use isophote_pictures::space::Space;

/// Frames of a sequence that are opened to find out what can be chosen, where the first cannot be read.
const ATTEMPTS: usize = 8;

/// Frames per second of sequences, which do not tell.
const RATE: f64 = 24.0;

/// Options by which a document is opened.
#[derive(Clone, Debug)]
pub struct Options {
    /// Selection within EXR files; guides that styles may want are all looked for.
    pub selection: Selection,
    /// Space of the numbers, where it is not the file that says so.
    pub space: Option<Space>,
    /// Paper and hatching that lie on the pictures, by their names or files.
    pub materials: Vec<(MaterialKind, PathBuf)>,
    /// True where a picture that is one of several numbered ones stands for all of them.
    pub as_sequence: bool,
    /// Most bytes of frames in memory.
    pub cache: u64,
}

impl Default for Options {
    fn default() -> Self {
        // The window's own pictures and the device need memory as well.
        let cache = memory::kept().0;
        Self {
            selection: Selection::default(),
            space: None,
            materials: Vec::new(),
            as_sequence: false,
            cache,
        }
    }
}

/// An open document.
#[derive(Debug)]
pub struct Document {
    info: Arc<Info>,
    content: Content,
}

#[derive(Debug)]
enum Content {
    /// A scene, which is loaded elsewhere.
    None,
    Still(Arc<Frame>),
    Moving {
        player: Player,
        rate: f64,
    },
}

impl Document {
    /// Opens a document on another thread.
    pub fn begin(path: PathBuf, options: Options) -> Loading<Self> {
        Loading::start(move || Self::open(&path, &options))
    }

    /// Opens a document: reads a picture, looks for the frames of a sequence, asks a video what it is. Of a scene nothing is
    /// read.
    ///
    /// # Errors
    /// [`Error::Input`] for what is missing, damaged or no document, [`Error::Failure`] when memory is short or ffmpeg is
    /// missing.
    pub fn open(path: &Path, options: &Options) -> Result<Self> {
        let (kind, path) = Kind::of(path, options.as_sequence)?;
        let selection = Selection { wanted: Guide::ALL.to_vec(), ..options.selection.clone() };
        let laid = |(kind, name): &(MaterialKind, PathBuf)| Ok(Laid::new(kind.open(name)?, options.space));
        let materials = options.materials.iter().map(laid).collect::<Result<_>>()?;
        let reading = Reading { selection, space: options.space, materials };
        let (offers, content) = match kind {
            Kind::Scene => (Offers::default(), Content::None),
            Kind::Picture => {
                let opened = read::open(&path, &reading.selection)?;
                let offers = opened.offers();
                let frame = reader::decoded(&path, None, opened, &reading)?;
                (offers, Content::Still(Arc::new(frame)))
            }
            Kind::Sequence => sequence(&path, reading, options.cache)?,
            Kind::Video => video(&path, reading, options.cache)?,
        };
        let (selection, materials) = (options.selection.clone(), options.materials.clone());
        let info = Arc::new(Info { kind, path, offers, selection, materials });
        Ok(Self { info, content })
    }

    /// Its properties.
    pub fn info(&self) -> &Arc<Info> {
        &self.info
    }

    /// Kind of the document.
    pub fn kind(&self) -> Kind {
        self.info.kind
    }

    /// Its file, or the pattern of its files, as `apply` and `render` take it.
    pub fn path(&self) -> &Path {
        &self.info.path
    }

    /// The frames; none of scenes and pictures.
    pub fn frames(&self) -> Option<Frames> {
        let Content::Moving { player, rate } = &self.content else { return None };
        let (numbers, cached) = player.numbers();
        Some(Frames { numbers, cached, rate: *rate })
    }

    /// A frame, or why there is none; nothing while it is being read. A picture is the same whatever the number; frames are
    /// read ahead from the one that was asked for last.
    pub fn frame(&self, number: i64) -> Option<Result<Arc<Frame>>> {
        match &self.content {
            Content::None => Some(Err(self.no_frames())),
            Content::Still(frame) => Some(Ok(Arc::clone(frame))),
            Content::Moving { player, .. } => player.frame(number),
        }
    }

    /// As [`Document::frame`], but waits for it.
    ///
    /// # Errors
    /// The reason why there is none.
    pub fn wait(&self, number: i64) -> Result<Arc<Frame>> {
        match &self.content {
            Content::None => Err(self.no_frames()),
            Content::Still(frame) => Ok(Arc::clone(frame)),
            Content::Moving { player, .. } => player.wait(number),
        }
    }

    /// Sets the direction in which frames will be asked for: 1 forward, -1 backward, 0 not at all. They go round.
    pub fn play(&self, direction: i64) {
        if let Content::Moving { player, .. } = &self.content {
            player.play(direction);
        }
    }

    /// The frames as they are looked at, at the first, for which it waits; not for the window's thread.
    ///
    /// # Errors
    /// The reason why it cannot be shown.
    pub fn playback(&self) -> Result<Playback> {
        let frames = self.frames();
        let first = self.wait(frames.as_ref().map_or(1, Frames::first))?;
        Ok(Playback::new(&self.info, frames, &first))
    }

    fn no_frames(&self) -> Error {
        Error::file(self.path(), "is a scene and has no pictures", "render it")
    }
}

/// A numbered sequence.
fn sequence(path: &Path, reading: Reading, cache: u64) -> Result<(Offers, Content)> {
    let Some(pattern) = Pattern::new(path)? else {
        return Err(Error::file(path, "has no place for a frame number", "write shot.####.exr"));
    };
    let numbers = pattern.on_disk()?;
    let mut offers = numbers.iter().take(ATTEMPTS).map(|number| {
        let opened = read::open(&pattern.file(*number), &reading.selection)?;
        Ok::<_, Error>(opened.offers())
    });
    let first = offers.next().unwrap_or_else(|| Ok(Offers::default()));
    // One bad frame is no bad sequence.
    let offers = first.or_else(|error| offers.find_map(Result::ok).ok_or(error))?;
    let player = Player::start(FrameReader::Files(pattern, reading), Store::new(cache, numbers.into()))?;
    Ok((offers, Content::Moving { player, rate: RATE }))
}

/// A video.
fn video(path: &Path, reading: Reading, cache: u64) -> Result<(Offers, Content)> {
    if let Some(option) = reading.selection.option() {
        return Err(Error::input(option, format!("'{}' is no EXR file", path.display()), "leave it out"));
    }
    let clip = Clip::open(path)?;
    let (rate, last) = (clip.stream().frames_per_second(), clip.last());
    let store = Store::new(cache, (1..=last).collect());
    let source = FrameReader::Video(path.to_owned(), Box::new(clip), reading);
    let player = Player::start(source, store)?;
    Ok((Offers::default(), Content::Moving { player, rate }))
}
