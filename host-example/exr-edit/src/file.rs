//! The container of an OpenEXR file: headers, offset tables and chunks, by position in the file's bytes.
//!
//! Source: "OpenEXR File Layout" of the OpenEXR project. Nothing is decoded here. What is not understood is kept as
//! bytes: that is how attributes, parts and chunks that nobody touches come out as they went in.

use std::io::Write;
use std::sync::Arc;

use crate::codec;
use crate::compression;
use crate::content::{self, Decoded, Edit, PartEdit};
use crate::cursor::Cursor;
use crate::error::{Error, Result};
use crate::layout::{Block, Layout};
use crate::limits::{Budget, Limits, Reserved};
use crate::part::{Chunk, DEEP, MULTI_PART, Part, TILED, channel_list};

/// Bit of the version field: names of more than [`SHORT_NAME`] bytes.
pub const LONG_NAMES: u32 = 0x400;
/// The newest compression whose chunks are known well.
const NEWEST: u8 = 11;
/// Longest name without that bit.
const SHORT_NAME: usize = 31;

/// A file of which nothing is decoded.
#[derive(Debug)]
pub struct File {
    bytes: Vec<u8>,
    parts: Vec<Arc<Part>>,
    budget: Arc<Budget>,
}

/// Compressed pieces that are written for each chunk of a part, where it has new ones.
type Data = Option<Vec<Vec<Vec<u8>>>>;

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
                let found = chunk(&bytes, table.u64()?, number, block, part.tiles.is_some());
                part.chunks.push(found.map_err(|problem| match problem {
                    // Its chunks may be of another size than is known here.
                    Error::Damaged(_) if part.compression > NEWEST => compression::unread(part.compression),
                    problem => problem,
                })?);
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

    /// Names of the compression of a part and of the one that [`write`](Self::write) takes where the part changes, where
    /// they differ: what would lose something of every channel each time is not written.
    pub fn recompressed(&self, part: usize) -> Option<[&'static str; 2]> {
        let part = self.parts.get(part)?;
        let written = codec::written(part);
        (written != part.compression).then(|| [part.compression, written].map(compression::name))
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
    /// [`Error::Damaged`]; [`Error::Unsupported`] for compressions that are not read;
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
            let (chunks, reservation) = content::encode(&self.bytes, part, decoded, edit, &self.budget)?;
            data[number] = Some(chunks);
            reserved.push(reservation);
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
        let count = |(part, change): (&Arc<Part>, &Option<&Edit>)| match change {
            Some(_) => part.chunks.iter().map(|c| codec::pieces(part, &c.block).count()).sum(),
            None => part.chunks.len(),
        };
        let chunks: usize = self.parts.iter().zip(changes).map(count).sum();
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
                let header = self.changed_header(part);
                let (start, list) = (part.header.start, &part.channel_list);
                head.extend(&header[..list.start - start]);
                let value = channel_list(edit.channels());
                head.extend((value.len() as u32).to_le_bytes());
                head.extend(value);
                head.extend(&header[list.end - start..]);
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

    /// The header of a part that changes, with the compression and the number of chunks that are written.
    fn changed_header(&self, part: &Part) -> Vec<u8> {
        let mut header = self.bytes[part.header.clone()].to_vec();
        let written = codec::written(part);
        if written != part.compression {
            header[part.compression_at - part.header.start] = written;
            if let Some(at) = part.chunk_count_at {
                let count: usize = part.chunks.iter().map(|c| codec::pieces(part, &c.block).count()).sum();
                header[at - part.header.start..][..4].copy_from_slice(&(count as u32).to_le_bytes());
            }
        }
        header
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
        let pieces = |part: usize, chunk: usize| match &data[part] {
            Some(chunks) => chunks[chunk].iter().map(Vec::as_slice).collect(),
            None => vec![&self.bytes[self.parts[part].chunks[chunk].data.clone()]],
        };
        let count = |part: usize, chunk: usize| data[part].as_ref().map_or(1, |chunks| chunks[chunk].len());
        // Where in the tables the pieces of each chunk begin.
        let mut firsts: Vec<Vec<usize>> = Vec::with_capacity(self.parts.len());
        let mut entries = 0;
        for (number, part) in self.parts.iter().enumerate() {
            let mut of_part = Vec::with_capacity(part.chunks.len());
            for chunk in 0..part.chunks.len() {
                of_part.push(entries);
                entries += count(number, chunk);
            }
            firsts.push(of_part);
        }
        let mut offset = (head.len() + 8 * entries) as u64;
        let mut table: Vec<u64> = vec![0; entries];
        for (part, chunk) in &order {
            let prefix = self.parts[*part].chunks[*chunk].prefix.len();
            for (at, piece) in pieces(*part, *chunk).into_iter().enumerate() {
                table[firsts[*part][*chunk] + at] = offset;
                offset += (prefix + 4 + piece.len()) as u64;
            }
        }
        out.write_all(head)?;
        for entry in table {
            out.write_all(&entry.to_le_bytes())?;
        }
        for (number, chunk) in &order {
            let part = &self.parts[*number];
            let Chunk { block, prefix, .. } = &part.chunks[*chunk];
            let blocks = codec::pieces(part, block);
            for (data, piece) in pieces(*number, *chunk).into_iter().zip(blocks) {
                let mut prefix = self.bytes[prefix.clone()].to_vec();
                // Scan lines are numbered by their first row, which ends the prefix.
                if let (None, Some(row)) = (part.tiles, prefix.last_chunk_mut::<4>()) {
                    *row = piece.number.1.to_le_bytes();
                }
                out.write_all(&prefix)?;
                out.write_all(&(data.len() as u32).to_le_bytes())?;
                out.write_all(data)?;
            }
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
