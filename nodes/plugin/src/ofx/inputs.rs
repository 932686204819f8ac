//! Inputs of a plan: the picture and its guides, of the frame that is rendered and of those around it.
//!
//! The images of other frames are fetched when they are read and given back at once. They are read for every render:
//! hosts do not tell effects when the pictures of other frames change.

use super::clips::{SOURCE, guide_clip};
use super::colours::Colours;
use super::content;
use super::contents::Content;
use super::effects::Effect;
use super::frame::Frame;
use super::host::{Host, Outcome, Properties};
use super::image::{Alpha, Beyond, Clip, Fetched};
use super::prepared::Prepared;
use super::stop::Stop;
use super::threads::FrameThreads;
use crate::pixel_aspect::{divide, multiply};
use crate::pool;
use isophote::Error;
use isophote::engine::cpu::Threads;
use isophote::engine::plan::Port;
use isophote::engine::{Image, Plan, Rect};
use isophote::graph::GraphInput;
use isophote::request::Guides;
use isophote_abi::openfx::*;
use isophote_motion::{Convention, Way};
use std::ffi::CStr;

/// One field of an interlaced picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// 0 for the rows 0, 2, 4, ..., 1 for the others; counted upwards.
    pub parity: i32,
}

impl Field {
    /// The field that the arguments of an action name, if any.
    pub fn of(args: Properties<'_>) -> Option<Self> {
        match args.string(kOfxImageEffectPropFieldToRender, 0)?.as_c_str() {
            f if f == kOfxImageFieldLower => Some(Self { parity: 0 }),
            f if f == kOfxImageFieldUpper => Some(Self { parity: 1 }),
            _ => None,
        }
    }
}

/// Pixels that were read for an input of a plan.
pub struct Read {
    /// The plan's name for it.
    pub name: String,
    /// The host's pixels, or those of the plan once they are ready.
    pub pixels: Image,
    input: GraphInput,
    /// The part of the plan's image.
    window: Rect,
    is_ready: bool,
}

impl Read {
    /// Keeps its memory for others.
    pub fn keep_memory(self) {
        pool::keep_image(self.pixels);
    }
}

/// An image for an input of a plan, before its pixels are read.
pub struct Taken<'h> {
    /// The plan's name for it.
    pub name: String,
    input: GraphInput,
    /// Its frame, counted from the one that is rendered.
    offset: i32,
    /// The part of the plan's image.
    pub window: Rect,
    pixels: Pixels<'h>,
}

/// Pixels of an image that was taken.
enum Pixels<'h> {
    /// The source's or a guide's, of the frame that is rendered.
    OfFrame,
    /// Another frame's, with what lies beyond them.
    OfNeighbour(Fetched<'h>, Beyond),
    /// Vectors, which are read at once.
    Vectors(Image),
}

/// Result of taking or reading.
pub enum Gathered<T> {
    /// Everything.
    All(Vec<T>),
    /// Nothing, since this frame, counted from the one that is rendered, lacks an image.
    Without(i32),
}

/// The images of one render.
pub struct Inputs<'h> {
    pub host: &'h Host,
    pub instance: Handle,
    pub time: f64,
    pub frame: Frame,
    pub field: Option<Field>,
    pub source: Fetched<'h>,
    pub guides: Vec<(GraphInput, Fetched<'h>)>,
    /// Meaning of the vectors of clips.
    pub convention: Convention,
    /// Change of the source's colours to those of the plan, and back.
    pub colours: Colours,
    /// True where nothing is to change, not even an alpha that is 1 by declaration.
    pub identity: bool,
    /// Threads of the frame.
    pub threads: FrameThreads,
}

/// The image of an optional clip, where there is one that can be read: what is of an unknown format counts as none, since
/// the picture can do without.
pub fn fetch<'h>(
    host: &'h Host,
    instance: Handle,
    frame: &Frame,
    name: &CStr,
    time: f64,
) -> Outcome<Option<Fetched<'h>>> {
    match Clip::of(host, instance, name).map_or(Ok(None), |clip| clip.image(time)) {
        Err(status) if status == kOfxStatErrImageFormat => Ok(None),
        image => Ok(image?.filter(|image| image.is_sound(frame))),
    }
}

