//! Square pixels for pictures that have others: nodes know lengths in pixels, the same in every direction, so that marks are round
//! where the picture is shown.

use isophote_files::error::{AtPlace, Result};
use isophote_loader::Library;
use isophote_loader::abi::{ISOPHOTE_ALPHA_PREMULTIPLIED, ISOPHOTE_ALPHA_STRAIGHT, IsophoteAlpha};
use isophote_pictures::exr::OwnPixels;
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::{Pixels, Precision};
use isophote_pictures::read::Source;

/// Advice where the library refuses.
const FIX: &str = "use a smaller picture";

/// Aspect of a picture's pixels that can be one.
pub fn aspect(meaning: &Meaning) -> f64 {
    let aspect = f64::from(meaning.pixel_aspect);
    if (0.01..=100.0).contains(&aspect) { aspect } else { 1.0 }
}

/// True where the pixels of all pictures are square already.
pub fn is_square(source: &Source) -> bool {
    source.pictures.iter().all(|picture| aspect(&picture.meaning) == 1.0)
}

/// Makes the pixels of all pictures square, with their guides and masks. Those that are stay as they are.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for sizes that the library refuses.
pub fn make(library: &Library, name: &str, source: &mut Source) -> Result<()> {
    let refused = |e: isophote_loader::Error| e.at(name, FIX);
    for picture in &mut source.pictures {
        let aspect = aspect(&picture.meaning);
        let size = (picture.pixels.width(), picture.pixels.height());
        let (square, scale) = library.square_size(size, aspect).map_err(refused)?;
        if square == size {
            continue;
        }
        let to_square = To { library, aspect, alpha: alpha(&picture.meaning), size: square };
        let (channels, precision) = (picture.pixels.channels(), picture.pixels.precision());
        let pixels = to_square.made("color", &picture.pixels, (channels, precision)).map_err(refused)?;
        let known = library.guides().map_err(refused)?;
        for (name, guide) in &mut picture.guides {
            let channels = known.iter().find(|known| known.id == *name).map(|known| known.channels);
            let channels = channels.unwrap_or(guide.channels());
            *guide = to_square.made(name, guide, (channels, Precision::F32)).map_err(refused)?;
        }
        for mask in picture.masks.iter_mut().flatten() {
            *mask = to_square.made("mask", mask, (1, Precision::F32)).map_err(refused)?;
        }
        picture.pixels = pixels;
        picture.own = Some(OwnPixels { size, aspect, scale });
    }
    Ok(())
}

/// A result in the pixels that its picture had, with what that says of them.
///
/// # Errors
/// [`isophote_files::error::Error::Input`] for what the library refuses.
pub fn unmake(
    library: &Library,
    name: &str,
    (own, meaning): (&OwnPixels, &Meaning),
    result: &Pixels,
) -> Result<Pixels> {
    let OwnPixels { size, aspect, .. } = *own;
    let mut own = Pixels::zeroed(size.0, size.1, result.channels(), result.precision());
    let how = (aspect, alpha(meaning));
    library.from_square(result, how, &mut own, 0).map_err(|e| e.at(name, FIX))?;
    Ok(own)
}

/// Size in square pixels, for what a frame will need.
///
/// # Errors
/// As [`make`].
pub fn size(library: &Library, name: &str, size: (u32, u32), aspect: f64) -> Result<(u32, u32)> {
    Ok(library.square_size(size, aspect).map_err(|e| e.at(name, FIX))?.0)
}

fn alpha(meaning: &Meaning) -> IsophoteAlpha {
    if meaning.is_premultiplied() { ISOPHOTE_ALPHA_PREMULTIPLIED } else { ISOPHOTE_ALPHA_STRAIGHT }
}

/// The change to square pixels.
struct To<'a> {
    library: &'a Library,
    aspect: f64,
    alpha: IsophoteAlpha,
    size: (u32, u32),
}

impl To<'_> {
    fn made(
        &self,
        input: &str,
        image: &Pixels,
        (channels, precision): (u32, Precision),
    ) -> isophote_loader::Result<Pixels> {
        let mut square = Pixels::zeroed(self.size.0, self.size.1, channels, precision);
        self.library.to_square((input, image), (self.aspect, self.alpha), &mut square, 0)?;
        Ok(square)
    }
}
