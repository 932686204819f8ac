//! Maps that are painted over pictures: the control map, by which places are directed, and the mask, which says where the look is.

pub mod brush;
pub mod channel;
pub mod maps;
pub mod stroke;
pub mod tiles;

use std::path::PathBuf;
use std::sync::Arc;

use self::brush::Brush;
use self::channel::{Channel, Kind};
use self::maps::Maps;
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
    /// A number that grows with everything that is painted.
    pub revision: u64,
    /// Maps of files that are not open now, which are painted on when they are opened again.
    pub kept: Vec<(PathBuf, Arc<Maps>)>,
    /// Files that hold what was painted, with their maps as they were then.
    pub saved: Vec<(Kind, PathBuf, Arc<Maps>)>,
}

impl Default for Painting {
    fn default() -> Self {
        Self {
            is_on: false,
            brush: Brush::default(),
            is_shown: true,
            stroke: None,
            revision: 0,
            kept: Vec::new(),
            saved: Vec::new(),
        }
    }
}

impl Painting {
    /// The file that holds a map as it is painted now.
    pub fn file(&self, kind: Kind, maps: &Maps) -> Option<&PathBuf> {
        let is_same = |known: &Maps| {
            let mut channels = Channel::ALL.iter().filter(|channel| channel.kind() == kind);
            channels.all(|channel| known.layer(*channel) == maps.layer(*channel))
        };
        let (.., file, _) = self.saved.iter().find(|(of, _, known)| *of == kind && is_same(known))?;
        Some(file)
    }
}