/// The guides of an effect that have an image; those of motion where they are wanted.
pub fn fetch_guides<'h>(
    effect: &Effect,
    host: &'h Host,
    instance: Handle,
    frame: &Frame,
    time: f64,
    wants_motion: bool,
) -> Outcome<Vec<(GraphInput, Fetched<'h>)>> {
    let mut guides = Vec::new();
    for guide in &effect.guides {
        if (wants_motion || !guide.is_motion())
            && let Some(name) = guide_clip(*guide)
            && let Some(image) = fetch(host, instance, frame, name, time)?
            && image.suits(*guide)
        {
            guides.push((*guide, image));
        }
    }
    Ok(guides)
}

impl<'h> Inputs<'h> {
    /// The guides that there are. Vectors need two channels at least.
    pub fn available(&self) -> Guides {
        let counts = self.vector_channels();
        Guides::of(|guide| match guide {
            GraphInput::Motion => self.convention.among(Way::Backward, counts).is_some(),
            GraphInput::MotionForward => self.convention.among(Way::Forward, counts).is_some(),
            guide => self.guide(guide).is_some(),
        })
    }

    /// True where colour is not multiplied by alpha.
    pub fn is_straight(&self) -> bool {
        self.source.alpha == Alpha::Unpremultiplied
    }

    /// The host's pixels that a plan, or a part of it, reads of each of its images.
    pub fn gather(
        &self,
        prepared: &Prepared,
        plan: &Plan,
        windows: &[Rect],
        threads: &dyn Threads,
    ) -> Result<Gathered<Read>, Stop> {
        self.each(prepared, plan.inputs(), windows, threads, |taken| self.read_taken(prepared, taken))
    }

    /// Result of `made` for the image of each of a plan's inputs. One is given back before the next is taken.
    pub fn each<'p, T>(
        &self,
        prepared: &Prepared,
        ports: impl IntoIterator<Item = &'p Port>,
        windows: &[Rect],
        threads: &dyn Threads,
        made: impl Fn(Taken<'h>) -> Result<T, Stop>,
    ) -> Result<Gathered<T>, Stop> {
        let mut all = Vec::new();
        for port in ports {
            let window = windows[port.image.index()];
            let Some(input) = GraphInput::from_id(port.base()).filter(|_| !window.is_empty()) else {
                continue;
            };
            match self.pixels(prepared, input, port.frame, window, threads)? {
                Some(pixels) => {
                    let (name, offset) = (port.name.clone(), port.frame);
                    all.push(made(Taken { name, input, offset, window, pixels })?);
                }
                None if port.frame != 0 => return Ok(Gathered::Without(port.frame)),
                None => {}
            }
        }
        Ok(Gathered::All(all))
    }

    /// The host's pixels of an image that was taken.
    pub fn read_taken(&self, prepared: &Prepared, taken: Taken<'h>) -> Result<Read, Stop> {
        let Taken { name, input, window, pixels, .. } = taken;
        let host = prepared.host_window(window);
        let pixels = match pixels {
            Pixels::Vectors(pixels) => pixels,
            Pixels::OfNeighbour(image, beyond) if input == GraphInput::Color => {
                self.read_colour(&image, host, beyond)?
            }
            Pixels::OfNeighbour(image, _) if input.is_colour() => self.read_layer(input, &image, host)?,
            Pixels::OfNeighbour(image, _) => self.read_guide(input, &image, host)?,
            Pixels::OfFrame => match self.image(input) {
                Some(image) if input != GraphInput::Color && input.is_colour() => {
                    self.read_layer(input, image, host)?
                }
                Some(image) if input != GraphInput::Color => self.read_guide(input, image, host)?,
                _ => self.read(host)?,
            },
        };
        Ok(Read { name, pixels, input, window, is_ready: false })
    }

