//! Look on the picture, computed on the processor by the library: at the size at which it is seen, and no more
//! of it than is seen.

use std::sync::Arc;

use egui::ColorImage;

use crate::jobs::ruled::Rules;
use crate::state::document::frame::Frame;
use crate::state::document::reduce;
use crate::state::look::EditedLook;
use crate::state::preview::order::Order;
use crate::state::preview::picture::{self, Meaning, Picture};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::limits;
use isophote_finishing::stylize::style::Style;
use isophote_loader::abi::{ISOPHOTE_ERROR_CANCELLED, IsophoteRequest};
use isophote_loader::catalogue::Kind;
use isophote_loader::process::Part;
use isophote_loader::{Control, Input, Library};
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use isophote_pictures::space::Space;

/// Bytes a pixel that filtering takes beside the picture, for nearly all looks.
const WORKING: u64 = 300;

/// A frame, the size that it has in a preview, the part of it that was read, and what was read.
type Read = (Arc<Frame>, (u32, u32), Part, Frame);

/// Makes previews, one after the other.
pub struct Renderer {
    library: Library,
    threads: u32,
    /// The part of the picture that was read last, for the next look on it.
    read: Option<Read>,
    rules: Rules,
}

impl Renderer {
    /// One that uses so many threads; 0 for one per core.
    pub fn new(library: Library, threads: u32) -> Self {
        let rules = Rules::new(library.clone());
        Self { library, threads, read: None, rules }
    }

