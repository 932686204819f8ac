//! What frames need, told before they are decoded.

use std::path::Path;

use super::filter::{Layer, MaskedStyle, at_frame, frames, layers};
use super::memory::Needs;
use super::painted::is_made_by_hand;
use super::square;
use super::stages::stages;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::plan::Texture;
use isophote_loader::{Graph, Library};
use isophote_pictures::exr::Guide;
use isophote_pictures::read::{Opened, Source};

/// Bytes a pixel of what is mixed with what, as floats, and of the result.
const MIXED: u64 = 3 * 16;

/// Tells what frames need before they are decoded, on another thread than the filter's.
#[derive(Debug)]
pub struct Planner {
    library: Library,
    layers: Vec<Layer>,
    guides: Vec<Guide>,
    /// Maps and materials of the frames.
    painted: Vec<Guide>,
    /// Bytes that a frame may take.
    most: u64,
    /// True where a graphics device filters.
    is_on_card: bool,
    /// True where nothing asks for other samples in results than pictures have.
    keeps_samples: bool,
    /// Memory that filtering a picture takes, as was found last.
    last: Option<(Filtered, u64)>,
}

/// What the memory of a filter depends on beside its looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Filtered {
    size: (u32, u32),
    /// True for files that may have guides.
    has_layers: bool,
    /// Bytes that images should take at most.
    bound: u64,
}

impl Planner {
    /// Of looks of its own, which are the same as the filter's.
    ///
    /// # Errors
    /// As [`Filter::new`](super::filter::Filter::new).
    pub fn new(library: Library, looks: Vec<MaskedStyle>) -> Result<Self> {
        let mut guides = Vec::new();
        for look in &looks {
            guides.extend(look.style.usable_guides(&library)?);
        }
        Ok(Self {
            library,
            layers: layers(looks)?,
            guides,
            painted: Vec::new(),
            most: u64::MAX,
            is_on_card: false,
            keeps_samples: false,
            last: None,
        })
    }

    /// For frames that may take so many bytes. Those that would take more on the CPU are filtered by rows.
    #[must_use]
    pub fn within(self, most: u64) -> Self {
        Self { most, ..self }
    }

    /// For filters on a graphics device, or on the CPU.
    #[must_use]
    pub fn on_card(self, is_on_card: bool) -> Self {
        Self { is_on_card, ..self }
    }

    /// For results whose samples are those of the pictures, unless their colours have to be changed for the library.
    #[must_use]
    pub fn keeping_samples(self, keeps_samples: bool) -> Self {
        Self { keeps_samples, ..self }
    }

    /// Counts the painted maps and the materials that each frame has.
    pub fn with_painted(self, painted: Vec<Guide>) -> Self {
        Self { painted, ..self }
    }

    /// Guides that the styles can use.
    pub fn guides(&self) -> &[Guide] {
        &self.guides
    }

    /// Bytes that filtering a picture takes at most, besides the picture and its result. On the CPU that is no more than its
    /// bound, where it can be less.
    fn filter_memory(&mut self, name: &str, frame: Option<i64>, filtered: Filtered) -> Result<u64> {
        let is_animated = frame.map_or(Ok(false), |frame| at_frame(&self.layers, frame))?;
        if let Some((_, bytes)) = self.last.filter(|(last, _)| *last == filtered && !is_animated) {
            return Ok(bytes);
        }
        let Filtered { size, has_layers, bound } = filtered;
        let refused = |e: isophote_loader::Error| e.at(name, "choose another picture or style");
        let pixels = u64::from(size.0) * u64::from(size.1);
        let is_counted =
            |guide: &&Guide| self.painted.contains(guide) || has_layers && !is_made_by_hand(**guide);
        let guides = self.guides.iter().filter(is_counted).map(|guide| guide.id());
        // One look is made at a time; what it keeps of frames stays.
        let (mut kept, mut most) = (0, 0);
        for layer in &self.layers {
            let style = &layer.look.style;
            let mut request = style.request(&self.library, size).map_err(refused)?;
            let all = guides.clone().chain(layer.guide());
            request.guides = self.library.guide_bits(all).map_err(refused)?;
            let frames = self.library.frames(&style.graph).map_err(refused)?;
            let images = if self.is_on_card || frames != [0, 0] {
                let plan = self.library.plan_frame(&style.graph, &request, frames[0]).map_err(refused)?;
                plan.textures().map_err(refused)?.iter().map(Texture::bytes).sum()
            } else {
                images(&style.graph, &request, bound).map_err(refused)?
            };
            let mixed = if layer.is_mixed() || self.layers.len() > 1 { pixels * MIXED } else { 0 };
            most = most.max(images + mixed);
            kept += stages(&self.library, style, &request, frames).map_err(refused)?;
        }
        let bytes = most + kept;
        self.last = Some((filtered, bytes));
        Ok(bytes)
    }