    /// Content of all that would be read of an image that was taken, for the rows of `part`, which lies in its window. None where
    /// the host gave too little of it: less than `is_part` of the picture would need.
    pub fn content(
        &self,
        prepared: &Prepared,
        taken: &Taken<'h>,
        part: Rect,
        is_part: bool,
        threads: &dyn Threads,
    ) -> Outcome<Option<Content>> {
        let [window, part] = [taken.window, part].map(|window| self.grown(prepared.host_window(window)));
        let (image, beyond) = match &taken.pixels {
            Pixels::Vectors(pixels) => {
                return Ok(Some(Content { form: content::of_image(pixels, threads), images: Vec::new() }));
            }
            Pixels::OfNeighbour(image, beyond) => (Some(image), *beyond),
            Pixels::OfFrame => (self.image(taken.input), Beyond::Edge),
        };
        let name = if taken.input == GraphInput::Color { Some(SOURCE) } else { guide_clip(taken.input) };
        let is_held = |image: &&Fetched<'_>| !is_part || self.is_held(name, taken.offset, image, part);
        let Some(image) = image.filter(is_held) else { return Ok(None) };
        let form = content::of_text(&format!("{window:?} {beyond:?} {:?}", self.field));
        // Of a tile, all is read of it for any row.
        let is_tiled = Beyond::of_guide(taken.input) == Beyond::Tiled;
        let (window, part) =
            if is_tiled { (image.window(&self.frame)?, image.window(&self.frame)?) } else { (window, part) };
        Ok(Some(Content { form, images: vec![image.rows(&self.frame, window, part, threads)?] }))
    }

    /// True where the host gave all of a window that its clip has in a frame.
    pub fn is_held(&self, name: Option<&CStr>, offset: i32, image: &Fetched<'_>, window: Rect) -> bool {
        let held = self.frame.inside(image.bounds);
        let defined = || {
            let clip = Clip::of(self.host, self.instance, name?)?;
            self.frame.pixels(&clip.defined(self.time + f64::from(offset))?)
        };
        held.contains(&window)
            || defined().is_some_and(|d| held.contains(&window.intersection(&self.frame.inside(d))))
    }

    /// Makes the host's pixels those of the plan, if they are not yet.
    pub fn make_ready(
        &self,
        prepared: &Prepared,
        read: &mut Read,
        threads: &dyn Threads,
    ) -> Result<(), Stop> {
        if std::mem::replace(&mut read.is_ready, true) {
            return Ok(());
        }
        if read.input.is_colour() {
            self.colours.enter(&mut read.pixels, threads);
        }
        if let Some(square) = prepared.square {
            if read.input.is_colour() && self.is_straight() {
                multiply(&mut read.pixels);
            }
            let pixels = std::mem::take(&mut read.pixels);
            read.pixels = square.to_square(pixels, read.window, read.input, threads).map_err(Error::from)?;
        }
        Ok(())
    }

