//! Pixels that each chunk of a part holds, and their order in it when it is not compressed.

use crate::compression;
use crate::error::{Error, Result};

/// Longest side of a tile.
const LONGEST_TILE: usize = 1 << 20;

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

impl Window {
    /// True where samples at every so many columns and rows fill the window: both its origin and its size are
    /// multiples.
    pub(crate) fn fits(&self, sampling: (usize, usize)) -> bool {
        let whole = |origin: i32, length: usize, step: usize| {
            i64::from(origin).rem_euclid(step as i64) == 0 && length.is_multiple_of(step)
        };
        whole(self.x, self.width, sampling.0) && whole(self.y, self.height, sampling.1)
    }
}

/// Type in which samples of a channel are stored.
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
    /// Type in which samples are stored.
    pub sample: Sample,
    /// The flags byte and the reserved bytes, as they were.
    pub flags: [u8; 4],
    /// Every how many columns and rows there is a sample.
    pub sampling: (usize, usize),
}

/// Division of a part into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiles {
    /// Columns of a whole tile.
    pub width: u32,
    /// Rows of a whole tile.
    pub height: u32,
    /// Levels in the lower half (0 one, 1 mip map, 2 rip map), rounding in the upper (0 down, 1 up).
    pub mode: u8,
}

/// The pixels of one chunk: a rectangle of one level of resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Level across and down; 0 is full resolution.
    pub level: (usize, usize),
    /// Size of the whole level.
    pub level_size: (usize, usize),
    /// Number of the tile across and down; of scan lines the row in the data window's coordinates.
    pub number: (i32, i32),
    /// First column within the level.
    pub x: usize,
    /// First row within the level.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// Samples of one channel that follow each other in a block.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Index of the channel.
    pub channel: usize,
    /// Row of the channel's own samples within the level.
    pub row: usize,
    /// First of the channel's own samples within that row.
    pub column: usize,
    /// Number of samples.
    pub count: usize,
}

impl Block {
    /// Coordinates that the chunk gives of itself.
    pub fn coordinates(&self, tiled: bool) -> impl Iterator<Item = i64> + use<> {
        let (x, y) = (i64::from(self.number.0), i64::from(self.number.1));
        let all = [x, y, self.level.0 as i64, self.level.1 as i64];
        let (first, count) = if tiled { (0, 4) } else { (1, 1) };
        all.into_iter().skip(first).take(count)
    }

    /// Walks over all samples in their order: rows, in each the channels that have samples in it.
    pub fn runs(&self, channels: &[Channel]) -> impl Iterator<Item = Run> {
        (self.y..self.y + self.height).flat_map(move |y| self.row(y, channels))
    }

    /// The samples of one row of the level. Origins of windows are multiples of the sampling ([`Window::fits`]), so
    /// that positions within the window decide which channels have any.
    pub fn row(&self, y: usize, channels: &[Channel]) -> impl Iterator<Item = Run> {
        let sampled = channels.iter().enumerate().filter(move |(_, c)| y.is_multiple_of(c.sampling.1));
        sampled.map(move |(channel, c)| Run {
            channel,
            row: y / c.sampling.1,
            column: self.x / c.sampling.0,
            count: self.width / c.sampling.0,
        })
    }

    /// Bytes of all samples.
    pub fn bytes(&self, channels: &[Channel]) -> usize {
        let bytes = |c: &Channel| {
            let rows = (self.y + self.height).div_ceil(c.sampling.1) - self.y.div_ceil(c.sampling.1);
            rows * (self.width / c.sampling.0) * c.sample.bytes()
        };
        channels.iter().map(bytes).sum()
    }
}

/// Order of the blocks of a part in its table of offsets.
#[derive(Debug)]
pub struct Layout {
    /// Columns and rows of a whole block.
    size: (usize, usize),
    levels: Vec<Level>,
    /// Of scan lines, whose blocks are numbered by their first row: the top row of the data window.
    top: Option<i32>,
}

/// A level of resolution.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// Number across and down; 0 is full resolution.
    number: (usize, usize),
    /// Columns and rows.
    size: (usize, usize),
}

impl Layout {
    /// Layout of a part of this window, compression and division, of at most so many pixels.
    ///
    /// # Errors
    /// [`Error::Damaged`] for divisions that cannot be, [`Error::Unsupported`] for too many pixels.
    pub fn new(window: Window, compression: u8, tiles: Option<Tiles>, most: u64) -> Result<Self> {
        let full = (window.width, window.height);
        if (full.0 * full.1) as u64 > most {
            let problem = format!("has {}x{} pixels", full.0, full.1);
            return Err(Error::unsupported(problem, format!("use a picture of 1 to {most} pixels")));
        }
        let lines = compression::lines(compression)?;
        let Some(tiles) = tiles else {
            let levels = vec![Level { number: (0, 0), size: full }];
            return Ok(Self { size: (full.0, lines), levels, top: Some(window.y) });
        };
        let size = (tiles.width as usize, tiles.height as usize);
        if !(1..=LONGEST_TILE).contains(&size.0) || !(1..=LONGEST_TILE).contains(&size.1) {
            return Err(Error::damaged(format!("its tiles have {}x{} pixels", size.0, size.1)));
        }
        Ok(Self { size, levels: levels(full, tiles.mode)?, top: None })
    }

    /// Number of blocks.
    pub fn count(&self) -> usize {
        self.levels.iter().map(|level| self.grid(level)).map(|(across, down)| across * down).sum()
    }

    /// All blocks, in the order of the table of offsets.
    pub fn blocks(&self) -> impl Iterator<Item = Block> {
        self.levels.iter().flat_map(move |level| {
            let (across, down) = self.grid(level);
            (0..across * down).map(move |index| self.block(level, index % across, index / across))
        })
    }

    /// Blocks of a level across and down.
    fn grid(&self, level: &Level) -> (usize, usize) {
        (level.size.0.div_ceil(self.size.0), level.size.1.div_ceil(self.size.1))
    }

    fn block(&self, level: &Level, column: usize, row: usize) -> Block {
        let (x, y) = (column * self.size.0, row * self.size.1);
        Block {
            level: level.number,
            level_size: level.size,
            number: self.top.map_or((column as i32, row as i32), |top| (0, top + y as i32)),
            x,
            y,
            width: self.size.0.min(level.size.0 - x),
            height: self.size.1.min(level.size.1 - y),
        }
    }
}

/// The levels of a tiled part, of which there are fewer than 300; see [`Tiles::mode`].
fn levels(full: (usize, usize), mode: u8) -> Result<Vec<Level>> {
    let up = mode >> 4 == 1;
    let count =
        |length: usize| 1 + if up { length.next_power_of_two().ilog2() } else { length.ilog2() } as usize;
    let size = |length: usize, level: usize| {
        let scaled = if up { length.div_ceil(1 << level) } else { length >> level };
        scaled.max(1)
    };
    let numbers: Vec<(usize, usize)> = match mode & 15 {
        0 => vec![(0, 0)],
        1 => (0..count(full.0.max(full.1))).map(|l| (l, l)).collect(),
        2 => (0..count(full.1)).flat_map(|y| (0..count(full.0)).map(move |x| (x, y))).collect(),
        other => return Err(Error::damaged(format!("its levels are of the unknown kind {other}"))),
    };
    let level =
        |number: (usize, usize)| Level { number, size: (size(full.0, number.0), size(full.1, number.1)) };
    Ok(numbers.into_iter().map(level).collect())
}
