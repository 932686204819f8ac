//! A style on frames in main memory, computed by the library on the CPU: the faster way where a graphics driver computes
//! there itself.

use crate::apply::stages::stages;
use crate::stylize::style::Style;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::{ISOPHOTE_ERROR_CANCELLED, IsophoteRequest};
use isophote_loader::catalogue::Kind;
use isophote_loader::plan::Texture;
use isophote_loader::{AsImage, Control, Image, Input, Library, Sequence};
use isophote_pictures::exr::Guide;
use isophote_pictures::pixels::{Pixels, Precision};

/// A style with what the library keeps of frames.
#[derive(Debug)]
pub struct Processor {
    library: Library,
    style: Style,
    guides: Vec<Guide>,
    /// True where it takes a mask.
    takes_mask: bool,
    /// State that is kept of frames of one size, where they depend on each other.
    sequence: Option<((u32, u32), Sequence)>,
}

/// An image that belongs to someone else.
#[derive(Clone, Copy)]
struct Lent<'i>(Image<'i>);

impl AsImage for Lent<'_> {
    fn image(&self) -> Image<'_> {
        self.0
    }
}

impl Processor {
    /// A style on frames of one shot.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the library fails.
    pub fn new(library: &Library, style: Style) -> Result<Self> {
        let guides = style.usable_guides(library)?;
        let takes_mask = style.takes("mask")?;
        Ok(Self { library: library.clone(), style, guides, takes_mask, sequence: None })
    }

    /// The style.
    pub fn style(&self) -> &Style {
        &self.style
    }

    /// The style, to be computed in another way.
    pub fn style_mut(&mut self) -> &mut Style {
        &mut self.style
    }

    /// Guides that the style can use.
    pub fn guides(&self) -> &[Guide] {
        &self.guides
    }

    /// Frames before its own that a frame depends on.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the library fails.
    pub fn depth(&self) -> Result<usize> {
        let frames = self.library.frames(&self.style.graph);
        let [past, _] = frames.map_err(|e| e.at(&self.style.name, "choose another style"))?;
        Ok(past as usize)
    }

    /// Bytes that a frame of `request` takes at most while it is computed, with all guides, and those that are kept of frames.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] for sizes that the library refuses.
    pub fn memory(&self, request: &IsophoteRequest) -> Result<u64> {
        let (library, style) = (&self.library, &self.style);
        let bytes = || {
            let guides = library.guide_bits(self.guides.iter().map(|guide| guide.id()))?;
            let request = IsophoteRequest { guides, ..*request };
            let frames = library.frames(&style.graph)?;
            let plan = library.plan_frame(&style.graph, &request, frames[0])?;
            let textures: u64 = plan.textures()?.iter().map(Texture::bytes).sum();
            Ok(textures + stages(library, style, &request, frames)?)
        };
        bytes().map_err(|e: isophote_loader::Error| e.at(&style.name, "choose another picture or style"))
    }

    /// The frame of `request`, of which `image` gives the image of an input, and those of frames before where they are
    /// known: four numbers a pixel, or one of scalars. Nothing where it was cancelled.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Input`] when the style cannot be computed on these images.
    pub fn process<'i>(
        &mut self,
        request: &IsophoteRequest,
        image: &dyn Fn(&str, i64) -> Option<Image<'i>>,
        control: &mut Control<'_>,
    ) -> Result<Option<Pixels>> {
        self.style.at_frame(request.frame)?;
        let size = (request.width, request.height);
        let channels = if self.style.kind == Kind::Scalar { 1 } else { 4 };
        let mut target = Pixels::zeroed(size.0, size.1, channels, Precision::F32);
        match self.run(request, image, &mut target, control) {
            Ok(()) => Ok(Some(target)),
            Err(refused) if refused.status() == Some(ISOPHOTE_ERROR_CANCELLED) => Ok(None),
            Err(refused) => Err(refused.at(&self.style.name, "choose another picture or style")),
        }
    }

    fn run<'i>(
        &mut self,
        request: &IsophoteRequest,
        image: &dyn Fn(&str, i64) -> Option<Image<'i>>,
        target: &mut Pixels,
        control: &mut Control<'_>,
    ) -> isophote_loader::Result<()> {
        let (library, style) = (&self.library, &mut self.style);
        let reference_height = style.lengths.reference_height();
        let mask = self.takes_mask.then_some("mask");
        let names = self.guides.iter().map(|guide| guide.id()).chain(mask);
        let own = |name| image(name, request.frame).map(|image| (name, Lent(image)));
        let guides: Vec<(&str, Lent<'_>)> = names.filter_map(own).collect();
        let bits = library.guide_bits(guides.iter().map(|(name, _)| *name))?;
        let request = IsophoteRequest { reference_height, guides: bits, ..*request };
        let frames = library.frames(&style.graph)?;
        if frames == [0, 0] {
            let color = own("color");
            let inputs = color.iter().chain(&guides).map(|(name, pixels)| Input { name, pixels });
            let inputs: Vec<Input<'_>> = inputs.collect();
            style.graph.process(None, &request, &inputs, target, control)?;
            return Ok(());
        }
        let size = (request.width, request.height);
        if self.sequence.as_ref().is_none_or(|(of, _)| *of != size) {
            let memory = stages(library, style, &request, frames)?;
            self.sequence = Some((size, library.sequence(memory, 0.0)?));
        }
        let Some((_, sequence)) = &mut self.sequence else { return Ok(()) };
        // No renderer and no window knows what comes.
        let mut known = |name: &str, frame: i64| {
            let is_known = frame <= request.frame;
            is_known.then(|| image(name, frame)).flatten().map(Lent)
        };
        sequence.process(style.graph.handle(), None, &request, &mut known, target, control)?;
        Ok(())
    }
}
