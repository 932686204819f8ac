//! Decompressing and compressing single chunks.

mod b44;
mod dwa;
mod foreign;
mod zip;

use crate::compression;
use crate::error::{Error, Result};
use crate::layout::{Block, Channel, Sample};
use crate::part::Part;
use foreign::{B44, B44A, DWAA, DWAB, PIZ, PXR24, RLE};

/// Most bytes that a byte of any compression can stand for: deflate's 1032, and a quarter that PXR24 drops.
const MOST_BYTES_PER_BYTE: usize = 1400;
/// The same of DWAA and DWAB, where blocks of 64 equal samples are one number before they are deflated.
const MOST_BYTES_PER_DWA_BYTE: usize = 64 * 1032;
/// Every chunk may be larger by its headers.
const SMALL: usize = 4096;

const NONE: u8 = 0;
const ZIPS: u8 = 2;
const ZIP: u8 = 3;
/// Scan lines in a chunk of ZIP, of which those of DWAA and DWAB are multiples.
pub const ZIP_LINES: usize = 16;

fn name(part: &Part) -> &'static str {
    compression::name(part.compression)
}

/// The compression that chunks of a part are written with when they change: its own, but ZIP for DWAA and DWAB, which
/// would lose something of every channel each time.
pub fn written(part: &Part) -> u8 {
    if matches!(part.compression, DWAA | DWAB) { ZIP } else { part.compression }
}

/// The blocks of the chunks that are written for one chunk of a part that changes.
pub fn pieces(part: &Part, block: &Block) -> impl Iterator<Item = Block> + use<> {
    let is_divided = written(part) != part.compression && part.tiles.is_none();
    let lines = if is_divided { ZIP_LINES } else { block.height.max(1) };
    let block = *block;
    (0..block.height).step_by(lines).map(move |row| Block {
        y: block.y + row,
        height: lines.min(block.height - row),
        number: (block.number.0, if is_divided { block.number.1 + row as i32 } else { block.number.1 }),
        ..block
    })
}

/// Checks that chunks of a part can be read and written.
pub fn check(part: &Part) -> Result<()> {
    if part.compression > DWAB {
        return Err(compression::unread(part.compression));
    }
    let rows = |c: &Channel| matches!(c.sampling.1, 1 | 2 | 4);
    if matches!(part.compression, PIZ | PXR24 | B44 | B44A | DWAA | DWAB) && !part.channels.iter().all(rows) {
        let name = name(part);
        let problem = format!("has a channel with every third or rarer row under {name}, which is not read");
        return Err(Error::unsupported(problem, "save it with ZIP compression"));
    }
    Ok(())
}

/// Checks that so many compressed bytes can stand for a block.
pub fn check_length(part: &Part, block: &Block, length: usize) -> Result<()> {
    let most =
        if matches!(part.compression, DWAA | DWAB) { MOST_BYTES_PER_DWA_BYTE } else { MOST_BYTES_PER_BYTE };
    if block.bytes(&part.channels) > length.saturating_mul(most) + SMALL {
        return Err(bad(part, "holds too few bytes"));
    }
    Ok(())
}

/// Bytes that decoding or encoding all chunks of a part takes, with these channels, beside what goes in and comes out:
/// every thread works on one chunk at a time.
pub fn working_memory(part: &Part, channels: &[Channel]) -> u64 {
    let largest =
        part.chunks.iter().map(|c| c.block.bytes(channels).max(c.block.bytes(&part.channels))).max();
    let compressed = part.chunks.iter().map(|c| c.data.len()).max();
    let tables = match part.compression {
        NONE => 0,
        // Tables of all 16-bit numbers, several of them.
        PIZ => 6 << 20,
        // The same where numbers are coded, and the blocks that are transformed, as halves and as floats.
        DWAA | DWAB => {
            let padded = part.chunks.iter().map(|c| dwa::padded(&part.channels, &c.block)).max();
            (6 << 20) + 24 * padded.unwrap_or(0)
        }
        // Of deflate, which wants most.
        _ => 512 << 10,
    };
    // Lists of channels as the codecs keep them.
    let lists: usize = channels.iter().map(|c| 512 + c.name.len()).sum();
    let one = 12 * largest.unwrap_or(0) + 2 * compressed.unwrap_or(0) + tables + lists;
    one as u64 * rayon::current_num_threads().min(part.chunks.len()) as u64
}

/// The samples of a chunk, in the order of [`Block::runs`]. Its length was checked by [`check_length`].
pub fn decode(part: &Part, block: &Block, data: &[u8]) -> Result<Vec<u8>> {
    let size = block.bytes(&part.channels);
    if data.len() == size {
        return Ok(data.to_vec());
    }
    let is_dwa = matches!(part.compression, DWAA | DWAB);
    if is_dwa && !dwa::is_possible(&part.channels, block, size, data) {
        return Err(bad(part, "names impossible sizes"));
    }
    let raw = match part.compression {
        ZIPS | ZIP => zip::unzip(data, size),
        B44 | B44A => b44::decode(part, block, data),
        RLE | PIZ | PXR24 | DWAA | DWAB => {
            let (header, area) = foreign::header(part.compression, &part.channels, block, size)
                .ok_or_else(|| bad(part, "has channels whose sampling is not read"))?;
            foreign::decompress(&header, area, data)
        }
        _ => None,
    };
    raw.filter(|raw| raw.len() == size).ok_or_else(|| bad(part, "does not read"))
}

fn bad(part: &Part, what: &str) -> Error {
    Error::damaged(format!("a chunk of {} compression {what}", name(part)))
}

/// Compresses the samples of a chunk, or of one of its [`pieces`]. `old` holds the data that the file had, and for every channel
/// where its samples come from in it, when they are unchanged.
pub fn encode(
    part: &Part,
    channels: &[Channel],
    block: &Block,
    raw: Vec<u8>,
    old: &[u8],
    kept: &[Option<usize>],
) -> Result<Vec<u8>> {
    let failed = || Error::damaged(format!("a chunk cannot be compressed by {} again", name(part)));
    let packed = match written(part) {
        NONE => return Ok(raw),
        ZIPS | ZIP => zip::zip(&raw),
        // Floats of a chunk that was not worth compressing would lose the bits that PXR24 drops.
        PXR24 if old.len() == block.bytes(&part.channels) && keeps_floats(part, kept) => return Ok(raw),
        B44 | B44A => b44::join(part, channels, block, &raw, old, kept).ok_or_else(failed)?,
        _ => {
            let (header, area) =
                foreign::header(part.compression, channels, block, raw.len()).ok_or_else(failed)?;
            foreign::compress(&header, area, raw.clone()).ok_or_else(failed)?
        }
    };
    Ok(if packed.len() < raw.len() { packed } else { raw })
}

/// Compresses the samples of a chunk by ZIP, where that makes them fewer bytes: others are stored as they are.
pub fn smaller_zip(raw: Vec<u8>) -> Vec<u8> {
    let packed = zip::zip(&raw);
    if packed.len() < raw.len() { packed } else { raw }
}

fn keeps_floats(part: &Part, kept: &[Option<usize>]) -> bool {
    kept.iter().flatten().any(|old| part.channels[*old].sample == Sample::Float)
}
