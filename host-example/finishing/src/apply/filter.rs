//! Work on every frame: the graph on each of its pictures.

use std::sync::Arc;

use super::backend::Backend;
use super::card::Card;
use super::frame_cache::Window;
use super::picture_request::PictureRequest;
use super::square;
use super::stages::stages;
use crate::stylize::style::Style;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::catalogue::Kind;
use isophote_loader::{Control, Device, Input, Library, Sequence};
use isophote_pictures::convert::Conversion;
use isophote_pictures::exr::{ExrFile, Picture};
use isophote_pictures::meaning::Meaning;
use isophote_pictures::mix::{self, Encoding};
use isophote_pictures::pixels::{Pixels, Precision};
use isophote_pictures::space::Space;
use isophote_pictures::working::WorkingSpace;
use isophote_pictures::write::Format;

/// Look of a picture: a style, maybe where a mask is.
#[derive(Debug)]
pub struct MaskedStyle {
    /// The style.
    pub style: Style,
    /// Index of the mask among those of pictures.
    pub mask: Option<usize>,
}

impl MaskedStyle {
    /// A style for whole pictures.
    pub fn whole(style: Style) -> Self {
        Self { style, mask: None }
    }
}

/// Looks with what they run on. Each is made from the picture itself, and laid over the results of those before where its
/// mask is.
#[derive(Debug)]
pub struct Filter {
    library: Library,
    layers: Vec<Layer>,
    card: Arc<Card<Device>>,
    space: Option<Space>,
    output_space: Option<Space>,
    /// True where results are floats, whatever the picture's precision is.
    is_precise: bool,
    threads: u32,
}

/// A look with what is kept of it.
#[derive(Debug)]
pub(super) struct Layer {
    pub(super) look: MaskedStyle,
    /// The mask that its graph takes as an input; that of other looks is applied to their results.
    input: Option<usize>,
    /// True where it draws on nothing, so that results have alpha.
    is_bare: bool,
    /// State that is kept of the frames of each picture.
    sequences: Vec<Kept>,
}

/// State that is kept of the frames of one picture, for whose size and device it is made.
#[derive(Debug)]
struct Kept {
    size: (u32, u32),
    is_on_card: bool,
    sequence: Sequence,
}

/// Results of one frame.
#[derive(Debug)]
pub struct Filtered {
    /// One for each picture that is written.
    pub results: Vec<Pixels>,
    /// Meaning of their numbers.
    pub meaning: Meaning,
    /// Samples that were NaN or infinite and were replaced.
    pub replaced: u64,
}

/// Looks as they are applied: the mask of the only one enters its graph where that takes it.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for a mask of what is no picture of colours.
pub(super) fn layers(looks: Vec<MaskedStyle>) -> Result<Vec<Layer>> {
    let is_single = looks.len() == 1;
    let mut layers = Vec::with_capacity(looks.len());
    for look in looks {
        let MaskedStyle { style, mask } = &look;
        if mask.is_some() || !is_single {
            style.must_cover()?;
        }
        let input = if is_single && style.takes("mask")? { *mask } else { None };
        let is_bare = style.draws_alone()?;
        layers.push(Layer { look, input, is_bare, sequences: Vec::new() });
    }
    Ok(layers)
}

/// Frames before and after its own that a frame of any of the looks depends on.
pub(super) fn frames(library: &Library, layers: &[Layer]) -> Result<[i64; 2]> {
    let mut most = [0; 2];
    for Layer { look: MaskedStyle { style, .. }, .. } in layers {
        let frames = library.frames(&style.graph).map_err(|e| e.at(&style.name, "choose another style"))?;
        most = [0, 1].map(|side| i64::from(frames[side]).max(most[side]));
    }
    Ok(most)
}

/// Gives animated parameters of the looks their values at a frame, and says whether there are any.
pub(super) fn at_frame(layers: &[Layer], frame: i64) -> Result<bool> {
    let mut is_animated = false;
    for layer in layers {
        is_animated |= layer.look.style.at_frame(frame)?;
    }
    Ok(is_animated)
}

