//! Palettes: lists of colours in files of painting programs, and colours that are found in pictures.
//!
//! | file | what is read |
//! |---|---|
//! | `.gpl` | GIMP, and what Inkscape, Krita and Aseprite write for it |
//! | `.hex`, `.txt` | hexadecimal numbers, as Lospec and Paint.NET write them |
//! | `.pal` | Paint Shop Pro (`JASC-PAL`) |
//! | `.json` | a list of colours as text, or an object with one as its `colors` |
//! | `.ase` | Adobe's swatches for exchange: RGB, grey, CMYK, Lab |
//! | `.aco` | Photoshop's colour swatches, versions 1 and 2: RGB, HSB, CMYK, Lab, grey |
//! | a picture of few colours | all of them, by rows |
//! | any other picture | the middles of clusters, the darkest first |
//!
//! Files are recognized by their first bytes, and names count for nothing.

mod adobe;
mod clusters;
mod spaces;
mod text;

use std::collections::HashSet;
use std::io::Read;
use std::path::Path;

pub use self::spaces::{Colour, hex};

use self::adobe::Swatches;
use self::spaces::rounded;
use crate::convert::Conversion;
use crate::exr::Selection;
use crate::meaning::Meaning;
use crate::pixels::Pixels;
use crate::read;
use crate::resize::resized;
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_files::{frames, input};

/// Colours that are found in a picture unless another number is asked for.
pub const USUAL: usize = 8;
/// Most colours of a palette that is read.
pub const MOST: usize = 4096;
/// Most bytes of a file that is no picture.
const MOST_BYTES: u64 = 16 << 20;
/// Most colours of a picture that is a palette itself.
const FEW: usize = 64;
/// Longest side of a picture in which clusters are sought, in pixels.
const SIDE: u32 = 256;

/// Way to put most palettes right.
const FIX: &str = "name a palette (.gpl, .hex, .ase, .aco, .pal or .json) or a picture";

/// Way to put right those whose kind is known.
const AGAIN: &str = "use an intact file, or export the palette again, such as .gpl";
/// Kind of a text that is of no other.
const LIST: &str = "a list of colours";

/// Colours of a file, each once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Name of the file without its ending.
    pub name: String,
    /// The colours, at least two.
    pub colours: Vec<Colour>,
    /// What is to be said of them, as sentences after the file's name.
    pub notes: Vec<String>,
}

/// Limits of what is read.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Number of colours; without it all of a palette, and [`USUAL`] of a picture.
    pub count: Option<usize>,
    /// Most colours, which larger palettes are reduced to.
    pub most: usize,
}

/// Reads a palette, or finds the colours of a picture.
///
/// # Errors
/// [`Error::Input`] for files that cannot be read, are neither, are damaged, or have fewer than two colours.
pub fn read(path: &Path, wanted: Wanted) -> Result<Palette> {
    let bytes = bytes(path)?;
    let most = wanted.count.unwrap_or(wanted.most).min(wanted.most);
    let mut notes = Vec::new();
    let mut colours = match swatches(path, &bytes)? {
        Some(swatches) => {
            notes.extend(said(&swatches));
            swatches.colours
        }
        None => {
            drop(bytes);
            of_picture(path, wanted.count.unwrap_or(USUAL).min(most))?
        }
    };
    let mut known = HashSet::new();
    colours.retain(|colour| known.insert(*colour));
    match colours.len() {
        0 => return Err(Error::file(path, "has no colours", FIX)),
        1 => return Err(Error::file(path, "has one colour alone", "name a palette of two colours or more")),
        2..=MOST => {}
        more => {
            let problem = format!("has {more} colours, and a palette may have {MOST}");
            return Err(Error::file(path, problem, "name a picture, whose colours are reduced, or fewer"));
        }
    }
    if colours.len() > most {
        notes.push(format!("has {} colours, and {most} of them are taken", colours.len()));
        colours = clusters::reduced(&colours, most);
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Palette { name, colours, notes })
}

/// Writes a palette as a file of GIMP, hexadecimal numbers or JSON, as its name ends.
///
/// # Errors
/// [`Error::Input`] for other endings, and as [`files::write`].
pub fn write(path: &Path, existing: Existing, palette: &Palette) -> Result<()> {
    let Palette { name, colours, .. } = palette;
    let text = match extension(path)?.as_str() {
        "gpl" => text::to_gimp(name, colours),
        "hex" => text::to_numbers(colours),
        _ => text::to_json(name, colours),
    };
    files::write_bytes(path, existing, text.as_bytes())
}

/// The ending of a palette that is written.
///
/// # Errors
/// [`Error::Input`] for others than `.gpl`, `.hex` and `.json`.
pub fn extension(path: &Path) -> Result<String> {
    let own = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match own.as_str() {
        "gpl" | "hex" | "json" => Ok(own),
        _ => Err(Error::file(
            path,
            "is not a kind of palette that is written",
            "name a .gpl, .hex or .json file",
        )),
    }
}

