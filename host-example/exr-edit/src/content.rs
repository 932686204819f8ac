//! Content of a part: its samples out of decompressed chunks, and new ones back into chunks.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use half::f16;
use rayon::prelude::*;

use crate::codec;
use crate::cursor::LONGEST_NAME;
use crate::error::{Error, Result};
use crate::layout::{Block, Channel, Sample, Window};
use crate::limits::{Budget, Reserved};
use crate::part::{Chunk, Part};

/// Largest half; what is beyond would be infinite.
const LARGEST_HALF: f32 = 65504.0;
/// Bytes for each chunk beside its samples: its place in the list, and in those of threads that are joined.
const CHUNK: usize = 4 * size_of::<Vec<u8>>();

/// Samples of a channel at full resolution, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Plane {
    /// Numbers such as ids.
    Uint(Vec<u32>),
    /// Halves.
    Half(Vec<f16>),
    /// Floats.
    Float(Vec<f32>),
}

impl Plane {
    /// As floats; integers above 2^24 lose their last digits.
    pub fn to_f32(&self) -> Vec<f32> {
        match self {
            Self::Uint(v) => v.iter().map(|s| *s as f32).collect(),
            Self::Half(v) => v.iter().map(|s| s.to_f32()).collect(),
            Self::Float(v) => v.clone(),
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Uint(v) => v.len(),
            Self::Half(v) => v.len(),
            Self::Float(v) => v.len(),
        }
    }

    /// True where there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The decompressed chunks of a part.
#[derive(Debug)]
pub struct Decoded {
    number: usize,
    part: Arc<Part>,
    /// Samples of each chunk, in the order of [`Block::runs`].
    chunks: Vec<Vec<u8>>,
    budget: Arc<Budget>,
    /// Memory that the chunks and the planes that were handed out take.
    reserved: Mutex<Reserved>,
}

impl Decoded {
    /// Decompresses every chunk.
    ///
    /// # Errors
    /// As [`File::decode`](crate::File::decode).
    pub(crate) fn new(bytes: &[u8], number: usize, part: &Arc<Part>, budget: &Arc<Budget>) -> Result<Self> {
        codec::check(part)?;
        for chunk in &part.chunks {
            codec::check_length(part, &chunk.block, chunk.data.len())?;
        }
        let reserved = budget.reserve(part.decoded_bytes() + (part.chunks.len() * CHUNK) as u64)?;
        let _meanwhile = budget.reserve(codec::working_memory(part, &part.channels))?;
        let decode = |chunk: &Chunk| codec::decode(part, &chunk.block, &bytes[chunk.data.clone()]);
        let chunks = part.chunks.par_iter().map(decode).collect::<Result<_>>()?;
        Ok(Self {
            number,
            part: Arc::clone(part),
            chunks,
            budget: Arc::clone(budget),
            reserved: Mutex::new(reserved),
        })
    }

    /// Index of the part in its file.
    pub fn number(&self) -> usize {
        self.number
    }

    /// True where it is this part that was decoded.
    pub(crate) fn is_of(&self, part: &Arc<Part>) -> bool {
        Arc::ptr_eq(&self.part, part)
    }

    /// Samples of each chunk of the part.
    pub(crate) fn chunks(&self) -> &[Vec<u8>] {
        &self.chunks
    }

    /// All samples of a channel at full resolution. What planes take counts against the limit of memory until this
    /// value is dropped.
    ///
    /// # Errors
    /// [`Error::Memory`]; [`Error::Argument`] when there is no such channel.
    pub fn plane(&self, channel: usize) -> Result<Plane> {
        let described = self.part.channels.get(channel);
        let described = described.ok_or_else(|| Error::Argument(format!("there is no channel {channel}")))?;
        let width = self.part.window.width / described.sampling.0;
        let count = width * (self.part.window.height / described.sampling.1);
        let share = self.budget.reserve((count * described.sample.bytes()) as u64)?;
        self.reserved.lock().unwrap_or_else(PoisonError::into_inner).join(share);
        Ok(match described.sample {
            Sample::Uint => Plane::Uint(self.gather(channel, width, vec![0; count], u32::from_le_bytes)),
            Sample::Half => {
                Plane::Half(self.gather(channel, width, vec![f16::ZERO; count], f16::from_le_bytes))
            }
            Sample::Float => Plane::Float(self.gather(channel, width, vec![0.0; count], f32::from_le_bytes)),
        })
    }

