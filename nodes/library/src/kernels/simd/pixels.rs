//! Blocks of eight neighbouring pixels: reading, writing and fetching them from anywhere.
//!
//! A block at the end of a row goes through the same arithmetic as a full one, its missing lanes
//! filled, so that no pixel depends on where its tile ends.

use isophote_engine::fearless_simd::{Simd, f32x4, f32x8, i32x8, prelude::*};
use isophote_engine::math::{load4, store4, transposed};
use isophote_engine::{Band, CpuPass, View};

/// Pixels in a block.
pub const BLOCK: usize = 8;

/// Up to eight pixels of a row, starting at (`x`, `y`) (absolute).
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Column of the first pixel.
    pub x: i32,
    /// Row.
    pub y: i32,
    /// Pixels, 1..=8.
    pub len: usize,
}

impl Block {
    /// Columns of the pixels; lanes past the end repeat the last one, so that they are safe to fetch.
    #[inline(always)]
    pub fn columns<S: Simd>(&self, simd: S) -> i32x8<S> {
        let lanes = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        lanes.min(i32x8::splat(simd, self.len as i32 - 1)) + i32x8::splat(simd, self.x)
    }

    /// `N` values a pixel, copied to `short` where the block is; lanes past the end are as they were there.
    #[inline(always)]
    fn values<'v, const N: usize>(&self, view: &View<'v>, short: &'v mut [f32; 4 * BLOCK]) -> &'v [f32] {
        let at = view.offset(self.x, self.y);
        if self.len == BLOCK {
            return &view.data()[at..at + N * BLOCK];
        }
        short[..N * self.len].copy_from_slice(&view.data()[at..at + N * self.len]);
        &short[..N * BLOCK]
    }

    /// The pixels of a one-channel image.
    #[inline(always)]
    pub fn read1<S: Simd>(&self, simd: S, view: &View<'_>) -> f32x8<S> {
        let mut short = [0.0; 4 * BLOCK];
        f32x8::from_slice(simd, self.values::<1>(view, &mut short))
    }

    /// The pixels of a two-channel image.
    #[inline(always)]
    pub fn read2<S: Simd>(&self, simd: S, view: &View<'_>) -> [f32x8<S>; 2] {
        let mut short = [0.0; 4 * BLOCK];
        let v = self.values::<2>(view, &mut short);
        f32x8::from_slice(simd, &v[..8]).deinterleave(f32x8::from_slice(simd, &v[8..])).into()
    }

    /// The pixels of a four-channel image.
    #[inline(always)]
    pub fn read4<S: Simd>(&self, simd: S, view: &View<'_>) -> [f32x8<S>; 4] {
        let mut short = [0.0; 4 * BLOCK];
        load4(simd, self.values::<4>(view, &mut short))
    }
}

/// Runs `f` on every block of a band; it is given the values of output 0 to fill, `N` a pixel.
#[inline(always)]
pub fn for_blocks<const N: usize>(band: &mut Band<'_>, mut f: impl FnMut(Block, &mut [f32])) {
    let window = band.window;
    for y in window.y0..window.y1 {
        // A plain loop: adapters of iterators stay calls in code for wide vectors.
        let row = band.row_mut(0, y);
        let mut x = window.x0;
        while x < window.x1 {
            let (at, len) = ((x - window.x0) as usize, BLOCK.min((window.x1 - x) as usize));
            f(Block { x, y, len }, &mut row[N * at..N * (at + len)]);
            x += BLOCK as i32;
        }
    }
}

/// Columns that are worked through together by kernels that read far around: what the pixels of so many
/// columns have in common stays in the first-level cache from row to row. A multiple of [`BLOCK`].
pub const TILE: i32 = 64;

/// [`for_blocks`] in tiles of [`TILE`] columns.
#[inline(always)]
pub fn for_blocks_in_tiles<const N: usize>(band: &mut Band<'_>, mut f: impl FnMut(Block, &mut [f32])) {
    let window = band.window;
    let mut start = window.x0;
    while start < window.x1 {
        let end = (start + TILE).min(window.x1);
        for y in window.y0..window.y1 {
            let row = band.row_mut(0, y);
            let mut x = start;
            while x < end {
                let (at, len) = ((x - window.x0) as usize, BLOCK.min((end - x) as usize));
                f(Block { x, y, len }, &mut row[N * at..N * (at + len)]);
                x += BLOCK as i32;
            }
        }
        start = end;
    }
}

