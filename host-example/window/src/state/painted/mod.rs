//! Maps that are painted over pictures: the control map, by which places are directed, and the mask, which says where the look is.

pub mod brush;
pub mod channel;
pub mod key_frames;
pub mod maps;
pub mod stroke;
pub mod tiles;

use std::path::PathBuf;
use std::sync::Arc;

use self::brush::Brush;
use self::channel::Kind;
use self::key_frames::KeyFrames;
use self::stroke::Stroke;

/// Painting as it is done in the window.
#[derive(Debug)]
pub struct Painting {
    /// True where the pointer paints.
    pub is_on: bool,
    /// The brush.
    pub brush: Brush,
    /// True where what is painted is shown over the picture.
    pub is_shown: bool,
    /// The stroke that is being painted.
    pub stroke: Option<Stroke>,
    /// Frame that it is painted on.
    pub frame: i64,
    /// A number that grows with everything that is painted.
    pub revision: u64,
    /// Maps of files that are not open now, which are painted on when they are opened again.
    pub kept: Vec<(PathBuf, Arc<KeyFrames>)>,
    /// Files that hold what was painted, with their maps as they were then.
    pub saved: Vec<(Kind, PathBuf, Arc<KeyFrames>)>,
}

impl Default for Painting {
    fn default() -> Self {
        Self {
            is_on: false,
            brush: Brush::default(),
            is_shown: true,
            stroke: None,
            frame: 0,
            revision: 0,
            kept: Vec::new(),
            saved: Vec::new(),
        }
    }
}

impl Painting {
    /// The file that holds a map as it is painted now.
    pub fn file(&self, kind: Kind, keys: &KeyFrames) -> Option<&PathBuf> {
        let is_file =
            |(of, _, known): &&(Kind, PathBuf, Arc<KeyFrames>)| *of == kind && known.has_same(kind, keys);
        let (_, file, _) = self.saved.iter().find(is_file)?;
        Some(file)
    }
}
