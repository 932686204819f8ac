//! Masks of a run, its painted maps and its materials: where they come from, and each in its picture's size.
//!
//! A mask is a number for each pixel. Files of colours stand for their luminance, 0.2126 R + 0.7152 G + 0.0722 B of the numbers
//! as they are stored; alpha is never looked at. What is no number is 0, and all is cut to 0..=1.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use isophote_exr_edit::Window;

use super::materials::{Laid, of_guides};
use super::objects::{Rule, Ruled};
use super::painted::Painted;
use super::tasks::Tasks;
use isophote_files::error::{Error, Result};
use isophote_files::frames::{self, Pattern};
use isophote_pictures::convert::Conversion;
use isophote_pictures::exr::{self, Guide, MaskSource, OnUnknown, Picture, Selection};
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::{Pixels, Samples};
use isophote_pictures::read::{self, Source, Unread};
use isophote_pictures::space::Space;

/// Where a mask comes from, and whether what it leaves out is meant.
#[derive(Clone, Debug)]
pub struct MaskChoice {
    /// Source of the mask.
    pub source: MaskSource,
    /// True where it is turned round.
    pub invert: bool,
}

/// The masks of a run, and its painted maps.
#[derive(Debug, Default)]
pub struct Masks {
    masks: Vec<Mask>,
    maps: Vec<Map>,
    /// Paper and hatching.
    materials: Vec<Laid>,
    /// What rules for things say. Where the things are, the last masks say.
    rules: Vec<Rule>,
    /// Space that somebody names for the pictures.
    space: Option<Space>,
}

/// A painted map.
#[derive(Debug)]
struct Map {
    kind: &'static Painted,
    place: Place,
    /// Space that somebody names for the pictures.
    space: Option<Space>,
    /// The map that all frames have in common.
    kept: Mutex<Option<(OfMap, Pixels)>>,
}

/// Place of a map's picture, and the meaning of its numbers where the map has colours.
type OfMap = (Frame, Option<Meaning>);

#[derive(Debug)]
struct Mask {
    place: Place,
    /// Part of the file that is the mask, where that is not all of it.
    source: Option<MaskSource>,
    invert: bool,
    on_unknown: OnUnknown,
    /// The mask of a file that all frames have in common.
    kept: Mutex<Option<(Frame, Pixels)>>,
}

#[derive(Debug)]
enum Place {
    /// The file of the picture, of which it was read.
    Picture,
    File(PathBuf),
    Files(Pattern),
}

impl Place {
    fn of(path: &Path) -> Result<Self> {
        Ok(Pattern::new(path)?.map_or_else(|| Self::File(path.to_owned()), Self::Files))
    }
}

/// Data and display windows of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    data: Window,
    display: Window,
}

impl Masks {
    /// The masks that were asked for; layers and Cryptomattes are in the files `from`, or in those of the pictures.
    ///
    /// # Errors
    /// [`Error::Input`] for names of files that have several places for a number.
    pub fn new(choices: &[MaskChoice], from: Option<&Path>, on_unknown: OnUnknown) -> Result<Self> {
        let mask = |choice: &MaskChoice| {
            let (place, source) = match (&choice.source, from) {
                (MaskSource::File(path), _) => (Place::of(path)?, None),
                (source, Some(from)) => (Place::of(from)?, Some(source.clone())),
                (_, None) => (Place::Picture, None),
            };
            Ok(Mask { place, source, invert: choice.invert, on_unknown, kept: Mutex::new(None) })
        };
        Ok(Self {
            masks: choices.iter().map(mask).collect::<Result<_>>()?,
            maps: Vec::new(),
            materials: Vec::new(),
            rules: Vec::new(),
            space: None,
        })
    }

