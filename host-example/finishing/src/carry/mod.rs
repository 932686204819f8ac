//! Painted maps that are carried along the motion of a shot, from the frames that they were painted on to all others.
//!
//! Between two key frames the maps of both are seen, each the more the nearer it is; before the first and after the last there is
//! one. Where neither is seen, nothing is painted.

pub mod files;
mod places;
mod vectors;

use std::io::{Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

use self::places::{Field, Places};
pub use self::vectors::Vectors;
use isophote_files::error::{Error, Result};
use isophote_pictures::exr::Selection;
use isophote_pictures::pixels::{Pixels, Samples};
use isophote_pictures::read;

/// A map and the frame that it was painted on.
#[derive(Debug)]
pub struct Key {
    /// Number of the frame.
    pub frame: i64,
    map: Pixels,
    /// Numbers where nothing is painted, one a channel.
    nothing: Vec<f32>,
}

/// Frame that was carried to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// Its number.
    pub frame: i64,
    /// Share of it on which nothing is painted, since no map is seen there.
    pub unknown: f32,
}

/// Taker of the maps of all frames.
pub trait Taker {
    /// Goes on or not, which is asked for each frame on the way.
    ///
    /// # Errors
    /// The reason why no more frames are wanted.
    fn goes_on(&self) -> Result<()> {
        Ok(())
    }

    /// Takes the map of a frame; they come in order.
    ///
    /// # Errors
    /// The reason why it cannot be taken, which ends all.
    fn take(&mut self, carried: Carried, map: Pixels) -> Result<()>;
}

impl Key {
    /// A map that was painted on a frame, with numbers of 0 to 1 where nothing is painted, one a channel.
    pub fn new(frame: i64, map: Pixels, nothing: Vec<f32>) -> Self {
        Self { frame, map, nothing }
    }

    /// Reads the maps of frames, as they are stored, all with as many channels.
    ///
    /// # Errors
    /// As [`read::read`]; [`Error::Input`] for control maps among masks.
    pub fn read_all(files: &[(i64, PathBuf)]) -> Result<Vec<Self>> {
        let read = |(frame, path): &(i64, PathBuf)| {
            let mut source = read::read(path, &Selection::default())?;
            let picture = source.pictures.drain(..).next();
            let pixels = picture.ok_or_else(|| Error::file(path, "is empty", "name another map"))?.pixels;
            Ok(Self::new(*frame, without_plain_alpha(pixels), Vec::new()))
        };
        let mut keys: Vec<Self> = files.iter().map(read).collect::<Result<_>>()?;
        let most = keys.iter().map(|key| key.map.channels()).max().unwrap_or_default();
        for (key, (_, path)) in keys.iter_mut().zip(files) {
            match (key.map.channels(), most) {
                (own, most) if own == most => {}
                (3, 4) => key.map = with_neutral_alpha(&key.map),
                _ => {
                    let problem = "is grey as masks are, and others are control maps";
                    return Err(Error::file(path, problem, "carry masks by themselves"));
                }
            }
            // Control maps have colours, and their half is neutral; masks are grey.
            key.nothing = vec![if most >= 3 { 0.5 } else { 0.0 }; most as usize];
        }
        Ok(keys)
    }

    fn size(&self) -> (u32, u32) {
        (self.map.width(), self.map.height())
    }

    /// The map of another frame by its numbers, 32 bits a channel; where they are none, nothing is painted.
    fn filled(&self, numbers: Vec<f32>) -> Result<Pixels> {
        let (width, height) = self.size();
        let nothing = self.nothing.iter().cycle();
        let numbers = numbers.into_iter().zip(nothing);
        let numbers = numbers.map(|(value, nothing)| if value.is_nan() { *nothing } else { value }).collect();
        let pixels = Pixels::new(width, height, self.map.channels(), Samples::F32(numbers));
        pixels.ok_or_else(|| Error::failure("a map is not as large as it should be", "report it"))
    }
}

