//! The container of an OpenEXR file: headers, offset tables and chunks, by position in the file's bytes.
//!
//! Source: "OpenEXR File Layout" of the OpenEXR project. Nothing is decoded here. What is not understood is kept as
//! bytes: that is how attributes, parts and chunks that nobody touches come out as they went in.

use std::io::Write;
use std::sync::Arc;

use crate::codec;
use crate::cursor::Cursor;
use crate::edit::{self, Edit, PartEdit};
use crate::error::{Error, Result};
use crate::layout::{Block, Layout};
use crate::limits::{Budget, Limits, Reserved};
use crate::part::{Chunk, DEEP, MULTI_PART, Part, TILED, channel_list};
use crate::planes::Decoded;

/// Bit of the version field: names of more than [`SHORT_NAME`] bytes.
const LONG_NAMES: u32 = 0x400;
/// Longest name without that bit.
const SHORT_NAME: usize = 31;

/// A file of which nothing is decoded.
#[derive(Debug)]
pub struct File {
    bytes: Vec<u8>,
    parts: Vec<Arc<Part>>,
    budget: Arc<Budget>,
}

/// Compressed chunks of a part, where it has new ones.
type Data = Option<Vec<Vec<u8>>>;

impl File {
    /// Finds the parts and chunks of a whole file in memory. Every chunk must lie where the table of offsets says.
    ///
    /// # Errors
    /// [`Error::Damaged`], [`Error::Unsupported`] for versions and kinds of parts that are not read,
    /// [`Error::Memory`].
    pub fn parse(bytes: Vec<u8>, limits: Limits) -> Result<Self> {
        let budget = Budget::new(limits);
        let mut at = Cursor::new(&bytes);
        at.skip(4)?;
        let version = at.u32()?;
        if !matches!(version & 0xff, 1 | 2) || version & !(0xff | TILED | LONG_NAMES | DEEP | MULTI_PART) != 0
        {
            let problem = format!("is an EXR of version {version:#x}, which is not read");
            return Err(Error::unsupported(problem, "convert it"));
        }
        let several = version & MULTI_PART != 0;
        let mut parts = Vec::new();
        loop {
            parts.push(Part::parse(&mut at, version, &budget)?);
            if !several || at.peek() == Some(0) {
                break;
            }
        }
        if several {
            at.skip(1)?;
        }
        for (number, part) in parts.iter_mut().enumerate() {
            let layout = Layout::new(part.window, part.compression, part.tiles, limits.pixels)?;
            let count = layout.count();
            // The table alone must fit into the file.
            let mut table = at.take(count.checked_mul(8).ok_or_else(Error::ends)?)?;
            part.reserved.join(budget.reserve_many::<Chunk>(count)?);
            part.chunks = Vec::with_capacity(count);
            for block in layout.blocks() {
                let number = several.then_some(number);
                part.chunks.push(chunk(&bytes, table.u64()?, number, block, part.tiles.is_some())?);
            }
        }
        let parts = parts.into_iter().map(Arc::new).collect();
        Ok(Self { bytes, parts, budget })
    }

    /// The parts, in the order of the file.
    pub fn parts(&self) -> &[Arc<Part>] {
        &self.parts
    }

    /// The attributes of type `string` of a part: names, and bytes that should be UTF-8, in the order of the file.
    pub fn texts(&self, part: usize) -> impl Iterator<Item = (&str, &[u8])> {
        self.parts.get(part).into_iter().flat_map(|part| part.texts(&self.bytes))
    }

    /// Length of the file in bytes.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }

    /// True where [`decode`](Self::decode) reads the compression of a part.
    pub fn can_decode(&self, part: usize) -> bool {
        self.parts.get(part).is_some_and(|part| codec::check(part).is_ok())
    }

    /// Decompresses all chunks of a part, side by side on rayon's threads.
    ///
    /// # Errors
    /// [`Error::Damaged`]; [`Error::Unsupported`] for compressions that could not be written again;
    /// [`Error::Memory`]; [`Error::Argument`] when there is no such part.
    pub fn decode(&self, part: usize) -> Result<Decoded> {
        let found =
            self.parts.get(part).ok_or_else(|| Error::Argument(format!("there is no part {part}")))?;
        Decoded::new(&self.bytes, part, found, &self.budget)
    }

