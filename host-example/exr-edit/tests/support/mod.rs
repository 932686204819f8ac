//! Files to read: made by the `exr` crate's own writer, and those of the OpenEXR project where they are.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use exr::prelude::*;

/// DWAA and DWAB, which are read only, on scan lines and on tiles with mip maps.
pub fn lossy() -> Vec<Encoding> {
    let compressions = [Compression::DWAA(None), Compression::DWAB(None)];
    let of = |blocks: Blocks| {
        compressions.map(|compression| Encoding { compression, blocks, line_order: LineOrder::Increasing })
    };
    [of(Blocks::ScanLines), of(Blocks::Tiles(Vec2(16, 8)))].concat()
}

/// Every compression that can be written again, on scan lines and on tiles with mip maps.
pub fn encodings() -> Vec<Encoding> {
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::B44A,
    ];
    let of = |blocks: Blocks| {
        compressions.map(|compression| Encoding { compression, blocks, line_order: LineOrder::Increasing })
    };
    [of(Blocks::ScanLines), of(Blocks::Tiles(Vec2(16, 8)))].concat()
}

/// A file of colour, depth and ids; `noise` of 0 is one value everywhere, which any codec makes small.
pub fn file(encoding: Encoding, size: (usize, usize), noise: f32) -> Vec<u8> {
    let wave = |scale: f32| {
        (0..size.0 * size.1).map(move |i| 0.25 + noise * scale * ((i * 7919 % 1009) as f32 / 1009.0))
    };
    let half = |scale| FlatSamples::F16(wave(scale).map(f16::from_f32).collect());
    let ids = wave(1.0).map(|v| (v * 4e9) as u32).collect();
    let channels = [
        AnyChannel::new("R", half(1.0)),
        AnyChannel::new("G", half(0.5)),
        AnyChannel::new("B", half(0.25)),
        AnyChannel::new("Z", FlatSamples::F32(wave(1e4).collect())),
        AnyChannel::new("id", FlatSamples::U32(ids)),
    ];
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let layer = Layer::new(size, LayerAttributes::named("main"), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).expect("the file can be made");
    bytes.into_inner()
}

/// All EXR files in a folder of the OpenEXR project's; empty where the folder is not there.
pub fn assets(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets/exr").join(folder);
    let Ok(entries) = std::fs::read_dir(&folder) else {
        eprintln!("skipped: there is no {}", folder.display());
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(|p| p.is_file()).collect();
    files.sort();
    files
}
