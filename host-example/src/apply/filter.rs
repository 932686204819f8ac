//! What is done to every frame: the graph on each of its pictures.

use std::path::Path;

use super::backend::Backend;
use super::convert;
use super::exr::{ExrFile, Guide, Picture};
use super::memory::Needs;
use super::primaries::{AP1, Change, REC709, same};
use super::read::{ImageState, Opened};
use super::reel::{Window, guide_bit};
use super::space::Space;
use super::write::Format;
use crate::error::Result;
use crate::loader::catalogue::Kind;
use crate::loader::contract::{
    ISOPHOTE_ALPHA_PREMULTIPLIED, ISOPHOTE_ALPHA_STRAIGHT, ISOPHOTE_SPACE_ACESCG, ISOPHOTE_SPACE_LINEAR,
    ISOPHOTE_SPACE_SRGB, IsophoteHistory, IsophoteRequest,
};
use crate::loader::plan::{Role, Texture};
use crate::loader::{Answer, Control, Device, Input, Library, Sequence};
use crate::pixels::{Pixels, Precision};
use crate::stylize::history::{is_stage, split};
use crate::stylize::style::Style;

/// A style with what it runs on.
#[derive(Debug)]
pub struct Filter {
    library: Library,
    style: Style,
    device: Option<Device>,
    space: Option<Space>,
    threads: u32,
    /// What is kept of the frames of each picture.
    sequences: Vec<Kept>,
}