    /// The same with painted maps, each of a file, or of one for each frame, for pictures in a space that `space` names, or
    /// that their files say.
    ///
    /// # Errors
    /// As [`Masks::new`].
    pub fn with_maps(self, paths: &[(&'static Painted, &Path)], space: Option<Space>) -> Result<Self> {
        let map = |(kind, path): &(&'static Painted, &Path)| {
            Ok(Map { kind, place: Place::of(path)?, space, kept: Mutex::new(None) })
        };
        Ok(Self { maps: paths.iter().map(map).collect::<Result<_>>()?, ..self })
    }

    /// The same with materials.
    #[must_use]
    pub fn with_materials(self, materials: Vec<Laid>) -> Self {
        Self { materials, ..self }
    }

    /// The same with rules for things, of which the last choices say where they are, for pictures in a space that `space` names,
    /// or that their files say.
    #[must_use]
    pub fn with_rules(self, rules: Vec<Rule>, space: Option<Space>) -> Self {
        Self { rules, space, ..self }
    }

    /// Makes sure that all frames have their files; those of a video are not known.
    ///
    /// # Errors
    /// [`Error::Input`] naming files that are missing.
    pub fn check(&self, tasks: Option<&Tasks>) -> Result<()> {
        let masks = self.masks.iter().map(|mask| (&mask.place, "masks".to_owned()));
        let maps = self.maps.iter().map(|map| (&map.place, map.kind.names()));
        for (place, what) in masks.chain(maps) {
            match (place, tasks) {
                (Place::Files(pattern), Some(tasks)) if !tasks.is_sequence() => {
                    let problem = format!("names {what} by frame, and there is one picture");
                    return Err(Error::file(&pattern.file(0), problem, "name one file"));
                }
                (Place::Files(pattern), Some(tasks)) => {
                    let frames = tasks.ready.iter().filter_map(|task| task.frame);
                    let missing: Vec<i64> = frames.filter(|frame| !pattern.file(*frame).is_file()).collect();
                    if let Some(first) = missing.first() {
                        let problem = format!(
                            "is no file; {what} of the frames {} are missing",
                            frames::summary(&missing)
                        );
                        return Err(Error::file(
                            &pattern.file(*first),
                            problem,
                            format!("give other --frames, or other {what}"),
                        ));
                    }
                }
                (Place::File(path), _) => Unread::open(path).map(drop)?,
                (Place::Files(_), None) | (Place::Picture, _) => {}
            }
        }
        Ok(())
    }

    /// Completes the masks of a frame, which is refused for want of one.
    ///
    /// # Errors
    /// [`Error::Failure`] where memory is short.
    pub fn add(&self, source: &mut Source, number: Option<i64>) -> Result<()> {
        for picture in &mut source.pictures {
            let frame = Frame {
                data: picture.window(),
                display: picture.meaning.display.unwrap_or(picture.window()),
            };
            for map in &self.maps {
                let id = map.kind.guide.id();
                match map.of_frame(number, frame, &picture.meaning) {
                    Ok(pixels) => {
                        picture.guides.retain(|(name, _)| *name != id);
                        picture.guides.push((id, with_alpha_of(&picture.pixels, pixels)));
                    }
                    Err(error @ Error::Failure { .. }) => return Err(error),
                    Err(error) => {
                        picture.refused.get_or_insert(error);
                    }
                }
            }
            self.materials.iter().for_each(|material| material.lay(picture));
            picture.masks.resize(self.masks.len(), None);
            for (mask, slot) in self.masks.iter().zip(&mut picture.masks) {
                let path = match &mask.place {
                    Place::Picture => {
                        *slot = slot.take().map(|values| mask.finished(values));
                        continue;
                    }
                    Place::File(path) => path.clone(),
                    Place::Files(pattern) => pattern.file(number.unwrap_or_default()),
                };
                match mask.of_file(&path, frame) {
                    Ok(pixels) => *slot = Some(pixels),
                    Err(error @ Error::Failure { .. }) => return Err(error),
                    Err(error) => {
                        picture.refused.get_or_insert(error);
                    }
                }
            }
            self.follow_rules(picture);
        }
        Ok(())
    }

    /// Makes a control map of the rules for things, and colours of lines.
    fn follow_rules(&self, picture: &mut Picture) {
        let guide = |wanted: Guide| {
            let found = picture.guides.iter().find(|(name, _)| *name == wanted.id());
            found.map(|(_, pixels)| pixels.to_f32())
        };
        let first = self.masks.len() - self.rules.len();
        let coverage: Vec<Option<Vec<f32>>> =
            picture.masks[first..].iter().map(|mask| mask.as_ref().map(Pixels::to_f32)).collect();
        if coverage.iter().all(Option::is_none) {
            return;
        }
        let coverage: Vec<Option<&[f32]>> = coverage.iter().map(Option::as_deref).collect();
        let (size, depth) = ((picture.pixels.width(), picture.pixels.height()), guide(Guide::Depth));
        let ruled = Ruled { rules: &self.rules, coverage: &coverage, size, depth: depth.as_deref() };
        let (control, paint) = (guide(Guide::Control), guide(Guide::LinePaint));
        let meaning = of_guides(&picture.meaning, self.space);
        let made = [
            (Guide::Control, ruled.control(control.as_deref())),
            (Guide::LinePaint, ruled.line_paint(&meaning, paint.as_deref())),
        ];
        for (guide, map) in made.into_iter().filter_map(|(guide, map)| Some((guide, map?))) {
            picture.guides.retain(|(name, _)| *name != guide.id());
            picture.guides.push((guide.id(), map));
        }
    }
}

impl Mask {
    /// The mask that a file holds for a picture of this frame.
    fn of_file(&self, path: &Path, frame: Frame) -> Result<Pixels> {
        of_file(&self.kept, &self.place, &frame, || Ok(self.finished(self.read(path, frame)?)))
    }

    /// Mask in a file, in the size of a picture.
    fn read(&self, path: &Path, frame: Frame) -> Result<Pixels> {
        let unread = Unread::open(path)?;
        let opened = match unread.any(path)? {
            read::Any::Exr(bytes) => {
                let wanted = (self.source.as_ref(), self.on_unknown);
                return exr::mask_of(path, bytes, wanted, |data, display| frame.place(data, display));
            }
            read::Any::Other(_) if self.source.is_some() => {
                return Err(Error::file(
                    path,
                    "is no EXR file, and has no layers",
                    "name an EXR file, or a mask of its own",
                ));
            }
            read::Any::Other(opened) => opened,
        };
        let mut window = frame.data;
        // Told before all of it is decoded.
        if let Some((width, height)) = opened.size() {
            window = placed(path, frame, (width, height))?;
        }
        let source = opened.decode(path)?;
        let Some(Picture { pixels, .. }) = source.pictures.into_iter().next() else {
            return Err(Error::file(path, "is empty", "name another mask"));
        };
        // A camera's attitude may have turned it.
        let size = (pixels.width(), pixels.height());
        if size != (window.width as u32, window.height as u32) {
            window = placed(path, frame, size)?;
        }
        placed_over(&pixels, window)
            .ok_or_else(|| Error::file(path, "does not hold as many pixels as it says", "name another mask"))
    }

    fn finished(&self, values: Pixels) -> Pixels {
        let cut = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) };
        let turned = |value: f32| if self.invert { 1.0 - cut(value) } else { cut(value) };
        let numbers = values.to_f32().into_iter().map(turned).collect();
        // As many as there were.
        Pixels::new(values.width(), values.height(), 1, Samples::F32(numbers)).unwrap_or(values)
    }
}

