//! Reading and writing pixels: blocks of eight neighbouring ones, one vector per channel.
//!
//! A block at the end of a row goes through the same arithmetic as a full one, its missing lanes filled
//! with its last pixel, so that no pixel depends on where its tile ends. The number of channels, `N`, is
//! 1, 2 or 4 everywhere.

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
    /// The block that starts at (`x`, `y`) and ends before column `end` at the latest; beyond it, the last
    /// pixel before it.
    #[inline(always)]
    pub fn until(end: i32, x: i32, y: i32) -> Self {
        let x = x.min(end - 1);
        Self { x, y, len: BLOCK.min((end - x) as usize) }
    }

    /// Columns of the pixels; lanes past the end repeat the last one, so that they are safe to fetch.
    #[inline(always)]
    pub fn columns<S: Simd>(&self, simd: S) -> i32x8<S> {
        let lanes = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]);
        lanes.at_most(i32x8::splat(simd, self.len as i32 - 1)) + i32x8::splat(simd, self.x)
    }

    /// Centres of the pixels, x and y; lanes past the end repeat the last one.
    #[inline(always)]
    pub fn centres<S: Simd>(&self, simd: S) -> [f32x8<S>; 2] {
        let columns: f32x8<S> = self.columns(simd).to_float();
        [columns + 0.5, f32x8::splat(simd, self.y as f32 + 0.5)]
    }

    /// The pixels of an image of `N` channels.
    #[inline(always)]
    pub fn read<S: Simd, const N: usize>(&self, simd: S, view: &View<'_>) -> [f32x8<S>; N] {
        let at = view.offset(self.x, self.y);
        read(simd, &view.data()[at..at + N * self.len])
    }

    /// Writes the pixels to output `output`, of `N` channels.
    #[inline(always)]
    pub fn write<S: Simd, const N: usize>(&self, pixels: [f32x8<S>; N], band: &mut Band<'_>, output: usize) {
        let at = N * (self.x - band.window.x0) as usize;
        write(pixels, &mut band.row_mut(output, self.y)[at..at + N * self.len]);
    }
}

/// Eight tensors (E, F, G) from the start of pixels of four channels, or those with the same eigenvectors whose G is 0 from
/// pixels (E - G, F) of two.
#[inline(always)]
pub fn read_tensors<S: Simd>(simd: S, values: &[f32], channels: usize) -> [f32x8<S>; 3] {
    if channels == 2 {
        let [e, f] = read(simd, values);
        return [e, f, f32x8::splat(simd, 0.0)];
    }
    let [e, f, g, _] = read(simd, values);
    [e, f, g]
}

/// Eight pixels from the start of `values`, which holds at least one; past its end they repeat the last one.
#[inline(always)]
pub fn read<S: Simd, const N: usize>(simd: S, values: &[f32]) -> [f32x8<S>; N] {
    if values.len() >= N * BLOCK {
        return channels(simd, values);
    }
    let (mut block, last) = ([0.0; 4 * BLOCK], values.len() - N);
    for lane in 0..BLOCK {
        let at = (N * lane).min(last);
        block[N * lane..N * lane + N].copy_from_slice(&values[at..at + N]);
    }
    channels(simd, &block)
}

/// One vector per channel of the first eight pixels of `values`.
#[inline(always)]
fn channels<S: Simd, const N: usize>(simd: S, values: &[f32]) -> [f32x8<S>; N] {
    const { assert!(N == 1 || N == 2 || N == 4) }
    let mut out = [f32x8::splat(simd, 0.0); N];
    if N == 4 {
        let [r, g, b, a] = load4(simd, &values[..4 * BLOCK]);
        (out[0], out[1 % N], out[2 % N], out[3 % N]) = (r, g, b, a);
    } else if N == 2 {
        let (low, high) = (eight(simd, values, 0), eight(simd, values, BLOCK));
        (out[0], out[N - 1]) = low.deinterleave(high);
    } else {
        out[0] = eight(simd, values, 0);
    }
    out
}

/// The pixels of a four-channel image that lie (dx, dy) from those of a block, clamped to the picture.
#[inline(always)]
pub fn pixels_beside<S: Simd>(simd: S, view: &View<'_>, block: Block, [dx, dy]: [i32; 2]) -> [f32x8<S>; 4] {
    let (window, x, y) = (view.window(), block.x + dx, block.y + dy);
    if window.x0 <= x && x + BLOCK as i32 <= window.x1 {
        return Block { x, y, len: BLOCK }.read(simd, view);
    }
    fetch4(simd, view, offsets(view, block.columns(simd) + dx, i32x8::splat(simd, y)))
}

/// Eight values from index `at` on.
#[inline(always)]
pub fn eight<S: Simd>(simd: S, values: &[f32], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &values[at..at + 8])
}

/// Writes eight pixels to the start of `target`, or as many as it has room for.
#[inline(always)]
pub fn write<S: Simd, const N: usize>(pixels: [f32x8<S>; N], target: &mut [f32]) {
    if target.len() >= N * BLOCK {
        store(pixels, target);
    } else {
        let mut block = [0.0; 4 * BLOCK];
        store(pixels, &mut block);
        target.copy_from_slice(&block[..target.len()]);
    }
}

