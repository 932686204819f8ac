//! Pictures of 32-bit floats in main memory, and writing them as PNG or EXR.

use std::path::Path;

use half::f16;
use isophote_exr_edit::{Plane, create};

use crate::primaries::Chromaticities;
use crate::transfer::srgb_encode;
use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};

/// An image of 32-bit floats, channels interleaved, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Numbers per pixel.
    pub channels: usize,
    /// `width * height * channels` numbers.
    pub data: Vec<f32>,
}

/// Precision of the numbers in an EXR file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 16 bit, enough for colours.
    Half,
    /// 32 bit, for ids, depths and motion.
    Float,
}

/// Saves a picture as its extension says. One of 4 channels is linear red, green and blue with premultiplied
/// alpha: 8-bit sRGB-encoded PNG, or linear EXR in half precision. One of 1 channel is a number, kept as it is:
/// grey PNG from 0 to 1, or EXR in single precision.
///
/// # Errors
/// As [`files::write()`]; [`Error::Input`] for other extensions.
pub fn save(path: &Path, existing: Existing, picture: &Picture) -> Result<()> {
    match extension(path).as_str() {
        "png" => save_png(path, existing, picture, false),
        "exr" if picture.channels == 1 => {
            save_exr(path, existing, picture, &["Y"], Precision::Float, (None, None))
        }
        "exr" => save_exr(path, existing, picture, &["R", "G", "B", "A"], Precision::Half, (None, None)),
        _ => Err(unknown_extension(path)),
    }
}

/// Checks that [`save`] knows the extension; asked before any work is done.
///
/// # Errors
/// [`Error::Input`] naming the file and the extensions that are known.
pub fn check_extension(path: &Path) -> Result<()> {
    match extension(path).as_str() {
        "png" | "exr" => Ok(()),
        _ => Err(unknown_extension(path)),
    }
}

fn unknown_extension(path: &Path) -> Error {
    Error::file(path, "is not a kind of picture that is written", "name a .png or .exr file")
}

/// True where a path names an EXR file.
pub fn is_exr(path: &Path) -> bool {
    extension(path) == "exr"
}

fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Saves a picture as PNG of 8 bits, or of 16 where it is to be deep.
///
/// # Errors
/// As [`files::write()`].
pub fn save_png(path: &Path, existing: Existing, picture: &Picture, is_deep: bool) -> Result<()> {
    let most = if is_deep { 65535.0 } else { 255.0 };
    let whole = |value: f32| (value.clamp(0.0, 1.0) * most + 0.5) as u16;
    let mut samples = Vec::with_capacity(picture.data.len());
    let mut opaque = true;
    for pixel in picture.data.chunks_exact(picture.channels) {
        match pixel {
            [r, g, b, a] => {
                // PNG keeps colour and coverage apart.
                let unpremultiply = if *a > 0.0 && *a < 1.0 { 1.0 / a } else { 1.0 };
                samples.extend([r, g, b].map(|v| whole(srgb_encode(v * unpremultiply))));
                samples.push(whole(*a));
                opaque &= *a >= 1.0;
            }
            _ => samples.extend(pixel.first().map(|v| whole(*v))),
        }
    }
    use image::ExtendedColorType as Color;
    let color = match (picture.channels, opaque, is_deep) {
        (4, true, false) => Color::Rgb8,
        (4, false, false) => Color::Rgba8,
        (4, true, true) => Color::Rgb16,
        (4, false, true) => Color::Rgba16,
        (_, _, false) => Color::L8,
        (_, _, true) => Color::L16,
    };
    if picture.channels == 4 && opaque {
        samples = samples.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    }
    let bytes: Vec<u8> = match is_deep {
        // The encoder takes the machine's order.
        true => samples.into_iter().flat_map(u16::to_ne_bytes).collect(),
        false => samples.into_iter().map(|v| v as u8).collect(),
    };
    files::write(path, existing, |file| {
        let encoder = image::codecs::png::PngEncoder::new(file);
        image::ImageEncoder::write_image(encoder, &bytes, picture.width, picture.height, color)
            .map_err(|e| e.to_string())
    })
}

