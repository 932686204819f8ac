//! Decompressing and compressing single chunks.
//!
//! ZIP is done here, with zlib's fast level: it is what nearly all frames of a farm use, and the writing of
//! large frames must keep up with filtering. B44 is cut into its channels, which are compressed one by one, so that
//! those that nobody touched keep their bytes; it is the only lossy compression that can be written. RLE, PIZ, PXR24 and
//! the coding of a B44 channel are the `exr` crate's.

use std::cell::Cell;
use std::io::{Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::Vec2;
use flate2::bufread::ZlibDecoder;
use flate2::write::ZlibEncoder;

use super::Fault;
use super::blocks::Block;
use super::container::{Channel, Part, Sample};

/// Effort of ZIP, 1 to 9. OpenEXR itself takes 4.
const ZIP_LEVEL: u32 = 4;
/// Most bytes that a byte of any compression can stand for: deflate's 1032, and a quarter that PXR24 drops.
const MOST_BYTES_PER_BYTE: usize = 1400;
/// Every chunk may be larger by its headers.
const SMALL: usize = 4096;

/// Compressions by their number in a file.
pub const NAMES: [&str; 12] =
    ["none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB", "HTJ2K256", "HTJ2K32"];
const NONE: u8 = 0;
const RLE: u8 = 1;
const ZIPS: u8 = 2;
const ZIP: u8 = 3;
const PIZ: u8 = 4;
const PXR24: u8 = 5;
const B44: u8 = 6;
const B44A: u8 = 7;

/// Whether chunks of a part can be read and written.
pub fn check(part: &Part) -> Result<(), Fault> {
    let name = NAMES.get(usize::from(part.compression)).copied().unwrap_or("unknown");
    if part.compression > B44A {
        return Err(Fault::Unsupported {
            problem: format!("is compressed by {name}, which cannot be written without loss"),
            mend: "save it with ZIP or PIZ compression".into(),
        });
    }
    let rows = |c: &Channel| matches!(c.sampling.1, 1 | 2 | 4);
    if matches!(part.compression, PIZ | PXR24 | B44 | B44A) && !part.channels.iter().all(rows) {
        return Err(Fault::Unsupported {
            problem: format!("has a channel with every third or rarer row under {name}, which is not read"),
            mend: "save it with ZIP compression".into(),
        });
    }
    Ok(())
}

/// The samples of a chunk, in the order of [`Block::runs`].
pub fn decode(part: &Part, block: &Block, data: &[u8]) -> Result<Vec<u8>, Fault> {
    let size = block.bytes(&part.channels);
    let bad = |what: &str| {
        Fault::damaged(format!("a chunk of {} compression {what}", NAMES[usize::from(part.compression)]))
    };
    if data.len() == size {
        return Ok(data.to_vec());
    }
    if size > data.len().saturating_mul(MOST_BYTES_PER_BYTE) + SMALL {
        return Err(bad("holds too few bytes"));
    }
    let raw = match part.compression {
        ZIPS | ZIP => unzip(data, size),
        B44 | B44A => split_b44(part, block, data).and_then(|pieces| {
            let mut planes = Vec::with_capacity(pieces.len());
            for (index, piece) in pieces.into_iter().enumerate() {
                planes.push(b44_plane(part, block, index, piece)?);
            }
            Some(interleave(part, block, &planes))
        }),
        RLE | PIZ | PXR24 => {
            let (header, area) = header(part.compression, &part.channels, block, size)
                .ok_or_else(|| bad("has channels whose sampling is not read"))?;
            quietly(|| {
                header.compression.decompress_image_section_from_le(&header, data.to_vec(), area, false).ok()
            })
            .flatten()
        }
        _ => None,
    };
    raw.filter(|raw| raw.len() == size).ok_or_else(|| bad("does not read"))
}

/// Compresses the samples of a chunk. `old` holds the data that the file had, and for every channel
/// where its samples come from in it, when they are unchanged.
pub fn encode(
    part: &Part,
    channels: &[Channel],
    block: &Block,
    raw: Vec<u8>,
    old: &[u8],
    kept: &[Option<usize>],
) -> Result<Vec<u8>, Fault> {
    let failed = || {
        Fault::damaged(format!(
            "a chunk cannot be compressed by {} again",
            NAMES[usize::from(part.compression)]
        ))
    };
    let packed = match part.compression {
        NONE => return Ok(raw),
        ZIPS | ZIP => zip(&raw),
        B44 | B44A => join_b44(part, channels, block, &raw, old, kept).ok_or_else(failed)?,
        _ => {
            let (header, area) = header(part.compression, channels, block, raw.len()).ok_or_else(failed)?;
            quietly(|| header.compression.compress_image_section_to_le(&header, raw.clone(), area).ok())
                .flatten()
                .ok_or_else(failed)?
        }
    };
    Ok(if packed.len() < raw.len() { packed } else { raw })
}

/// Undoes ZIP: deflate, then differences of neighbours, then even and odd bytes apart.
fn unzip(data: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut packed = Vec::with_capacity(size);
    ZlibDecoder::new(data).take(size as u64 + 1).read_to_end(&mut packed).ok()?;
    if packed.len() != size {
        return None;
    }
    let mut last = packed.first().copied().unwrap_or(0);
    for byte in packed.iter_mut().skip(1) {
        last = last.wrapping_add(*byte).wrapping_sub(128);
        *byte = last;
    }
    let mut raw = vec![0; size];
    let (even, odd) = packed.split_at(size.div_ceil(2));
    for (pair, (a, b)) in raw.chunks_exact_mut(2).zip(even.iter().zip(odd)) {
        pair[0] = *a;
        pair[1] = *b;
    }
    if size % 2 == 1 {
        raw[size - 1] = *even.last()?;
    }
    Some(raw)
}

fn zip(raw: &[u8]) -> Vec<u8> {
    let mut packed = vec![0; raw.len()];
    let (even, odd) = packed.split_at_mut(raw.len().div_ceil(2));
    for (pair, (a, b)) in raw.chunks_exact(2).zip(even.iter_mut().zip(odd)) {
        *a = pair[0];
        *b = pair[1];
    }
    if raw.len() % 2 == 1
        && let (Some(last), Some(end)) = (raw.last(), even.last_mut())
    {
        *end = *last;
    }
    let mut last = packed.first().copied().unwrap_or(0);
    for byte in packed.iter_mut().skip(1) {
        let value = *byte;
        *byte = value.wrapping_sub(last).wrapping_add(128);
        last = value;
    }
    let mut encoder =
        ZlibEncoder::new(Vec::with_capacity(raw.len() / 2), flate2::Compression::new(ZIP_LEVEL));
    // Memory takes everything that is written to it.
    let written = encoder.write_all(&packed).and_then(|()| encoder.finish());
    written.unwrap_or_else(|_| raw.to_vec())
}

/// The crate's description of a chunk by itself, with its place. Nothing when a pixel has no whole number of
/// bytes, by which the crate reckons.
fn header(
    compression: u8,
    channels: &[Channel],
    block: &Block,
    bytes: usize,
) -> Option<(Header, IntegerBounds)> {
    let area = block.width * block.height;
    if !bytes.is_multiple_of(area) {
        return None;
    }
    let described = channels.iter().map(|c| ChannelDescription {
        name: Text::new_or_none(&c.name).unwrap_or_default(),
        sample_type: match c.sample {
            Sample::Uint => SampleType::U32,
            Sample::Half => SampleType::F16,
            Sample::Float => SampleType::F32,
        },
        quantize_linearly: c.flags[0] != 0,
        sampling: Vec2(c.sampling.0, c.sampling.1),
    });
    let compression = match compression {
        RLE => Compression::RLE,
        PIZ => Compression::PIZ,
        PXR24 => Compression::PXR24,
        B44 => Compression::B44,
        B44A => Compression::B44A,
        _ => return None,
    };
    let size = Vec2(block.width, block.height);
    let tile = exr::meta::attribute::TileDescription {
        tile_size: size,
        level_mode: exr::meta::attribute::LevelMode::Singular,
        rounding_mode: exr::math::RoundingMode::Down,
    };
    let mut header = Header::new(Text::default(), size, described.collect()).with_encoding(
        compression,
        BlockDescription::Tiles(tile),
        LineOrder::Increasing,
    );
    // The crate forgets that samples may be fewer than pixels.
    header.channels.bytes_per_pixel = bytes / area;
    // Rows count from a multiple of every sampling, see `check`.
    Some((header, IntegerBounds { position: Vec2(0, 0), size }))
}

/// Size of a channel's samples within a block.
fn plane_size(channel: &Channel, block: &Block) -> (usize, usize) {
    (block.width / channel.sampling.0, block.height.div_ceil(channel.sampling.1))
}

/// The compressed bytes of every channel in a B44 chunk.
fn split_b44<'a>(part: &Part, block: &Block, mut data: &'a [u8]) -> Option<Vec<&'a [u8]>> {
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

