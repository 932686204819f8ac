//! B44 by channels, which are compressed one by one, so that those that nobody touched keep their bytes. It is the only
//! lossy compression that can be written again. The coding of a channel is the `exr` crate's.

use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;

use super::foreign::{compress, decompress, header};
use crate::layout::{Block, Channel, Sample};
use crate::part::Part;

/// Size of a channel's samples within a block.
fn plane_size(channel: &Channel, block: &Block) -> (usize, usize) {
    (block.width / channel.sampling.0, block.height.div_ceil(channel.sampling.1))
}

/// The compressed bytes of every channel in a B44 chunk.
fn split<'a>(part: &Part, block: &Block, mut data: &'a [u8]) -> Option<Vec<&'a [u8]>> {
    let mut pieces = Vec::with_capacity(part.channels.len());
    for channel in &part.channels {
        let (width, height) = plane_size(channel, block);
        let mut length = 0;
        if channel.sample == Sample::Half {
            for _ in 0..width.div_ceil(4) * height.div_ceil(4) {
                // A shift of 13 or more in the third byte marks a flat block, which is three bytes.
                length += if *data.get(length + 2)? >= 13 << 2 { 3 } else { 14 };
            }
        } else {
            length = width * height * 4;
        }
        pieces.push(data.get(..length)?);
        data = &data[length..];
    }
    data.is_empty().then_some(pieces)
}

/// A half channel as a picture of its own, of whole blocks of 4x4 samples. It is then always shorter
/// compressed than not, which is how the crate tells the two apart.
fn alone(part: &Part, channel: &Channel, block: &Block) -> Option<(Header, IntegerBounds)> {
    let (width, height) = plane_size(channel, block);
    let block = Block { width: width.next_multiple_of(4), height: height.next_multiple_of(4), ..*block };
    let channel = Channel { sampling: (1, 1), ..channel.clone() };
    header(part.compression, &[channel], &block, block.width * block.height * 2)
}

/// The samples of a channel.
fn unpacked(part: &Part, block: &Block, channel: usize, piece: &[u8]) -> Option<Vec<u8>> {
    let channel = &part.channels[channel];
    if channel.sample != Sample::Half {
        return Some(piece.to_vec());
    }
    let (header, area) = alone(part, channel, block)?;
    let whole = decompress(&header, area, piece)?;
    let (width, height) = plane_size(channel, block);
    let rows = whole.chunks_exact(area.size.width() * 2).take(height);
    Some(rows.flat_map(|row| &row[..width * 2]).copied().collect())
}

/// The compressed bytes of a channel.
fn packed(part: &Part, block: &Block, channel: &Channel, plane: &[u8]) -> Option<Vec<u8>> {
    let (header, area) = alone(part, channel, block)?;
    let (width, height) = plane_size(channel, block);
    let mut whole = Vec::with_capacity(area.size.area() * 2);
    // The last column and row are repeated, as the coder itself would.
    for y in 0..area.size.height() {
        let row = &plane[y.min(height - 1) * width * 2..][..width * 2];
        whole.extend(row);
        for _ in width..area.size.width() {
            whole.extend(&row[(width - 1) * 2..]);
        }
    }
    compress(&header, area, whole)
}

/// Samples of whole channels in the order of a chunk.
fn interleave(part: &Part, block: &Block, planes: &[Vec<u8>]) -> Vec<u8> {
    let mut raw = Vec::with_capacity(block.bytes(&part.channels));
    let mut at = vec![0; planes.len()];
    for run in block.runs(&part.channels) {
        let length = run.count * part.channels[run.channel].sample.bytes();
        raw.extend(&planes[run.channel][at[run.channel]..at[run.channel] + length]);
        at[run.channel] += length;
    }
    raw
}

/// Compresses the samples of a chunk; arguments are those of `codec::encode`.
pub fn join(
    part: &Part,
    channels: &[Channel],
    block: &Block,
    raw: &[u8],
    old: &[u8],
    kept: &[Option<usize>],
) -> Option<Vec<u8>> {
    let mut planes: Vec<Vec<u8>> = vec![Vec::new(); channels.len()];
    let mut rest = raw;
    for run in block.runs(channels) {
        let (run_bytes, left) = rest.split_at(run.count * channels[run.channel].sample.bytes());
        planes[run.channel].extend(run_bytes);
        rest = left;
    }
    // A chunk that was not worth compressing has no compressed bytes to keep.
    let pieces = if old.len() == block.bytes(&part.channels) { None } else { split(part, block, old) };
    let mut joined = Vec::with_capacity(raw.len() / 2);
    for (index, (channel, plane)) in channels.iter().zip(planes).enumerate() {
        match (&pieces, kept[index]) {
            (Some(pieces), Some(old)) => joined.extend(pieces[old]),
            _ if channel.sample != Sample::Half => joined.extend(plane),
            // What was raw would lose by being compressed now.
            (None, Some(_)) => return Some(raw.to_vec()),
            (_, None) => joined.extend(packed(part, block, channel, &plane)?),
        }
    }
    Some(joined)
}

/// Decompresses a chunk.
pub fn decode(part: &Part, block: &Block, data: &[u8]) -> Option<Vec<u8>> {
    let pieces = split(part, block, data)?;
    let mut planes = Vec::with_capacity(pieces.len());
    for (index, piece) in pieces.into_iter().enumerate() {
        planes.push(unpacked(part, block, index, piece)?);
    }
    Some(interleave(part, block, &planes))
}
