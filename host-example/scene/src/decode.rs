//! Decoding of the images of textures.

use std::fmt;
use std::io::Cursor;

use image::ImageFormat;

use super::budget::Budget;
use super::material::Image;

/// Formats that are read, for messages.
pub const FORMATS: &str = if cfg!(feature = "compressed") {
    "PNG, JPEG, WebP, TGA, DDS, KTX2, BMP, GIF and TIFF are"
} else {
    "PNG, JPEG, WebP, TGA, DDS, BMP, GIF and TIFF are"
};

/// Most pixels across and down.
const MOST: u32 = 1 << 15;

/// Problem that kept an image from being decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DecodeProblem {
    /// A format that is not read here.
    Unsupported(&'static str),
    /// The file is damaged or too large.
    Damaged(String),
}

impl fmt::Display for DecodeProblem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Unsupported(format) => {
                write!(f, "is of {format} format, which is not read here ({FORMATS})")
            }
            Self::Damaged(problem) => f.write_str(problem),
        }
    }
}

/// Decodes an image, whose format is told by its first bytes; of several pictures in a file the first.
///
/// # Errors
/// [`DecodeProblem`]: another format, a damaged file, or one whose pixels are more than the budget.
pub fn decode(name: &str, bytes: &[u8], budget: &Budget) -> Result<Image, DecodeProblem> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => raster(name, bytes, ImageFormat::Png, budget),
        [0xff, 0xd8, 0xff, ..] => raster(name, bytes, ImageFormat::Jpeg, budget),
        [b'G', b'I', b'F', b'8', ..] => raster(name, bytes, ImageFormat::Gif, budget),
        [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..] => raster(name, bytes, ImageFormat::Bmp, budget),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => raster(name, bytes, ImageFormat::Tiff, budget),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
            raster(name, bytes, ImageFormat::WebP, budget)
        }
        [b'D', b'D', b'S', b' ', ..] => surface(name, bytes, budget),
        #[cfg(feature = "compressed")]
        [0xab, b'K', b'T', b'X', b' ', b'2', ..] => {
            super::ktx2::decode(name, bytes, MOST, budget).map_err(DecodeProblem::Damaged)
        }
        #[cfg(not(feature = "compressed"))]
        [0xab, b'K', b'T', b'X', b' ', b'2', ..] => Err(DecodeProblem::Unsupported("KTX2")),
        [0xab, b'K', b'T', b'X', ..] => Err(DecodeProblem::Unsupported("KTX")),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f' | b's', ..] => {
            Err(DecodeProblem::Unsupported("AVIF"))
        }
        [b'8', b'B', b'P', b'S', ..] => Err(DecodeProblem::Unsupported("PSD")),
        [0x76, 0x2f, 0x31, 0x01, ..] => Err(DecodeProblem::Unsupported("EXR")),
        [b'#', b'?', ..] => Err(DecodeProblem::Unsupported("Radiance HDR")),
        [] => Err(DecodeProblem::Damaged("the image is empty".into())),
        _ if is_targa(bytes) => raster(name, bytes, ImageFormat::Tga, budget),
        _ => Err(DecodeProblem::Unsupported("unknown")),
    }
}

/// True where the header of a TGA is possible: such files do not begin with a mark of their own.
fn is_targa(bytes: &[u8]) -> bool {
    let [_, map, kind, ..] = bytes else { return false };
    let Some([width_low, width_high, height_low, height_high, depth, flags]) = bytes.get(12..18) else {
        return false;
    };
    let size = [[*width_low, *width_high], [*height_low, *height_high]].map(u16::from_le_bytes);
    let depths: &[u8] = match (kind, map) {
        (1 | 9, 1) => &[8, 16],
        (2 | 10, 0 | 1) => &[15, 16, 24, 32],
        (3 | 11, 0 | 1) => &[8, 16],
        _ => return false,
    };
    depths.contains(depth) && !size.contains(&0) && flags & 0xc0 == 0
}

fn raster(name: &str, bytes: &[u8], format: ImageFormat, budget: &Budget) -> Result<Image, DecodeProblem> {
    let reader = || {
        let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = image::Limits::default();
        limits.max_image_width = Some(MOST);
        limits.max_image_height = Some(MOST);
        limits.max_alloc = Some(1 << 30);
        reader.limits(limits);
        reader
    };
    let damaged = |e: image::ImageError| DecodeProblem::Damaged(e.to_string());
    let (width, height) = reader().into_dimensions().map_err(damaged)?;
    budget.take(width as usize * height as usize, 4).map_err(DecodeProblem::Damaged)?;
    let decoded = reader().decode().map_err(damaged)?.into_rgba8();
    let (width, height) = decoded.dimensions();
    Ok(Image { name: name.to_owned(), width, height, rgba: decoded.into_raw() })
}

