//! What several kernels share: the layout check, Gaussian tables, blocks of pixels.

use isophote_engine::fearless_simd::{Simd, f32x8, prelude::*};
use isophote_engine::math::{load4, store4};
use isophote_engine::{Band, CpuPass, View};

/// Fails the build when a uniform block differs from the struct of its shader.
pub const fn assert_layout(rust: &[(&str, usize)], size: usize, wgsl: &[(&str, usize)], wgsl_size: usize) {
    assert!(size == wgsl_size, "the uniform block has another size than the struct in the shader");
    assert!(rust.len() == wgsl.len(), "the uniform block has another number of fields than the shader's");
    let mut i = 0;
    while i < rust.len() {
        assert!(rust[i].1 == wgsl[i].1, "a field of the uniform block lies at another offset in the shader");
        let (a, b) = (rust[i].0.as_bytes(), wgsl[i].0.as_bytes());
        assert!(a.len() == b.len(), "a field of the uniform block has another name in the shader");
        let mut k = 0;
        while k < a.len() {
            assert!(a[k] == b[k], "a field of the uniform block has another name in the shader");
            k += 1;
        }
        i += 1;
    }
}

/// Entries of a Gaussian table, the centre included.
pub const GAUSSIAN_TAPS: usize = 256;

/// Largest radius of a Gaussian table, in pixels.
pub const GAUSSIAN_MAX_RADIUS: u32 = GAUSSIAN_TAPS as u32 - 1;

/// One half of a Gaussian, packed as the uniform block wants it: entry i is the weight at distance i.
pub type GaussianTable = [[f32; 4]; GAUSSIAN_TAPS / 4];

/// Radius at which a Gaussian of standard deviation `sigma` (pixels) is cut: ceil(cutoff sigma).
pub fn gaussian_radius(sigma: f32, cutoff: f32) -> u32 {
    ((cutoff * sigma).ceil().max(0.0) as u32).min(GAUSSIAN_MAX_RADIUS)
}

/// Weights of a Gaussian of standard deviation `sigma` at distances 0..=radius (2.21), normalised
/// by the sum of the kept weights (both sides).
pub fn gaussian_table(sigma: f32, radius: u32) -> GaussianTable {
    let mut table = [[0.0; 4]; GAUSSIAN_TAPS / 4];
    let sigma = f64::from(sigma).max(1e-4);
    let weight = |i: u32| (-f64::from(i * i) / (2.0 * sigma * sigma)).exp();
    let sum: f64 = weight(0) + 2.0 * (1..=radius).map(weight).sum::<f64>();
    for i in 0..=radius.min(GAUSSIAN_MAX_RADIUS) {
        table[i as usize / 4][i as usize % 4] = (weight(i) / sum) as f32;
    }
    table
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
