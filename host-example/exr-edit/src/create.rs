//! New files: one part of named channels, compressed without loss.

use std::io::{Seek, Write};

use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes, Text,
    Vec2, WritableImage,
};

use crate::content::Plane;
use crate::error::{Error, Result};

/// Content of a new file.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// Columns of the data window, which begins at the origin.
    pub width: usize,
    /// Rows of the data window.
    pub height: usize,
    /// Full names, with layer and view, and `width * height` samples of each, which are stored as they are.
    pub channels: Vec<(String, Plane)>,
    /// Name of the program that made the picture (`software`).
    pub software: Option<String>,
    /// Remarks (`comments`).
    pub comments: Option<String>,
    /// Red, green, blue, white: x and y of each (`chromaticities`); Rec. ITU-R BT.709 without.
    pub chromaticities: Option<[f32; 8]>,
    /// Width of a pixel over its height (`pixelAspectRatio`); 1 without.
    pub pixel_aspect: Option<f32>,
    /// Row vectors times this matrix lead from the world to the camera (`worldToCamera`).
    pub world_to_camera: Option<[f32; 16]>,
    /// Row vectors times this matrix lead from the world to the window, each side from -1 to 1 (`worldToNDC`).
    pub world_to_ndc: Option<[f32; 16]>,
    /// Names and values of further attributes, whose type is `string`.
    pub texts: Vec<(String, String)>,
}

/// Writes a file of scan lines under ZIP compression, 16 rows in a chunk.
///
/// # Errors
/// [`Error::Argument`] for channels whose number of samples does not fit, that are twice there, or that have names that
/// are no ASCII, and for texts that are none; [`Error::Write`].
pub fn write(picture: &Picture, out: &mut (impl Write + Seek)) -> Result<()> {
    let mut channels = Vec::with_capacity(picture.channels.len());
    for (name, plane) in &picture.channels {
        if plane.len() != picture.width * picture.height || plane.is_empty() {
            let (count, width, height) = (plane.len(), picture.width, picture.height);
            return Err(Error::Argument(format!(
                "{count} samples do not fill channel '{name}' of {width}x{height} pixels"
            )));
        }
        let samples = match plane {
            Plane::Uint(v) => FlatSamples::U32(v.clone()),
            Plane::Half(v) => FlatSamples::F16(v.clone()),
            Plane::Float(v) => FlatSamples::F32(v.clone()),
        };
        channels.push(AnyChannel::new(text(name)?, samples));
    }
    let mut names: Vec<&str> = picture.channels.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Error::Argument(format!("there are two channels '{}'", twice[0])));
    }
    let attributes = LayerAttributes {
        software_name: picture.software.as_deref().map(text).transpose()?,
        comments: picture.comments.as_deref().map(text).transpose()?,
        world_to_camera: picture.world_to_camera,
        world_to_normalized_device: picture.world_to_ndc,
        other: picture.texts.iter().map(attribute).collect::<Result<_>>()?,
        ..LayerAttributes::default()
    };
    let size = (picture.width, picture.height);
    let channels = AnyChannels::sort(channels.into_iter().collect());
    let mut image = Image::from_layer(Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels));
    image.attributes.chromaticities = picture.chromaticities.map(|[rx, ry, gx, gy, bx, by, wx, wy]| {
        Chromaticities { red: Vec2(rx, ry), green: Vec2(gx, gy), blue: Vec2(bx, by), white: Vec2(wx, wy) }
    });
    image.attributes.pixel_aspect = picture.pixel_aspect.unwrap_or(1.0);
    image.write().to_buffered(out).map_err(|error| match error {
        exr::error::Error::Io(error) => Error::Write(error),
        other => Error::Argument(other.to_string()),
    })
}

fn attribute((name, value): &(String, String)) -> Result<(Text, AttributeValue)> {
    Ok((text(name)?, AttributeValue::Text(text(value)?)))
}

fn text(name: &str) -> Result<Text> {
    let refused = || Error::Argument(format!("'{name}' cannot be written as text"));
    Text::new_or_none(name).filter(|_| !name.is_empty() && !name.contains('\0')).ok_or_else(refused)
}
