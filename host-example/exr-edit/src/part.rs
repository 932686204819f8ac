//! One part of a file: what its header says, and where its chunks lie.
//!
//! Source: "OpenEXR File Layout" of the OpenEXR project. Attributes that are not understood stay where they are.

use std::ops::Range;
use std::sync::Arc;

use crate::cursor::{Cursor, LONGEST_NAME, TEXT_GROWTH};
use crate::error::{Error, Result};
use crate::layout::{Block, Channel, Sample, Tiles, Window};
use crate::limits::{Budget, Reserved};

/// Longest side of a window in pixels.
const LONGEST_SIDE: i64 = 65536;
/// Largest distance of a window from the origin, so that no sum overflows.
const FARTHEST: i64 = 1 << 30;
/// Bits of the version field: one tiled part, deep pixels, several parts.
pub const TILED: u32 = 0x200;
pub const DEEP: u32 = 0x800;
pub const MULTI_PART: u32 = 0x1000;
/// Fewest bytes of a channel in the file: a letter, its zero, and 16 bytes.
const SHORTEST_CHANNEL: usize = 18;
/// Fewest bytes of a view in the file: its length.
const SHORTEST_VIEW: usize = 4;

/// One part of a file. What is to change is in an [`Edit`](crate::Edit).
#[derive(Debug)]
#[non_exhaustive]
pub struct Part {
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
    /// The display window, where it is one.
    pub display: Option<Window>,
    /// Number of the compression, as files have it: 0 none, 1 RLE, 2 ZIPS, 3 ZIP, 4 PIZ, 5 PXR24, 6 B44, 7 B44A,
    /// 8 DWAA, 9 DWAB, 10 HTJ2K256, 11 HTJ2K32, 12 LJ2K, 13 ZSTD.
    pub compression: u8,
    /// Red, green, blue, white: x and y of each (CIE 1931).
    pub chromaticities: Option<[f32; 8]>,
    /// Width of a pixel over its height (`pixelAspectRatio`), where that is a positive number.
    pub pixel_aspect: Option<f32>,
    /// Row vectors times this matrix lead from the world to the camera.
    pub world_to_camera: Option<[f32; 16]>,
    /// All attributes up to and without the closing zero, as they were.
    pub(crate) header: Range<usize>,
    /// Range in the file of the value of `channels`, with its size before it.
    pub(crate) channel_list: Range<usize>,
    /// Place in the file of the value of `compression`.
    pub(crate) compression_at: usize,
    /// Place in the file of the value of `chunkCount`, where there is one.
    pub(crate) chunk_count_at: Option<usize>,
    /// Tiles, or nothing for scan lines.
    pub(crate) tiles: Option<Tiles>,
    /// All chunks, in the order of the offset table.
    pub(crate) chunks: Vec<Chunk>,
    /// Memory that lists and texts take.
    pub(crate) reserved: Reserved,
}

/// A piece of a part that is compressed by itself.
#[derive(Debug)]
pub struct Chunk {
    /// Pixels that it holds.
    pub block: Block,
    /// Its coordinates and the part's number, as they were.
    pub prefix: Range<usize>,
    /// The compressed bytes.
    pub data: Range<usize>,
}

impl Part {
    /// Index of a channel in [`channels`](Self::channels).
    pub fn channel(&self, name: &str) -> Option<usize> {
        self.channels.binary_search_by(|c| c.name.as_str().cmp(name)).ok()
    }

    /// Bytes of all samples of the part at all levels of resolution, not compressed.
    pub fn decoded_bytes(&self) -> u64 {
        self.chunks.iter().map(|c| c.block.bytes(&self.channels) as u64).sum()
    }