/// The bytes of a file, at most one more than a palette may have.
fn bytes(path: &Path) -> Result<Vec<u8>> {
    let unreadable = |problem: &dyn std::fmt::Display| Error::file(path, problem, FIX);
    let failed = |e: std::io::Error| unreadable(&format_args!("cannot be read: {e}"));
    let (file, found) = input::open(path).map_err(failed)?;
    if found.is_dir() {
        return Err(unreadable(&"is a folder"));
    }
    if !found.is_file() {
        return Err(unreadable(&"is a pipe or a device"));
    }
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.is_empty() {
        return Err(unreadable(&"is empty"));
    }
    Ok(bytes)
}

/// Colours of the bytes of a file; nothing where they are those of no palette.
fn swatches(path: &Path, bytes: &[u8]) -> Result<Option<Swatches>> {
    let plain = |colours| Swatches { colours, ..Swatches::default() };
    let (kind, read) = match bytes {
        _ if bytes.starts_with(adobe::EXCHANGE) => ("Adobe's swatches for exchange", adobe::exchange(bytes)),
        [0, 1 | 2, ..] => ("Photoshop's swatches", adobe::photoshop(bytes)),
        // Both numbers stand behind the length of the file.
        [_, _, _, _, 0xe0, 0xa5, ..] => {
            let fix = "export its palette from Aseprite as .gpl, or the picture as .png";
            return Err(Error::file(path, "is a picture of Aseprite, which is not read", fix));
        }
        [b'#', b'?', ..] => return Ok(None),
        _ => {
            // Names of colours may be of any encoding.
            let text = String::from_utf8_lossy(bytes);
            let text = text.trim_start_matches('\u{feff}').trim_start();
            match () {
                () if text.starts_with(text::GIMP) => ("a palette of GIMP", text::gimp(text).map(plain)),
                () if text.starts_with(text::JASC) => {
                    ("a palette of Paint Shop Pro", text::jasc(text).map(plain))
                }
                () if str::from_utf8(bytes).is_err() || text.contains('\0') => return Ok(None),
                () if text.starts_with(['[', '{']) => ("a palette in JSON", text::of_json(text).map(plain)),
                () => (LIST, text::numbers(text).map(plain)),
            }
        }
    };
    if bytes.len() as u64 > MOST_BYTES {
        let problem = format!("is too large for a palette, with more than {MOST_BYTES} bytes");
        return Err(Error::file(path, problem, FIX));
    }
    let fix = if kind == LIST { FIX } else { AGAIN };
    let wrong = |problem| Error::file(path, format!("cannot be read as {kind}: it {problem}"), fix);
    read.map(Some).map_err(wrong)
}

/// What is to be said of the colours of a file.
fn said(swatches: &Swatches) -> Vec<String> {
    let mut notes = Vec::new();
    if swatches.inks > 0 {
        let count = swatches.inks;
        notes.push(format!("has {count} colours of inks (CMYK) without a profile, which are guessed"));
    }
    if swatches.unread > 0 {
        notes.push(format!("has {} colours of books of inks, which are left out", swatches.unread));
    }
    notes
}

/// Colours of a picture: all where they are few, else `count` that stand for them.
fn of_picture(path: &Path, count: usize) -> Result<Vec<Colour>> {
    let source = match read::read(path, &Selection::default()) {
        Err(Error::Input { .. }) if !frames::is_picture(path) => {
            return Err(Error::file(path, "is no palette of a kind that is read, and no picture", FIX));
        }
        source => source?,
    };
    source.check()?;
    let Some(picture) = source.pictures.into_iter().next() else { return Ok(Vec::new()) };
    let shown = Conversion::between(&picture.meaning, &Meaning::display());
    let pixels = match shown {
        Some(conversion) => conversion.apply(&picture.pixels).0,
        None => picture.pixels,
    };
    if let Some(colours) = few(&pixels) {
        return Ok(colours);
    }
    let (width, height) = (pixels.width(), pixels.height());
    let longest = width.max(height);
    let side = |side: u32| (u64::from(side) * u64::from(SIDE) / u64::from(longest)).max(1) as u32;
    let small = match longest {
        ..=SIDE => pixels,
        _ => resized(&pixels, (side(width), side(height)), false),
    };
    Ok(clusters::found(&opaque(&small).collect::<Vec<_>>(), count))
}

/// The colours of a picture in the order of its rows, each once; nothing where there are more than [`FEW`].
fn few(pixels: &Pixels) -> Option<Vec<Colour>> {
    let (mut known, mut colours) = (HashSet::new(), Vec::new());
    for colour in opaque(pixels) {
        if known.insert(colour) {
            colours.push(colour);
        }
        if colours.len() > FEW {
            return None;
        }
    }
    Some(colours)
}

/// Colours of the pixels that are more opaque than transparent.
fn opaque(pixels: &Pixels) -> impl Iterator<Item = Colour> {
    let (numbers, channels) = (pixels.to_f32(), pixels.channels() as usize);
    let colour = move |at: usize| match numbers.get(at * channels..(at + 1) * channels)? {
        [r, g, b, a] => (*a >= 0.5).then(|| rounded([*r, *g, *b])),
        [r, g, b] => Some(rounded([*r, *g, *b])),
        [v, ..] => Some(rounded([*v; 3])),
        [] => None,
    };
    let count = pixels.width() as usize * pixels.height() as usize;
    (0..count).filter_map(colour)
}

#[cfg(test)]
#[path = "palette/tests.rs"]
mod tests;
