//! Sizes that a chunk of DWAA or DWAB names of itself, checked before the `exr` crate allocates by them.
//!
//! Source: `DataSizesSingle` in OpenEXR's `internal_dwa_compressor.h`: eleven numbers of 64 bits, little end first.

use crate::layout::{Block, Channel};

/// Places among the numbers.
const UNKNOWN_BYTES: usize = 1;
const RLE_PACKED_BYTES: usize = 6;
const RLE_BYTES: usize = 7;
const AC_COUNT: usize = 8;
const DC_COUNT: usize = 9;
/// Samples of a block that is transformed.
const SAMPLES: usize = 64;
/// Bytes of tokens beside those that they stand for, where there are few.
const TOKENS: usize = 4096;

/// Blocks of 8 by 8 samples that cover all channels of a chunk.
fn blocks(channels: &[Channel], block: &Block) -> usize {
    let of = |c: &Channel| {
        (block.width / c.sampling.0).div_ceil(8) * block.height.div_ceil(c.sampling.1).div_ceil(8)
    };
    channels.iter().map(of).sum()
}

/// Samples of whole transformed blocks: what decoding takes beside the samples of the chunk grows with them.
pub fn padded(channels: &[Channel], block: &Block) -> usize {
    SAMPLES * blocks(channels, block)
}

/// True where the numbers of a chunk are possible for a block of `size` bytes.
pub fn is_possible(channels: &[Channel], block: &Block, size: usize, data: &[u8]) -> bool {
    let number = |place: usize| {
        let bytes = data.get(8 * place..)?.first_chunk::<8>()?;
        usize::try_from(u64::from_le_bytes(*bytes)).ok()
    };
    let most = [
        (UNKNOWN_BYTES, size),
        (RLE_PACKED_BYTES, 2 * size + TOKENS),
        (RLE_BYTES, size),
        (AC_COUNT, padded(channels, block)),
        (DC_COUNT, blocks(channels, block)),
    ];
    most.into_iter().all(|(place, most)| number(place).is_some_and(|number| number <= most))
}
