//! Motion between frames: where a pixel's point is in another frame, from its own place. Twin of
//! `shaders/shared/motion.wgsl`.

use crate::kernels::shared::sampling::{fetch4, sample_linear4};
use crate::kernels::simd::pixels::{Block, load_pixels, offsets, premultiply};
use isophote_engine::View;
use isophote_engine::fearless_simd::{Simd, f32x8, i32x8, mask32x8, prelude::*};
use isophote_engine::math::{spread, transposed};

/// Components of motions that are not known.
pub const UNKNOWN: f32 = 1e9;

/// Larger components are unknown ones.
pub const KNOWN: f32 = 1e8;

/// Where motions are known.
#[inline(always)]
pub fn is_known<S: Simd>([x, _]: [f32x8<S>; 2]) -> mask32x8<S> {
    x.abs().simd_lt(KNOWN)
}

/// Where positions lie inside a picture of `size` pixels.
#[inline(always)]
pub fn is_inside<S: Simd>(x: f32x8<S>, y: f32x8<S>, [width, height]: [i32; 2]) -> mask32x8<S> {
    x.simd_ge(0.0) & x.simd_le(width as f32) & y.simd_ge(0.0) & y.simd_le(height as f32)
}

/// Motions unless they are longer than `limit` or no numbers, which makes them unknown.
#[inline(always)]
pub fn bounded<S: Simd>([x, y]: [f32x8<S>; 2], limit: f32) -> [f32x8<S>; 2] {
    // Comparisons with what is no number are false.
    let known = x.abs().simd_le(limit) & y.abs().simd_le(limit);
    let unknown = f32x8::splat(x.simd, UNKNOWN);
    [known.select(x, unknown), known.select(y, unknown)]
}

/// Weights of the four pixels around a share of the way from the second to the third: the cubic of Catmull and Rom.
#[inline(always)]
pub fn catmull_rom<S: Simd>(f: f32x8<S>) -> [f32x8<S>; 4] {
    let one = f32x8::splat(f.simd, 1.0);
    let g = one - f;
    [
        f * g * g * -0.5,
        (f * f).mul_add(f * 1.5 - 2.5, one),
        (g * g).mul_add(g * 1.5 - 2.5, one),
        g * f * f * -0.5,
    ]
}

/// Bilinear samples of a colour image at eight positions, colours multiplied by their alpha, one vector per channel.
#[inline(always)]
pub fn sample_linear_covered4<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 4] {
    let plain = sample_linear4(simd, view, x, y);
    // No alpha is above 1: a mean of 1 is one of nothing else, and opaque colours are their own multiples.
    let opaque = plain[3].simd_ge(1.0);
    if opaque.all_true() {
        return plain;
    }
    let one = f32x8::splat(simd, 1.0);
    let (columns, fx) = floor_and_share(x, view.full()[0]);
    let (rows, fy) = floor_and_share(y, view.full()[1]);
    let mut samples = taps_covered(simd, view, [columns, rows], [one - fx, fx], [one - fy, fy]);
    // Rounded as anywhere: a pixel must not depend on which others it is computed with.
    for (sample, plain) in samples.iter_mut().zip(plain) {
        *sample = opaque.select(plain, *sample);
    }
    samples
}

/// Samples of a colour image at eight positions with a sharp interpolation (absolute, pixel centres at +0.5, clamped to
/// the edge), colours multiplied by their alpha, one vector per channel.
#[inline(always)]
pub fn sample_sharp_covered4<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 4] {
    let ([w, h], held, data) = (view.full(), view.window(), view.data());
    let (columns, fx) = floor_and_share(x, w);
    let (rows, fy) = floor_and_share(y, h);
    let (wx, wy) = (catmull_rom(fx), catmull_rom(fy));
    let inside = columns.simd_ge(1) & columns.simd_lt(w - 2) & rows.simd_ge(1) & rows.simd_lt(h - 2);
    if !inside.all_true() {
        return taps_covered(simd, view, [columns - 1, rows - 1], wx, wy);
    }
    let stride = view.stride() as u32 as usize;
    let at = ((rows - (held.y0 + 1)) * stride as i32 + (columns - (held.x0 + 1)) * 4).to_array();
    let (spread_x, spread_y) = (wx.map(spread), wy.map(spread));
    let mut pixels = [f32x8::splat(simd, 0.0); 4];
    let mut least = f32x8::splat(simd, 1.0);
    for lane in 0..4 {
        let (low, high) = (at[lane] as u32 as usize, at[lane + 4] as u32 as usize);
        let (low, high) = (&data[low..low + 3 * stride + 16], &data[high..high + 3 * stride + 16]);
        let mut sum = f32x8::splat(simd, 0.0);
        for j in 0..4 {
            let (low, high) = (&low[j * stride..j * stride + 16], &high[j * stride..j * stride + 16]);
            let mut row = f32x8::splat(simd, 0.0);
            for i in 0..4 {
                let pixel = load_pixels(simd, &low[4 * i..], &high[4 * i..]);
                least = least.min(pixel);
                row = pixel.mul_add(spread_x[i][lane], row);
            }
            sum = row.mul_add(spread_y[j][lane], sum);
        }
        pixels[lane] = sum;
    }
    // The last of each four values is an alpha.
    if least[3] < 1.0 || least[7] < 1.0 {
        return taps_covered(simd, view, [columns - 1, rows - 1], wx, wy);
    }
    transposed(pixels)
}