impl Map {
    /// The map of a frame whose numbers have this meaning.
    fn of_frame(&self, number: Option<i64>, frame: Frame, meaning: &Meaning) -> Result<Pixels> {
        let path = match &self.place {
            Place::Files(pattern) => pattern.file(number.unwrap_or_default()),
            Place::File(path) => path.clone(),
            Place::Picture => PathBuf::new(),
        };
        let meaning = self.kind.is_colour.then(|| of_guides(meaning, self.space));
        let of = (frame, meaning);
        of_file(&self.kept, &self.place, &of, || self.kind.read(&path, frame, of.1.as_ref()))
    }
}

impl Painted {
    /// Map in a file, in the size of a picture and in colours of this meaning.
    fn read(&self, path: &Path, frame: Frame, meaning: Option<&Meaning>) -> Result<Pixels> {
        let another = format!("name another {}", self.name);
        let source = read::open(path, &Selection::default())?.decode(path)?;
        let Some(picture) = source.pictures.into_iter().next() else {
            return Err(Error::file(path, "is empty", another));
        };
        let own = picture.window();
        let window = frame.place(own, picture.meaning.display).map_err(|problem| {
            Error::file(path, problem, format!("make {} of the picture's size", self.names()))
        })?;
        let pixels = match self.wanted {
            Some(wanted) if picture.pixels.channels() < 3 => {
                return Err(Error::file(path, wanted, "name a picture of colours"));
            }
            _ => in_colours(picture.pixels),
        };
        let (channels, numbers) = (pixels.channels() as usize, pixels.to_f32());
        let is_unpainted = channels == 3
            || self.is_plain_opaque && numbers.chunks_exact(channels).all(|pixel| pixel[channels - 1] >= 1.0);
        // Light without an alpha has that of its picture. Beside the map nothing is painted.
        let stride = if self.guide.is_light() { channels } else { 4 };
        let mut map = vec![self.nothing; window.width * window.height * stride];
        for y in 0..window.height {
            for x in 0..window.width {
                let (column, row) =
                    (i64::from(window.x - own.x) + x as i64, i64::from(window.y - own.y) + y as i64);
                if (0..own.width as i64).contains(&column) && (0..own.height as i64).contains(&row) {
                    let from =
                        &numbers[(row as usize * own.width + column as usize) * channels..][..channels];
                    let to = &mut map[(y * window.width + x) * stride..][..stride];
                    to[..channels].copy_from_slice(from);
                    if is_unpainted && stride == 4 {
                        to[3] = self.opaque;
                    }
                }
            }
        }
        let map = Pixels::new(window.width as u32, window.height as u32, stride as u32, Samples::F32(map))
            .ok_or_else(|| Error::file(path, "does not hold as many pixels as it says", another))?;
        Ok(match meaning.and_then(|meaning| Conversion::between(&picture.meaning, meaning)) {
            Some(change) => change.apply(&map).0,
            None => map,
        })
    }
}