/// Writes eight pixels to the start of `target`.
#[inline(always)]
fn store<S: Simd, const N: usize>(pixels: [f32x8<S>; N], target: &mut [f32]) {
    const { assert!(N == 1 || N == 2 || N == 4) }
    if N == 4 {
        store4([pixels[0], pixels[1 % N], pixels[2 % N], pixels[3 % N]], &mut target[..4 * BLOCK]);
    } else if N == 2 {
        let (low, high) = pixels[0].interleave(pixels[N - 1]);
        low.store_slice(&mut target[..8]);
        high.store_slice(&mut target[8..16]);
    } else {
        pixels[0].store_slice(&mut target[..8]);
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
            let block = Block::until(window.x1, x, y);
            let at = (x - window.x0) as usize;
            f(block, &mut row[N * at..N * (at + block.len)]);
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
                let block = Block::until(end, x, y);
                let at = (x - window.x0) as usize;
                f(block, &mut row[N * at..N * (at + block.len)]);
                x += BLOCK as i32;
            }
        }
        start = end;
    }
}

/// Runs `f` on all pixels of a pass that computes each from the same pixel of its one input: from `I`
/// channels to `O`.
#[inline(always)]
pub fn map_pixels<S: Simd, const I: usize, const O: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    band: &mut Band<'_>,
    mut f: impl FnMut([f32x8<S>; I]) -> [f32x8<S>; O],
) {
    map_pairs(
        simd,
        pass,
        band,
        #[inline(always)]
        |[a, b]| [f(a), f(b)],
    );
}

/// [`map_pixels`] on two blocks at a time, whose operations need not wait for each other.
#[inline(always)]
pub fn map_pairs<S: Simd, const I: usize, const O: usize>(
    simd: S,
    pass: &CpuPass<'_>,
    band: &mut Band<'_>,
    mut f: impl FnMut([[f32x8<S>; I]; 2]) -> [[f32x8<S>; O]; 2],
) {
    const PAIR: usize = 2 * BLOCK;
    let window = band.window;
    let view = &pass.inputs[0];
    let width = window.width() as usize;
    for y in window.y0..window.y1 {
        let at = view.offset(window.x0, y);
        let target = &mut band.row_mut(0, y)[..O * width];
        let source = &view.data()[at..at + I * width];
        let mut x = 0;
        while x < width {
            let (source, target) = (&source[I * x..], &mut target[O * x..]);
            if x + PAIR <= width {
                let [a, b] = f([channels(simd, source), channels(simd, &source[I * BLOCK..])]);
                store(a, target);
                store(b, &mut target[O * BLOCK..]);
            } else {
                // Where there is no second block, the last pixel stands for it.
                let second = (I * BLOCK).min(source.len() - I);
                let [a, b] = f([read(simd, source), read(simd, &source[second..])]);
                let end = target.len().min(O * BLOCK);
                let (first, rest) = target.split_at_mut(end);
                write(a, first);
                write(b, rest);
            }
            x += PAIR;
        }
    }
}

/// Where eight pixels begin in the data of `view`; positions are clamped to the picture and must then
/// lie in the window.
#[inline(always)]
pub fn offsets<S: Simd>(view: &View<'_>, x: i32x8<S>, y: i32x8<S>) -> i32x8<S> {
    let ([w, h], window) = (view.full(), view.window());
    let column = x.within(0, w - 1) - window.x0;
    let row = y.within(0, h - 1) - window.y0;
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

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::fearless_simd::{Level, dispatch};
    use isophote_engine::{Image, Rect};

    fn image(width: u32, height: u32, channels: u32) -> Image {
        let values = (0..width * height * channels).map(|i| (i * 7 % 103) as f32 + 1.0).collect();
        Image::from_vec(width, height, channels, values).unwrap()
    }

    /// Copies a picture block by block.
    fn copied<const N: usize>(source: &Image) -> Vec<f32> {
        let [w, h] = [source.width(), source.height()];
        let (view, mut values) = (View::new(source, [w as i32, h as i32]), vec![0.0; source.data().len()]);
        let outputs = vec![values.as_mut_slice()];
        let mut band = Band { window: Rect::of_size(w, h), full: [w as i32, h as i32], outputs };
        dispatch!(Level::new(), simd => for_blocks::<N>(&mut band, |block, target| {
            let pixels: [f32x8<_>; N] = block.read(simd, &view);
            let columns = block.columns(simd);
            for lane in block.len..BLOCK {
                assert_eq!(columns[lane], block.x + block.len as i32 - 1);
                for channel in pixels {
                    assert_eq!(channel[lane], channel[block.len - 1], "missing lanes repeat the last pixel");
                }
            }
            write(pixels, target);
        }));
        values
    }

    #[test]
    fn what_is_read_is_written_whatever_the_width() {
        for width in 1..=19 {
            assert_eq!(copied::<1>(&image(width, 3, 1)), image(width, 3, 1).data());
            assert_eq!(copied::<2>(&image(width, 3, 2)), image(width, 3, 2).data());
            assert_eq!(copied::<4>(&image(width, 3, 4)), image(width, 3, 4).data());
        }
    }

    #[test]
    fn every_pixel_is_mapped_whatever_the_width() {
        for width in 1..=35 {
            let source = image(width, 2, 4);
            let size = [width as i32, 2];
            let views = [View::new(&source, size)];
            let pass = CpuPass { params: &[], inputs: &views, level: Level::new() };
            let mut values = vec![0.0; 4 * width as usize];
            let outputs = vec![values.as_mut_slice()];
            let mut band = Band { window: Rect::of_size(width, 2), full: size, outputs };
            dispatch!(pass.level, simd => map_pixels(simd, &pass, &mut band, |[r, g, b, a]| [r + g, b - a]));
            let want = source.data().chunks_exact(4).flat_map(|p| [p[0] + p[1], p[2] - p[3]]);
            assert_eq!(values, want.collect::<Vec<_>>());
        }
    }
}