/// What is kept of the frames of one picture, whose size it is made for.
#[derive(Debug)]
struct Kept {
    size: (u32, u32),
    sequence: Sequence,
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
        Ok(Self { library, style, device, space, threads, sequences: Vec::new() })
    }

    /// Frames before and after its own that a frame depends on.
    ///
    /// # Errors
    /// [`crate::error::Error::Failure`] when the library fails.
    pub fn frames(&self) -> Result<[i64; 2]> {
        let frames = self.library.frames(&self.style.graph);
        Ok(frames.map_err(|e| e.at(&self.style.name, "choose another style"))?.map(i64::from))
    }

    /// Filters all pictures of a frame, or the first where `format` holds one; `exr` is the file that they came from.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] for pictures that the library refuses,
    /// [`crate::error::Error::Failure`] when it or the device fails.
    pub fn run(
        &mut self,
        name: &str,
        window: &Window<'_>,
        exr: Option<&ExrFile>,
        format: Format,
        progress: &mut dyn FnMut(f32),
    ) -> Result<Filtered> {
        let (own, source) = (&window.own, &window.own.source);
        if let Some(frame) = own.number {
            self.style.at_frame(frame)?;
        }
        let in_place = exr.filter(|_| format == Format::Exr);
        let count = if in_place.is_some() { source.pictures.len() } else { source.pictures.len().min(1) };
        let to = format.state(source.state);
        let scalar = self.style.kind != Kind::Color;
        let mut filtered = Filtered { results: Vec::with_capacity(count), replaced: 0 };
        for (at, picture) in source.pictures.iter().take(count).enumerate() {
            let channels = match in_place {
                Some(exr) => exr.result_channels(at, scalar),
                None if scalar => 1,
                None => picture.pixels.channels().max(3),
            };
            let working = WorkingSpace::of(self.space, source.state, picture);
            let there = working.change.as_ref().map(|(there, _)| there);
            let (color, bad) = own.working(at, there).unwrap_or((&picture.pixels, 0));
            filtered.replaced += bad;
            let precision = if to == source.state { color.precision() } else { Precision::F32 };
            let mut result = Pixels::zeroed(color.width(), color.height(), channels, precision);
            let mut request = self.request(name, color, source.state, working.space)?;
            // Windows farther out than marks can be told apart are windows of their own.
            if picture.origin.iter().all(|o| o.abs() <= MOST_ORIGIN) {
                [request.origin_x, request.origin_y] = picture.origin.map(f64::from);
            }
            request.canonical_height = picture.canonical_height;
            request.frame = own.number.unwrap_or_default();
            let share = 1.0 / count as f32;
            let mut report = |done: f32| progress((at as f32 + done) * share);
            let mut control = Control { threads: self.threads, progress: Some(&mut report), measured: None };
            let job = Job { at, there, request, color, window };
            filtered.replaced += self
                .process(&job, &mut result, &mut control)
                .map_err(|e| e.at(name, "choose another picture or style"))?;
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

    /// Filters one picture, and returns how many samples were replaced.
    fn process(&mut self, job: &Job<'_>, result: &mut Pixels, control: &mut Control<'_>) -> Answer<u64> {
        let Job { at, there, mut request, color, window } = *job;
        let Some(picture) = window.own.source.pictures.get(at) else { return Ok(0) };
        let frames = self.library.frames(&self.style.graph)?;
        if frames == [0, 0] {
            let mut inputs = vec![Input { name: "color", pixels: color }];
            inputs.extend(picture.guides.iter().map(|(name, pixels)| Input { name, pixels }));
            let device = self.device.as_ref();
            return Ok(self.style.graph.process(device, &request, &inputs, result, control)?.replaced);
        }
        request.guides = picture.guides.iter().fold(0, |all, (name, _)| all | guide_bit(name));
        let size = (request.width, request.height);
        self.sequences.truncate(if self.sequences.get(at).is_some_and(|k| k.size != size) {
            at
        } else {
            usize::MAX
        });
        if self.sequences.len() <= at {
            let memory = stages(&self.library, &self.style, &request, frames)?;
            self.sequences.push(Kept { size, sequence: self.library.sequence(memory, 0.0)? });
        }
        let footage = |input: &str, frame: i64| window.image(at, input, frame, there);
        let sequence = &mut self.sequences[at].sequence;
        let device = self.device.as_ref();
        Ok(sequence.process(&mut self.style.graph, device, &request, &footage, result, control)?.replaced)
    }

    fn request(
        &self,
        name: &str,
        color: &Pixels,
        state: ImageState,
        space: Space,
    ) -> Result<IsophoteRequest> {
        let size = (color.width(), color.height());
        let request =
            self.style.request(&self.library, size).map_err(|e| e.at(name, "use a smaller picture"))?;
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
        let guides = usable_guides(&library, &style)?;
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
        let mut request = self.style.request(&self.library, size).map_err(refused)?;
        request.guides = self.guides.iter().fold(0, |all, guide| all | guide_bit(guide.id()));
        let frames = self.library.frames(&self.style.graph).map_err(refused)?;
        let plan = match frames {
            [0, 0] => self.style.graph.plan(&request),
            [past, _] => self.library.plan_in_order(&self.style.graph, &request, &history(past)),
        };
        let plan = plan.map_err(refused)?;
        let textures: u64 = plan.textures().map_err(refused)?.iter().map(Texture::bytes).sum();
        let bytes = textures + stages(&self.library, &self.style, &request, frames).map_err(refused)?;
        self.last = Some((size, bytes));
        Ok(bytes)
    }

    /// Frames before and after `frame` that it depends on.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] when an animated parameter cannot have its value.
    pub fn frames(&self, frame: Option<i64>) -> Result<[i64; 2]> {
        let Some(frame) = frame else { return Ok([0, 0]) };
        self.style.at_frame(frame)?;
        let frames = self.library.frames(&self.style.graph);
        let frames = frames.map_err(|e| e.at(&self.style.name, "choose another style"))?;
        Ok(frames.map(i64::from))
    }

    /// How many frames are held while `frame` is done: it and all that it depends on.
    ///
    /// # Errors
    /// As [`Planner::frames`].
    pub fn span(&self, frame: Option<i64>) -> Result<u64> {
        let [past, future] = self.frames(frame)?;
        Ok((past + future + 1) as u64)
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

/// One picture of a frame.
#[derive(Clone, Copy)]
struct Job<'a> {
    at: usize,
    /// The change to the working space.
    there: Option<&'a Change>,
    request: IsophoteRequest,
    /// The picture in its working space.
    color: &'a Pixels,
    window: &'a Window<'a>,
}

/// Plans for so many frames before the one that is computed.
fn history(past: u32) -> IsophoteHistory {
    IsophoteHistory { past, max_motion: 0.0 }
}

/// Bytes of the stages that a frame reads of those before and after it, which are at most so many, and of its own.
fn stages(library: &Library, style: &Style, request: &IsophoteRequest, frames: [u32; 2]) -> Answer<u64> {
    let [past, future] = frames;
    if past + future == 0 {
        return Ok(0);
    }
    let plan = library.plan_in_order(&style.graph, request, &history(past))?;
    let textures = plan.textures()?;
    let kept = textures.iter().filter(|t| t.role == Role::Output && is_stage(t.name));
    // Of farther frames only inputs are read.
    let read = textures.iter().filter_map(|t| split(t.name)).filter(|(name, _)| is_stage(name));
    let past = read.map(|(_, before)| before as u64).max().unwrap_or(0);
    Ok(kept.map(Texture::bytes).sum::<u64>() * (past + u64::from(future) + 1))
}

/// Guides that a style can use, whether or not they are connected.
///
/// # Errors
/// [`crate::error::Error::Failure`] when the library fails.
pub fn usable_guides(library: &Library, style: &Style) -> Result<Vec<Guide>> {
    let mut guides = Vec::new();
    let refused = |e: crate::loader::Refusal| e.at(&style.name, "choose another style");
    // Stills read no motion.
    let is_steady = style.is_animated() || library.frames(&style.graph).map_err(refused)? != [0, 0];
    for node in 0..style.graph.count() {
        let spec = style.graph.spec(node).map_err(refused)?;
        for port in spec.inputs {
            match port.kind {
                Kind::Normal => guides.push(Guide::Normal),
                Kind::Depth => guides.push(Guide::Depth),
                Kind::ObjectId => guides.push(Guide::ObjectId),
                Kind::Position => guides.push(Guide::RestPosition),
                Kind::Motion if is_steady && port.id == "motion" => guides.push(Guide::Motion),
                Kind::Motion if is_steady => guides.push(Guide::MotionForward),
                _ => {}
            }
        }
    }
    Ok(guides)
}
