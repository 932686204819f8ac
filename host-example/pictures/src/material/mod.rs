//! Materials that styles draw on and with: paper and hatching, of files and those that ship, as tiles that repeat over a
//! picture.

mod hatchings;
mod papers;
mod shipped;
mod surface;

use std::path::Path;

pub use self::shipped::Shipped;

use self::shipped::SIDE;
use crate::convert::Conversion;
use crate::exr::{Guide, Selection};
use crate::meaning::Meaning;
use crate::pixels::{Pixels, Precision, Samples};
use crate::read;
use crate::resize::resized;
use isophote_files::error::{Error, Result};

/// Height of pictures over which materials lie as large as they are, pixels.
pub const REFERENCE: f64 = 1080.0;

/// Side from which on borders may lie a part of a pixel off when a tile is scaled, for little is seen of them, and much memory
/// would be needed.
const LARGE: u32 = 2048;

/// Kind of material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MaterialKind {
    /// Paper: colours, and a grain of what is lighter and darker.
    Paper,
    /// Hatching: up to four tones, a channel each, 1 where they leave paper.
    Hatching,
}

/// A material: a tile whose right border meets its left one, and its lower border the upper one.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    kind: MaterialKind,
    /// Grey, RGB or RGBA.
    pixels: Pixels,
    meaning: Meaning,
}

impl MaterialKind {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Hatching];

    /// The guide that it is for styles.
    pub fn guide(self) -> Guide {
        match self {
            Self::Paper => Guide::Paper,
            Self::Hatching => Guide::Hatching,
        }
    }

    /// Those that ship.
    pub fn shipped(self) -> &'static [Shipped] {
        match self {
            Self::Paper => &papers::ALL,
            Self::Hatching => &hatchings::ALL,
        }
    }

    /// The material of a name that ships, or of a file.
    ///
    /// # Errors
    /// [`Error::Input`] for files that cannot be read, and for hatching without marks.
    pub fn open(self, name: &Path) -> Result<Material> {
        match self.named(name) {
            Some(shipped) => Ok(Material::of(self, shipped)),
            None => self.read(name),
        }
    }

    /// True for the name of one that ships.
    pub fn ships(self, name: &Path) -> bool {
        self.named(name).is_some()
    }

    fn named(self, name: &Path) -> Option<&'static Shipped> {
        self.shipped().iter().find(|shipped| Path::new(shipped.name) == name)
    }

    fn read(self, path: &Path) -> Result<Material> {
        let another = format!("name a picture, or one of {}", self.names());
        if !path.exists() {
            return Err(Error::file(path, "is no file, and no name of what ships", another));
        }
        let source = read::open(path, &Selection::default())?.decode(path)?;
        let Some(picture) = source.pictures.into_iter().next() else {
            return Err(Error::file(path, "is empty", another));
        };
        let material = Material { kind: self, pixels: picture.pixels, meaning: picture.meaning };
        if self == Self::Hatching && !material.has_marks() {
            let problem = "has no marks: all of it is paper, or all of it is ink";
            return Err(Error::file(
                path,
                problem,
                "draw dark marks on white; of several tones, one in each channel",
            ));
        }
        Ok(material)
    }

    /// Names of those that ship, for people.
    pub fn names(self) -> String {
        self.shipped().iter().map(|shipped| shipped.name).collect::<Vec<_>>().join(", ")
    }
}

impl Material {
    /// One that ships.
    pub fn of(kind: MaterialKind, shipped: &Shipped) -> Self {
        let (side, channels) = (SIDE as u32, if kind == MaterialKind::Paper { 3 } else { 4 });
        let made = Pixels::new(side, side, channels, Samples::U8((shipped.made)()));
        // As many samples as the side says.
        let pixels = made.unwrap_or_else(|| Pixels::zeroed(side, side, channels, Precision::U8));
        Self { kind, pixels, meaning: Meaning::display() }
    }

    /// The kind that it is.
    pub fn kind(&self) -> MaterialKind {
        self.kind
    }

    /// Its tile.
    pub fn pixels(&self) -> &Pixels {
        &self.pixels
    }

    /// The meaning of its tile's numbers.
    pub fn meaning(&self) -> &Meaning {
        &self.meaning
    }