/// A map with the alpha of its picture, where it has none.
fn with_alpha_of(picture: &Pixels, map: Pixels) -> Pixels {
    let channels = picture.channels() as usize;
    if map.channels() != 3 || channels != 4 {
        return map;
    }
    let (alpha, colours) = (picture.to_f32().into_iter().skip(3).step_by(channels), map.to_f32());
    let numbers = colours.as_chunks::<3>().0.iter().zip(alpha).flat_map(|([r, g, b], a)| [*r, *g, *b, a]);
    // As many samples as the size says.
    let made = Pixels::new(map.width(), map.height(), 4, Samples::F32(numbers.collect()));
    made.unwrap_or(map)
}

/// A picture with three channels of colour, which greys have alike.
fn in_colours(pixels: Pixels) -> Pixels {
    let (channels, numbers) = match pixels.channels() {
        1 => (3, pixels.to_f32().into_iter().flat_map(|v| [v; 3]).collect()),
        2 => (4, pixels.to_f32().as_chunks::<2>().0.iter().flat_map(|[v, a]| [*v, *v, *v, *a]).collect()),
        _ => return pixels,
    };
    // As many samples as the size says.
    Pixels::new(pixels.width(), pixels.height(), channels, Samples::F32(numbers)).unwrap_or(pixels)
}