/// Samples of a two-channel image at eight positions with a sharp interpolation; see [`sample_sharp_covered4`].
#[inline(always)]
pub fn sample_sharp2<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 2] {
    let ([w, h], held, data) = (view.full(), view.window(), view.data());
    let (columns, fx) = floor_and_share(x, w);
    let (rows, fy) = floor_and_share(y, h);
    let (wx, wy) = (catmull_rom(fx), catmull_rom(fy));
    let inside = columns.simd_ge(1) & columns.simd_lt(w - 2) & rows.simd_ge(1) & rows.simd_lt(h - 2);
    if !inside.all_true() {
        // In the order of the other way: a pixel must not depend on which others it is computed with.
        let mut sum = [f32x8::splat(simd, 0.0); 2];
        for i in 0..4 {
            let at = |j: i32| fetch2(simd, view, columns + (i as i32 - 1), rows + (j - 1));
            let mut column = at(0).map(|v| v * wy[0]);
            for j in 1..4 {
                let pixel = at(j as i32);
                for c in 0..2 {
                    column[c] = pixel[c].mul_add(wy[j], column[c]);
                }
            }
            for c in 0..2 {
                sum[c] += wx[i] * column[c];
            }
        }
        return sum;
    }
    let stride = view.stride() as u32 as usize;
    let at = ((rows - (held.y0 + 1)) * stride as i32 + (columns - (held.x0 + 1)) * 2).to_array();
    let (wx, wy) = (wx.map(|w| w.to_array()), wy.map(|w| w.to_array()));
    let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
    for lane in 0..8 {
        let at = at[lane] as u32 as usize;
        let data = &data[at..at + 3 * stride + 8];
        // The four pixels of a row are neighbours in memory: one load.
        let mut columns = f32x8::from_slice(simd, &data[..8]) * wy[0][lane];
        for j in 1..4 {
            let row = f32x8::from_slice(simd, &data[j * stride..j * stride + 8]);
            columns = row.mul_add(f32x8::splat(simd, wy[j][lane]), columns);
        }
        let columns = columns.to_array();
        for i in 0..4 {
            first[lane] += wx[i][lane] * columns[2 * i];
            second[lane] += wx[i][lane] * columns[2 * i + 1];
        }
    }
    [f32x8::simd_from(simd, first), f32x8::simd_from(simd, second)]
}

/// The weighted sum of N x N pixels from those at `first` on, colours multiplied by their alpha.
#[inline(always)]
fn taps_covered<S: Simd, const N: usize>(
    simd: S,
    view: &View<'_>,
    [columns, rows]: [i32x8<S>; 2],
    wx: [f32x8<S>; N],
    wy: [f32x8<S>; N],
) -> [f32x8<S>; 4] {
    let mut sum = [f32x8::splat(simd, 0.0); 4];
    for j in 0..N {
        let mut row = [f32x8::splat(simd, 0.0); 4];
        for i in 0..N {
            let pixel = premultiply(fetch4(simd, view, columns + i as i32, rows + j as i32));
            for c in 0..4 {
                row[c] = pixel[c].mul_add(wx[i], row[c]);
            }
        }
        for c in 0..4 {
            sum[c] = row[c].mul_add(wy[j], sum[c]);
        }
    }
    sum
}

/// The motions at eight places, clamped to the picture.
#[inline(always)]
pub fn fetch2<S: Simd>(simd: S, view: &View<'_>, x: i32x8<S>, y: i32x8<S>) -> [f32x8<S>; 2] {
    let (at, data) = (offsets(view, x, y).to_array(), view.data());
    let (mut first, mut second) = ([0.0; 8], [0.0; 8]);
    for lane in 0..8 {
        let at = at[lane] as u32 as usize;
        let pair = &data[at..at + 2];
        (first[lane], second[lane]) = (pair[0], pair[1]);
    }
    [f32x8::simd_from(simd, first), f32x8::simd_from(simd, second)]
}