impl Layer {
    /// The guide beside those of the picture, by its name.
    pub(super) fn guide(&self) -> Option<&'static str> {
        self.input.map(|_| "mask")
    }

    /// True where its result is mixed with what is below it.
    pub(super) fn is_mixed(&self) -> bool {
        self.look.mask.is_some() && self.input.is_none()
    }

    /// Filters one picture, and returns how many samples were replaced.
    fn process(
        &mut self,
        (library, device): (&Library, Option<&Device>),
        job: &LayerJob<'_>,
        result: &mut Pixels,
        control: &mut Control<'_>,
    ) -> isophote_loader::Result<u64> {
        let LayerJob { at, there, mut request, color, window } = *job;
        let Some(picture) = window.own.source.pictures.get(at) else { return Ok(0) };
        let style = &mut self.look.style;
        request.reference_height = style.lengths.reference_height();
        let frames = library.frames(&style.graph)?;
        let mask = self.input.and_then(|mask| Some(("mask", picture.masks.get(mask)?.as_ref()?)));
        let own = |(name, _): &(&'static str, Pixels)| Some((*name, window.own.guide(at, name, there)?));
        let guides = picture.guides.iter().filter_map(own).chain(mask);
        let inputs = guides.map(|(name, pixels)| Input { name, pixels });
        if frames == [0, 0] {
            let mut all = vec![Input { name: "color", pixels: color }];
            all.extend(inputs);
            style.graph.set_memory(window.own.bound)?;
            return Ok(style.graph.process(device, &request, &all, result, control)?.replaced);
        }
        request.guides = library.guide_bits(inputs.map(|input| input.name))?;
        let (size, is_on_card) = ((request.width, request.height), device.is_some());
        if self.sequences.get(at).is_some_and(|k| (k.size, k.is_on_card) != (size, is_on_card)) {
            self.sequences.truncate(at);
        }
        if self.sequences.len() <= at {
            let memory = stages(library, style, &request, frames)?;
            self.sequences.push(Kept { size, is_on_card, sequence: library.sequence(memory, 0.0)? });
        }
        let input = self.input;
        let mut image = |name: &str, frame: i64| match (name, input) {
            ("mask", Some(mask)) => window.mask(at, mask, frame),
            _ => window.image(at, name, frame, there),
        };
        let sequence = &mut self.sequences[at].sequence;
        Ok(sequence.process(style.graph.handle(), device, &request, &mut image, result, control)?.replaced)
    }
}

impl Filter {
    /// Looks on the device that `backend` asks for; at least one.
    ///
    /// # Errors
    /// [`Error::Failure`] when there is no such device, [`Error::Input`] for a mask of what is no picture of colours.
    pub fn new(
        library: Library,
        looks: Vec<MaskedStyle>,
        backend: Backend,
        space: Option<Space>,
        threads: u32,
    ) -> Result<Self> {
        let (card, layers) = (Arc::new(backend.card(&library)?), layers(looks)?);
        Ok(Self { library, layers, card, space, output_space: None, is_precise: false, threads })
    }

    /// The same with results in a space of their own.
    #[must_use]
    pub fn into_space(self, output_space: Option<Space>) -> Self {
        Self { output_space, ..self }
    }

    /// The same with results that are as exact as they are computed, for files that hold more than the picture's.
    #[must_use]
    pub fn precisely(self, is_precise: bool) -> Self {
        Self { is_precise, ..self }
    }

    /// The library that it runs.
    pub fn library(&self) -> Library {
        self.library.clone()
    }

    /// True where a graphics device filters, as long as it works.
    pub fn is_on_card(&self) -> bool {
        self.card.device().is_some()
    }

    /// Another one beside it on the same device, of the same looks.
    ///
    /// # Errors
    /// As [`Filter::new`].
    pub fn beside(&self, looks: Vec<MaskedStyle>) -> Result<Self> {
        let (library, card) = (self.library.clone(), Arc::clone(&self.card));
        Ok(Self { library, layers: layers(looks)?, card, ..*self })
    }

