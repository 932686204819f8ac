//! Readers of a document's frames: numbered files, or a video.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::state::document::frame::Frame;
use isophote_files::error::{Error, Result};
use isophote_files::frames::Pattern;
use isophote_files::limits;
use isophote_finishing::apply::materials::Laid;
use isophote_finishing::apply::square;
use isophote_finishing::video::Clip;
use isophote_loader::Library;
use isophote_pictures::exr::Selection;
use isophote_pictures::read::{self, Opened, Source};
use isophote_pictures::space::Space;

/// Frames before the one that is wanted that are decoded with it where a video plays backward.
const CHUNK: i64 = 16;

/// Options for reading files.
#[derive(Clone, Debug, Default)]
pub struct Reading {
    /// Selection within EXR files; every guide where `wanted` has all.
    pub selection: Selection,
    /// Space of the numbers, where it is not the file that says so.
    pub space: Option<Space>,
    /// Paper and hatching that lie on them.
    pub materials: Arc<[Laid]>,
}

/// Reader of frames by their numbers.
#[derive(Debug)]
pub enum FrameReader {
    /// A file for each.
    Files(Pattern, Reading),
    /// All in one file.
    Video(PathBuf, Box<Clip>, Reading),
}

/// Receiver of frames that were read.
pub trait Sink {
    /// True where a frame is worth being made.
    fn wants(&self, number: i64) -> bool;
    /// Takes a frame, or why there is none.
    fn put(&self, number: i64, frame: Result<Frame>);
    /// True where none of these frames is what is to be read next.
    fn is_elsewhere(&self, frames: RangeInclusive<i64>) -> bool;
}

impl FrameReader {
    /// Reads a frame, and those of a video that lie on the way.
    pub fn read(&mut self, number: i64, direction: i64, sink: &impl Sink) {
        match self {
            Self::Files(pattern, reading) => {
                sink.put(number, file(&pattern.file(number), number, reading));
            }
            Self::Video(path, clip, reading) => {
                let first = if direction < 0 { (number - CHUNK + 1).max(1) } else { number };
                if let Err(error) = decode(path, clip, (first, number), reading, sink) {
                    sink.put(number, Err(error));
                }
            }
        }
    }

    /// Number of the last frame, where reading may have shown that it is another.
    pub fn last(&self) -> Option<i64> {
        match self {
            Self::Files(..) => None,
            Self::Video(_, clip, _) => Some(clip.last()),
        }
    }
}

/// Reads the file of a frame.
fn file(path: &Path, number: i64, reading: &Reading) -> Result<Frame> {
    decoded(path, Some(number), read::open(path, &reading.selection)?, reading)
}

/// Decodes a file that was opened.
///
/// # Errors
/// As [`Opened::decode`]; [`Error::Failure`] when memory is short.
pub fn decoded(path: &Path, number: Option<i64>, opened: Opened, reading: &Reading) -> Result<Frame> {
    let name = path.display().to_string();
    limits::must_have(opened.weight(false), &name)?;
    let mut source = opened.decode(path)?;
    // Nothing is written back.
    source.exr = None;
    shown(&name, source, number, reading)
}

/// The frame that is shown: of square pixels, which are those that looks are made of.
fn shown(name: &str, mut source: Source, number: Option<i64>, reading: &Reading) -> Result<Frame> {
    source.pictures.truncate(1);
    let laid = |material: &Laid| source.pictures.iter_mut().for_each(|picture| material.lay(picture));
    reading.materials.iter().for_each(laid);
    if !square::is_square(&source) {
        square::make(&Library::open()?, name, &mut source)?;
    }
    Frame::of(name, source, number, reading.space)
}

/// Decodes frames from the first up to the second number, and those that lie before.
fn decode(
    path: &Path,
    clip: &mut Clip,
    (first, number): (i64, i64),
    reading: &Reading,
    sink: &impl Sink,
) -> Result<()> {
    let name = path.display().to_string();
    clip.go_to(first)?;
    while let Some((at, pixels)) = clip.take()? {
        if sink.wants(at) {
            let source = Source::alone(pixels, clip.stream().meaning());
            sink.put(at, shown(&name, source, Some(at), reading));
        }
        if at >= number || sink.is_elsewhere(at + 1..=number) {
            return Ok(());
        }
    }
    let last = clip.last();
    Err(Error::file(
        path,
        format!("ends with frame {last} and has no frame {number}"),
        "choose another frame",
    ))
}