    /// Reads one header.
    ///
    /// # Errors
    /// [`Error::Damaged`], [`Error::Unsupported`] for deep pixels, [`Error::Memory`].
    pub(crate) fn parse(at: &mut Cursor<'_>, version: u32, budget: &Arc<Budget>) -> Result<Self> {
        let start = at.position();
        // A list of parts grows by doubling; then each part moves to a place of its own.
        let reserved = budget.reserve_many::<Self>(4)?;
        let mut header = Header::new(start, reserved);
        loop {
            let name = at.name()?;
            if name.is_empty() {
                break;
            }
            let kind = at.name()?;
            let before = at.position();
            let size = at.u32()? as usize;
            let value = at.take(size)?;
            match (name, kind, size) {
                ("channels", "chlist", _) => header.part.channel_list = before..at.position(),
                ("compression", "compression", 1) => header.part.compression_at = at.position() - size,
                ("chunkCount", "int", 4) => header.part.chunk_count_at = Some(at.position() - size),
                _ => {}
            }
            header.read(name, kind, value, budget)?;
        }
        header.part.header.end = at.position() - 1;
        header.finish(version)
    }

    /// The attributes of type `string`, as [`File::texts`](crate::File::texts) has them; `bytes` are the file's.
    pub(crate) fn texts<'a>(&self, bytes: &'a [u8]) -> impl Iterator<Item = (&'a str, &'a [u8])> + use<'a> {
        let mut at = Cursor::new(&bytes[self.header.clone()]);
        let mut next = move || -> Result<_> {
            let (name, kind) = (at.name()?, at.name()?);
            let size = at.u32()? as usize;
            Ok((name, kind, at.take(size)?.rest()))
        };
        // What was parsed once does not fail before its end.
        let all = std::iter::from_fn(move || next().ok());
        all.filter(|(_, kind, _)| *kind == "string").map(|(name, _, value)| (name, value))
    }
}

/// A header under way.
struct Header {
    part: Part,
    compression: Option<u8>,
    tiles: Option<Tiles>,
    /// The attribute `type`.
    kind: String,
}

impl Header {
    fn new(start: usize, reserved: Reserved) -> Self {
        let part = Part {
            name: String::new(),
            view: None,
            views: Vec::new(),
            channels: Vec::new(),
            window: Window { x: 0, y: 0, width: 0, height: 0 },
            display: None,
            compression: 0,
            chromaticities: None,
            pixel_aspect: None,
            world_to_camera: None,
            header: start..start,
            channel_list: 0..0,
            compression_at: 0,
            chunk_count_at: None,
            tiles: None,
            chunks: Vec::new(),
            reserved,
        };
        Self { part, compression: None, tiles: None, kind: String::new() }
    }

