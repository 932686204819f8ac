//! Pictures in KTX2 files that are compressed by Basis Universal, as KHR_texture_basisu has them: ETC1S with BasisLZ, and
//! UASTC, plain or with Zstandard; and pixels of 8 bits as they are, which some programs write instead. The header is
//! checked here before the decoder of blocks, a crate, sees the file.
//! Colours stay as they are encoded: what a texture is used for says how they are read.

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use ruzstd::StreamingDecoder;
use ruzstd::io::Read;

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
struct Header<'a> {
    width: u32,
    height: u32,
    /// Form of the pixels.
    content: Content,
    /// The largest picture.
    data: &'a [u8],
    /// Bytes of the largest picture once it is decompressed by Zstandard.
    inflated: Option<usize>,
}

/// Content of a picture.
#[derive(Clone, Copy)]
enum Content {
    /// Blocks of Basis Universal.
    Blocks {
        /// True where alpha stands for green, of two channels.
        two_channels: bool,
    },
    /// Pixels of 8 bits a channel, of which each goes to the place of RGBA that is named.
    Pixels(&'static [usize]),
}

/// Places in RGBA of the channels of a format of Vulkan that has 8 bits for each.
fn channels_of(format: u32) -> Option<&'static [usize]> {
    Some(match format {
        9 | 15 => &[0],
        16 | 22 => &[0, 1],
        23 | 29 => &[0, 1, 2],
        30 | 36 => &[2, 1, 0],
        37 | 43 => &[0, 1, 2, 3],
        44 | 50 => &[2, 1, 0, 3],
        _ => return None,
    })
}

/// Decodes the largest picture of a file, which is at most `most` pixels across and down.
///
/// # Errors
/// A clause saying what is wrong with the file, what else it holds, or that the budget does not allow it.
pub fn decode(name: &str, bytes: &[u8], most: u32, budget: &Budget) -> Result<Image, String> {
    let header = Header::of(bytes, most)?;
    let (width, height) = (header.width, header.height);
    budget.take(width as usize * height as usize, 4)?;
    budget.take(header.inflated.unwrap_or(0), 1)?;
    let rgba = match header.content {
        Content::Blocks { two_channels } => blocks(bytes, &header, two_channels, budget),
        Content::Pixels(channels) => pixels(&header, channels),
    };
    let rgba = rgba.map_err(|problem| format!("is a damaged KTX2 file: {problem}"))?;
    Ok(Image { name: name.to_owned(), width, height, rgba })
}

/// Decodes blocks of Basis Universal.
fn blocks(bytes: &[u8], header: &Header, two_channels: bool, budget: &Budget) -> Result<Vec<u8>, String> {
    let bytes = without_keys(bytes, budget)?;
    let mut rgba = guarded(|| {
        let transcoder = Transcoder::new(&bytes).map_err(|e| format!("{e:?}"))?;
        transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(|e| format!("{e:?}"))
    })?;
    if rgba.len() != header.width as usize * header.height as usize * 4 {
        return Err("its picture is of another size".into());
    }
    if two_channels {
        for texel in rgba.as_chunks_mut::<4>().0 {
            *texel = [texel[0], texel[3], 0, 255];
        }
    }
    Ok(rgba)
}

/// Reads pixels as they are.
fn pixels(header: &Header, channels: &[usize]) -> Result<Vec<u8>, String> {
    let inflated = header.inflated.map(|length| {
        guarded(|| {
            let mut inflated = vec![0; length];
            let mut decoder = StreamingDecoder::new(header.data).map_err(|e| e.to_string())?;
            decoder.read_exact(&mut inflated).map_err(|e| e.to_string())?;
            Ok(inflated)
        })
    });
    let inflated = inflated.transpose()?;
    let data = inflated.as_deref().unwrap_or(header.data);
    let count = header.width as usize * header.height as usize;
    let mut rgba = Vec::with_capacity(count * 4);
    for pixel in data.chunks_exact(channels.len()).take(count) {
        let mut texel = [0, 0, 0, 255];
        for (place, value) in channels.iter().zip(pixel) {
            texel[*place] = *value;
        }
        rgba.extend(texel);
    }
    Ok(rgba)
}