/// The same pixels without alpha that is 1 everywhere, which is that of a file on which nobody painted it.
fn without_plain_alpha(pixels: Pixels) -> Pixels {
    let channels = pixels.channels() as usize;
    let numbers = pixels.to_f32();
    if channels != 4 || numbers.chunks_exact(4).any(|pixel| pixel[3] < 1.0) {
        return pixels;
    }
    let three = numbers.chunks_exact(4).flat_map(|pixel| pixel[..3].iter().copied()).collect();
    let (width, height, precision) = (pixels.width(), pixels.height(), pixels.precision());
    Pixels::new(width, height, 3, Samples::F32(three)).map_or(pixels, |pixels| pixels.converted(precision))
}

/// The same pixels with alpha that changes nothing.
fn with_neutral_alpha(pixels: &Pixels) -> Pixels {
    let numbers = pixels.to_f32();
    let four = numbers.as_chunks::<3>().0.iter().flat_map(|[r, g, b]| [*r, *g, *b, 0.5]).collect();
    let made = Pixels::new(pixels.width(), pixels.height(), 4, Samples::F32(four));
    made.map_or_else(|| pixels.clone(), |made| made.converted(pixels.precision()))
}

/// Frames, and what is painted on some of them.
pub struct Shot<'s> {
    /// Numbers of its frames, in order.
    pub frames: &'s [i64],
    /// Maps of some of them, in order, at least one.
    pub keys: &'s [Key],
}

impl Shot<'_> {
    /// Carries the maps to all frames.
    ///
    /// # Errors
    /// [`Error::Input`] for maps of other sizes and frames without vectors; as reading, and those of the taker.
    pub fn carry(&self, vectors: &mut Vectors, taker: &mut dyn Taker) -> Result<()> {
        for key in self.keys {
            let (size, map) = (vectors.size(key.frame)?, key.size());
            if size != map {
                let problem = format!("has {}x{} pixels, and its map {}x{}", size.0, size.1, map.0, map.1);
                return Err(Error::input(
                    format!("frame {}", key.frame),
                    problem,
                    "paint maps of the frames' size",
                ));
            }
        }
        // Before anything is made.
        if let Some(pair) = self.frames.windows(2).find(|pair| pair[1] != pair[0] + 1) {
            let problem = format!("has no frame {}, and motion leads from frame to frame", pair[0] + 1);
            return Err(Error::input(
                "the shot",
                problem,
                "render it, or carry what is before and after by itself",
            ));
        }
        if let (Some(key), [first, second, ..]) = (self.keys.first(), self.frames) {
            let beside = if key.frame == *first { second } else { first };
            let there = if key.frame == *first { *first } else { *second };
            between(vectors, *beside, there)?;
        }
        let ends = self.keys.iter().map(Some).chain([None]);
        let mut before: Option<&Key> = None;
        for after in ends {
            let from = before.map_or(i64::MIN, |key| key.frame + 1);
            let to = after.map_or(i64::MAX, |key| key.frame - 1);
            let between: Vec<i64> =
                self.frames.iter().copied().filter(|frame| (from..=to).contains(frame)).collect();
            self.span((before, after), &between, vectors, taker)?;
            if let Some(key) = after {
                taker.take(Carried { frame: key.frame, unknown: 0.0 }, key.map.clone())?;
            }
            before = after;
        }
        Ok(())
    }

    /// Carries maps to the frames between two key frames, or at an end.
    fn span(
        &self,
        (before, after): (Option<&Key>, Option<&Key>),
        frames: &[i64],
        vectors: &mut Vectors,
        taker: &mut dyn Taker,
    ) -> Result<()> {
        let Some(key) = before.or(after).filter(|_| !frames.is_empty()) else { return Ok(()) };
        let backward: Vec<i64> = frames.iter().rev().copied().collect();
        // From the key frame after, last frame first, to be read in the other order.
        let mut later = match after {
            Some(after) => Some(stored(after, &backward, vectors, taker)?),
            None => None,
        };
        let mut places = before.map(|before| (before, Walk::from(before)));
        for (index, frame) in frames.iter().enumerate() {
            taker.goes_on()?;
            let first = match &mut places {
                Some((key, walk)) => Some(walk.to(*frame, vectors)?.seen(&key.map)),
                None => None,
            };
            let last = match &mut later {
                Some(stored) => Some(stored.read(frames.len() - 1 - index)?),
                None => None,
            };
            // The nearer of both keys counts for more.
            let share = match (before, after) {
                (Some(before), Some(after)) => {
                    (frame - before.frame) as f32 / (after.frame - before.frame) as f32
                }
                (None, _) => 1.0,
                (_, None) => 0.0,
            };
            let mixed = mixed(first, last, share);
            let unknown =
                mixed.iter().filter(|value| value.is_nan()).count() as f32 / mixed.len().max(1) as f32;
            taker.take(Carried { frame: *frame, unknown }, key.filled(mixed)?)?;
        }
        Ok(())
    }
}

