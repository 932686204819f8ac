//! Pictures on disk, for looking at and for golden images.

use isophote_engine::Image;
use std::path::{Path, PathBuf};

/// The folder that failing tests write to and people look into: `target/isophote-tests`.
pub fn results() -> PathBuf {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/isophote-tests");
    let _ = std::fs::create_dir_all(&dir);
    dir
}

/// Folder of real pictures beside the checkout, where there is one.
pub fn assets() -> Option<PathBuf> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/assets");
    dir.is_dir().then_some(dir)
}

/// Values 0..=1 as 8 bits, rounded; one channel becomes grey.
pub fn to_rgba8(image: &Image) -> Vec<u8> {
    let quantize = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    let channels = image.channels() as usize;
    image
        .data()
        .chunks_exact(channels)
        .flat_map(|p| match p {
            [v] => [quantize(*v), quantize(*v), quantize(*v), 255],
            [r, g, b, a] => [quantize(*r), quantize(*g), quantize(*b), quantize(*a)],
            _ => [0, 0, 0, 255],
        })
        .collect()
}

/// Writes values 0..=1 as an 8-bit PNG.
///
/// # Panics
/// When the file cannot be written.
pub fn write(path: &Path, image: &Image) {
    let result = ::image::save_buffer(
        path,
        &to_rgba8(image),
        image.width(),
        image.height(),
        ::image::ExtendedColorType::Rgba8,
    );
    if let Err(e) = result {
        panic!("cannot write {}: {e}", path.display());
    }
}

/// Reads a picture as RGBA values 0..=1, not premultiplied.
///
/// # Errors
/// The decoder's words, with the path.
pub fn read(path: &Path) -> Result<Image, String> {
    let decoded = ::image::open(path).map_err(|e| format!("{}: {e}", path.display()))?.to_rgba8();
    let (width, height) = decoded.dimensions();
    let values = decoded.into_raw().into_iter().map(|v| f32::from(v) / 255.0).collect();
    Image::from_vec(width, height, 4, values).map_err(|e| e.to_string())
}