impl<'a> Header<'a> {
    fn of(bytes: &'a [u8], most: u32) -> Result<Self, String> {
        if !bytes.starts_with(&IDENTIFIER) || bytes.len() < 80 {
            return Err("is a KTX2 file that is cut off".into());
        }
        let [format, _, width, height, depth, layers, faces, levels, scheme] =
            [12, 16, 20, 24, 28, 32, 36, 40, 44].map(|at| word(bytes, at));
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
        let data = part(bytes, long(bytes, 80), long(bytes, 88))?;
        let inflated = long(bytes, 96);
        let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4)) * BLOCK;
        // Kinds of the one or two channels.
        let kinds = [Some(description[31] & 15), description.get(47).map(|kind| kind & 15)];
        let (content, whole) = match (format, description[12]) {
            (0, ETC1S) if scheme == BASIS_LZ => {
                let fits = shared.len() >= 20 + 20 * levels as usize;
                let two_channels = kinds == [Some(3), Some(4)];
                (Content::Blocks { two_channels }, if fits { 0 } else { u64::MAX })
            }
            (0, UASTC) if scheme != BASIS_LZ => {
                (Content::Blocks { two_channels: kinds[0] == Some(5) }, blocks)
            }
            (format, model) => {
                let channels = channels_of(format).filter(|_| matches!(scheme, PLAIN | ZSTANDARD));
                let channels = channels.ok_or_else(|| {
                    format!(
                        "is a KTX2 file of Vulkan format {format}, model {model} and compression {scheme}; ETC1S, \
                         UASTC and pixels of 8 bits a channel are read here"
                    )
                })?;
                (Content::Pixels(channels), u64::from(width) * u64::from(height) * channels.len() as u64)
            }
        };
        let zipped = scheme == ZSTANDARD;
        if if zipped { inflated != whole } else { (data.len() as u64) < whole } {
            return Err("is a KTX2 file whose picture is not all there".into());
        }
        let inflated =
            if zipped { Some(usize::try_from(inflated).map_err(|e| e.to_string())?) } else { None };
        Ok(Self { width, height, content, data, inflated })
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of 2 by 1 pixels of a format, whose data is plain or a frame of Zstandard.
    fn file(format: u32, scheme: u32, data: &[u8], inflated: usize) -> Vec<u8> {
        let mut bytes = IDENTIFIER.to_vec();
        bytes.extend([format, 1, 2, 1, 0, 0, 1, 1, scheme, 104, 44, 0, 0].map(u32::to_le_bytes).concat());
        bytes.extend([0, 0, 148, data.len() as u64, inflated as u64].map(u64::to_le_bytes).concat());
        bytes.resize(148, 0);
        bytes.extend(data);
        bytes
    }

    /// A frame of Zstandard that holds bytes as they are.
    fn frame(data: &[u8]) -> Vec<u8> {
        let size = data.len() as u8;
        [&[0x28, 0xb5, 0x2f, 0xfd, 0x20, size, size << 3 | 1, 0, 0], data].concat()
    }

    #[test]
    fn pixels_are_read_in_the_order_of_their_format() {
        for (format, data, expected) in [
            (9, &[1, 2][..], [1, 0, 0, 255, 2, 0, 0, 255]),
            (16, &[1, 2, 3, 4], [1, 2, 0, 255, 3, 4, 0, 255]),
            (23, &[1, 2, 3, 4, 5, 6], [1, 2, 3, 255, 4, 5, 6, 255]),
            (36, &[1, 2, 3, 4, 5, 6], [3, 2, 1, 255, 6, 5, 4, 255]),
            (43, &[1, 2, 3, 4, 5, 6, 7, 8], [1, 2, 3, 4, 5, 6, 7, 8]),
            (44, &[1, 2, 3, 4, 5, 6, 7, 8], [3, 2, 1, 4, 7, 6, 5, 8]),
        ] {
            let (plain, zipped) =
                (file(format, 0, data, data.len()), file(format, 2, &frame(data), data.len()));
            for bytes in [&plain, &zipped] {
                let image = decode("a", bytes, 16, &Budget::default()).unwrap();
                assert_eq!((image.width, image.height, &image.rgba[..]), (2, 1, &expected[..]), "{format}");
                for length in 0..bytes.len() {
                    assert!(
                        decode("a", &bytes[..length], 16, &Budget::default()).is_err(),
                        "{format}: {length}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_not_read_is_named() {
        let named = |at: usize, value: u32| {
            let mut bytes = file(37, 0, &[0; 8], 8);
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
            decode("a", &bytes, 16, &Budget::default()).unwrap_err()
        };
        for (at, value, part) in [
            (12, 97, "Vulkan format 97"),
            (20, 17, "17x1 pixels"),
            (24, 0, "2x0 pixels"),
            (28, 4, "a volume"),
            (36, 6, "a cube"),
            (40, 0, "0 sizes"),
            (44, 3, "compression 3"),
            (52, 8, "not described"),
            (88, 4, "not all there"),
            (92, 1, "cut off"),
        ] {
            assert!(named(at, value).contains(part), "'{part}' is not in '{}'", named(at, value));
        }
        let bytes = file(37, 0, &[0; 8], 8);
        assert!(decode("a", &bytes, 16, &Budget::new(7)).unwrap_err().contains("memory"));
    }
}
