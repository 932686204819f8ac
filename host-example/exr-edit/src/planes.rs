//! The decompressed chunks of a part, and single channels out of them.

use std::sync::{Arc, Mutex, PoisonError};

use half::f16;
use rayon::prelude::*;

use crate::codec;
use crate::error::{Error, Result};
use crate::layout::Sample;
use crate::limits::{Budget, Reserved};
use crate::part::{Chunk, Part};

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
    /// Samples of each chunk, in the order of [`Block::runs`](crate::layout::Block::runs).
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