    /// Takes in one attribute.
    fn read(&mut self, name: &str, kind: &str, mut value: Cursor<'_>, budget: &Arc<Budget>) -> Result<()> {
        let part = &mut self.part;
        let mut text = |value: &mut Cursor<'_>| {
            part.reserved.join(budget.reserve_many::<[u8; TEXT_GROWTH]>(value.left())?);
            Ok::<_, Error>(value.text())
        };
        match (name, kind) {
            ("type", "string") => self.kind = text(&mut value)?,
            ("name", "string") => part.name = text(&mut value)?,
            ("view", "string") => part.view = Some(text(&mut value)?),
            ("channels", "chlist") => {
                part.reserved.join(budget.reserve(value.left() as u64)?);
                part.reserved.join(budget.reserve_many::<Channel>(value.left() / SHORTEST_CHANNEL + 1)?);
                part.channels = channels(&mut value)?;
            }
            ("multiView", "stringvector") => {
                let most = value.left() / SHORTEST_VIEW;
                part.reserved.join(budget.reserve_many::<[u8; TEXT_GROWTH]>(value.left())?);
                part.reserved.join(budget.reserve_many::<String>(most)?);
                part.views = Vec::with_capacity(most);
                while !value.is_empty() {
                    let length = value.u32()? as usize;
                    part.views.push(value.take(length)?.text());
                }
            }
            ("dataWindow", "box2i") => part.window = window(&mut value)?,
            // No pixel depends on it.
            ("displayWindow", "box2i") => part.display = window(&mut value).ok(),
            ("compression", "compression") => self.compression = Some(value.u8()?),
            ("tiles", "tiledesc") => {
                self.tiles = Some(Tiles { width: value.u32()?, height: value.u32()?, mode: value.u8()? });
            }
            ("chromaticities", "chromaticities") => part.chromaticities = Some(value.floats()?),
            ("pixelAspectRatio", "float") => {
                let [aspect] = value.floats()?;
                part.pixel_aspect = Some(aspect).filter(|aspect| aspect.is_finite() && *aspect > 0.0);
            }
            ("worldToCamera", "m44f") => part.world_to_camera = Some(value.floats()?),
            _ => {}
        }
        Ok(())
    }

    /// The part, when its attributes are all there and agree.
    fn finish(self, version: u32) -> Result<Part> {
        let (mut part, kind) = (self.part, self.kind);
        let several = version & MULTI_PART != 0;
        if version & DEEP != 0 && !several || kind.starts_with("deep") {
            return Err(Error::unsupported("holds deep pixels, which are not read", "flatten it"));
        }
        if several && !matches!(kind.as_str(), "tiledimage" | "scanlineimage") {
            // A name of any length is no help.
            let kind: String = kind.chars().take(LONGEST_NAME).collect();
            let problem = format!("has a part of type '{kind}', which is not read");
            return Err(Error::unsupported(problem, "convert it"));
        }
        if part.channels.is_empty() {
            return Err(Error::damaged("a part lists no channels"));
        }
        if part.window.width == 0 {
            return Err(Error::damaged("a part has no data window"));
        }
        part.compression = self.compression.ok_or_else(|| Error::damaged("a part names no compression"))?;
        let tiled = if several { kind == "tiledimage" } else { version & TILED != 0 };
        if tiled {
            let missing = || Error::damaged("a part does not say how large its tiles are");
            part.tiles = Some(self.tiles.ok_or_else(missing)?);
        }
        match part.channels.iter().find(|c| !part.window.fits(c.sampling) || tiled && c.sampling != (1, 1)) {
            Some(Channel { name, .. }) => {
                Err(Error::damaged(format!("the sampling of channel '{name}' does not fit the window")))
            }
            None => Ok(part),
        }
    }
}

/// Reads the list of channels; as many as its bytes can hold have a place.
fn channels(at: &mut Cursor<'_>) -> Result<Vec<Channel>> {
    let mut list: Vec<Channel> = Vec::with_capacity(at.left() / SHORTEST_CHANNEL + 1);
    loop {
        let name = at.name()?;
        if name.is_empty() {
            break;
        }
        let sample = match at.u32()? {
            0 => Sample::Uint,
            1 => Sample::Half,
            2 => Sample::Float,
            other => return Err(Error::damaged(format!("channel '{name}' is of unknown type {other}"))),
        };
        let flags = at.array()?;
        let sampling = (at.u32()? as usize, at.u32()? as usize);
        if !(1..=LONGEST_SIDE as usize).contains(&sampling.0)
            || !(1..=LONGEST_SIDE as usize).contains(&sampling.1)
        {
            return Err(Error::damaged(format!("channel '{name}' has an impossible sampling")));
        }
        if list.last().is_some_and(|last| last.name.as_str() >= name) {
            return Err(Error::damaged("the channels are not sorted by name"));
        }
        list.push(Channel { name: name.to_owned(), sample, flags, sampling });
    }
    Ok(list)
}

/// Reads a window.
fn window(at: &mut Cursor<'_>) -> Result<Window> {
    let [x0, y0, x1, y1] = [at.i32()?, at.i32()?, at.i32()?, at.i32()?].map(i64::from);
    let (width, height) = (x1 - x0 + 1, y1 - y0 + 1);
    let near = [x0, y0, x1, y1].iter().all(|v| v.abs() <= FARTHEST);
    if !near || !(1..=LONGEST_SIDE).contains(&width) || !(1..=LONGEST_SIDE).contains(&height) {
        return Err(Error::damaged(format!("a data window goes from {x0},{y0} to {x1},{y1}")));
    }
    // In range, as was just seen.
    Ok(Window { x: x0 as i32, y: y0 as i32, width: width as usize, height: height as usize })
}

/// The list of channels as the file holds it.
pub fn channel_list(channels: &[Channel]) -> Vec<u8> {
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
