//! Which pixels each chunk of a part holds, and how they lie in it when it is not compressed.

use super::Fault;
use super::container::{Channel, Part, Window};

/// Most pixels of a part, as of every picture.
const MOST_PIXELS: usize = 1 << 28;

/// How a part is cut into tiles.
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
    /// What the chunk says of itself.
    pub fn coordinates(&self, tiled: bool) -> impl Iterator<Item = i64> + use<> {
        let (x, y) = (i64::from(self.number.0), i64::from(self.number.1));
        let all = [x, y, self.level.0 as i64, self.level.1 as i64];
        let (first, count) = if tiled { (0, 4) } else { (1, 1) };
        all.into_iter().skip(first).take(count)
    }

    /// Walks over all samples in their order: rows, in each the channels that have samples in it.
    pub fn runs(&self, window: Window, channels: &[Channel]) -> impl Iterator<Item = Run> {
        (self.y..self.y + self.height).flat_map(move |y| {
            channels.iter().enumerate().filter_map(move |(channel, c)| {
                // Origins are multiples of the sampling, so that positions within the window decide.
                debug_assert_eq!(i64::from(window.y).rem_euclid(c.sampling.1 as i64), 0);
                y.is_multiple_of(c.sampling.1).then(|| Run {
                    channel,
                    row: y / c.sampling.1,
                    column: self.x / c.sampling.0,
                    count: self.width / c.sampling.0,
                })
            })
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

/// Scan lines in a chunk of each compression.
fn lines(compression: u8) -> Result<usize, Fault> {
    match compression {
        0..=2 => Ok(1),
        3 | 5 => Ok(16),
        4 | 6 | 7 | 8 => Ok(32),
        9 => Ok(256),
        10 => Ok(32),
        11 => Ok(256),
        other => Err(Fault::damaged(format!("compression {other} is unknown"))),
    }
}

/// All blocks of a part in the order of its offset table, which has at most so many entries.
pub fn blocks(part: &Part, most: usize) -> Result<Vec<Block>, Fault> {
    let Window { y: top, width, height, .. } = part.window;
    if width * height > MOST_PIXELS {
        return Err(Fault::Unsupported {
            problem: format!("has {width}x{height} pixels"),
            mend: format!("use a picture of 1 to {MOST_PIXELS} pixels"),
        });
    }
    let too_many = || Fault::damaged("it ends before the picture does");
    let lines = lines(part.compression)?;
    let Some(tiles) = part.tiles else {
        let count = height.div_ceil(lines);
        if count > most {
            return Err(too_many());
        }
        let block = |index: usize| Block {
            level: (0, 0),
            level_size: (width, height),
            number: (0, top + (index * lines) as i32),
            x: 0,
            y: index * lines,
            width,
            height: lines.min(height - index * lines),
        };
        return Ok((0..count).map(block).collect());
    };
    let (tile_width, tile_height) = (tiles.width as usize, tiles.height as usize);
    if !(1..=1 << 20).contains(&tile_width) || !(1..=1 << 20).contains(&tile_height) {
        return Err(Fault::damaged(format!("its tiles have {tile_width}x{tile_height} pixels")));
    }
    let up = tiles.mode >> 4 == 1;
    let count =
        |length: usize| 1 + if up { length.next_power_of_two().ilog2() } else { length.ilog2() } as usize;
    let size = |length: usize, level: usize| {
        let scaled = if up { length.div_ceil(1 << level) } else { length >> level };
        scaled.max(1)
    };
    let levels: Vec<(usize, usize)> = match tiles.mode & 15 {
        0 => vec![(0, 0)],
        1 => (0..count(width.max(height))).map(|l| (l, l)).collect(),
        2 => (0..count(height)).flat_map(|y| (0..count(width)).map(move |x| (x, y))).collect(),
        other => return Err(Fault::damaged(format!("its levels are of the unknown kind {other}"))),
    };
    let mut blocks = Vec::new();
    for level in levels {
        let (width, height) = (size(width, level.0), size(height, level.1));
        let (across, down) = (width.div_ceil(tile_width), height.div_ceil(tile_height));
        if blocks.len() + across * down > most {
            return Err(too_many());
        }
        for row in 0..down {
            for column in 0..across {
                let (x, y) = (column * tile_width, row * tile_height);
                blocks.push(Block {
                    level,
                    level_size: (width, height),
                    number: (column as i32, row as i32),
                    x,
                    y,
                    width: tile_width.min(width - x),
                    height: tile_height.min(height - y),
                });
            }
        }
    }
    Ok(blocks)
}
