//! Contact sheets: pictures side by side with their names under them.
//!
//! Everything is shown as displays show it: light is encoded for sRGB, what is brighter than white is white, and
//! transparent parts show the sheet.

use std::path::Path;

use embedded_graphics::Drawable;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_1::FONT_9X18;
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::text::{Baseline, Text};
use image::imageops::{FilterType, resize};
use image::{ImageBuffer, Rgb, RgbImage, Rgba};

use crate::apply::square;
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};
use isophote_pictures::convert::Conversion;
use isophote_pictures::exr::Selection;
use isophote_pictures::meaning::Meaning;
use isophote_pictures::pixels::MOST_PIXELS;
use isophote_pictures::read;

/// Pixels between and around pictures.
const GAP: u32 = 12;
/// Height of a line of text with its margins.
const LINE: u32 = 26;
/// Columns of a letter.
const LETTER: u32 = FONT_9X18.character_size.width;
/// The sheet: dark enough to let pictures glow, light enough for black ones to have a border.
const GROUND: [u8; 3] = [46, 46, 48];

/// A picture with its label.
pub struct Cell {
    picture: RgbImage,
    label: String,
}

/// The picture of a file, or those of its views, `width` pixels wide.
///
/// # Errors
/// [`Error::Input`] for pictures that cannot be read.
pub fn cells(path: &Path, label: &str, width: u32) -> Result<Vec<Cell>> {
    let source = read::read(path, &Selection::default())?;
    let several = source.pictures.len() > 1;
    let mut cells = Vec::with_capacity(source.pictures.len());
    for (view, picture) in source.pictures.iter().enumerate() {
        let shown = Conversion::between(&picture.meaning, &Meaning::display());
        let changed = shown.map(|conversion| conversion.apply(&picture.pixels).0);
        let pixels = changed.as_ref().unwrap_or(&picture.pixels);
        let (wide, high, channels) = (pixels.width(), pixels.height(), pixels.channels() as usize);
        let mut numbers = Vec::with_capacity(wide as usize * high as usize * 4);
        for pixel in pixels.to_f32().chunks_exact(channels) {
            let (rgb, a) = match *pixel {
                [r, g, b, a] => ([r, g, b], a.clamp(0.0, 1.0)),
                [r, g, b] => ([r, g, b], 1.0),
                [v, ..] => ([v; 3], 1.0),
                [] => continue,
            };
            // A comparison with what is no number is false: such pixels are black.
            numbers.extend(rgb.map(|v| if v > 0.0 { v.min(1.0) * a } else { 0.0 }));
            numbers.push(a);
        }
        let whole = ImageBuffer::<Rgba<f32>, _>::from_raw(wide, high, numbers).ok_or_else(|| {
            Error::file(path, "does not hold as many pixels as it says", "use an intact file")
        })?;
        let across = f64::from(wide) * square::aspect(&picture.meaning);
        let down = ((f64::from(high) * f64::from(width) / across) as u32).clamp(1, 1 << 16);
        // Enlarged pixels are to be seen, reduced ones to be averaged.
        let filter = if width > wide && down >= high { FilterType::Nearest } else { FilterType::Triangle };
        let small = resize(&whole, width, down, filter);
        let picture = RgbImage::from_fn(width, down, |x, y| {
            let Rgba([r, g, b, a]) = *small.get_pixel(x, y);
            let over = |c: f32, ground: u8| (c * 255.0 + (1.0 - a) * f32::from(ground) + 0.5) as u8;
            Rgb([over(r, GROUND[0]), over(g, GROUND[1]), over(b, GROUND[2])])
        });
        let label = if several { format!("{label} ({})", view + 1) } else { label.to_owned() };
        cells.push(Cell { picture, label });
    }
    Ok(cells)
}

/// Writes all cells in rows of `columns`, each `width` pixels wide, as PNG.
///
/// # Errors
/// [`Error::Input`] for sheets that are too large or cannot be written.
pub fn save(path: &Path, existing: Existing, cells: &[Cell], columns: usize, width: u32) -> Result<()> {
    let sheet = arranged(cells, columns, width).ok_or_else(|| {
        Error::input("the sheet", "would be too large", "choose a smaller --width or fewer pictures")
    })?;
    files::write(path, existing, |file| {
        let encoder = image::codecs::png::PngEncoder::new(file);
        sheet.write_with_encoder(encoder).map_err(|e| e.to_string())
    })
}

/// All cells in rows of `columns`, each `width` pixels wide; nothing when that would be too large.
fn arranged(cells: &[Cell], columns: usize, width: u32) -> Option<RgbImage> {
    let rows: Vec<&[Cell]> = cells.chunks(columns.max(1)).collect();
    let heights: Vec<u32> =
        rows.iter().map(|row| row.iter().map(|c| c.picture.height()).max().unwrap_or(1)).collect();
    let across = columns.min(cells.len()) as u64;
    let wide = u64::from(GAP) + across * u64::from(width + GAP);
    let high = u64::from(GAP) + heights.iter().map(|h| u64::from(h + LINE)).sum::<u64>();
    if wide.checked_mul(high).is_none_or(|pixels| pixels > MOST_PIXELS) {
        return None;
    }
    let mut sheet = Sheet(RgbImage::from_pixel(wide as u32, high as u32, Rgb(GROUND)));
    let style = MonoTextStyle::new(&FONT_9X18, Rgb888::WHITE);
    let mut y = GAP;
    for (row, height) in rows.into_iter().zip(heights) {
        for (column, cell) in row.iter().enumerate() {
            let x = GAP + column as u32 * (width + GAP);
            image::imageops::replace(&mut sheet.0, &cell.picture, x.into(), y.into());
            let place = Point::new(x as i32, (y + cell.picture.height() + 3) as i32);
            let label = fitting(&cell.label, (width / LETTER) as usize);
            let Ok(_) = Text::with_baseline(&label, place, style, Baseline::Top).draw(&mut sheet);
        }
        y += height + LINE;
    }
    Some(sheet.0)
}

/// The end of a label, where the frame's number is, as far as it fits.
fn fitting(label: &str, most: usize) -> String {
    let length = label.chars().count();
    if length <= most {
        return label.to_owned();
    }
    let kept = most.saturating_sub(3);
    "...".chars().take(most).chain(label.chars().skip(length - kept)).collect()
}

/// The sheet as something to write on.
struct Sheet(RgbImage);

impl OriginDimensions for Sheet {
    fn size(&self) -> Size {
        Size::new(self.0.width(), self.0.height())
    }
}

impl DrawTarget for Sheet {
    type Color = Rgb888;
    type Error = std::convert::Infallible;

    fn draw_iter<I>(&mut self, pixels: I) -> std::result::Result<(), Self::Error>
    where
        I: IntoIterator<Item = embedded_graphics::Pixel<Self::Color>>,
    {
        for embedded_graphics::Pixel(point, color) in pixels {
            if let (Ok(x), Ok(y)) = (u32::try_from(point.x), u32::try_from(point.y))
                && let Some(pixel) = self.0.get_pixel_mut_checked(x, y)
            {
                *pixel = Rgb([color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_their_end() {
        assert_eq!(fitting("a.1001.exr", 10), "a.1001.exr");
        assert_eq!(fitting("long.name.1001.exr", 11), "...1001.exr");
        assert_eq!(fitting("abcdef", 2), "..");
    }
}