/// The motion at positions, as far as it is no longer than `limit`: interpolated where neighbours agree to a pixel,
/// else that of the nearest.
#[inline(always)]
pub fn motion_at<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>, limit: f32) -> [f32x8<S>; 2] {
    let [w, h] = view.full();
    let place = |p: f32x8<S>, full: i32| (p - 0.5).max(-2.0f32).min(full as f32 + 2.0);
    let (px, py) = (place(x, w), place(y, h));
    let (left, top) = (px.floor(), py.floor());
    let (fx, fy) = (px - left, py - top);
    let (left, top): (i32x8<S>, i32x8<S>) = (left.to_int(), top.to_int());
    let [a, b] = [left, left + 1].map(|column| bounded(fetch2(simd, view, column, top), limit));
    let [c, d] = [left, left + 1].map(|column| bounded(fetch2(simd, view, column, top + 1), limit));
    let near = |p: f32x8<S>, full: i32| p.floor().max(-2.0f32).min(full as f32 + 2.0).to_int::<i32x8<S>>();
    let nearest = bounded(fetch2(simd, view, near(x, w), near(y, h)), limit);
    let spread = |i: usize| a[i].max(b[i]).max(c[i].max(d[i])) - a[i].min(b[i]).min(c[i].min(d[i]));
    let alike = spread(0).max(spread(1)).simd_le(1.0);
    let mut motion = nearest;
    for i in 0..2 {
        let above = (b[i] - a[i]).mul_add(fx, a[i]);
        let below = (d[i] - c[i]).mul_add(fx, c[i]);
        motion[i] = alike.select((below - above).mul_add(fy, above), nearest[i]);
    }
    motion
}

/// The motions beside those of a block.
#[inline(always)]
pub fn beside<S: Simd>(simd: S, view: &View<'_>, block: Block, [dx, dy]: [i32; 2]) -> [f32x8<S>; 2] {
    let (held, x, y) = (view.window(), block.x + dx, block.y + dy);
    if held.x0 <= x && x + 8 <= held.x1 {
        return Block { x, y, len: 8 }.read(simd, view);
    }
    fetch2(simd, view, block.columns(simd) + dx, i32x8::splat(simd, y))
}

/// The pixel before a position, on one axis of a picture of `full` pixels, and the next one's share.
#[inline(always)]
fn floor_and_share<S: Simd>(position: f32x8<S>, full: i32) -> (i32x8<S>, f32x8<S>) {
    let position = (position - 0.5).max(-2.0f32).min(full as f32 + 2.0);
    let floor = position.floor();
    (floor.to_int(), position - floor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote_engine::Image;
    use isophote_engine::fearless_simd::{Level, dispatch};

    #[test]
    fn the_sharp_interpolation_keeps_pixels_and_parabolas() {
        let value = |x: f32, y: f32| 0.3 * x * x - 0.7 * y + 2.0;
        let values = (0..20 * 9 * 4)
            .map(|i| if i % 4 == 3 { 1.0 } else { value((i / 4 % 20) as f32, (i / 80) as f32) });
        let image = Image::from_vec(20, 9, 4, values.collect()).unwrap();
        let view = View::new(&image, [20, 9]);
        dispatch!(Level::new(), simd => {
            let xs = [3.0, 4.25, 5.5, 6.75, 8.0, 9.1, 10.9, 16.0];
            let ys = [2.0, 3.5, 4.0, 4.75, 5.25, 2.5, 3.0, 5.0];
            let (x, y) = (f32x8::from_slice(simd, &xs) + 0.5, f32x8::from_slice(simd, &ys) + 0.5);
            let got = sample_sharp_covered4(simd, &view, x, y);
            for lane in 0..8 {
                let want = value(xs[lane], ys[lane]);
                assert!((got[2][lane] - want).abs() < 1e-4, "{} {want}", got[2][lane]);
            }
            // At the border the last pixels go on.
            let corner = f32x8::splat(simd, -7.0);
            assert!((sample_sharp_covered4(simd, &view, corner, corner)[0][5] - 2.0).abs() < 1e-6);
        });
    }

    #[test]
    fn what_is_no_motion_is_unknown() {
        dispatch!(Level::new(), simd => {
            let x = f32x8::from_slice(simd, &[1.0, f32::NAN, f32::INFINITY, -7.0, 9.0, 0.0, -8.0, 1e30]);
            let y = f32x8::from_slice(simd, &[1.0, 1.0, 1.0, -7.0, 1.0, f32::NAN, 8.0, 0.0]);
            let known = is_known(bounded([x, y], 8.0)).select(f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.0));
            assert_eq!(known.to_array(), [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        });
    }
}