    fn gather<T: Copy, const N: usize>(
        &self,
        channel: usize,
        width: usize,
        mut plane: Vec<T>,
        number: impl Fn([u8; N]) -> T,
    ) -> Vec<T> {
        let channels = &self.part.channels;
        for (chunk, raw) in self.part.chunks.iter().zip(&self.chunks) {
            if chunk.block.level != (0, 0) {
                continue;
            }
            let mut at = 0;
            for run in chunk.block.runs(channels) {
                let bytes = run.count * channels[run.channel].sample.bytes();
                if run.channel == channel {
                    let target = &mut plane[run.row * width + run.column..][..run.count];
                    for (to, from) in target.iter_mut().zip(raw[at..at + bytes].as_chunks::<N>().0) {
                        *to = number(*from);
                    }
                }
                at += bytes;
            }
        }
        plane
    }
}

/// Content of the channels of a part in the file that is written: what they held, or new samples.
#[derive(Clone, Debug)]
pub struct Edit {
    window: Window,
    channels: Vec<Channel>,
    /// One for each channel.
    contents: Vec<Content>,
}

/// Content of a channel.
#[derive(Clone, Debug)]
enum Content {
    /// Content that the channel of this index held.
    Kept(usize),
    /// New samples, one for each of the channel's own at full resolution.
    New(Vec<f32>),
}

/// A part of a file that changes.
#[derive(Clone, Copy, Debug)]
pub struct PartEdit<'a> {
    /// Content that the part held.
    pub decoded: &'a Decoded,
    /// Changes of the part.
    pub edit: &'a Edit,
}

impl Edit {
    /// Everything as it is.
    pub fn of(part: &Part) -> Self {
        let contents = (0..part.channels.len()).map(Content::Kept).collect();
        Self { window: part.window, channels: part.channels.clone(), contents }
    }

    /// The channels of the part that is written, sorted by name.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Gives a channel other samples: one for each of the channel's own at full resolution, rows from the top.
    /// Levels of lower resolution hold means of them. They are stored as the channel stores its samples: halves
    /// within the range of finite ones, integers rounded.
    ///
    /// # Errors
    /// [`Error::Argument`] when there is no such channel or it has another number of samples.
    pub fn replace(&mut self, name: &str, samples: Vec<f32>) -> Result<()> {
        let at = self.place(name);
        let at = at.map_err(|_| Error::Argument(format!("there is no channel '{name}'")))?;
        self.check(&self.channels[at], &samples)?;
        self.contents[at] = Content::New(samples);
        Ok(())
    }

    /// Adds a channel.
    ///
    /// # Errors
    /// [`Error::Argument`] when there is one of its name, the name is empty, longer than 255 bytes or holds a zero, or
    /// the samples do not fit the data window.
    pub fn insert(&mut self, channel: Channel, samples: Vec<f32>) -> Result<()> {
        self.check(&channel, &samples)?;
        let name = &channel.name;
        if name.is_empty() || name.len() > LONGEST_NAME || name.contains('\0') {
            return Err(Error::Argument(format!("'{name}' cannot be the name of a channel")));
        }
        match self.place(name) {
            Ok(_) => Err(Error::Argument(format!("there is a channel '{name}' already"))),
            Err(at) => {
                self.channels.insert(at, channel);
                self.contents.insert(at, Content::New(samples));
                Ok(())
            }
        }
    }

