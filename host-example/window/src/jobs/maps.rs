//! Files of painted maps, as `apply` reads them.

use std::path::Path;
use std::sync::Arc;

use crate::state::painted::channel::Kind;
use crate::state::painted::maps::Maps;
use crate::state::playback::PaintedOver;
use isophote_files::error::{Error, Result};
use isophote_files::files::Existing;
use isophote_files::frames::Pattern;
use isophote_finishing::apply::masks::{MaskChoice, Masks};
use isophote_finishing::apply::painted::PAINTED;
use isophote_pictures::exr::{Guide, MaskSource, OnUnknown};
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::{Pixels, Precision, Samples};
use isophote_pictures::read::Source;
use isophote_pictures::write::{self, Format, Options};

/// Writes a map for a file with a picture of a size as a PNG file, which is replaced whole.
///
/// # Errors
/// [`Error::Input`] for other files, and for places where none can be written.
pub fn write(kind: Kind, maps: &Maps, (width, height): (u32, u32), path: &Path) -> Result<()> {
    if Format::of(path)? != Format::Png {
        return Err(Error::file(
            path,
            "is no PNG file, as which painted maps are saved",
            "end its name in .png",
        ));
    }
    let channels = if kind == Kind::Control { 4 } else { 1 };
    let pixels = Pixels::new(width, height, channels, Samples::U8(maps.bytes(kind, (width, height))));
    let pixels =
        pixels.ok_or_else(|| Error::failure("the map is not as large as it should be", "paint again"))?;
    let (meaning, format) = (Meaning::display(), (Format::Png, Options::default()));
    let source = Source::alone(pixels.clone(), meaning.clone());
    write::write(path, Existing::Replace, format, vec![pixels], &meaning, &source, None)
}

/// Writes a map of all that is painted over a document: as one file, or as one for each frame where frames have maps of their own.
///
/// # Errors
/// As [`write()`]; [`Error::Input`] for a path without a place for a frame's number, and where a file is there that may not be
/// replaced.
pub fn write_all(kind: Kind, over: &PaintedOver, path: &Path, existing: Existing) -> Result<()> {
    let PaintedOver { keys, size, numbers } = over;
    if keys.is_one() {
        let maps = keys.iter().next().map(|(_, maps)| maps);
        return maps.map_or(Ok(()), |maps| write(kind, maps, *size, path));
    }
    let pattern = Pattern::new(path)?.ok_or_else(|| {
        let problem = "is one file, and frames have maps of their own";
        Error::file(path, problem, "write #### where their numbers are to be, as in map.####.png")
    })?;
    let taken = numbers.iter().map(|number| pattern.file(*number)).find(|file| file.exists());
    if let Some(file) = taken.filter(|_| existing == Existing::Keep) {
        return Err(Error::file(&file, "is there already", "choose another name, or remove it"));
    }
    for number in numbers.iter() {
        if let Some(maps) = keys.seen(*number) {
            write(kind, maps, *size, &pattern.file(*number))?;
        }
    }
    Ok(())
}

/// Reads a map for a file with a picture of a size, as one for the picture as it is shown.
///
/// # Errors
/// As [`Masks::add`].
pub fn read(kind: Kind, path: &Path, [file_size, size]: [(u32, u32); 2]) -> Result<Arc<Maps>> {
    let masks = match kind {
        Kind::Mask => {
            let choice = MaskChoice { source: MaskSource::File(path.to_owned()), invert: false };
            Masks::new(&[choice], None, OnUnknown::default())?
        }
        Kind::Control => {
            let painted = PAINTED.iter().find(|painted| painted.guide == Guide::Control);
            let paths: Vec<_> = painted.map(|painted| (painted, path)).into_iter().collect();
            Masks::default().with_maps(&paths, None)?
        }
    };
    let under = Pixels::zeroed(file_size.0, file_size.1, 1, Precision::U8);
    let mut source = Source::alone(under, Meaning::display());
    masks.add(&mut source, None)?;
    let Some(picture) = source.pictures.pop() else { return Ok(Arc::new(Maps::new(size))) };
    if let Some(refused) = picture.refused {
        return Err(refused);
    }
    let guide =
        picture.guides.iter().find(|(name, _)| *name == Guide::Control.id()).map(|(_, pixels)| pixels);
    let numbers = match kind {
        Kind::Control => guide,
        Kind::Mask => picture.masks.first().and_then(Option::as_ref),
    };
    let mut maps = Maps::new(size);
    if let Some(numbers) = numbers {
        maps.take(kind, &numbers.to_f32(), file_size);
    }
    Ok(Arc::new(maps))
}
