//! The container of an OpenEXR file: headers, offset tables and chunks, by position in the file's bytes.
//!
//! Source: "OpenEXR File Layout" of the OpenEXR project. Nothing is decoded here and nothing is allocated that
//! the file's own length does not pay for, so that a damaged header costs no memory. What is not understood is
//! kept as bytes: that is how attributes, parts and chunks that nobody touches come out as they went in.

use std::ops::Range;

use super::Fault;
use super::blocks::{Block, Tiles, blocks};
use super::cursor::Cursor;

/// Longest side of a window in pixels, as the library takes.
const LONGEST_SIDE: i64 = 65536;
/// Largest distance of a window from the origin, so that no sum overflows.
const FARTHEST: i64 = 1 << 30;
/// Bits of the version field.
const TILED: u32 = 0x200;
const LONG_NAMES: u32 = 0x400;
const DEEP: u32 = 0x800;
const MULTI_PART: u32 = 0x1000;
/// Longest name without the long-names bit.
const SHORT_NAME: usize = 31;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Left column.
    pub x: i32,
    /// Top row.
    pub y: i32,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// How samples of a channel are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// 32-bit unsigned integers.
    Uint,
    /// 16-bit floats.
    Half,
    /// 32-bit floats.
    Float,
}

impl Sample {
    /// Bytes a sample.
    pub fn bytes(self) -> usize {
        if self == Self::Half { 2 } else { 4 }
    }
}

/// A channel as the header lists it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Full name with layer and view.
    pub name: String,
    /// How samples are stored.
    pub sample: Sample,
    /// The flags byte and the reserved bytes, as they were.
    pub flags: [u8; 4],
    /// Every how many columns and rows there is a sample.
    pub sampling: (usize, usize),
}

/// One part of a file.
#[derive(Debug)]
pub struct Part {
    /// All attributes up to and without the closing zero, as they were.
    pub header: Range<usize>,
    /// Where in the file the value of `channels` lies, with its size before it.
    channel_list: Range<usize>,
    /// Name of the part; empty without one.
    pub name: String,
    /// The view that the whole part shows.
    pub view: Option<String>,
    /// Views of a part that holds several; the first needs no name of its own.
    pub views: Vec<String>,
    /// Sorted by name.
    pub channels: Vec<Channel>,
    /// The data window.
    pub window: Window,
    /// Number of the compression.
    pub compression: u8,
    /// Tiles, or nothing for scan lines.
    pub tiles: Option<Tiles>,
    /// Red, green, blue, white: x and y of each.
    pub chromaticities: Option<[f32; 8]>,
    /// Row vectors times this matrix lead from the world to the camera.
    pub world_to_camera: Option<[f32; 16]>,
    /// All chunks, in the order of the offset table.
    pub chunks: Vec<Chunk>,
}

/// A piece of a part that is compressed by itself.
#[derive(Debug)]
pub struct Chunk {
    /// Which pixels it holds.
    pub block: Block,
    /// Its coordinates and the part's number, as they were.
    pub prefix: Range<usize>,
    /// The compressed bytes.
    pub data: Range<usize>,
}

/// A whole file.
#[derive(Debug)]
pub struct Container {
    /// The file.
    pub bytes: Vec<u8>,
    /// Its parts.
    pub parts: Vec<Part>,
}

impl Container {
    /// Finds everything in the file.
    pub fn new(bytes: Vec<u8>) -> Result<Self, Fault> {
        let mut at = Cursor::new(&bytes);
        at.skip(4)?;
        let version = at.u32()?;
        if !matches!(version & 0xff, 1 | 2) || version & !(0xff | TILED | LONG_NAMES | DEEP | MULTI_PART) != 0
        {
            return Err(Fault::unsupported(format!("is an EXR of version {version:#x}, which is not read")));
        }
        let multi_part = version & MULTI_PART != 0;
        let mut parts = Vec::new();
        loop {
            parts.push(part(&mut at, version)?);
            if !multi_part || at.peek() == Some(0) {
                break;
            }
        }
        if multi_part {
            at.skip(1)?;
        }
        for (number, part) in parts.iter_mut().enumerate() {
            let blocks = blocks(part, bytes.len() / 8)?;
            let mut offsets = Vec::with_capacity(blocks.len());
            for _ in 0..blocks.len() {
                offsets.push(at.u64()?);
            }
            part.chunks = Vec::with_capacity(blocks.len());
            for (block, offset) in blocks.into_iter().zip(offsets) {
                let number = multi_part.then_some(number);
                part.chunks.push(chunk(&bytes, offset, number, block, part.tiles.is_some())?);
            }
        }
        Ok(Self { bytes, parts })
    }