    /// Place where a channel is, or belongs.
    fn place(&self, name: &str) -> std::result::Result<usize, usize> {
        self.channels.binary_search_by(|c| c.name.as_str().cmp(name))
    }

    fn check(&self, channel: &Channel, samples: &[f32]) -> Result<()> {
        let (sampling, Window { width, height, .. }) = (channel.sampling, self.window);
        let whole = sampling.0 > 0 && sampling.1 > 0 && self.window.fits(sampling);
        if !whole || samples.len() != width / sampling.0 * (height / sampling.1) {
            let (name, count) = (&channel.name, samples.len());
            return Err(Error::Argument(format!(
                "{count} samples do not fill channel '{name}' of {width}x{height} pixels"
            )));
        }
        Ok(())
    }
}

/// Compresses every chunk of a part with what an edit says, in as many pieces as are written for it, and reserves what the
/// result takes.
///
/// # Errors
/// [`Error::Damaged`] when a codec fails, [`Error::Memory`], [`Error::Argument`] when the edit is of another part.
pub fn encode(
    bytes: &[u8],
    part: &Part,
    decoded: &Decoded,
    edit: &Edit,
    budget: &Arc<Budget>,
) -> Result<(Vec<Vec<Vec<u8>>>, Reserved)> {
    let kept: Vec<Option<usize>> = edit
        .contents
        .iter()
        .map(|content| match content {
            Content::Kept(old) => Some(*old),
            Content::New(_) => None,
        })
        .collect();
    let same = |(channel, old): (&Channel, &Option<usize>)| {
        old.is_none_or(|o| part.channels.get(o) == Some(channel))
    };
    if edit.window != part.window || !edit.channels.iter().zip(&kept).all(same) {
        return Err(Error::Argument("an edit is of another part".into()));
    }
    let pieces = |block: &Block| codec::pieces(part, block);
    let lists = |chunk: &Chunk| CHUNK * (1 + pieces(&chunk.block).count());
    let size: usize = part.chunks.iter().map(|c| c.block.bytes(&edit.channels) + lists(c)).sum();
    let reserved = budget.reserve(size as u64)?;
    let _meanwhile = budget.reserve(codec::working_memory(part, &edit.channels))?;
    let _levels = budget.reserve(level_memory(part, &edit.contents))?;
    let levels = smaller_levels(part, &edit.contents);
    let encode = |(chunk, raw): (&Chunk, &Vec<u8>)| {
        let block = &chunk.block;
        let contents = levels.get(&block.level).map_or(&edit.contents, |level| level);
        let mut raw = assemble(part, block, raw, &edit.channels, contents);
        let mut packed = Vec::new();
        for piece in pieces(block) {
            let rest = raw.split_off(piece.bytes(&edit.channels));
            let old = &bytes[chunk.data.clone()];
            packed.push(codec::encode(part, &edit.channels, &piece, raw, old, &kept)?);
            raw = rest;
        }
        Ok(packed)
    };
    let chunks = part.chunks.par_iter().zip(decoded.chunks()).map(encode).collect::<Result<_>>()?;
    Ok((chunks, reserved))
}

/// The samples of a block with other content.
fn assemble(part: &Part, block: &Block, raw: &[u8], channels: &[Channel], contents: &[Content]) -> Vec<u8> {
    let mut new = Vec::with_capacity(block.bytes(channels));
    // Where in `raw` the samples that each old channel has in a row begin.
    let mut old = vec![0; part.channels.len()];
    let mut at = 0;
    for y in block.y..block.y + block.height {
        for run in block.row(y, &part.channels) {
            old[run.channel] = at;
            at += run.count * part.channels[run.channel].sample.bytes();
        }
        for run in block.row(y, channels) {
            let channel = &channels[run.channel];
            match &contents[run.channel] {
                Content::Kept(index) => {
                    let start = old[*index];
                    new.extend(&raw[start..start + run.count * channel.sample.bytes()]);
                }
                Content::New(plane) => {
                    let width = block.level_size.0 / channel.sampling.0;
                    store(&plane[run.row * width + run.column..][..run.count], channel.sample, &mut new);
                }
            }
        }
    }
    new
}