    /// Number of them that should work on the frames of a sequence. Two on a graphics device: while it computes one
    /// frame, another one is uploaded or read back. Frames that depend on others are done by one, which knows them.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn best_count(&self) -> Result<usize> {
        Ok(if self.card.device().is_some() && self.frames()? == [0, 0] { 2 } else { 1 })
    }

    /// Frames before and after its own that a frame depends on.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn frames(&self) -> Result<[i64; 2]> {
        frames(&self.library, &self.layers)
    }

    /// Filters all pictures of a frame, or the first where `format` holds one; `exr` is the file that they came from.
    ///
    /// # Errors
    /// [`Error::Input`] for pictures that the library refuses, [`Error::Failure`] when it or the device fails.
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
            at_frame(&self.layers, frame)?;
        }
        let in_place = exr.filter(|_| format == Format::Exr);
        let count = if in_place.is_some() { source.pictures.len() } else { source.pictures.len().min(1) };
        if in_place.is_some() {
            self.check_output_space()?;
        }
        let to = format.state(source.state());
        let scalar = self.is_scalar();
        let mut filtered =
            Filtered { results: Vec::with_capacity(count), meaning: Meaning::usual(to), replaced: 0 };
        for (at, picture) in source.pictures.iter().take(count).enumerate() {
            let channels = self.channels((at, picture), in_place);
            let working = WorkingSpace::of(self.space, picture).with_alpha(self.is_bare());
            let there = working.there.as_ref();
            let (color, bad) = own.working(at, there).unwrap_or((&picture.pixels, 0));
            filtered.replaced += bad;
            let is_same = to == source.state() && self.output_space.is_none() && !self.is_precise;
            let precision = if is_same { color.precision() } else { Precision::F32 };
            let size = (color.width(), color.height());
            let usual = self.library.request(size).map_err(|e| e.at(name, "use a smaller picture"))?;
            let request = PictureRequest::of(picture, working.space, own.number).request(usual);
            let job = LayerJob { at, there, request, color, window };
            let share = 1.0 / count as f32;
            let mut report = |done: f32| progress((at as f32 + done) * share);
            let is_premultiplied = picture.meaning.is_premultiplied();
            let encoding = Encoding { is_premultiplied, space: working.space };
            let (mut result, replaced) =
                self.layered(name, &job, (channels, precision), encoding, &mut report)?;
            filtered.replaced += replaced;
            if let Some(own) = &picture.own {
                result = square::unmake(&self.library, name, (own, &picture.meaning), &result)?;
            }
            if !scalar {
                let meaning = format.kept(working.of_results(to, self.output_space));
                if let Some(back) = working.back(&meaning) {
                    result = back.apply(&result).0;
                }
                if at == 0 {
                    filtered.meaning = meaning;
                }
            }
            filtered.results.push(result);
        }
        Ok(filtered)
    }

    /// True where results have one channel.
    fn is_scalar(&self) -> bool {
        self.layers.iter().all(|layer| layer.look.style.kind != Kind::Color)
    }

    /// True where results have alpha, whether or not pictures have.
    fn is_bare(&self) -> bool {
        self.layers.iter().any(|layer| layer.is_bare)
    }

    /// Samples a pixel of the result of a picture, which goes back into a file or not.
    fn channels(&self, (at, picture): (usize, &Picture), in_place: Option<&ExrFile>) -> u32 {
        match in_place {
            Some(exr) => exr.result_channels(at, self.is_scalar(), self.is_bare()),
            None if self.is_scalar() => 1,
            None if self.is_bare() => 4,
            None => picture.pixels.channels().max(3),
        }
    }

    /// Refuses a space of results that go back into the file that they came from.
    fn check_output_space(&self) -> Result<()> {
        if self.output_space.is_none() {
            return Ok(());
        }
        let problem = "is not for EXR files made of themselves, whose headers say what all their layers mean";
        Err(Error::input("--output-space", problem, "leave it out, or write a .tif or .png file"))
    }

    /// The looks of one picture over each other, and how many samples were replaced.
    fn layered(
        &mut self,
        name: &str,
        job: &LayerJob<'_>,
        (channels, precision): (u32, Precision),
        encoding: Encoding,
        progress: &mut dyn FnMut(f32),
    ) -> Result<(Pixels, u64)> {
        let (color, count) = (job.color, self.layers.len() as f32);
        let masks = job.window.own.source.pictures.get(job.at).map_or(&[][..], |picture| &picture.masks);
        let mut replaced = 0;
        let mut below: Option<Pixels> = None;
        for (number, layer) in self.layers.iter_mut().enumerate() {
            let mut result = Pixels::zeroed(color.width(), color.height(), channels, precision);
            let mut report = |done: f32| progress((number as f32 + done) / count);
            let mut control =
                Control { threads: self.threads, progress: Some(&mut report), ..Control::default() };
            let process = |device: Option<&Device>| {
                layer.process((&self.library, device), job, &mut result, &mut control)
            };
            let bad = self.card.run(process).map_err(|e| e.at(name, "choose another picture or style"))?;
            // All of them read the same picture.
            replaced = bad.max(replaced);
            let mask = layer.look.mask.and_then(|mask| masks.get(mask)?.as_ref());
            below = Some(match mask.filter(|_| layer.is_mixed()) {
                Some(mask) => mix::mixed(below.as_ref().unwrap_or(color), result, mask, encoding),
                None => result,
            });
        }
        let nothing = || Error::input(name, "is given no style", "name one");
        Ok((below.ok_or_else(nothing)?, replaced))
    }
}

/// One picture of a frame.
#[derive(Clone, Copy)]
struct LayerJob<'a> {
    at: usize,
    /// The change to the working space.
    there: Option<&'a Conversion>,
    request: IsophoteRequest,
    /// The picture in its working space.
    color: &'a Pixels,
    window: &'a Window<'a>,
}