fn b44_plane(part: &Part, block: &Block, channel: usize, piece: &[u8]) -> Option<Vec<u8>> {
    let channel = &part.channels[channel];
    if channel.sample != Sample::Half {
        return Some(piece.to_vec());
    }
    let (header, area) = alone(part, channel, block)?;
    let decompress =
        || header.compression.decompress_image_section_from_le(&header, piece.to_vec(), area, false).ok();
    let whole = quietly(decompress).flatten()?;
    let (width, height) = plane_size(channel, block);
    let rows = whole.chunks_exact(area.size.width() * 2).take(height);
    Some(rows.flat_map(|row| &row[..width * 2]).copied().collect())
}

fn b44_packed(part: &Part, block: &Block, channel: &Channel, plane: &[u8]) -> Option<Vec<u8>> {
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
    quietly(|| header.compression.compress_image_section_to_le(&header, whole, area).ok()).flatten()
}

/// Samples of whole channels in the order of a chunk.
fn interleave(part: &Part, block: &Block, planes: &[Vec<u8>]) -> Vec<u8> {
    let mut raw = Vec::with_capacity(block.bytes(&part.channels));
    let mut at = vec![0; planes.len()];
    for run in block.runs(part.window, &part.channels) {
        let length = run.count * part.channels[run.channel].sample.bytes();
        raw.extend(&planes[run.channel][at[run.channel]..at[run.channel] + length]);
        at[run.channel] += length;
    }
    raw
}