    /// Writes the file again with other data in some chunks, and other channels in some parts. `channels` and
    /// `data` are asked for every part and chunk; nothing means as it was. Chunks keep their order.
    pub fn write(
        &self,
        channels: impl Fn(usize) -> Option<Vec<Channel>>,
        data: impl Fn(usize, usize) -> Option<Vec<u8>>,
        out: &mut impl std::io::Write,
    ) -> std::io::Result<()> {
        let lists: Vec<Option<Vec<Channel>>> = (0..self.parts.len()).map(channels).collect();
        let long = lists.iter().flatten().flatten().any(|c| c.name.len() > SHORT_NAME);
        let version = self.bytes[4..8].first_chunk().map_or(2, |b| u32::from_le_bytes(*b));
        let mut head = self.bytes[..4].to_vec();
        head.extend((version | if long { LONG_NAMES } else { 0 }).to_le_bytes());
        for (part, list) in self.parts.iter().zip(&lists) {
            if let Some(list) = list {
                head.extend(&self.bytes[part.header.start..part.channel_list.start]);
                let value = channel_list(list);
                head.extend((value.len() as u32).to_le_bytes());
                head.extend(value);
                head.extend(&self.bytes[part.channel_list.end..part.header.end]);
            } else {
                head.extend(&self.bytes[part.header.clone()]);
            }
            head.push(0);
        }
        if version & MULTI_PART != 0 {
            head.push(0);
        }
        let mut order: Vec<(usize, usize)> = (0..self.parts.len())
            .flat_map(|part| (0..self.parts[part].chunks.len()).map(move |chunk| (part, chunk)))
            .collect();
        order.sort_by_key(|(part, chunk)| self.parts[*part].chunks[*chunk].prefix.start);
        let replaced: Vec<Option<Vec<u8>>> = order.iter().map(|(part, chunk)| data(*part, *chunk)).collect();
        let mut offset = (head.len() + 8 * order.len()) as u64;
        let mut tables: Vec<Vec<u64>> = self.parts.iter().map(|p| vec![0; p.chunks.len()]).collect();
        for ((part, chunk), data) in order.iter().zip(&replaced) {
            let old = &self.parts[*part].chunks[*chunk];
            tables[*part][*chunk] = offset;
            offset += (old.prefix.len() + 4 + data.as_ref().map_or(old.data.len(), Vec::len)) as u64;
        }
        out.write_all(&head)?;
        for entry in tables.iter().flatten() {
            out.write_all(&entry.to_le_bytes())?;
        }
        for ((part, chunk), data) in order.iter().zip(&replaced) {
            let old = &self.parts[*part].chunks[*chunk];
            let data = data.as_deref().unwrap_or(&self.bytes[old.data.clone()]);
            out.write_all(&self.bytes[old.prefix.clone()])?;
            out.write_all(&(data.len() as u32).to_le_bytes())?;
            out.write_all(data)?;
        }
        Ok(())
    }
}

/// One header.
fn part(at: &mut Cursor<'_>, version: u32) -> Result<Part, Fault> {
    let start = at.position();
    let mut part = Part {
        header: start..start,
        channel_list: 0..0,
        name: String::new(),
        view: None,
        views: Vec::new(),
        channels: Vec::new(),
        window: Window { x: 0, y: 0, width: 0, height: 0 },
        compression: u8::MAX,
        tiles: None,
        chromaticities: None,
        world_to_camera: None,
        chunks: Vec::new(),
    };
    let (mut kind, mut tiles) = (String::new(), None);
    loop {
        let name = at.name()?;
        if name.is_empty() {
            break;
        }
        let type_name = at.name()?;
        let before = at.position();
        let size = at.u32()? as usize;
        let mut value = at.take(size)?;
        match (name.as_str(), type_name.as_str()) {
            ("channels", "chlist") => {
                part.channels = channels(&mut value)?;
                part.channel_list = before..at.position();
            }
            ("dataWindow", "box2i") => part.window = window(&mut value)?,
            ("compression", "compression") => part.compression = value.u8()?,
            ("tiles", "tiledesc") => {
                tiles = Some(Tiles { width: value.u32()?, height: value.u32()?, mode: value.u8()? });
            }
            ("type", "string") => kind = value.rest(),
            ("name", "string") => part.name = value.rest(),
            ("view", "string") => part.view = Some(value.rest()),
            ("multiView", "stringvector") => {
                while !value.is_empty() {
                    let length = value.u32()? as usize;
                    part.views.push(value.take(length)?.rest());
                }
            }
            ("chromaticities", "chromaticities") => part.chromaticities = Some(value.floats()?),
            ("worldToCamera", "m44f") => part.world_to_camera = Some(value.floats()?),
            _ => {}
        }
    }
    part.header.end = at.position() - 1;
    if version & DEEP != 0 && version & MULTI_PART == 0 || kind.starts_with("deep") {
        return Err(Fault::Unsupported {
            problem: "holds deep pixels, which are not read".into(),
            mend: "flatten it".into(),
        });
    }
    let tiled = if version & MULTI_PART == 0 { version & TILED != 0 } else { kind == "tiledimage" };
    if version & MULTI_PART != 0 && !matches!(kind.as_str(), "tiledimage" | "scanlineimage") {
        return Err(Fault::unsupported(format!("has a part of type '{kind}', which is not read")));
    }
    if part.channels.is_empty() {
        return Err(Fault::damaged("a part lists no channels"));
    }
    if part.window.width == 0 {
        return Err(Fault::damaged("a part has no data window"));
    }
    if part.compression == u8::MAX {
        return Err(Fault::damaged("a part names no compression"));
    }
    if tiled {
        part.tiles =
            Some(tiles.ok_or_else(|| Fault::damaged("a part does not say how large its tiles are"))?);
    }
    for channel in &part.channels {
        let (sx, sy) = channel.sampling;
        let Window { x, y, width, height } = part.window;
        let fits = |origin: i32, length: usize, step: usize| {
            i64::from(origin).rem_euclid(step as i64) == 0 && length.is_multiple_of(step)
        };
        if !fits(x, width, sx) || !fits(y, height, sy) || tiled && (sx, sy) != (1, 1) {
            let name = &channel.name;
            return Err(Fault::damaged(format!("the sampling of channel '{name}' does not fit the window")));
        }
    }
    Ok(part)
}

