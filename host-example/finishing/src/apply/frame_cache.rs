//! Frames in memory: those that are filtered, and their neighbours as long as others depend on them.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::memory::Share;
use isophote_pictures::convert::Conversion;
use isophote_pictures::exr::{ExrFile, Guide, Picture};
use isophote_pictures::pixels::Pixels;
use isophote_pictures::read::Source;

/// A frame that was read.
#[derive(Debug)]
pub struct CachedFrame<'a> {
    /// Its number in a sequence.
    pub number: Option<i64>,
    /// Source that was read, without what is only written.
    pub source: Source,
    /// The other content of an EXR file, until the frame is written.
    exr: Mutex<Option<ExrFile>>,
    /// The pictures in their working space, where that is another.
    changed: Vec<OnceLock<(Pixels, u64)>>,
    /// Layers of colours of the pictures, likewise.
    layers: Vec<OnceLock<Vec<(&'static str, Pixels)>>>,
    /// Bytes that images may take while it is filtered on the CPU; 0 lets the library choose.
    pub bound: u64,
    /// Given back when the frame is needed no more.
    _share: Share<'a>,
}

impl<'a> CachedFrame<'a> {
    /// A frame that was read; `is_written` says whether its file is needed for a result.
    pub fn new(number: Option<i64>, mut source: Source, is_written: bool, share: Share<'a>) -> Self {
        let exr = source.exr.take().filter(|_| is_written);
        let changed = source.pictures.iter().map(|_| OnceLock::new()).collect();
        let layers = source.pictures.iter().map(|_| OnceLock::new()).collect();
        Self { number, source, exr: Mutex::new(exr), changed, layers, bound: 0, _share: share }
    }

    /// The same for a filter whose images take so many bytes.
    #[must_use]
    pub fn within(self, bound: u64) -> Self {
        Self { bound, ..self }
    }

    /// The file that the result goes into; once.
    pub fn take_exr(&self) -> Option<ExrFile> {
        self.exr.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// A picture in its working space, with the number of samples that were replaced on the way.
    pub fn working(&self, at: usize, change: Option<&Conversion>) -> Option<(&Pixels, u64)> {
        let picture = self.source.pictures.get(at)?;
        let Some(change) = change else { return Some((&picture.pixels, 0)) };
        let (pixels, replaced) = self.changed.get(at)?.get_or_init(|| change.apply(&picture.pixels));
        Some((pixels, *replaced))
    }

    /// A guide of a picture: layers of colours in its working space, data as it is.
    pub fn guide(&self, at: usize, name: &str, change: Option<&Conversion>) -> Option<&Pixels> {
        let named = |list: &'_ [(&'static str, Pixels)]| list.iter().position(|(known, _)| *known == name);
        let guides = &self.source.pictures.get(at)?.guides;
        if let Some(change) = change {
            let layers = self.layers.get(at)?.get_or_init(|| {
                let layers = guides.iter().filter(|(name, _)| is_colour(name));
                layers.map(|(name, pixels)| (*name, change.apply(pixels).0)).collect()
            });
            if let Some(found) = named(layers) {
                return Some(&layers[found].1);
            }
        }
        named(guides).map(|found| &guides[found].1)
    }
}

/// True for a guide whose numbers are colours.
fn is_colour(name: &str) -> bool {
    Guide::ALL.into_iter().any(|guide| guide.id() == name && guide.is_colour())
}

/// The frames that a frame depends on and that there are, with itself.
#[derive(Clone, Debug)]
pub struct Window<'a> {
    /// The frame itself.
    pub own: Arc<CachedFrame<'a>>,
    /// It and its neighbours, in any order.
    pub frames: Vec<Arc<CachedFrame<'a>>>,
}

impl Window<'_> {
    /// Image for an input of picture `at` in a frame, if that is like the frame itself; `change` leads to the working
    /// space.
    pub fn image(&self, at: usize, input: &str, frame: i64, change: Option<&Conversion>) -> Option<&Pixels> {
        let (cached, _) = self.alike(at, frame)?;
        match input {
            "color" => cached.working(at, change).map(|(pixels, _)| pixels),
            _ => cached.guide(at, input, change),
        }
    }

    /// A mask of picture `at` in a frame, if that is like the frame itself.
    pub fn mask(&self, at: usize, mask: usize, frame: i64) -> Option<&Pixels> {
        self.alike(at, frame)?.1.masks.get(mask)?.as_ref()
    }

    /// Picture `at` in a frame, if that is like the frame itself.
    fn alike(&self, at: usize, frame: i64) -> Option<(&CachedFrame<'_>, &Picture)> {
        let cached = self.frames.iter().find(|cached| cached.number.unwrap_or_default() == frame)?;
        let (own, other): (&Picture, &Picture) =
            (self.own.source.pictures.get(at)?, cached.source.pictures.get(at)?);
        let size = |picture: &Picture| (picture.pixels.width(), picture.pixels.height());
        let is_alike = size(own) == size(other) && own.meaning.state == other.meaning.state;
        is_alike.then_some((cached, other))
    }
}
