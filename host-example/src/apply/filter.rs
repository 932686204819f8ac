//! What is done to every frame: the graph on each of its pictures.

use std::path::Path;

use super::backend::Backend;
use super::convert;
use super::exr::{Guide, Picture};
use super::memory::Needs;
use super::primaries::{AP1, Change, REC709, same};
use super::read::{ImageState, Opened, Source};
use super::space::Space;
use super::write::Format;
use crate::error::Result;
use crate::loader::catalogue::Kind;
use crate::loader::contract::{
    ISOPHOTE_ALPHA_PREMULTIPLIED, ISOPHOTE_ALPHA_STRAIGHT, ISOPHOTE_GUIDE_DEPTH, ISOPHOTE_GUIDE_NORMAL,
    ISOPHOTE_GUIDE_OBJECT_ID, ISOPHOTE_SPACE_ACESCG, ISOPHOTE_SPACE_LINEAR, ISOPHOTE_SPACE_SRGB,
    IsophoteRequest,
};
use crate::loader::plan::Texture;
use crate::loader::{Control, Device, Input, Library};
use crate::pixels::{Pixels, Precision};
use crate::stylize::style::Style;

/// A style with what it runs on.
#[derive(Debug)]
pub struct Filter {
    library: Library,
    style: Style,
    device: Option<Device>,
    space: Option<Space>,
    threads: u32,
}

/// Farthest from 0 that a picture may begin, pixels, as the contract has it.
const MOST_ORIGIN: i32 = 1_000_000;

/// Results of one frame.
#[derive(Debug)]
pub struct Filtered {
    /// One for each picture that is written.
    pub results: Vec<Pixels>,
    /// Samples that were NaN or infinite and were replaced.
    pub replaced: u64,
}

/// Tells what frames need before they are decoded, on another thread than the filter's.
#[derive(Debug)]
pub struct Planner {
    library: Library,
    style: Style,
    guides: Vec<Guide>,
    /// What filtering a picture of this size takes, as was found last.
    last: Option<((u32, u32), u64)>,
}

impl Filter {
    /// A style on the device that `backend` asks for.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when there is no such device.
    pub fn new(
        library: Library,
        style: Style,
        backend: Backend,
        space: Option<Space>,
        threads: u32,
    ) -> Result<Self> {
        let device = backend.device(&library)?;
        Ok(Self { library, style, device, space, threads })
    }

    /// Filters all pictures of `source`, or the first where `format` holds one.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] for pictures that the library refuses,
    /// [`crate::error::Error::Failure`] when it or the device fails.
    pub fn run(
        &mut self,
        name: &str,
        frame: Option<i64>,
        source: &Source,
        format: Format,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Filtered> {
        if let Some(frame) = frame {
            self.style.at_frame(frame)?;
        }
        let in_place = source.exr.as_ref().filter(|_| format == Format::Exr);
        let pictures = if in_place.is_some() {
            source.pictures.as_slice()
        } else {
            source.pictures.get(..1).unwrap_or_default()
        };
        let to = format.state(source.state);
        let scalar = self.style.kind != Kind::Color;
        let mut filtered = Filtered { results: Vec::with_capacity(pictures.len()), replaced: 0 };
        for (at, picture) in pictures.iter().enumerate() {
            let channels = match in_place {
                Some(exr) => exr.result_channels(at, scalar),
                None if scalar => 1,
                None => picture.pixels.channels().max(3),
            };
            let working = WorkingSpace::of(self.space, source.state, picture);
            let there = working.change.map(|(there, _)| convert::changed(&picture.pixels, &there));
            let (color, bad) = there.as_ref().map_or((&picture.pixels, 0), |(pixels, bad)| (pixels, *bad));
            filtered.replaced += bad;
            let precision = if to == source.state { color.precision() } else { Precision::F32 };
            let mut result = Pixels::zeroed(color.width(), color.height(), channels, precision);
            let mut request = self.request(name, color, source.state, working.space)?;
            // Windows farther out than marks can be told apart are windows of their own.
            if picture.origin.iter().all(|o| o.abs() <= MOST_ORIGIN) {
                [request.origin_x, request.origin_y] = picture.origin.map(f64::from);
            }
            request.frame = frame.unwrap_or_default();
            let mut inputs = vec![Input { name: "color", pixels: color }];
            inputs.extend(picture.guides.iter().map(|(name, pixels)| Input { name, pixels }));
            let share = 1.0 / pictures.len() as f32;
            let mut report = |done: f32| progress((at as f32 + done) * share);
            let mut control = Control { threads: self.threads, progress: Some(&mut report), measured: None };
            let report = self
                .style
                .graph
                .process(self.device.as_ref(), &request, &inputs, &mut result, &mut control)
                .map_err(|e| e.at(name, "choose another picture or style"))?;
            filtered.replaced += report.replaced;
            if !scalar {
                result = convert::between(result, source.state, working.space, to);
                let is_shown = source.state == ImageState::SceneReferred && to == ImageState::DisplayReferred;
                if let Some((_, back)) = working.change.filter(|_| !is_shown) {
                    result = convert::changed(&result, &back).0;
                }
            }
            filtered.results.push(result);
        }
        Ok(filtered)
    }

    fn request(
        &self,
        name: &str,
        color: &Pixels,
        state: ImageState,
        space: Space,
    ) -> Result<IsophoteRequest> {
        let size = (color.width(), color.height());
        let request = self.library.request(size).map_err(|e| e.at(name, "use a smaller picture"))?;
        Ok(IsophoteRequest {
            space: match space {
                Space::Srgb => ISOPHOTE_SPACE_SRGB,
                Space::Acescg => ISOPHOTE_SPACE_ACESCG,
                _ => ISOPHOTE_SPACE_LINEAR,
            },
            alpha: match state {
                ImageState::DisplayReferred => ISOPHOTE_ALPHA_STRAIGHT,
                ImageState::SceneReferred => ISOPHOTE_ALPHA_PREMULTIPLIED,
            },
            ..request
        })
    }
}

impl Planner {
    /// Of a style of its own, which is the same as the filter's.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when the library fails.
    pub fn new(library: Library, style: Style) -> Result<Self> {
        let guides = usable_guides(&style)?;
        Ok(Self { library, style, guides, last: None })
    }