    /// Writes the file again with the changes of some parts. Chunks keep their order.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Argument`] when a part has several edits or one that was made for another part;
    /// [`Error::Damaged`] when a codec fails; [`Error::Memory`].
    pub fn write(&self, edits: &[PartEdit<'_>], out: &mut impl Write) -> Result<()> {
        let mut changes: Vec<Option<&Edit>> = vec![None; self.parts.len()];
        let mut data: Vec<Data> = self.parts.iter().map(|_| None).collect();
        // Held until everything is written.
        let mut reserved = Vec::with_capacity(edits.len());
        for PartEdit { decoded, edit } in edits {
            let number = decoded.number();
            let part = self.parts.get(number).filter(|p| decoded.is_of(p));
            let part = part.ok_or_else(|| Error::Argument("an edit is of another file".into()))?;
            if changes[number].replace(edit).is_some() {
                return Err(Error::Argument(format!("part {number} has two edits")));
            }
            let (chunks, held) = edit::encode(&self.bytes, part, decoded, edit, &self.budget)?;
            data[number] = Some(chunks);
            reserved.push(held);
        }
        let _head = self.reserve_tables(&changes)?;
        self.write_all(&self.head(&changes), &data, out)
    }

    /// Memory that the head of a written file and the tables of its chunks take.
    fn reserve_tables(&self, changes: &[Option<&Edit>]) -> Result<Reserved> {
        const GROWTH: usize = 3;
        let lists = changes.iter().flatten().flat_map(|edit| edit.channels()).map(|c| c.name.len() + 18);
        let head: usize =
            self.parts.iter().map(|p| p.header.len() + 16).sum::<usize>() + lists.sum::<usize>();
        let chunks: usize = self.parts.iter().map(|p| p.chunks.len()).sum();
        // Offsets, and the order of the chunks with what sorting it takes.
        self.budget.reserve((GROWTH * head + chunks * (8 + 4 * size_of::<(usize, usize)>())) as u64)
    }

    /// The version and all headers.
    fn head(&self, changes: &[Option<&Edit>]) -> Vec<u8> {
        let long =
            changes.iter().flatten().flat_map(|edit| edit.channels()).any(|c| c.name.len() > SHORT_NAME);
        let version = self.version();
        let mut head = self.bytes[..4].to_vec();
        head.extend((version | if long { LONG_NAMES } else { 0 }).to_le_bytes());
        for (part, change) in self.parts.iter().zip(changes) {
            if let Some(edit) = change {
                head.extend(&self.bytes[part.header.start..part.channel_list.start]);
                let value = channel_list(edit.channels());
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
        head
    }

    fn version(&self) -> u32 {
        self.bytes[4..8].first_chunk().map_or(2, |b| u32::from_le_bytes(*b))
    }

    /// Writes the head, the tables of offsets and the chunks, in the order that they had.
    fn write_all(&self, head: &[u8], data: &[Data], out: &mut impl Write) -> Result<()> {
        let mut order: Vec<(usize, usize)> =
            Vec::with_capacity(self.parts.iter().map(|p| p.chunks.len()).sum());
        for (number, part) in self.parts.iter().enumerate() {
            order.extend((0..part.chunks.len()).map(|chunk| (number, chunk)));
        }
        order.sort_by_key(|(part, chunk)| self.parts[*part].chunks[*chunk].prefix.start);
        let bytes = |part: usize, chunk: usize| match &data[part] {
            Some(chunks) => chunks[chunk].as_slice(),
            None => &self.bytes[self.parts[part].chunks[chunk].data.clone()],
        };
        let mut offset = (head.len() + 8 * order.len()) as u64;
        let mut tables: Vec<Vec<u64>> = self.parts.iter().map(|p| vec![0; p.chunks.len()]).collect();
        for (part, chunk) in &order {
            tables[*part][*chunk] = offset;
            let prefix = self.parts[*part].chunks[*chunk].prefix.len();
            offset += (prefix + 4 + bytes(*part, *chunk).len()) as u64;
        }
        out.write_all(head)?;
        for entry in tables.iter().flatten() {
            out.write_all(&entry.to_le_bytes())?;
        }
        for (part, chunk) in &order {
            let data = bytes(*part, *chunk);
            out.write_all(&self.bytes[self.parts[*part].chunks[*chunk].prefix.clone()])?;
            out.write_all(&(data.len() as u32).to_le_bytes())?;
            out.write_all(data)?;
        }
        Ok(())
    }
}

/// The chunk at an offset, which must say of itself what the table says.
fn chunk(bytes: &[u8], offset: u64, part: Option<usize>, block: Block, tiled: bool) -> Result<Chunk> {
    let start = usize::try_from(offset).ok().filter(|o| *o < bytes.len());
    let start = start.ok_or_else(Error::ends)?;
    let mut at = Cursor::new(bytes);
    at.skip(start)?;
    for expected in part.map(|p| p as i64).into_iter().chain(block.coordinates(tiled)) {
        if i64::from(at.i32()?) != expected {
            return Err(Error::damaged("a chunk is not where the table of offsets says"));
        }
    }
    let prefix = start..at.position();
    let size = at.u32()? as usize;
    let data = at.position()..at.position() + at.take(size)?.left();
    Ok(Chunk { block, prefix, data })
}