    /// The preview, or nothing where it was cancelled.
    ///
    /// # Errors
    /// Errors of the library about the look, and [`Error::Failure`] when memory is short.
    pub fn render(
        &mut self,
        picture: &Picture,
        order: &Order,
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<ColorImage>> {
        let Order { look, size, part, fineness } = order;
        let fineness = finest(&picture.frame, *size, *fineness);
        let finer = |at: i32| at * fineness as i32;
        let size = (size.0 * fineness, size.1 * fineness);
        let part = part.map(|corner| corner.map(finer));
        let [[left, top], [right, bottom]] = part;
        let wide = u64::from(right.abs_diff(left));
        limits::must_have(wide * u64::from(bottom.abs_diff(top)) * WORKING, &look.name)?;
        let shown = |colors: &[[f32; 4]], width: u32, meaning: Meaning| {
            picture::shown(colors, width as usize, fineness as usize, meaning, picture.exposure)
        };
        let Some(mut style) = look.style(&self.library)? else {
            let frame = self.read(&picture.frame, size, part);
            return Ok(Some(shown(&frame.color, frame.width, picture.meaning())));
        };
        let meaning = match style.kind {
            // One channel of grey, encoded for a display.
            Kind::Scalar => Meaning { space: Space::Srgb, is_premultiplied: false },
            _ => picture.meaning(),
        };
        let result = self.ruled(picture, (look, &mut style), (size, part), cancelled)?;
        Ok(result.map(|result| shown(result.to_f32().as_chunks::<4>().0, result.width(), meaning)))
    }

    /// Part of the picture in a look, whose style this is, at a size; things have the looks that its rules give them.
    fn ruled(
        &mut self,
        picture: &Picture,
        (look, style): (&EditedLook, &mut Style),
        (size, part): ((u32, u32), Part),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Pixels>> {
        let mut directed = self.rules.directed(look, style, picture.things.as_ref())?;
        let ruled = match (&directed, &picture.things) {
            (Some(directed), Some(things)) => {
                self.rules.follow(directed, (look, style), (&picture.frame, things))?
            }
            _ => None,
        };
        let frame = ruled.as_ref().map_or(&picture.frame, |ruled| &ruled.frame);
        let mut stylized =
            |style: &mut Style| self.stylized((picture, frame), style, (size, part), cancelled);
        let Some(below) = stylized(style)? else { return Ok(None) };
        let Some((directed, ruled)) = directed.as_mut().zip(ruled.as_ref()) else { return Ok(Some(below)) };
        let (masks, encoding) = ruled.places(size, part);
        directed.lay_over(below, (&masks, encoding), |processor| stylized(processor.style_mut()))
    }

    /// Part of the picture, of which this is the frame, in a style, at a size.
    fn stylized(
        &mut self,
        (picture, frame): (&Picture, &Arc<Frame>),
        style: &mut Style,
        (size, part): ((u32, u32), Part),
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Pixels>> {
        style.at_frame(picture.frame.number.unwrap_or_default())?;
        let refused = |e: isophote_loader::Error| e.at(&style.name, "choose another look");
        let mut guides = style.usable_guides(&self.library)?;
        guides.retain(|guide| frame.guide(*guide).is_some());
        // Looks read farther where a control map widens their lines.
        let bits = self.library.guide_bits(guides.iter().map(|guide| guide.id())).map_err(refused)?;
        let request = IsophoteRequest { guides: bits, ..self.request(picture, size, style)? };
        let read = style.graph.support(&request, part).map_err(refused)?;
        let mut control = Control { threads: self.threads, cancelled: Some(cancelled), ..Control::default() };
        let frame = self.read(frame, size, read);
        let color = pixels(frame, 4, frame.color.as_flattened())?;
        let usable = frame.guides.iter().filter(|image| guides.contains(&image.guide));
        let guides: Vec<(&str, Pixels)> = usable
            .map(|image| Ok((image.guide.id(), pixels(frame, image.channels, &image.data)?)))
            .collect::<Result<_>>()?;
        let mut inputs = vec![Input { name: "color", pixels: &color }];
        inputs.extend(guides.iter().map(|(name, pixels)| Input { name, pixels }));
        let [[left, top], [right, bottom]] = part;
        let mut target = Pixels::zeroed(right.abs_diff(left), bottom.abs_diff(top), 4, Precision::F32);
        match style.graph.process_part(&request, &inputs, read[0], part, &mut target, &mut control) {
            Ok(_) => Ok(Some(target)),
            Err(refusal) if refusal.status() == Some(ISOPHOTE_ERROR_CANCELLED) => Ok(None),
            Err(refusal) => Err(refusal.at(&style.name, "choose another look")),
        }
    }

    /// Request of `apply`, for a picture of this size.
    fn request(&self, picture: &Picture, size: (u32, u32), style: &Style) -> Result<IsophoteRequest> {
        let usual =
            style.request(&self.library, size).map_err(|e| e.at(&style.name, "choose another picture"))?;
        let IsophoteRequest { width, height, .. } = usual;
        let scale = picture.scale(width) * picture.frame.request.scale;
        Ok(IsophoteRequest { width, height, scale, ..picture.frame.request(usual) })
    }

    /// A part of the picture made as small as `size`.
    fn read(&mut self, frame: &Arc<Frame>, size: (u32, u32), part: Part) -> &Frame {
        let known = self.read.take().filter(|(of, known_size, known_part, _)| {
            Arc::ptr_eq(of, frame) && (*known_size, *known_part) == (size, part)
        });
        let read =
            known.unwrap_or_else(|| (Arc::clone(frame), size, part, reduce::reduced(frame, size, part)));
        &self.read.insert(read).3
    }

    /// Gives memory back.
    pub fn rest(&mut self) {
        self.read = None;
        self.rules.rest();
    }
}

/// The largest factor up to `fineness` by which a preview of a size can be finer without being finer than the frame.
fn finest(frame: &Frame, size: (u32, u32), fineness: u32) -> u32 {
    let fits = |factor: &u32| size.0 * factor <= frame.width && size.1 * factor <= frame.height;
    (1..=fineness).rev().find(fits).unwrap_or(1)
}

fn pixels(frame: &Frame, channels: u32, numbers: &[f32]) -> Result<Pixels> {
    let pixels = Pixels::new(frame.width, frame.height, channels, Samples::F32(numbers.to_vec()));
    pixels.ok_or_else(|| Error::failure("a picture is not as large as it should be", "open it again"))
}