/// Writes one value a pixel.
#[inline(always)]
pub fn write1<S: Simd>(v: f32x8<S>, target: &mut [f32]) {
    if target.len() == BLOCK {
        v.store_slice(target);
    } else {
        target.copy_from_slice(&v.to_array()[..target.len()]);
    }
}

/// Writes two values a pixel.
#[inline(always)]
pub fn write2<S: Simd>([a, b]: [f32x8<S>; 2], target: &mut [f32]) {
    let (low, high) = a.interleave(b);
    if target.len() == 2 * BLOCK {
        low.store_slice(&mut target[..8]);
        high.store_slice(&mut target[8..]);
    } else {
        let mut block = [0.0; 2 * BLOCK];
        low.store_slice(&mut block[..8]);
        high.store_slice(&mut block[8..]);
        target.copy_from_slice(&block[..target.len()]);
    }
}

/// Writes four values a pixel.
#[inline(always)]
pub fn write4<S: Simd>(v: [f32x8<S>; 4], target: &mut [f32]) {
    if target.len() == 4 * BLOCK {
        store4(v, target);
    } else {
        let mut block = [0.0; 4 * BLOCK];
        store4(v, &mut block);
        target.copy_from_slice(&block[..target.len()]);
    }
}

/// Where eight pixels begin in the data of `view`; positions are clamped to the picture and must then
/// lie in the window.
#[inline(always)]
pub fn offsets<S: Simd>(view: &View<'_>, x: i32x8<S>, y: i32x8<S>) -> i32x8<S> {
    let ([w, h], window) = (view.full(), view.window());
    let column = x.max(0).min(w - 1) - window.x0;
    let row = y.max(0).min(h - 1) - window.y0;
    row * view.stride() as i32 + column * view.channels() as i32
}

/// Eight values of a one-channel image.
#[inline(always)]
pub fn fetch1<S: Simd>(simd: S, view: &View<'_>, at: i32x8<S>) -> f32x8<S> {
    let data = view.data();
    f32x8::from_fn(simd, |lane| data[at[lane] as usize])
}

/// Eight pixels of a four-channel image, one vector per channel.
#[inline(always)]
pub fn fetch4<S: Simd>(simd: S, view: &View<'_>, at: i32x8<S>) -> [f32x8<S>; 4] {
    let (data, at) = (view.data(), at.to_array());
    let mut pixels = [f32x8::splat(simd, 0.0); 4];
    for i in 0..4 {
        let (low, high) = (at[i] as u32 as usize, at[i + 4] as u32 as usize);
        pixels[i] = load_pixels(simd, &data[low..low + 4], &data[high..high + 4]);
    }
    transposed(pixels)
}

/// Pixels that [`map_pixels`] gives at a time.
pub const PAIR: usize = 16;

/// Runs `f` on [`PAIR`] pixels at a time: a pass from each pixel of input 0, of `I` channels, to the same
/// pixel of output 0, of `O`.
#[inline(always)]
pub fn map_pixels<const I: usize, const O: usize>(
    pass: &CpuPass<'_>,
    band: &mut Band<'_>,
    mut f: impl FnMut(&[f32], &mut [f32]),
) {
    let window = band.window;
    let view = &pass.inputs[0];
    let width = window.width() as usize;
    for y in window.y0..window.y1 {
        let at = view.offset(window.x0, y);
        let target = &mut band.row_mut(0, y)[..O * width];
        let source = &view.data()[at..at + I * width];
        let mut x = 0;
        while x + PAIR <= width {
            f(&source[I * x..I * (x + PAIR)], &mut target[O * x..O * (x + PAIR)]);
            x += PAIR;
        }
        if x < width {
            // The last pixels of a row go through the same arithmetic, padded with zeros.
            let (mut from, mut to) = ([0.0; 4 * PAIR], [0.0; 4 * PAIR]);
            from[..I * (width - x)].copy_from_slice(&source[I * x..]);
            f(&from[..I * PAIR], &mut to[..O * PAIR]);
            target[O * x..].copy_from_slice(&to[..O * (width - x)]);
        }
    }
}