    /// The material in the colours of a picture, RGBA, at another size: `scale` pixels across and down for one of its own. Of a
    /// tile that reaches farther than `most`, what lies there is left out.
    pub fn scaled(&self, scale: [f64; 2], meaning: &Meaning, most: [i64; 2]) -> Pixels {
        let own = [self.pixels.width(), self.pixels.height()];
        let side = |length: u32, axis: usize| (f64::from(length) * scale[axis]).round().max(1.0) as u32;
        let kept = |axis: usize| {
            // Some more is read at the end.
            let seen = ((most[axis] as f64 / scale[axis]).ceil() + 8.0).min(f64::from(own[axis])) as u32;
            seen.next_multiple_of(whole(own[axis], side(own[axis], axis))).min(own[axis])
        };
        let part = [kept(0), kept(1)];
        let size = [side(part[0], 0), side(part[1], 1)];
        let tile = with_alpha(scaled_part(&self.pixels, part, size, self.meaning.is_premultiplied()));
        match Conversion::between(&self.meaning, meaning) {
            Some(change) if self.kind == MaterialKind::Paper => change.apply(&tile).0,
            _ => tile,
        }
    }

    /// True where some of it is paper, and some is not.
    fn has_marks(&self) -> bool {
        let channels = self.pixels.channels() as usize;
        let values = self.pixels.to_f32();
        (0..channels).any(|channel| {
            let mut tone = values.iter().skip(channel).step_by(channels);
            let first = tone.next().copied().unwrap_or_default();
            tone.any(|value| (value - first).abs() > 0.02)
        })
    }
}

/// Part of a tile, from its corner on, at another size. All of it has borders that still meet.
fn scaled_part(tile: &Pixels, part: [u32; 2], size: [u32; 2], is_premultiplied: bool) -> Pixels {
    if size == part {
        return tiled(tile, size.into(), [0; 2]);
    }
    // With so much of its neighbours around it that filters read nothing else.
    let around = |axis: usize| {
        let (own, size) = (part[axis], size[axis]);
        let more = (4 * own.div_ceil(size) + 4).next_multiple_of(whole(own, size));
        (more, (f64::from(more) * f64::from(size) / f64::from(own)).round() as u32)
    };
    let ((x, left), (y, top)) = (around(0), around(1));
    let wide = tiled(tile, (part[0] + 2 * x, part[1] + 2 * y), [-i64::from(x), -i64::from(y)]);
    let scaled = resized(&wide, (size[0] + 2 * left, size[1] + 2 * top), is_premultiplied);
    tiled(&scaled, size.into(), [left.into(), top.into()])
}

