//! EXR files: the colours of one layer, with everything else kept as it was.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatImage, FlatSamples, Layer, LayerAttributes, ReadChannels,
    ReadLayers, SmallVec, WritableImage,
};
use half::f16;

use super::read::{Family, Source, check_size, malformed};
use crate::error::{Error, Result};
use crate::output;
use crate::pixels::{Pixels, Precision, Samples};

/// An EXR file, and which of its channels are the picture.
#[derive(Debug)]
pub struct Layers {
    image: FlatImage,
    layer: usize,
    /// Channels of the layer: grey, RGB or RGBA, in this order.
    channels: Vec<usize>,
}

/// Reads the first layer that has red, green and blue, or grey alone.
///
/// # Errors
/// [`Error::Input`] for damaged and deep files and for files without such a layer.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Source> {
    let failed = |e: exr::error::Error| match e {
        exr::error::Error::NotSupported(what) => {
            Error::file(path, format!("is an EXR of a kind that is not read: {what}"), "convert it")
        }
        e => malformed(path, "EXR", e),
    };
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(failed)?;
    for header in &meta.headers {
        check_size(path, header.layer_size.x() as u64, header.layer_size.y() as u64)?;
        if header.deep {
            return Err(Error::file(path, "holds deep pixels, which are not read", "flatten it"));
        }
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(failed)?;
    let picture = |names: &[&str]| {
        image.layer_data.iter().enumerate().find_map(|(at, layer)| Some((at, find(layer, names)?)))
    };
    let Some((layer, mut channels)) = picture(&["R", "G", "B"]).or_else(|| picture(&["Y"])) else {
        return Err(Error::file(
            path,
            "has no layer with channels R, G and B of floats",
            "name a picture with colours",
        ));
    };
    if let [_, _, _] = channels[..]
        && let Some(alpha) = find(&image.layer_data[layer], &["A"])
    {
        channels.extend(alpha);
    }
    let layers = Layers { image, layer, channels };
    let pixels = layers.pixels().ok_or_else(|| malformed(path, "EXR", "its channels are of unequal size"))?;
    Ok(Source { pixels, family: Family::Light, profile: None, layers: Some(layers) })
}

type FlatLayer = Layer<AnyChannels<FlatSamples>>;

/// Channels of these names, which hold a float for every pixel; names may follow one common prefix and a dot.
fn find(layer: &FlatLayer, names: &[&str]) -> Option<Vec<usize>> {
    let list = &layer.channel_data.list;
    let name = |at: usize| list[at].name.to_string();
    let usable = |at: &usize| {
        list[*at].sampling.x() == 1
            && list[*at].sampling.y() == 1
            && !matches!(list[*at].sample_data, FlatSamples::U32(_))
    };
    let with = |prefix: &str| -> Option<Vec<usize>> {
        let wanted = |n: &&str| (0..list.len()).filter(usable).find(|at| name(*at) == format!("{prefix}{n}"));
        names.iter().map(wanted).collect()
    };
    let prefixes = (0..list.len()).filter_map(|at| Some(name(at).strip_suffix(names[0])?.to_owned()));
    with("").or_else(|| prefixes.filter(|p| p.ends_with('.')).find_map(|p| with(&p)))
}

impl Layers {
    fn pixels(&self) -> Option<Pixels> {
        let layer = &self.image.layer_data[self.layer];
        let (width, height) = (layer.size.x(), layer.size.y());
        let planes: Vec<&FlatSamples> =
            self.channels.iter().map(|at| &layer.channel_data.list[*at].sample_data).collect();
        let count = planes.len();
        if planes.iter().any(|p| p.len() != width * height) {
            return None;
        }
        let samples = if planes.iter().all(|p| matches!(p, FlatSamples::F16(_))) {
            let mut all = vec![f16::ZERO; width * height * count];
            for (offset, plane) in planes.iter().enumerate() {
                if let FlatSamples::F16(values) = plane {
                    all.iter_mut().skip(offset).step_by(count).zip(values).for_each(|(to, from)| *to = *from);
                }
            }
            Samples::F16(all)
        } else {
            let mut all = vec![0.0; width * height * count];
            for (offset, plane) in planes.iter().enumerate() {
                let values = plane.values_as_f32();
                all.iter_mut().skip(offset).step_by(count).zip(values).for_each(|(to, from)| *to = from);
            }
            Samples::F32(all)
        };
        Pixels::new(width as u32, height as u32, count as u32, samples)
    }

    /// Puts another picture of as many channels in the place of the one that was read.
    fn replace(&mut self, pixels: &Pixels) {
        let numbers = pixels.to_f32();
        let count = pixels.channels() as usize;
        let list = &mut self.image.layer_data[self.layer].channel_data.list;
        for (offset, at) in self.channels.iter().enumerate() {
            let values = numbers.iter().skip(offset).step_by(count).copied();
            list[*at].sample_data = match list[*at].sample_data {
                FlatSamples::F16(_) => FlatSamples::F16(values.map(f16::from_f32).collect()),
                _ => FlatSamples::F32(values.collect()),
            };
        }
    }
}

/// Writes a result: into a copy of the file that it came from when that is EXR and its channels are the same,
/// otherwise as a file of its own.
///
/// # Errors
/// [`Error::Input`] when the folder is missing or cannot be written.
pub fn write(path: &Path, pixels: &Pixels, layers: Option<Layers>) -> Result<()> {
    if let Some(mut layers) = layers {
        if layers.channels.len() == pixels.channels() as usize {
            layers.replace(pixels);
        } else {
            let old = &layers.image.layer_data[layers.layer];
            let mut layer = plain(pixels);
            layer.attributes = old.attributes.clone();
            layers.image.layer_data = SmallVec::from_iter([layer]);
        }
        return save(path, &layers.image);
    }
    let single = exr::prelude::Image::from_layer(plain(pixels));
    save(
        path,
        &FlatImage { attributes: single.attributes, layer_data: SmallVec::from_iter([single.layer_data]) },
    )
}

fn plain(pixels: &Pixels) -> FlatLayer {
    let names: &[&str] = match pixels.channels() {
        1 => &["Y"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    };
    let numbers = pixels.to_f32();
    let channel = |(offset, name): (usize, &&str)| {
        let values = numbers.iter().skip(offset).step_by(names.len()).copied();
        let samples = match pixels.precision() {
            Precision::U8 | Precision::F16 => FlatSamples::F16(values.map(f16::from_f32).collect()),
            Precision::U16 | Precision::F32 => FlatSamples::F32(values.collect()),
        };
        AnyChannel::new(*name, samples)
    };
    Layer::new(
        (pixels.width() as usize, pixels.height() as usize),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(names.iter().enumerate().map(channel).collect()),
    )
}

fn save(path: &Path, image: &FlatImage) -> Result<()> {
    output::write_beside(path, |file| image.write().to_buffered(file).map_err(|e| e.to_string()))
}