    /// Guides that the style can use.
    pub fn guides(&self) -> &[Guide] {
        &self.guides
    }

    /// Bytes that filtering a picture of this size takes at most, besides the picture and its result.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] for sizes and graphs that the library refuses.
    pub fn filter_memory(&mut self, name: &str, frame: Option<i64>, size: (u32, u32)) -> Result<u64> {
        let is_animated = frame.map_or(Ok(false), |frame| self.style.at_frame(frame))?;
        if let Some((_, bytes)) = self.last.filter(|(last, _)| *last == size && !is_animated) {
            return Ok(bytes);
        }
        let refused = |e: crate::loader::Refusal| e.at(name, "choose another picture or style");
        let mut request = self.library.request(size).map_err(refused)?;
        for guide in &self.guides {
            request.guides |= match guide {
                Guide::Normal => ISOPHOTE_GUIDE_NORMAL,
                Guide::Depth => ISOPHOTE_GUIDE_DEPTH,
                Guide::ObjectId => ISOPHOTE_GUIDE_OBJECT_ID,
            };
        }
        let plan = self.style.graph.plan(&request).map_err(refused)?;
        let bytes = plan.textures().map_err(refused)?.iter().map(Texture::bytes).sum();
        self.last = Some((size, bytes));
        Ok(bytes)
    }

    /// What the frame `file` needs; nothing when it will be refused, which is reported when its turn comes.
    ///
    /// # Errors
    /// As [`Planner::filter_memory`].
    pub fn needs(&mut self, file: &Path, frame: Option<i64>, opened: &Opened) -> Result<Option<Needs>> {
        let Some(size) = opened.size() else { return Ok(None) };
        let filter = self.filter_memory(&file.display().to_string(), frame, size)?;
        Ok(Some(Needs { frame: opened.weight(), filter }))
    }
}

/// The colour space in which a picture is filtered, and the change of primaries to it, which the library does not
/// know and which is done here.
pub struct WorkingSpace {
    /// The space of the request.
    pub space: Space,
    /// To Rec.709 and back, for primaries that a request cannot name.
    pub change: Option<(Change, Change)>,
}

impl WorkingSpace {
    /// What `space` says, or what the file says without.
    pub fn of(space: Option<Space>, state: ImageState, picture: &Picture) -> Self {
        let known = |space| Self { space, change: None };
        let primaries = match (space, state) {
            (Some(Space::P3 | Space::Rec2020), _) => space.and_then(Space::primaries),
            (Some(space), _) => return known(space),
            (None, ImageState::DisplayReferred) => return known(Space::Srgb),
            (None, ImageState::SceneReferred) => picture.chromaticities,
        };
        let change = |from| Some((Change::new(from, REC709)?, Change::new(REC709, from)?));
        match primaries {
            Some(c) if same(c, AP1) => known(Space::Acescg),
            Some(c) if !same(c, REC709) && picture.pixels.channels() > 1 => {
                Self { space: Space::Linear, change: change(c) }
            }
            _ => known(Space::Linear),
        }
    }
}

/// Guides that a style can use, whether or not they are connected.
///
/// # Errors
/// [`crate::error::Error::Failure`] when the library fails.
pub fn usable_guides(style: &Style) -> Result<Vec<Guide>> {
    let mut guides = Vec::new();
    for node in 0..style.graph.count() {
        let spec = style.graph.spec(node).map_err(|e| e.at(&style.name, "choose another style"))?;
        for port in spec.inputs {
            match port.kind {
                Kind::Normal => guides.push(Guide::Normal),
                Kind::Depth => guides.push(Guide::Depth),
                Kind::ObjectId => guides.push(Guide::ObjectId),
                _ => {}
            }
        }
    }
    Ok(guides)
}