/// Number of pixels of a side that become a whole number of them when it is made as long as `size`; of long sides a pixel.
fn whole(own: u32, size: u32) -> u32 {
    if own > LARGE { 1 } else { own / common_divisor(own, size) }
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// A picture of this size, laid with tiles; its first pixel is that at `corner` of one.
pub fn tiled(tile: &Pixels, (width, height): (u32, u32), corner: [i64; 2]) -> Pixels {
    let samples = match tile.samples() {
        Samples::U8(v) => Samples::U8(repeated(v, tile, (width, height), corner)),
        Samples::U16(v) => Samples::U16(repeated(v, tile, (width, height), corner)),
        Samples::F16(v) => Samples::F16(repeated(v, tile, (width, height), corner)),
        Samples::F32(v) => Samples::F32(repeated(v, tile, (width, height), corner)),
    };
    // As many samples as the size says.
    Pixels::new(width, height, tile.channels(), samples).unwrap_or_else(|| tile.clone())
}

fn repeated<T: Copy>(samples: &[T], tile: &Pixels, (width, height): (u32, u32), corner: [i64; 2]) -> Vec<T> {
    let channels = tile.channels() as usize;
    let [columns, rows] = [tile.width(), tile.height()].map(|side| side as usize);
    let [left, top] =
        [(corner[0], columns), (corner[1], rows)].map(|(at, side)| at.rem_euclid(side as i64) as usize);
    let mut all = Vec::with_capacity(width as usize * height as usize * channels);
    for y in 0..height as usize {
        let row = &samples[(top + y) % rows * columns * channels..][..columns * channels];
        let (mut x, mut left_over) = (left, width as usize);
        while left_over > 0 {
            let run = (columns - x).min(left_over);
            all.extend_from_slice(&row[x * channels..(x + run) * channels]);
            (x, left_over) = (0, left_over - run);
        }
    }
    all
}

/// The same as RGBA.
fn with_alpha(pixels: Pixels) -> Pixels {
    let numbers = pixels.to_f32();
    let numbers = match pixels.channels() {
        1 => numbers.iter().flat_map(|v| [*v, *v, *v, 1.0]).collect(),
        3 => numbers.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 1.0]).collect(),
        _ => return pixels,
    };
    let made = Pixels::new(pixels.width(), pixels.height(), 4, Samples::F32(numbers));
    // As many samples as the size says.
    made.map_or_else(|| pixels.clone(), |made| made.converted(pixels.precision()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tones(pixels: &Pixels) -> Vec<f64> {
        let channels = pixels.channels() as usize;
        let values = pixels.to_f32();
        let mean = |channel: usize| {
            let sum: f32 = values.iter().skip(channel).step_by(channels).sum();
            f64::from(sum) / (values.len() / channels) as f64
        };
        (0..channels).map(mean).collect()
    }

    #[test]
    fn tones_of_hatchings_that_ship_cover_what_they_should_and_hold_the_lighter_ones() {
        for shipped in MaterialKind::Hatching.shipped() {
            let pixels = Material::of(MaterialKind::Hatching, shipped).pixels;
            for (tone, share) in tones(&pixels).into_iter().zip([0.14, 0.31, 0.52, 0.76]) {
                assert!((1.0 - tone - share).abs() < 0.015, "{}: {tone} for {share}", shipped.name);
            }
            let Samples::U8(values) = pixels.samples() else { panic!() };
            assert!(
                values.as_chunks::<4>().0.iter().all(|v| v.is_sorted_by(|a, b| a >= b)),
                "{}",
                shipped.name
            );
        }
    }

    #[test]
    fn borders_of_what_ships_meet_at_any_size() {
        for kind in MaterialKind::ALL {
            for shipped in kind.shipped() {
                let material = Material::of(kind, shipped);
                // Scaled, one of a kind stands for all.
                let is_first = shipped.name == kind.shipped()[0].name;
                for size in [1.0, 1.3333, 0.37].into_iter().take(if is_first { 3 } else { 1 }) {
                    let tile = material.scaled([size; 2], &Meaning::display(), [i64::MAX; 2]);
                    let (width, height) = (tile.width(), tile.height());
                    let wide = tiled(&tile, (width + 2, height + 2), [-1, -1]);
                    let (values, channels) = (wide.to_f32(), wide.channels() as usize);
                    let at = |x: u32, y: u32| f64::from(values[((y * (width + 2) + x) as usize) * channels]);
                    // Steps from a column to the next, and from a row to the next.
                    let across =
                        |x: u32| (1..=height).map(|y| (at(x + 1, y) - at(x, y)).powi(2)).sum::<f64>();
                    let down = |y: u32| (1..=width).map(|x| (at(x, y + 1) - at(x, y)).powi(2)).sum::<f64>();
                    let inner =
                        |step: &dyn Fn(u32) -> f64, side: u32| (1..side).map(step).fold(0.0, f64::max);
                    assert!(
                        across(width) <= 1.3 * inner(&across, width),
                        "{} across at {size}",
                        shipped.name
                    );
                    assert!(down(height) <= 1.3 * inner(&down, height), "{} down at {size}", shipped.name);
                }
            }
        }
    }

    #[test]
    fn papers_of_files_come_in_the_colours_of_the_picture() {
        let pixels = Pixels::new(1, 1, 3, Samples::U8(vec![188, 188, 188])).unwrap();
        let paper =
            Material { kind: MaterialKind::Paper, pixels: pixels.clone(), meaning: Meaning::display() };
        let light = paper.scaled([1.0; 2], &Meaning::light(), [1; 2]).to_f32();
        assert!((light[0] - 0.503).abs() < 0.002, "{light:?}");
        let tones = Material { kind: MaterialKind::Hatching, ..paper };
        assert_eq!(tones.scaled([1.0; 2], &Meaning::light(), [1; 2]), with_alpha(pixels));
        assert!(!tones.has_marks());
    }

    #[test]
    fn of_large_tiles_only_what_is_seen_is_scaled() {
        let material = Material::of(MaterialKind::Paper, &MaterialKind::Paper.shipped()[0]);
        for scale in [2.0, 0.73] {
            let scaled = |most| material.scaled([scale; 2], &Meaning::display(), most);
            let (part, whole) = (scaled([90, 61]), scaled([i64::MAX; 2]));
            assert!(part.width() < 200 && part.height() < 200 && whole.width() > 300);
            assert_eq!(tiled(&part, (90, 61), [0; 2]), tiled(&whole, (90, 61), [0; 2]), "{scale}");
        }
    }
}
