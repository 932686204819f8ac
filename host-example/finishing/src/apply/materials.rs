//! Paper and hatching of a run, laid over its pictures.
//!
//! They lie on the display window from its corner, as large as their pixels on 1080 lines, so that frames of any size show the
//! same sheet.

use std::sync::{Mutex, PoisonError};

use isophote_pictures::exr::Picture;
use isophote_pictures::material::{Material, REFERENCE, tiled};
use isophote_pictures::meaning::{Alpha, Meaning};
use isophote_pictures::pixels::Pixels;
use isophote_pictures::space::Space;

/// Materials over a frame of a renderer, whose colours are linear light of Rec.709, by the names of guides.
pub fn on_frame<'m>(
    materials: impl IntoIterator<Item = &'m Material>,
    size: (u32, u32),
) -> Vec<(&'static str, Pixels)> {
    let scale = f64::from(size.1) / REFERENCE;
    let over = |material: &Material| {
        let most = [size.0, size.1].map(i64::from);
        let tile = material.scaled([scale; 2], &Meaning::light(), most);
        (material.kind().guide().id(), tiled(&tile, size, [0; 2]))
    };
    materials.into_iter().map(over).collect()
}

/// Meaning of colours beside a picture's own, of which `space` may name the space.
pub(super) fn of_guides(picture: &Meaning, space: Option<Space>) -> Meaning {
    let meaning = picture.clone().named(space);
    let alpha = if meaning.is_premultiplied() { Alpha::Premultiplied } else { Alpha::Straight };
    Meaning { alpha, data: None, display: None, ..meaning }
}

/// Tile of the pictures before.
#[derive(Debug)]
struct Tile {
    scale: [f64; 2],
    /// Meaning of its numbers.
    meaning: Meaning,
    /// Columns and rows from its corner on that are there, at least.
    most: [i64; 2],
    pixels: Pixels,
}

/// A material that lies on all pictures of a run.
#[derive(Debug)]
pub struct Laid {
    material: Material,
    /// Space that somebody names for the pictures.
    space: Option<Space>,
    tile: Mutex<Option<Tile>>,
}

impl Laid {
    /// A material on pictures whose numbers mean what `space` names, or what their files say.
    pub fn new(material: Material, space: Option<Space>) -> Self {
        Self { material, space, tile: Mutex::default() }
    }

    /// Lays it over a picture.
    pub fn lay(&self, picture: &mut Picture) {
        let (id, pixels) = (self.material.kind().guide().id(), self.over(picture));
        picture.guides.retain(|(name, _)| *name != id);
        picture.guides.push((id, pixels));
    }

    /// The material over all pixels of a picture, in its colours.
    fn over(&self, picture: &Picture) -> Pixels {
        let window = picture.window();
        let display = picture.meaning.display.unwrap_or(window);
        let scale = display.height as f64 / REFERENCE;
        let scale = [scale / f64::from(picture.meaning.pixel_aspect), scale];
        let meaning = of_guides(&picture.meaning, self.space);
        let corner = [i64::from(window.x) - i64::from(display.x), i64::from(window.y) - i64::from(display.y)];
        let size = (window.width as u32, window.height as u32);
        // What lies left of the corner or above it, or frames that move, need all of the tile.
        let ends = [corner[0] + window.width as i64, corner[1] + window.height as i64];
        let most = if corner == [0; 2] { ends } else { [i64::MAX; 2] };
        let mut kept = self.tile.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |of: &Tile| (of.scale, &of.meaning, of.most) == (scale, &meaning, most);
        if let Some(tile) = kept.as_ref().filter(|tile| is_same(tile)) {
            return tiled(&tile.pixels, size, corner);
        }
        let pixels = self.material.scaled(scale, &meaning, most);
        let over = tiled(&pixels, size, corner);
        *kept = Some(Tile { scale, meaning, most, pixels });
        over
    }
}
