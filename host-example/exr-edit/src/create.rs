//! New files: one part of named channels, compressed without loss.

use std::io::{Seek, SeekFrom, Write};

use exr::meta::attribute::{ChannelDescription, Chromaticities, LineOrder, SampleType};
use exr::meta::header::{Header, ImageAttributes};
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{AttributeValue, Compression, LayerAttributes, Text, Vec2};
use rayon::prelude::*;

use crate::codec::{ZIP_LINES, smaller_zip};
use crate::content::Plane;
use crate::cursor::Cursor;
use crate::error::{Error, Result};
use crate::file::LONG_NAMES;

/// Chunks that each thread compresses before they are written: few enough to take little memory.
const CHUNKS_AT_ONCE: usize = 4;
/// The first bytes of every EXR file.
pub const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// The version field of a file of scan lines of one part.
const VERSION: u32 = 2;
/// Bytes of the place of a chunk.
const OFFSET: usize = 8;

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
    let mut channels: Vec<&(String, Plane)> = picture.channels.iter().collect();
    // Files have them in this order.
    channels.sort_unstable_by(|(a, _), (b, _)| a.as_bytes().cmp(b.as_bytes()));
    for (name, plane) in &channels {
        if plane.len() != picture.width * picture.height || plane.is_empty() {
            let (count, width, height) = (plane.len(), picture.width, picture.height);
            return Err(Error::Argument(format!(
                "{count} samples do not fill channel '{name}' of {width}x{height} pixels"
            )));
        }
    }
    if let Some(twice) = channels.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        return Err(Error::Argument(format!("there are two channels '{}'", twice[0].0)));
    }
    let planes: Vec<&Plane> = channels.iter().map(|(_, plane)| plane).collect();
    let head = head(header(picture, &channels)?)?;
    let rows: Vec<usize> = (0..picture.height).step_by(ZIP_LINES).collect();
    let mut offsets = Vec::with_capacity(rows.len());
    let mut at = (head.len() + OFFSET * rows.len()) as u64;
    let start = out.stream_position()?;
    out.write_all(&head)?;
    // Their places are not known before they are compressed.
    out.write_all(&vec![0; OFFSET * rows.len()])?;
    for rows in rows.chunks(CHUNKS_AT_ONCE * rayon::current_num_threads()) {
        let pack = |first: &usize| smaller_zip(rows_of(&planes, picture, *first));
        for (first, packed) in rows.iter().zip(rows.par_iter().map(pack).collect::<Vec<_>>()) {
            offsets.push(at);
            at += (2 * size_of::<i32>() + packed.len()) as u64;
            out.write_all(&(*first as i32).to_le_bytes())?;
            out.write_all(&(packed.len() as i32).to_le_bytes())?;
            out.write_all(&packed)?;
        }
    }
    out.seek(SeekFrom::Start(start + head.len() as u64))?;
    out.write_all(&offsets.iter().flat_map(|offset| offset.to_le_bytes()).collect::<Vec<_>>())?;
    out.seek(SeekFrom::Start(start + at))?;
    Ok(())
}

/// Bytes of a file before its chunks and their places: what it is, and its header, whose attributes are sorted by their names so
/// that files of the same content are the same.
fn head(header: Header) -> Result<Vec<u8>> {
    let failed = |error: exr::error::Error| Error::Argument(error.to_string());
    let has_long_names =
        MetaData::validate(std::slice::from_ref(&header), true).map_err(failed)?.has_long_names;
    let mut unsorted = Vec::new();
    header.write(&mut unsorted).map_err(failed)?;
    let (mut cursor, mut attributes) = (Cursor::new(&unsorted), Vec::new());
    while cursor.peek().is_some_and(|byte| byte != 0) {
        let start = cursor.position();
        let name = cursor.name()?;
        cursor.name()?;
        let size = cursor.u32()?;
        cursor.skip(size as usize)?;
        attributes.push((name, start..cursor.position()));
    }
    attributes.sort_unstable_by_key(|(name, _)| *name);
    let mut head = MAGIC.to_vec();
    head.extend((VERSION | if has_long_names { LONG_NAMES } else { 0 }).to_le_bytes());
    attributes.into_iter().for_each(|(_, bytes)| head.extend(&unsorted[bytes]));
    head.push(0);
    Ok(head)
}

/// The samples of a chunk that begins at a row: of each row all channels, one after the other.
fn rows_of(planes: &[&Plane], picture: &Picture, first: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    for y in first..(first + ZIP_LINES).min(picture.height) {
        let row = y * picture.width..(y + 1) * picture.width;
        for plane in planes {
            match plane {
                Plane::Uint(v) => bytes.extend(v[row.clone()].iter().flat_map(|v| v.to_le_bytes())),
                Plane::Half(v) => bytes.extend(v[row.clone()].iter().flat_map(|v| v.to_le_bytes())),
                Plane::Float(v) => bytes.extend(v[row.clone()].iter().flat_map(|v| v.to_le_bytes())),
            }
        }
    }
    bytes
}

fn header(picture: &Picture, channels: &[&(String, Plane)]) -> Result<Header> {
    let description = |(name, plane): &&(String, Plane)| {
        let sample_type = match plane {
            Plane::Uint(_) => SampleType::U32,
            Plane::Half(_) => SampleType::F16,
            Plane::Float(_) => SampleType::F32,
        };
        Ok(ChannelDescription::named(text(name)?, sample_type))
    };
    let channels = channels.iter().map(description).collect::<Result<_>>()?;
    let own = LayerAttributes {
        software_name: picture.software.as_deref().map(text).transpose()?,
        comments: picture.comments.as_deref().map(text).transpose()?,
        world_to_camera: picture.world_to_camera,
        world_to_normalized_device: picture.world_to_ndc,
        other: picture.texts.iter().map(attribute).collect::<Result<_>>()?,
        ..LayerAttributes::default()
    };
    let size = (picture.width, picture.height);
    let mut shared = ImageAttributes::with_size(size);
    shared.chromaticities = picture.chromaticities.map(|[rx, ry, gx, gy, bx, by, wx, wy]| Chromaticities {
        red: Vec2(rx, ry),
        green: Vec2(gx, gy),
        blue: Vec2(bx, by),
        white: Vec2(wx, wy),
    });
    shared.pixel_aspect = picture.pixel_aspect.unwrap_or(1.0);
    let header = Header::new(Text::default(), size, channels)
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(own)
        .with_shared_attributes(shared);
    Ok(header)
}

fn attribute((name, value): &(String, String)) -> Result<(Text, AttributeValue)> {
    Ok((text(name)?, AttributeValue::Text(text(value)?)))
}

fn text(name: &str) -> Result<Text> {
    let refused = || Error::Argument(format!("'{name}' cannot be written as text"));
    Text::new_or_none(name).filter(|_| !name.is_empty() && !name.contains('\0')).ok_or_else(refused)
}