fn join_b44(
    part: &Part,
    channels: &[Channel],
    block: &Block,
    raw: &[u8],
    old: &[u8],
    kept: &[Option<usize>],
) -> Option<Vec<u8>> {
    let mut planes: Vec<Vec<u8>> = vec![Vec::new(); channels.len()];
    let mut rest = raw;
    for run in block.runs(part.window, channels) {
        let (run_bytes, left) = rest.split_at(run.count * channels[run.channel].sample.bytes());
        planes[run.channel].extend(run_bytes);
        rest = left;
    }
    // A chunk that was not worth compressing has no compressed bytes to keep.
    let pieces = if old.len() == block.bytes(&part.channels) { None } else { split_b44(part, block, old) };
    let mut packed = Vec::with_capacity(raw.len() / 2);
    for (index, (channel, plane)) in channels.iter().zip(planes).enumerate() {
        match (&pieces, kept[index]) {
            (Some(pieces), Some(old)) => packed.extend(pieces[old]),
            _ if channel.sample != Sample::Half => packed.extend(plane),
            // What was raw would lose by being compressed now.
            (None, Some(_)) => return Some(raw.to_vec()),
            (_, None) => packed.extend(b44_packed(part, block, channel, &plane)?),
        }
    }
    Some(packed)
}

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder of others, whose assertions damaged data may break; it then yields nothing, and nothing is printed.
fn quietly<T>(run: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                usual(info);
            }
        }));
    });
    QUIET.set(true);
    // Everything that the closure touches is its own and dropped when it fails.
    let result = catch_unwind(AssertUnwindSafe(run));
    QUIET.set(false);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zip_is_undone() {
        for length in [0usize, 1, 2, 3, 1000, 1001] {
            let raw: Vec<u8> = (0..length).map(|i| (i * i / 7) as u8).collect();
            assert_eq!(unzip(&zip(&raw), length), Some(raw));
        }
        assert_eq!(unzip(b"nonsense", 12), None);
    }
}