/// Runs `f` on eight four-channel pixels at a time, one vector per channel, over a whole band; a pass
/// from each pixel to the same pixel.
#[inline(always)]
pub fn map_pixels4<S: Simd>(
    simd: S,
    pass: &CpuPass<'_>,
    band: &mut Band<'_>,
    mut f: impl FnMut([f32x8<S>; 4]) -> [f32x8<S>; 4],
) {
    map_pixels::<4, 4>(
        pass,
        band,
        #[inline(always)]
        |source, target| {
            store4(f(load4(simd, &source[..32])), &mut target[..32]);
            store4(f(load4(simd, &source[32..])), &mut target[32..]);
        },
    );
}

/// Eight four-channel pixels of row `y` from column `x` on; columns past `last` repeat it.
#[inline(always)]
pub fn get_pixels4<S: Simd>(simd: S, view: &View<'_>, x: i32, y: i32, last: i32) -> [f32x8<S>; 4] {
    let data = view.data();
    if x + 7 <= last {
        let at = view.offset(x, y);
        return load4(simd, &data[at..at + 32]);
    }
    let mut block = [0.0; 32];
    for (lane, pixel) in block.chunks_exact_mut(4).enumerate() {
        pixel.copy_from_slice(&view.pixel4((x + lane as i32).min(last), y));
    }
    load4(simd, &block)
}

/// Eight four-channel pixels of `row` from its pixel `i` on; past its end they repeat the last one.
#[inline(always)]
pub fn row_pixels4<S: Simd>(simd: S, row: &[f32], i: usize) -> [f32x8<S>; 4] {
    let rest = &row[4 * i..];
    if let Some(full) = rest.get(..32) {
        return load4(simd, full);
    }
    let mut block = [0.0; 32];
    for (lane, pixel) in block.chunks_exact_mut(4).enumerate() {
        let at = (4 * lane).min(rest.len() - 4);
        pixel.copy_from_slice(&rest[at..at + 4]);
    }
    load4(simd, &block)
}

/// Eight two-channel pixels of row `y` from column `x` on; columns past `last` repeat it.
#[inline(always)]
pub fn get_pixels2<S: Simd>(simd: S, view: &View<'_>, x: i32, y: i32, last: i32) -> [f32x8<S>; 2] {
    let data = view.data();
    let mut block = [0.0; 16];
    if x + 7 <= last {
        let at = view.offset(x, y);
        block.copy_from_slice(&data[at..at + 16]);
    } else {
        for lane in 0..8 {
            let at = view.offset((x + lane as i32).min(last), y);
            block[2 * lane..2 * lane + 2].copy_from_slice(&data[at..at + 2]);
        }
    }
    f32x8::from_slice(simd, &block[..8]).deinterleave(f32x8::from_slice(simd, &block[8..])).into()
}

/// Writes eight four-channel pixels to the start of `row`, or as many as it still has.
#[inline(always)]
pub fn put_pixels4<S: Simd>(values: [f32x8<S>; 4], row: &mut [f32]) {
    if let Some(full) = row.get_mut(..32) {
        store4(values, full);
    } else {
        let mut block = [0.0; 32];
        store4(values, &mut block);
        row.copy_from_slice(&block[..row.len()]);
    }
}

/// The pixels at two offsets, one in each half of a vector.
#[inline(always)]
pub fn load_pixels<S: Simd>(simd: S, low: &[f32], high: &[f32]) -> f32x8<S> {
    f32x4::from_slice(simd, &low[..4]).combine(f32x4::from_slice(simd, &high[..4]))
}

/// The four values from offset `at` on.
#[inline(always)]
pub fn load_pixel<S: Simd>(simd: S, data: &[f32], at: i32) -> f32x4<S> {
    // Through u32 one comparison is enough to check the range.
    let at = at as u32 as usize;
    f32x4::from_slice(simd, &data[at..at + 4])
}