    /// The host's pixels under a window of the plan's; none where there is no image.
    fn pixels(
        &self,
        prepared: &Prepared,
        input: GraphInput,
        offset: i32,
        window: Rect,
        threads: &dyn Threads,
    ) -> Result<Option<Pixels<'h>>, Stop> {
        let window = prepared.host_window(window);
        let vectors = |way| Ok(self.vectors(prepared, way, offset, window, threads)?.map(Pixels::Vectors));
        match input {
            GraphInput::Motion => vectors(Way::Backward),
            GraphInput::MotionForward => vectors(Way::Forward),
            _ if offset != 0 => self.of_neighbour(input, offset),
            input => Ok(self.image(input).map(|_| Pixels::OfFrame)),
        }
    }

    /// The image of an input in the frame that is rendered.
    fn image(&self, input: GraphInput) -> Option<&Fetched<'h>> {
        if input == GraphInput::Color { Some(&self.source) } else { self.guide(input) }
    }

    /// The image of a guide in the frame that is rendered.
    pub fn guide(&self, guide: GraphInput) -> Option<&Fetched<'h>> {
        self.guides.iter().find(|(g, _)| *g == guide).map(|(_, image)| image)
    }

    /// The pixels of `window` of the source.
    pub fn read(&self, window: Rect) -> Outcome<Image> {
        self.read_colour(&self.source, window, Beyond::Edge)
    }

    fn read_colour(&self, image: &Fetched<'_>, window: Rect, beyond: Beyond) -> Outcome<Image> {
        let mut pixels = self.of_field(window, |window| {
            image.read(&self.frame, window, GraphInput::Color, beyond, self.threads.threads())
        })?;
        if image.alpha == Alpha::Opaque && !self.identity {
            pixels.data_mut().chunks_exact_mut(4).for_each(|p| p[3] = 1.0);
        }
        Ok(pixels)
    }

    /// A layer of colours, multiplied by its alpha where the source is.
    fn read_layer(&self, guide: GraphInput, image: &Fetched<'_>, window: Rect) -> Outcome<Image> {
        let mut pixels = self.read_colour(image, window, Beyond::of_guide(guide))?;
        match (self.is_straight(), image.alpha) {
            (true, Alpha::Premultiplied) => divide(&mut pixels),
            (false, Alpha::Unpremultiplied) => multiply(&mut pixels),
            _ => {}
        }
        Ok(pixels)
    }

    fn read_guide(&self, guide: GraphInput, image: &Fetched<'_>, window: Rect) -> Outcome<Image> {
        let beyond = Beyond::of_guide(guide);
        self.of_field(window, |window| image.read(&self.frame, window, guide, beyond, self.threads.threads()))
    }

    /// The pixels of `window`, by what `read` reads; those of one field where one is rendered.
    pub fn of_field(&self, window: Rect, read: impl Fn(Rect) -> Outcome<Image>) -> Outcome<Image> {
        let Some(field) = self.field else { return read(window) };
        // Rows of the other field take the next of this one, as hosts that double the lines have it. Then
        // a picture of both fields and one of doubled lines come out alike.
        let grown = self.grown(window);
        let both = read(grown)?;
        let mut one = pool::part(&both, window, self.threads.threads()).map_err(|_| kOfxStatErrMemory)?;
        for y in window.y0..window.y1 {
            let up = self.frame.picture[3] - 1 - y;
            if up.rem_euclid(2) != field.parity {
                // The partner is above for the lower field's odd rows, and below for the upper's even ones.
                let partner = if field.parity == 0 { y + 1 } else { y - 1 };
                let other = if partner == y + 1 { y - 1 } else { y + 1 };
                let from = if (grown.y0..grown.y1).contains(&partner) { partner } else { other };
                if (grown.y0..grown.y1).contains(&from) {
                    one.row_mut(y).copy_from_slice(both.row(from));
                }
            }
        }
        Ok(one)
    }

    /// The pixels that are read for a window: rows of a field have neighbours in the other.
    pub fn grown(&self, window: Rect) -> Rect {
        let whole = Rect::of_size(self.frame.size()[0], self.frame.size()[1]);
        let grown = Rect { y0: window.y0 - 1, y1: window.y1 + 1, ..window }.intersection(&whole);
        if self.field.is_some() { grown } else { window }
    }

    /// The image of a clip in another frame; none where the clip, or the host, has none.
    pub fn neighbour(&self, name: &CStr, offset: i32) -> Result<Option<(Clip<'h>, Fetched<'h>)>, Stop> {
        let time = self.time + f64::from(offset);
        let clip = Clip::of(self.host, self.instance, name).filter(|clip| clip.has_frame(time));
        // Whatever is wrong with another frame, this one can do without it.
        let found = clip.and_then(|clip| Some((clip, clip.image(time).ok().flatten()?)));
        // A host that wants to stop may have no images either.
        if self.host.aborted(self.instance) { Err(Stop::Aborted) } else { Ok(found) }
    }

    /// An image of another frame.
    fn of_neighbour(&self, input: GraphInput, offset: i32) -> Result<Option<Pixels<'h>>, Stop> {
        let name = if input == GraphInput::Color { Some(SOURCE) } else { guide_clip(input) };
        let Some(name) = name else { return Ok(None) };
        let is_fit = |image: &Fetched<'_>| image.suits(input) && image.is_sound(&self.frame);
        let found = self.neighbour(name, offset)?.filter(|(_, image)| is_fit(image));
        Ok(found.map(|(clip, image)| {
            let beyond = match input {
                GraphInput::Color => self.beyond(clip.defined(self.time + f64::from(offset))),
                _ => Beyond::Edge,
            };
            Pixels::OfNeighbour(image, beyond)
        }))
    }

    /// Values outside the image of another frame, by its region: nothing, where it does not cover this one's.
    fn beyond(&self, defined: Option<OfxRectD>) -> Beyond {
        let ([x0, y0, x1, y1], defined_pixels) =
            (self.frame.picture, defined.and_then(|r| self.frame.pixels(&r)));
        match defined_pixels {
            Some(h) if h[0] > x0 + 1 || h[1] > y0 + 1 || h[2] < x1 - 1 || h[3] < y1 - 1 => Beyond::Zero,
            _ => Beyond::Edge,
        }
    }
}
