//! The codecs of the `exr` crate on single chunks: RLE, PIZ, PXR24, DWAA, DWAB, and one channel of B44.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, IntegerBounds, LineOrder, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::Vec2;

use crate::layout::{Block, Channel, Sample};

pub const RLE: u8 = 1;
pub const PIZ: u8 = 4;
pub const PXR24: u8 = 5;
pub const B44: u8 = 6;
pub const B44A: u8 = 7;
pub const DWAA: u8 = 8;
pub const DWAB: u8 = 9;

/// The crate's description of a chunk by itself, with its place. Nothing when a pixel has no whole number of
/// bytes, by which the crate reckons.
pub fn header(
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
        DWAA => Compression::DWAA(None),
        DWAB => Compression::DWAB(None),
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
    // Rows count from a multiple of every sampling, see `codec::check`.
    Some((header, IntegerBounds { position: Vec2(0, 0), size }))
}

/// Decompresses with a header that [`header`] made.
pub fn decompress(header: &Header, area: IntegerBounds, data: &[u8]) -> Option<Vec<u8>> {
    quietly(|| header.compression.decompress_image_section_from_le(header, data.to_vec(), area, false).ok())
        .flatten()
}

/// Compresses with a header that [`header`] made.
pub fn compress(header: &Header, area: IntegerBounds, raw: Vec<u8>) -> Option<Vec<u8>> {
    quietly(|| header.compression.compress_image_section_to_le(header, raw, area).ok()).flatten()
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