fn channels(at: &mut Cursor<'_>) -> Result<Vec<Channel>, Fault> {
    let mut list: Vec<Channel> = Vec::new();
    loop {
        let name = at.name()?;
        if name.is_empty() {
            break;
        }
        let sample = match at.u32()? {
            0 => Sample::Uint,
            1 => Sample::Half,
            2 => Sample::Float,
            other => return Err(Fault::damaged(format!("channel '{name}' is of unknown type {other}"))),
        };
        let flags = at.array()?;
        let sampling = (at.u32()? as usize, at.u32()? as usize);
        if !(1..=LONGEST_SIDE as usize).contains(&sampling.0)
            || !(1..=LONGEST_SIDE as usize).contains(&sampling.1)
        {
            return Err(Fault::damaged(format!("channel '{name}' has an impossible sampling")));
        }
        if list.last().is_some_and(|last| last.name >= name) {
            return Err(Fault::damaged("the channels are not sorted by name"));
        }
        list.push(Channel { name, sample, flags, sampling });
    }
    Ok(list)
}

fn channel_list(channels: &[Channel]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for channel in channels {
        bytes.extend(channel.name.as_bytes());
        bytes.push(0);
        let sample = match channel.sample {
            Sample::Uint => 0u32,
            Sample::Half => 1,
            Sample::Float => 2,
        };
        bytes.extend(sample.to_le_bytes());
        bytes.extend(channel.flags);
        bytes.extend((channel.sampling.0 as u32).to_le_bytes());
        bytes.extend((channel.sampling.1 as u32).to_le_bytes());
    }
    bytes.push(0);
    bytes
}

fn window(at: &mut Cursor<'_>) -> Result<Window, Fault> {
    let [x0, y0, x1, y1] = [at.i32()?, at.i32()?, at.i32()?, at.i32()?].map(i64::from);
    let (width, height) = (x1 - x0 + 1, y1 - y0 + 1);
    let near = [x0, y0, x1, y1].iter().all(|v| v.abs() <= FARTHEST);
    if !near || !(1..=LONGEST_SIDE).contains(&width) || !(1..=LONGEST_SIDE).contains(&height) {
        return Err(Fault::damaged(format!("a data window goes from {x0},{y0} to {x1},{y1}")));
    }
    // In range, as was just seen.
    Ok(Window { x: x0 as i32, y: y0 as i32, width: width as usize, height: height as usize })
}

/// The chunk at an offset, which must say of itself what the table says.
fn chunk(bytes: &[u8], offset: u64, part: Option<usize>, block: Block, tiled: bool) -> Result<Chunk, Fault> {
    let start = usize::try_from(offset).ok().filter(|o| *o < bytes.len());
    let start = start.ok_or_else(|| Fault::damaged("it ends before the picture does"))?;
    let mut at = Cursor::new(bytes);
    at.skip(start)?;
    let mut told = Vec::with_capacity(5);
    for _ in 0..usize::from(part.is_some()) + if tiled { 4 } else { 1 } {
        told.push(i64::from(at.i32()?));
    }
    let expected = part.map(|p| p as i64).into_iter().chain(block.coordinates(tiled));
    if !expected.eq(told.iter().copied()) {
        return Err(Fault::damaged("a chunk is not where the table of offsets says"));
    }
    let prefix = start..at.position();
    let size = at.u32()? as usize;
    let data = at.position()..at.position() + at.take(size)?.len();
    Ok(Chunk { block, prefix, data })
}