/// Appends samples as a channel stores them.
fn store(values: &[f32], sample: Sample, to: &mut Vec<u8>) {
    let half = |v: &f32| f16::from_f32(v.clamp(-LARGEST_HALF, LARGEST_HALF)).to_le_bytes();
    match sample {
        Sample::Uint => to.extend(values.iter().flat_map(|v| (v.round() as u32).to_le_bytes())),
        Sample::Half => to.extend(values.iter().flat_map(half)),
        Sample::Float => to.extend(values.iter().flat_map(|v| v.to_le_bytes())),
    }
}

/// Bytes that [`smaller_levels`] allocates.
fn level_memory(part: &Part, contents: &[Content]) -> u64 {
    let new = contents.iter().filter(|c| matches!(c, Content::New(_))).count() as u64;
    let blocks = part.chunks.iter().map(|c| &c.block).filter(|b| b.level != (0, 0));
    let (mut pixels, mut levels) = (0, 0);
    for block in blocks {
        // Each level has one first block.
        levels += u64::from((block.x, block.y) == (0, 0));
        pixels += (block.width * block.height) as u64;
    }
    if levels == 0 {
        return 0;
    }
    // Beside the levels, one plane that is shrunk in one direction only, and the lists.
    let between = (part.window.width * part.window.height) as u64;
    4 * (pixels * new + between) + levels * (size_of_val(contents) + 256) as u64
}

/// New content of the levels below full resolution: means over the pixels that each of theirs covers.
fn smaller_levels(part: &Part, contents: &[Content]) -> HashMap<(usize, usize), Vec<Content>> {
    let mut levels = HashMap::new();
    let full = (part.window.width, part.window.height);
    for block in part.chunks.iter().map(|c| &c.block).filter(|b| b.level != (0, 0)) {
        levels.entry(block.level).or_insert_with(|| {
            let shrunk = |content: &Content| match content {
                Content::Kept(old) => Content::Kept(*old),
                Content::New(plane) => Content::New(shrink(plane, full, block.level_size)),
            };
            contents.iter().map(shrunk).collect::<Vec<_>>()
        });
    }
    levels
}

/// A plane of another size: means over the area that each pixel covers, along one axis after the other.
fn shrink(plane: &[f32], from: (usize, usize), to: (usize, usize)) -> Vec<f32> {
    let along = |plane: &[f32], width: usize, height: usize, new: usize| -> Vec<f32> {
        // One axis at a time, transposed on the way so that both look alike.
        let mut out = vec![0.0; new * height];
        let scale = width as f64 / new as f64;
        for target in 0..new {
            let (start, end) = (target as f64 * scale, (target + 1) as f64 * scale);
            let (first, last) = (start as usize, (end.ceil() as usize).min(width));
            for y in 0..height {
                let row = &plane[y * width..][..width];
                let mut sum = 0.0;
                for (x, value) in row.iter().enumerate().take(last).skip(first) {
                    let covered = (end.min((x + 1) as f64) - start.max(x as f64)).max(0.0);
                    sum += covered * f64::from(*value);
                }
                out[target * height + y] = (sum / scale) as f32;
            }
        }
        out
    };
    let across = along(plane, from.0, from.1, to.0);
    along(&across, from.1, to.0, to.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_means() {
        let plane: Vec<f32> = (0..12).map(|v| v as f32).collect();
        assert_eq!(shrink(&plane, (4, 3), (2, 1)), [4.5, 6.5]);
        assert_eq!(shrink(&plane, (4, 3), (4, 3)), plane);
        let odd = shrink(&[1.0, 2.0, 6.0], (3, 1), (2, 1));
        assert!((odd[0] - 4.0 / 3.0).abs() < 1e-6 && (odd[1] - 14.0 / 3.0).abs() < 1e-6);
    }
}