    /// Frames before and after `frame` that it depends on.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) when an animated parameter cannot have its value.
    pub fn frames(&self, frame: Option<i64>) -> Result<[i64; 2]> {
        let Some(frame) = frame else { return Ok([0, 0]) };
        at_frame(&self.layers, frame)?;
        frames(&self.library, &self.layers)
    }

    /// Number of frames that are held while `frame` is done: it and all that it depends on.
    ///
    /// # Errors
    /// As [`Planner::frames`].
    pub fn span(&self, frame: Option<i64>) -> Result<u64> {
        let [past, future] = self.frames(frame)?;
        Ok((past + future + 1) as u64)
    }

    /// Needs of the frame `file`; nothing when it will be refused, which is reported when its turn comes.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) for sizes and graphs that the library refuses.
    pub fn needs(&mut self, file: &Path, frame: Option<i64>, opened: &Opened) -> Result<Option<Needs>> {
        let Some(own) = opened.size() else { return Ok(None) };
        let name = file.display().to_string();
        let size = square::size(&self.library, &name, own, opened.pixel_aspect())?;
        // Each as it is read, as it is kept and as one of all frames.
        let of_look = |look: &MaskedStyle| look.style.objects.len() + usize::from(look.mask.is_some());
        let masks: usize = self.layers.iter().map(|layer| of_look(&layer.look)).sum();
        let masks = masks as u64 + 4 * self.painted.len() as u64;
        let maps = u64::from(size.0) * u64::from(size.1) * 4 * 3 * masks;
        let area = |(width, height): (u32, u32)| u64::from(width) * u64::from(height);
        // Both are there while one is made of the other.
        let weight = opened.weight(self.keeps_samples && self.layers.len() == 1);
        let grown = if size == own { 0 } else { weight.saturating_mul(area(size) / area(own).max(1)) };
        let frame_weight = weight.saturating_add(maps).saturating_add(grown);
        let bound = self.most.saturating_sub(frame_weight);
        let filtered = Filtered { size, has_layers: opened.has_layers(), bound };
        let filter = self.filter_memory(&name, frame, filtered)?;
        Ok(Some(Needs { frame: frame_weight, filter }))
    }

    /// Makes the pixels of a frame square, where they are not.
    ///
    /// # Errors
    /// As [`square::make`].
    pub fn square(&self, name: &str, source: &mut Source) -> Result<()> {
        let is_square = source.pictures.iter().all(|picture| picture.meaning.pixel_aspect == 1.0);
        if is_square { Ok(()) } else { square::make(&self.library, name, source) }
    }
}

/// Bytes of the images of a graph on the CPU, whole where that is within `bound`, for rows of them take longer.
fn images(graph: &Graph, request: &IsophoteRequest, bound: u64) -> isophote_loader::Result<u64> {
    // No bytes at all would leave it to the library.
    graph.set_memory(bound.max(1))?;
    graph.memory(request)
}