/// Saves all channels under the given names as linear EXR of these primaries and pixels of this shape, compressed without loss;
/// Rec.709 and square ones need not be named.
///
/// # Errors
/// As [`files::write()`].
pub fn save_exr(
    path: &Path,
    existing: Existing,
    picture: &Picture,
    names: &[&str],
    precision: Precision,
    (chromaticities, pixel_aspect): (Option<Chromaticities>, Option<f32>),
) -> Result<()> {
    let image =
        create::Picture { chromaticities, pixel_aspect, ..created(&[Layer { picture, names, precision }]) };
    write_exr(path, existing, &image)
}

/// Numbers of an EXR file: a picture with the full names of its channels.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// The numbers; all layers of a file have the same size.
    pub picture: &'a Picture,
    /// A name for each number of a pixel, such as `N.X`.
    pub names: &'a [&'a str],
    /// Precision in which they are stored.
    pub precision: Precision,
}

/// What the header of an EXR file says beside its channels.
#[derive(Clone, Debug, Default)]
pub struct Header {
    /// The camera's matrix for row vectors, row by row.
    pub world_to_camera: Option<[f32; 16]>,
    /// Names and values of further attributes.
    pub texts: Vec<(String, String)>,
}

/// Saves several layers as one linear EXR file, compressed without loss.
///
/// # Errors
/// As [`files::write()`]; [`Error::Input`] for layers that do not fit together.
pub fn save_layers(path: &Path, existing: Existing, layers: &[Layer<'_>], header: Header) -> Result<()> {
    let Header { world_to_camera, texts } = header;
    write_exr(path, existing, &create::Picture { world_to_camera, texts, ..created(layers) })
}

fn created(layers: &[Layer<'_>]) -> create::Picture {
    let size = layers.first().map_or((0, 0), |layer| (layer.picture.width, layer.picture.height));
    create::Picture {
        width: size.0 as usize,
        height: size.1 as usize,
        channels: layers.iter().flat_map(planes).collect(),
        ..create::Picture::default()
    }
}

fn write_exr(path: &Path, existing: Existing, image: &create::Picture) -> Result<()> {
    files::write(path, existing, |file| create::write(image, file).map_err(|e| e.to_string()))
}

/// The numbers of a layer as the channels of an EXR file, as many as have names.
fn planes(layer: &Layer<'_>) -> Vec<(String, Plane)> {
    let count = layer.picture.channels;
    let plane = |(index, name): (usize, &&str)| {
        let values = layer.picture.data.iter().skip(index).step_by(count).copied();
        let plane = match layer.precision {
            Precision::Half => Plane::Half(values.map(f16::from_f32).collect()),
            Precision::Float => Plane::Float(values.collect()),
        };
        ((*name).to_owned(), plane)
    };
    layer.names.iter().take(count).enumerate().map(plane).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn gradient() -> Picture {
        let data = (0..5 * 3).flat_map(|i| [i as f32 / 14.0, 0.25, 0.5, 1.0]).collect();
        Picture { width: 5, height: 3, channels: 4, data }
    }

    #[test]
    fn png_is_srgb_encoded() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        save(&path, Existing::Keep, &gradient()).unwrap();
        let read = image::open(&path).unwrap().into_rgba8();
        assert_eq!(read.dimensions(), (5, 3));
        assert_eq!(read.get_pixel(4, 2).0, [255, 137, 188, 255]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left behind");
    }

    #[test]
    fn exr_keeps_numbers_and_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let picture = Picture { width: 2, height: 1, channels: 2, data: vec![1e-7, -3.5, 70000.0, 0.1] };
        save_exr(&path, Existing::Keep, &picture, &["motion.X", "motion.Y"], Precision::Float, (None, None))
            .unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        let channels = &read.layer_data.channel_data.list;
        assert_eq!(channels[0].name.to_string(), "motion.X");
        assert_eq!(channels[0].sample_data.values_as_f32().collect::<Vec<_>>(), [1e-7, 70000.0]);
        assert_eq!(channels[1].sample_data.values_as_f32().collect::<Vec<_>>(), [-3.5, 0.1]);
    }

    #[test]
    fn unwritable_places_are_input_errors() {
        let folder = tempfile::tempdir().unwrap();
        for path in ["missing/a.png", "missing/a.exr", "a.tiff"] {
            let error = save(&folder.path().join(path), Existing::Keep, &gradient()).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert_eq!(error.to_string().lines().count(), 1);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