/// The first surface of a DDS file: the picture itself, or one face of a cube.
fn surface(name: &str, bytes: &[u8], budget: &Budget) -> Result<Image, DecodeProblem> {
    let damaged = |e: dds::DecodingError| DecodeProblem::Damaged(e.to_string());
    let mut decoder = dds::Decoder::new(Cursor::new(bytes)).map_err(damaged)?;
    let size = decoder.main_size();
    let (width, height) = (size.width, size.height);
    if width == 0 || height == 0 || width > MOST || height > MOST {
        return Err(DecodeProblem::Damaged(format!("has {width}x{height} pixels, not 1 to {MOST} a side")));
    }
    let pixels = width as usize * height as usize;
    // A block of 16 pixels has 8 bytes at least, in the largest form of which they are 144.
    if pixels / 144 > bytes.len() {
        return Err(DecodeProblem::Damaged(format!(
            "claims {width}x{height} pixels but has {} bytes",
            bytes.len()
        )));
    }
    budget.take(pixels, 4).map_err(DecodeProblem::Damaged)?;
    let mut rgba = vec![0; pixels * 4];
    let view = dds::ImageViewMut::new(&mut rgba, size, dds::ColorFormat::RGBA_U8);
    let view = view.ok_or_else(|| DecodeProblem::Damaged("has no such size".into()))?;
    decoder.read_surface(view).map_err(damaged)?;
    Ok(Image { name: name.to_owned(), width, height, rgba })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMATS: [(ImageFormat, bool); 7] = [
        (ImageFormat::Png, true),
        (ImageFormat::Jpeg, false),
        (ImageFormat::WebP, true),
        (ImageFormat::Tga, true),
        (ImageFormat::Bmp, true),
        (ImageFormat::Gif, true),
        (ImageFormat::Tiff, true),
    ];

    /// Halves of red and blue.
    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let halves =
            image::RgbImage::from_fn(16, 8, |x, _| image::Rgb(if x < 8 { [255, 0, 0] } else { [0, 0, 255] }));
        image::DynamicImage::from(halves).write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn every_format_is_read() {
        for (format, exact) in FORMATS {
            let image = decode("a", &encoded(format), &Budget::default())
                .unwrap_or_else(|e| panic!("{format:?}: {e}"));
            assert_eq!((image.width, image.height), (16, 8), "{format:?}");
            for (x, color) in [(0, [255, 0, 0, 255]), (15, [0, 0, 255, 255])] {
                let texel = &image.rgba[x * 4..x * 4 + 4];
                let apart = texel.iter().zip(color).map(|(a, b): (&u8, u8)| a.abs_diff(b)).max().unwrap();
                assert!(apart <= if exact { 0 } else { 8 }, "{format:?}: {texel:?} at {x}");
            }
        }
    }

    #[test]
    fn damage_is_no_panic() {
        for (format, _) in FORMATS {
            let whole = encoded(format);
            for length in 0..whole.len().min(64) {
                let _ = decode("a", &whole[..length], &Budget::default());
            }
            for at in 0..whole.len().min(64) {
                let mut changed = whole.clone();
                changed[at] ^= 0xff;
                let _ = decode("a", &changed, &Budget::new(1 << 24));
            }
        }
    }

    /// A DDS of 4x4 pixels with a code of four letters and these blocks.
    fn blocks(code: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let mut words = [0u32; 32];
        words[0] = u32::from_le_bytes(*b"DDS ");
        words[1] = 124;
        words[2] = 0x1007;
        (words[3], words[4]) = (4, 4);
        words[19] = 32;
        words[20] = 4;
        words[21] = u32::from_le_bytes(*code);
        words[27] = 0x1000;
        [words.map(u32::to_le_bytes).concat().as_slice(), data].concat()
    }

    #[test]
    fn compressed_surfaces_are_read() {
        // Both ends of the line of colours are red.
        let red = [0x00, 0xf8, 0x00, 0xf8, 0, 0, 0, 0];
        let half = [0x88; 8];
        let steps = [0x80, 0x80, 0, 0, 0, 0, 0, 0];
        for (code, data, alpha) in [
            (b"DXT1", red.to_vec(), 255),
            (b"DXT3", [half, red].concat(), 136),
            (b"DXT5", [steps, red].concat(), 128),
        ] {
            let file = blocks(code, &data);
            let image = decode("a", &file, &Budget::default()).unwrap();
            assert_eq!((image.width, image.height), (4, 4));
            assert_eq!(image.rgba[..4], [255, 0, 0, alpha], "{}", String::from_utf8_lossy(code));
            for length in 4..file.len() {
                assert!(matches!(
                    decode("a", &file[..length], &Budget::default()),
                    Err(DecodeProblem::Damaged(_))
                ));
            }
        }
    }

    #[test]
    fn damaged_surfaces_are_no_panic() {
        let file = blocks(b"DXT5", &[0x80; 16]);
        for at in 0..file.len() {
            for value in [0, 1, 0x7f, 0xff] {
                let mut changed = file.clone();
                changed[at] = value;
                let _ = decode("a", &changed, &Budget::new(1 << 24));
            }
        }
    }

    #[test]
    fn other_formats_are_named() {
        for (bytes, format) in [
            (&b"\xabKTX 11\xbb\r\n\x1a\n"[..], "KTX"),
            (b"\0\0\0\x1cftypavif", "AVIF"),
            (b"8BPS", "PSD"),
            (b"mtllib a.mtl\nv 0 0 0\nv 0 0 0", "unknown"),
        ] {
            assert_eq!(decode("a", bytes, &Budget::default()), Err(DecodeProblem::Unsupported(format)));
        }
        assert!(matches!(decode("a", b"", &Budget::default()), Err(DecodeProblem::Damaged(_))));
    }
}
