//! Pictures in KTX2 files that are compressed by Basis Universal, as KHR_texture_basisu has them: ETC1S with BasisLZ, and
//! UASTC, plain or with Zstandard. The header is checked here before the decoder of blocks, a crate, sees the file.
//! Colours stay as they are encoded: what a texture is used for says how they are read.

use basisu::{DecodeFlags, TargetFormat, Transcoder};

use super::budget::Budget;
use super::guarded::guarded;
use super::material::Image;

const IDENTIFIER: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";

/// Models of colour in the description of the data.
const ETC1S: u8 = 163;
const UASTC: u8 = 166;

/// Kinds of supercompression.
const PLAIN: u32 = 0;
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;

/// Bytes of a block of 4 by 4 pixels of UASTC.
const BLOCK: u64 = 16;

/// Parts of the header that matter.
struct Header {
    width: u32,
    height: u32,
    /// True where alpha stands for green, of two channels.
    two_channels: bool,
    /// Bytes of the largest picture once it is decompressed.
    inflated: u64,
}

/// Decodes the largest picture of a file, which is at most `most` pixels across and down.
///
/// # Errors
/// A clause saying what is wrong with the file, what else it holds, or that the budget does not allow it.
pub fn decode(name: &str, bytes: &[u8], most: u32, budget: &Budget) -> Result<Image, String> {
    let Header { width, height, two_channels, inflated } = Header::of(bytes, most)?;
    let pixels = width as usize * height as usize;
    budget.take(pixels, 4)?;
    budget.take(usize::try_from(inflated).unwrap_or(usize::MAX), 1)?;
    let bytes = without_keys(bytes, budget)?;
    let decoded = guarded(|| {
        let transcoder = Transcoder::new(&bytes).map_err(|e| format!("{e:?}"))?;
        transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(|e| format!("{e:?}"))
    });
    let mut rgba = decoded.map_err(|problem| format!("is a damaged KTX2 file: {problem}"))?;
    if rgba.len() != pixels * 4 {
        return Err("is a damaged KTX2 file: its picture is of another size".into());
    }
    if two_channels {
        for texel in rgba.as_chunks_mut::<4>().0 {
            *texel = [texel[0], texel[3], 0, 255];
        }
    }
    Ok(Image { name: name.to_owned(), width, height, rgba })
}

impl Header {
    fn of(bytes: &[u8], most: u32) -> Result<Self, String> {
        if !bytes.starts_with(&IDENTIFIER) || bytes.len() < 80 {
            return Err("is a KTX2 file that is cut off".into());
        }
        let [format, _, width, height, depth, layers, faces, levels, scheme] =
            [12, 16, 20, 24, 28, 32, 36, 40, 44].map(|at| word(bytes, at));
        if format != 0 {
            return Err(format!(
                "is a KTX2 file of Vulkan format {format}; those of Basis Universal (ETC1S, UASTC) are read here"
            ));
        }
        if depth > 0 || layers > 1 || faces != 1 {
            return Err("is a KTX2 file of a cube, a volume or several pictures, not of one".into());
        }
        if width == 0 || height == 0 || width > most || height > most {
            return Err(format!("has {width}x{height} pixels, not 1 to {most} a side"));
        }
        if !(1..=16).contains(&levels) {
            return Err(format!("is a KTX2 file of {levels} sizes of its picture, not 1 to 16"));
        }
        let description = part(bytes, u64::from(word(bytes, 48)), u64::from(word(bytes, 52)))?;
        let shared = part(bytes, long(bytes, 64), long(bytes, 72))?;
        part(bytes, 80, 24 * u64::from(levels))?;
        for level in 0..levels as usize {
            let at = 80 + 24 * level;
            part(bytes, long(bytes, at), long(bytes, at + 8))?;
        }
        if description.len() < 44 {
            return Err("is a KTX2 file whose data is not described".into());
        }
        let (length, inflated) = (long(bytes, 88), long(bytes, 96));
        let whole = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4)) * BLOCK;
        // Kinds of the one or two channels.
        let channels = [Some(description[31] & 15), description.get(47).map(|kind| kind & 15)];
        let (fits, two_channels) = match (description[12], scheme) {
            (ETC1S, BASIS_LZ) => (shared.len() >= 20 + 20 * levels as usize, channels == [Some(3), Some(4)]),
            (UASTC, PLAIN) => (length >= whole, channels[0] == Some(5)),
            (UASTC, ZSTANDARD) => (inflated == whole, channels[0] == Some(5)),
            (model, scheme) => {
                return Err(format!(
                    "is a KTX2 file of model {model} and compression {scheme}; ETC1S and UASTC are read here"
                ));
            }
        };
        if !fits {
            return Err("is a KTX2 file whose picture is not all there".into());
        }
        Ok(Self { width, height, two_channels, inflated: if scheme == ZSTANDARD { inflated } else { 0 } })
    }
}

/// The file without its keys and values, which say nothing that is needed: the decoder panics at broken ones.
fn without_keys(bytes: &[u8], budget: &Budget) -> Result<Vec<u8>, String> {
    budget.take(bytes.len(), 1)?;
    let mut bytes = bytes.to_vec();
    if let Some(place) = bytes.get_mut(56..64) {
        place.fill(0);
    }
    Ok(bytes)
}

/// The bytes of a part of the file.
fn part(bytes: &[u8], offset: u64, length: u64) -> Result<&[u8], String> {
    let range = || {
        let (start, length) = (usize::try_from(offset).ok()?, usize::try_from(length).ok()?);
        bytes.get(start..start.checked_add(length)?)
    };
    range().ok_or_else(|| "is a KTX2 file that is cut off".to_owned())
}

/// A number of 32 bits, or 0 beyond the end.
fn word(bytes: &[u8], at: usize) -> u32 {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map_or(0, |word| u32::from_le_bytes(*word))
}

/// A number of 64 bits, or 0 beyond the end.
fn long(bytes: &[u8], at: usize) -> u64 {
    u64::from(word(bytes, at)) | u64::from(word(bytes, at + 4)) << 32
}
