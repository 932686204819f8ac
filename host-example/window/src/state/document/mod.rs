//! Documents that the window shows, as far as they are known without reading on: their kinds, choices and frames.

pub mod frame;
pub mod kind;
pub mod reduce;

use std::path::PathBuf;
use std::sync::Arc;

use self::kind::Kind;
use isophote_files::frames::{self, Pattern};
use isophote_pictures::exr::{Guide, Offers, Selection};
use isophote_pictures::material::MaterialKind;

/// Properties of an open document, which stay while it is open.
#[derive(Debug)]
pub struct Info {
    /// Its kind.
    pub kind: Kind,
    /// Its file, or the pattern of its files, as `apply` and `render` take it.
    pub path: PathBuf,
    /// Choices that an EXR file offers, and those made.
    pub offers: Offers,
    /// Selection that was asked for of an EXR file.
    pub selection: Selection,
    /// Paper and hatching that lie on it, by their names or files.
    pub materials: Vec<(MaterialKind, PathBuf)>,
}

impl Info {
    /// True where its files say what things cover of their pixels.
    pub fn has_things(&self) -> bool {
        let is_ids = |(guide, _): &(Guide, Vec<String>)| *guide == Guide::ObjectId;
        self.offers.has_mattes || self.offers.guides.iter().any(is_ids)
    }

    /// The file of a picture, or of the frame of a number.
    pub fn file_of(&self, number: Option<i64>) -> Option<PathBuf> {
        match self.kind {
            Kind::Picture => Some(self.path.clone()),
            Kind::Sequence => Some(Pattern::new(&self.path).ok()??.file(number?)),
            Kind::Scene | Kind::Video => None,
        }
    }

    /// The pattern of the sequence that a picture seems to be a frame of.
    pub fn sequence(&self) -> Option<PathBuf> {
        (self.kind == Kind::Picture).then(|| frames::sequence_of(&self.path)).flatten()
    }
}

/// The frames of a sequence or a video.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    /// Their numbers, in order; at least one. Those of a video are a guess where its container does not tell.
    pub numbers: Arc<[i64]>,
    /// Numbers of those that are in memory.
    pub cached: Vec<i64>,
    /// Frames per second.
    pub rate: f64,
}

impl Frames {
    /// Number of the first.
    pub fn first(&self) -> i64 {
        self.numbers.first().copied().unwrap_or(1)
    }

    /// Number of the last.
    pub fn last(&self) -> i64 {
        self.numbers.last().copied().unwrap_or(1)
    }
}