/// Map that a file holds for a picture of this frame: as it was kept, or as it is read, and kept where all frames have it in
/// common.
fn of_file<Of: Clone + PartialEq>(
    kept: &Mutex<Option<(Of, Pixels)>>,
    place: &Place,
    of: &Of,
    read: impl FnOnce() -> Result<Pixels>,
) -> Result<Pixels> {
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, pixels)) = kept.as_ref().filter(|(known, _)| known == of) {
        return Ok(pixels.clone());
    }
    let pixels = read()?;
    if matches!(place, Place::File(_)) {
        *kept = Some((of.clone(), pixels.clone()));
    }
    Ok(pixels)
}

impl Frame {
    /// Window of a mask that belongs to the picture: the same part of the display, or else all of it.
    fn place(self, data: Window, display: Option<Window>) -> std::result::Result<Window, String> {
        let display = display.unwrap_or(data);
        let size = |window: Window| (window.width, window.height);
        if size(display) == size(self.display) {
            let moved = |from: i32, to: i32, at: i32| i64::from(at) - i64::from(from) + i64::from(to);
            let x = moved(self.display.x, display.x, self.data.x);
            let y = moved(self.display.y, display.y, self.data.y);
            if let (Ok(x), Ok(y)) = (i32::try_from(x), i32::try_from(y)) {
                return Ok(Window { x, y, ..self.data });
            }
        }
        if size(data) == size(self.data) {
            return Ok(data);
        }
        let ((width, height), (wide, high)) = (size(display), size(self.display));
        Err(format!("shows {width}x{height} pixels, and the picture {wide}x{high}"))
    }
}

/// The luminance of a picture over a window; 0 where it has no pixels.
fn placed_over(pixels: &Pixels, window: Window) -> Option<Pixels> {
    let numbers = pixels.to_f32();
    let grey = |pixel: &[f32]| match *pixel {
        [r, g, b, ..] if r == g && g == b => r,
        [r, g, b, ..] => 0.2126 * r + 0.7152 * g + 0.0722 * b,
        [v, ..] => v,
        [] => 0.0,
    };
    let channels = pixels.channels() as usize;
    let mut mask = vec![0.0; window.width * window.height];
    let own = Window { x: 0, y: 0, width: pixels.width() as usize, height: pixels.height() as usize };
    exr::add(&mut mask, window, own, |at| grey(&numbers[at * channels..][..channels]));
    Pixels::new(window.width as u32, window.height as u32, 1, Samples::F32(mask))
}

/// The window of a file of so many pixels.
fn placed(path: &Path, frame: Frame, (width, height): (u32, u32)) -> Result<Window> {
    let own = Window { x: 0, y: 0, width: width as usize, height: height as usize };
    frame.place(own, None).map_err(|problem| Error::file(path, problem, "make masks of the picture's size"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_lie_over_the_same_part_of_the_display() {
        let window = |x, y, width, height| Window { x, y, width, height };
        let frame = Frame { data: window(10, 20, 5, 4), display: window(0, 0, 100, 50) };
        // Of the whole display, of a part of it, of a display that begins elsewhere, and of the picture's own pixels.
        assert_eq!(frame.place(window(0, 0, 100, 50), None), Ok(window(10, 20, 5, 4)));
        assert_eq!(frame.place(window(3, 3, 9, 9), Some(window(0, 0, 100, 50))), Ok(window(10, 20, 5, 4)));
        assert_eq!(frame.place(window(3, 3, 9, 9), Some(window(-1, 2, 100, 50))), Ok(window(9, 22, 5, 4)));
        assert_eq!(frame.place(window(0, 0, 5, 4), None), Ok(window(0, 0, 5, 4)));
        assert!(frame.place(window(0, 0, 50, 25), None).is_err_and(|e| e.contains("50x25")));
    }
}
