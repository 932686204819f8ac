//! Single channels out of chunks and into them.

use std::collections::HashMap;

use half::f16;
use rayon::prelude::*;

use super::blocks::Block;
use super::container::{Channel, Chunk, Container, Part, Sample};
use super::{Fault, codec};

/// Largest half; what is beyond would be infinite.
const LARGEST_HALF: f32 = 65504.0;

/// Samples of a channel at full resolution.
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
    /// As floats; large integers lose their last digits.
    pub fn to_f32(&self) -> Vec<f32> {
        match self {
            Self::Uint(v) => v.iter().map(|s| *s as f32).collect(),
            Self::Half(v) => v.iter().map(|s| s.to_f32()).collect(),
            Self::Float(v) => v.clone(),
        }
    }
}

/// What a channel of the file that is written holds.
#[derive(Clone, Debug)]
pub enum Content {
    /// What the channel of this index held.
    Kept(usize),
    /// New samples, one for each of the channel's own at full resolution.
    New(Vec<f32>),
}

/// The decompressed chunks of a part.
#[derive(Debug)]
pub struct Decoded {
    chunks: Vec<Vec<u8>>,
}

impl Decoded {
    /// Decompresses every chunk.
    pub fn new(container: &Container, part: &Part) -> Result<Self, Fault> {
        codec::check(part)?;
        let decode = |chunk: &Chunk| codec::decode(part, &chunk.block, &container.bytes[chunk.data.clone()]);
        Ok(Self { chunks: part.chunks.par_iter().map(decode).collect::<Result<_, _>>()? })
    }

    /// All samples of a channel at full resolution.
    pub fn plane(&self, part: &Part, channel: usize) -> Plane {
        let described = &part.channels[channel];
        let width = part.window.width / described.sampling.0;
        let count = width * (part.window.height / described.sampling.1);
        match described.sample {
            Sample::Uint => {
                Plane::Uint(self.gather(part, channel, width, vec![0; count], u32::from_le_bytes))
            }
            Sample::Half => {
                Plane::Half(self.gather(part, channel, width, vec![f16::ZERO; count], f16::from_le_bytes))
            }
            Sample::Float => {
                Plane::Float(self.gather(part, channel, width, vec![0.0; count], f32::from_le_bytes))
            }
        }
    }

    fn gather<T: Copy, const N: usize>(
        &self,
        part: &Part,
        channel: usize,
        width: usize,
        mut plane: Vec<T>,
        number: impl Fn([u8; N]) -> T,
    ) -> Vec<T> {
        for (chunk, raw) in part.chunks.iter().zip(&self.chunks) {
            if chunk.block.level != (0, 0) {
                continue;
            }
            let mut at = 0;
            for run in chunk.block.runs(part.window, &part.channels) {
                let bytes = run.count * part.channels[run.channel].sample.bytes();
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

    /// Compresses every chunk with other content; `channels` and `contents` go together.
    pub fn encode(
        &self,
        container: &Container,
        part: &Part,
        channels: &[Channel],
        contents: &[Content],
    ) -> Result<Vec<Vec<u8>>, Fault> {
        let levels = smaller_levels(part, contents);
        let kept: Vec<Option<usize>> = contents
            .iter()
            .map(|c| match c {
                Content::Kept(old) => Some(*old),
                Content::New(_) => None,
            })
            .collect();
        let encode = |(chunk, raw): (&Chunk, &Vec<u8>)| {
            let block = &chunk.block;
            let contents = levels.get(&block.level).map_or(contents, Vec::as_slice);
            let new = assemble(part, block, raw, channels, contents);
            codec::encode(part, channels, block, new, &container.bytes[chunk.data.clone()], &kept)
        };
        part.chunks.par_iter().zip(&self.chunks).map(encode).collect()
    }
}

/// The samples of a block with other content.
fn assemble(part: &Part, block: &Block, raw: &[u8], channels: &[Channel], contents: &[Content]) -> Vec<u8> {
    // Where in `raw` each old channel's samples of each row begin.
    let mut old = vec![Vec::new(); part.channels.len()];
    let mut at = 0;
    for run in block.runs(part.window, &part.channels) {
        old[run.channel].push(at);
        at += run.count * part.channels[run.channel].sample.bytes();
    }
    let mut rows = vec![0; channels.len()];
    let mut new = Vec::with_capacity(block.bytes(channels));
    for run in block.runs(part.window, channels) {
        let channel = &channels[run.channel];
        let row = rows[run.channel];
        rows[run.channel] += 1;
        match &contents[run.channel] {
            Content::Kept(index) => {
                let start = old[*index][row];
                new.extend(&raw[start..start + run.count * channel.sample.bytes()]);
            }
            Content::New(plane) => {
                let width = block.level_size.0 / channel.sampling.0;
                let values = &plane[run.row * width + run.column..][..run.count];
                match channel.sample {
                    Sample::Uint => new.extend(values.iter().flat_map(|v| (v.round() as u32).to_le_bytes())),
                    Sample::Half => new.extend(
                        values
                            .iter()
                            .flat_map(|v| f16::from_f32(v.clamp(-LARGEST_HALF, LARGEST_HALF)).to_le_bytes()),
                    ),
                    Sample::Float => new.extend(values.iter().flat_map(|v| v.to_le_bytes())),
                }
            }
        }
    }
    new
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