/// A key frame's map as each of the frames sees it.
fn stored(key: &Key, frames: &[i64], vectors: &mut Vectors, taker: &dyn Taker) -> Result<Stored> {
    let (width, height) = key.size();
    let mut stored = Stored::new(width as usize * height as usize * key.map.channels() as usize)?;
    let mut walk = Walk::from(key);
    for frame in frames {
        taker.goes_on()?;
        stored.add(&walk.to(*frame, vectors)?.seen(&key.map))?;
    }
    Ok(stored)
}

/// Way from a key frame on, frame by frame.
struct Walk {
    frame: i64,
    places: Places,
}

impl Walk {
    fn from(key: &Key) -> Self {
        let (width, height) = key.size();
        Self { frame: key.frame, places: Places::own(width, height) }
    }

    /// Goes on to the next frame.
    fn to(&mut self, frame: i64, vectors: &mut Vectors) -> Result<&Places> {
        let there = between(vectors, frame, self.frame)?;
        let back = vectors.between(self.frame, frame)?;
        let [things, before] = [vectors.things(frame)?, vectors.things(self.frame)?];
        let back = back.as_ref().map(|back| Field::new(back, before.as_deref()));
        self.places = self.places.carried(Field::new(&there, things.as_deref()), back);
        self.frame = frame;
        Ok(&self.places)
    }
}

/// Vectors of a frame to one of its neighbours.
fn between(vectors: &mut Vectors, frame: i64, there: i64) -> Result<Vec<f32>> {
    vectors.between(frame, there)?.ok_or_else(|| {
        let problem = format!("frame {frame} has no motion vectors that lead to frame {there}");
        Error::input("the shot", problem, "name files of vectors by --motion, or give --motion estimate")
    })
}

/// Two maps as one, by the share of the last; either where the other is not seen.
fn mixed(first: Option<Vec<f32>>, last: Option<Vec<f32>>, share: f32) -> Vec<f32> {
    match (first, last) {
        (Some(first), Some(last)) => {
            let mix = |(a, b): (f32, f32)| match (a.is_nan(), b.is_nan()) {
                (true, _) => b,
                (_, true) => a,
                _ => a + (b - a) * share,
            };
            first.into_iter().zip(last).map(mix).collect()
        }
        (first, last) => first.or(last).unwrap_or_default(),
    }
}

/// Maps in a file for the time being: those of a whole shot need not fit into memory.
struct Stored {
    file: std::fs::File,
    numbers: usize,
}

impl Stored {
    fn new(numbers: usize) -> Result<Self> {
        Ok(Self { file: tempfile::tempfile().map_err(failed)?, numbers })
    }

    fn add(&mut self, map: &[f32]) -> Result<()> {
        self.file.write_all(bytemuck::cast_slice(map)).map_err(failed)
    }

    fn read(&mut self, at: usize) -> Result<Vec<f32>> {
        let mut map = vec![0.0_f32; self.numbers];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut map);
        let start = (at * bytes.len()) as u64;
        self.file.seek(SeekFrom::Start(start)).and_then(|_| self.file.read_exact(bytes)).map_err(failed)?;
        Ok(map)
    }
}

fn failed(e: std::io::Error) -> Error {
    Error::failure(format!("maps cannot be kept for the time being: {e}"), "make room on the disk")
}
