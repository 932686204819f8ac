//! Pictures that came from no EXR file as EXR files of their own.

use std::io::{Seek, Write};

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
};
use half::f16;

use crate::pixels::{Pixels, Precision};

/// Writes one layer, compressed without loss: halves of 8-bit pictures and halves, otherwise floats.
///
/// # Errors
/// The reason as text.
pub fn write(out: &mut (impl Write + Seek), pixels: &Pixels) -> Result<(), String> {
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
    let layer = Layer::new(
        (pixels.width() as usize, pixels.height() as usize),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(names.iter().enumerate().map(channel).collect()),
    );
    Image::from_layer(layer).write().to_buffered(out).map_err(|e| e.to_string())
}
