//! Motion between frames: where a pixel's point is in another frame, from its own place. Twin of
//! `shaders/shared/motion.wgsl`.

use crate::kernels::shared::coverage::premultiply;
use crate::kernels::shared::sampling::{fetch4, load_pairs, sample_linear4};
use crate::kernels::simd::pixels::{Block, eight, fetch1, load_pixels, offsets};
use isophote_engine::View;
use isophote_engine::fearless_simd::prelude::*;
use isophote_engine::fearless_simd::{Simd, f32x4, f32x8, i32x8, mask32x8};
use isophote_engine::math::{spread, transposed};

/// Components of motions that are not known.
pub const UNKNOWN: f32 = 1e9;

/// Larger components are unknown ones.
pub const KNOWN: f32 = 1e8;

/// Mask of motions that are known.
#[inline(always)]
pub fn is_known<S: Simd>([x, _]: [f32x8<S>; 2]) -> mask32x8<S> {
    x.abs().simd_lt(KNOWN)
}

/// Mask of positions that lie inside a picture of `size` pixels.
#[inline(always)]
pub fn is_inside<S: Simd>(x: f32x8<S>, y: f32x8<S>, [width, height]: [i32; 2]) -> mask32x8<S> {
    // Distances to the borders, so that one comparison is enough.
    let (right, bottom) = (f32x8::splat(x.simd, width as f32) - x, f32x8::splat(x.simd, height as f32) - y);
    x.at_most(right).at_most(y.at_most(bottom)).simd_ge(0.0)
}

/// Motions unless they are longer than `limit` or no numbers, which makes them unknown.
#[inline(always)]
pub fn bounded<S: Simd>([x, y]: [f32x8<S>; 2], limit: f32) -> [f32x8<S>; 2] {
    // Comparisons with what is no number are false.
    let unknown = f32x8::splat(x.simd, UNKNOWN);
    let known = x.abs().simd_le(limit).select(y.abs(), unknown).simd_le(limit);
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
    let plain = sample_linear_near4(simd, view, x, y);
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

/// Bilinear samples as [`sample_linear4`] takes them, in half the time where the positions are those of neighbours.
#[inline(always)]
pub fn sample_linear_near4<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 4] {
    let Some(run) = Run::of(simd, view, x, y, [0, 1]) else { return sample_linear4(simd, view, x, y) };
    let (data, stride) = (&view.data()[run.at..], view.stride() as u32 as usize);
    let (fx, fy) = (f32x8::splat(simd, run.fx), f32x8::splat(simd, run.fy));
    let mut pixels = [f32x8::splat(simd, 0.0); 4];
    for pair in 0..4 {
        let (above, below) =
            (&data[8 * pair..8 * pair + 12], &data[stride + 8 * pair..stride + 8 * pair + 12]);
        let (a, b) = (eight(simd, above, 0), eight(simd, above, 4));
        let (c, d) = (eight(simd, below, 0), eight(simd, below, 4));
        let (top, bottom) = ((b - a).mul_add(fx, a), (d - c).mul_add(fx, c));
        pixels[pair] = (bottom - top).mul_add(fy, top);
    }
    channels_of_pairs(pixels)
}

/// Samples of a colour image at eight positions with a sharp interpolation (absolute, pixel centres at +0.5, clamped to
/// the edge), colours multiplied by their alpha, one vector per channel.
#[inline(always)]
pub fn sample_sharp_covered4<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> [f32x8<S>; 4] {
    let ([w, h], window, data) = (view.full(), view.window(), view.data());
    let (columns, fx) = floor_and_share(x, w);
    let (rows, fy) = floor_and_share(y, h);
    let (wx, wy) = (catmull_rom(fx), catmull_rom(fy));
    if !all_between([columns, rows], [1, 1], [w - 3, h - 3]) {
        return taps_covered(simd, view, [columns - 1, rows - 1], wx, wy);
    }
    let stride = view.stride() as u32 as usize;
    let (mut pixels, zero) = ([f32x8::splat(simd, 0.0); 4], f32x8::splat(simd, 0.0));
    let mut least = f32x8::splat(simd, 1.0);
    let run = Run::of(simd, view, x, y, [1, 2]);
    if let Some(run) = &run {
        let data = &data[run.at..run.at + 3 * stride + 44];
        for pair in 0..4 {
            let mut sum = zero;
            for j in 0..4 {
                let taps = &data[j * stride + 8 * pair..j * stride + 8 * pair + 20];
                let mut row = zero;
                for i in 0..4 {
                    let pixel = eight(simd, taps, 4 * i);
                    if i == 0 || pair == 3 {
                        least = least.at_most(pixel);
                    }
                    row = pixel.mul_add(f32x8::splat(simd, wx[i][0]), row);
                }
                sum = row.mul_add(f32x8::splat(simd, wy[j][0]), sum);
            }
            pixels[pair] = sum;
        }
    } else {
        let at = ((rows - (window.y0 + 1)) * stride as i32 + (columns - (window.x0 + 1)) * 4).to_array();
        // One by one: what maps arrays stays a call in code for wide vectors.
        let spread_x = [spread(wx[0]), spread(wx[1]), spread(wx[2]), spread(wx[3])];
        let spread_y = [spread(wy[0]), spread(wy[1]), spread(wy[2]), spread(wy[3])];
        for lane in 0..4 {
            let (low, high) = (at[lane] as u32 as usize, at[lane + 4] as u32 as usize);
            let (low, high) = (&data[low..low + 3 * stride + 16], &data[high..high + 3 * stride + 16]);
            let mut sum = zero;
            for j in 0..4 {
                let (low, high) = (&low[j * stride..j * stride + 16], &high[j * stride..j * stride + 16]);
                let mut row = zero;
                for i in 0..4 {
                    let pixel = load_pixels(simd, &low[4 * i..], &high[4 * i..]);
                    least = least.at_most(pixel);
                    row = pixel.mul_add(spread_x[i][lane], row);
                }
                sum = row.mul_add(spread_y[j][lane], sum);
            }
            pixels[lane] = sum;
        }
    }
    // The last of each four values is an alpha.
    if least[3] < 1.0 || least[7] < 1.0 {
        return taps_covered(simd, view, [columns - 1, rows - 1], wx, wy);
    }
    if run.is_some() { channels_of_pairs(pixels) } else { transposed(pixels) }
}

/// Samples of a one-channel image at eight positions with a sharp interpolation; see [`sample_sharp_covered4`].
#[inline(always)]
pub fn sample_sharp1<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>) -> f32x8<S> {
    let ([w, h], window, data) = (view.full(), view.window(), view.data());
    let (columns, fx) = floor_and_share(x, w);
    let (rows, fy) = floor_and_share(y, h);
    let (wx, wy) = (catmull_rom(fx), catmull_rom(fy));
    if !all_between([columns, rows], [1, 1], [w - 3, h - 3]) {
        return taps1(simd, view, [columns - 1, rows - 1], wx, wy);
    }
    let stride = view.stride() as u32 as usize;
    if let Some(run) = Run::of(simd, view, x, y, [1, 2]) {
        let data = &data[run.at..run.at + 3 * stride + 11];
        let mut sum = f32x8::splat(simd, 0.0);
        for i in 0..4 {
            let mut column = eight(simd, data, i) * wy[0][0];
            for j in 1..4 {
                column = eight(simd, data, j * stride + i).mul_add(f32x8::splat(simd, wy[j][0]), column);
            }
            sum += column * wx[i][0];
        }
        return sum;
    }
    let at = ((rows - (window.y0 + 1)) * stride as i32 + (columns - (window.x0 + 1))).to_array();
    let wx = [wx[0].to_array(), wx[1].to_array(), wx[2].to_array(), wx[3].to_array()];
    let wy = [wy[0].to_array(), wy[1].to_array(), wy[2].to_array(), wy[3].to_array()];
    let mut sum = [0.0; 8];
    for lane in 0..8 {
        let at = at[lane] as u32 as usize;
        let data = &data[at..at + 3 * stride + 4];
        // The four pixels of a row are neighbours in memory: one load.
        let mut columns = f32x4::from_slice(simd, &data[..4]) * wy[0][lane];
        for j in 1..4 {
            let row = f32x4::from_slice(simd, &data[j * stride..j * stride + 4]);
            columns = row.mul_add(f32x4::splat(simd, wy[j][lane]), columns);
        }
        let columns = columns.to_array();
        for i in 0..4 {
            sum[lane] += wx[i][lane] * columns[i];
        }
    }
    f32x8::simd_from(simd, sum)
}

/// The weighted sum of 4 x 4 pixels of a one-channel image from those at `first` on, in the order of [`sample_sharp1`]'s
/// other ways: a pixel must not depend on which others it is computed with.
#[inline(always)]
fn taps1<S: Simd>(
    simd: S,
    view: &View<'_>,
    [columns, rows]: [i32x8<S>; 2],
    wx: [f32x8<S>; 4],
    wy: [f32x8<S>; 4],
) -> f32x8<S> {
    let mut sum = f32x8::splat(simd, 0.0);
    for i in 0..4 {
        let mut column = fetch1(simd, view, offsets(view, columns + i as i32, rows)) * wy[0];
        for j in 1..4 {
            let pixel = fetch1(simd, view, offsets(view, columns + i as i32, rows + j as i32));
            column = pixel.mul_add(wy[j], column);
        }
        sum += wx[i] * column;
    }
    sum
}

/// Eight positions that lie beside each other like the pixels of a row, away from the picture's edges.
struct Run {
    /// Index at which the first tap of the first position begins in the data.
    at: usize,
    /// The shares of the next column and row.
    fx: f32,
    fy: f32,
}

impl Run {
    /// The run of positions, if they are one; taps reach `before` pixels before those of the positions and `after` behind.
    #[inline(always)]
    fn of<S: Simd>(
        simd: S,
        view: &View<'_>,
        x: f32x8<S>,
        y: f32x8<S>,
        [before, after]: [i32; 2],
    ) -> Option<Self> {
        let ([w, h], window) = (view.full(), view.window());
        let (columns, fx) = floor_and_share(x, w);
        let (rows, fy) = floor_and_share(y, h);
        let (column, row, fx_first, fy_first) = (columns[0], rows[0], fx[0], fy[0]);
        let apart = (fx - fx_first).abs().at_least((fy - fy_first).abs());
        let is_run = are_neighbours(simd, columns, rows) && apart.simd_le(0.0).all_true();
        let is_inside = before <= column && column + 7 + after < w && before <= row && row + after < h;
        let at = (row - before - window.y0) * view.stride() as i32
            + (column - before - window.x0) * view.channels() as i32;
        (is_run && is_inside).then_some(Self { at: at as u32 as usize, fx: fx_first, fy: fy_first })
    }
}

/// True where eight pixels are neighbours in a row, in their order.
#[inline(always)]
fn are_neighbours<S: Simd>(simd: S, columns: i32x8<S>, rows: i32x8<S>) -> bool {
    let first = i32x8::from_slice(simd, &[0, 1, 2, 3, 4, 5, 6, 7]) + columns[0];
    ((columns - first) | (rows - rows[0])).simd_eq(0).all_true()
}

/// True where all columns and rows lie between bounds, both included.
#[inline(always)]
fn all_between<S: Simd>([x, y]: [i32x8<S>; 2], [left, top]: [i32; 2], [right, bottom]: [i32; 2]) -> bool {
    // Small pictures have no such.
    let there_are = left <= right && top <= bottom;
    let nearest = [x.within(left, right), y.within(top, bottom)];
    there_are && ((nearest[0] - x) | (nearest[1] - y)).simd_eq(0).all_true()
}

/// One vector per channel from eight pixels, two to a vector.
#[inline(always)]
fn channels_of_pairs<S: Simd>(p: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let ((rb0, ga0), (rb1, ga1)) = (p[0].deinterleave(p[1]), p[2].deinterleave(p[3]));
    let ((r, b), (g, a)) = (rb0.deinterleave(rb1), ga0.deinterleave(ga1));
    [r, g, b, a]
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
    let [low, high] = load_pairs(simd, view.data(), offsets(view, x, y).to_array());
    let (first, second) = low.deinterleave(high);
    [first, second]
}

/// The motion at positions, as far as it is no longer than `limit`: interpolated where neighbours agree to a pixel,
/// else that of the nearest.
#[inline(always)]
pub fn motion_at<S: Simd>(simd: S, view: &View<'_>, x: f32x8<S>, y: f32x8<S>, limit: f32) -> [f32x8<S>; 2] {
    let [w, h] = view.full();
    let (left, fx) = floor_and_share(x, w);
    let (top, fy) = floor_and_share(y, h);
    let [a, b, c, d] = corners2(simd, view, left, top);
    let (a, b, c, d) = (bounded(a, limit), bounded(b, limit), bounded(c, limit), bounded(d, limit));
    // The nearest pixel is the one before the position or the next.
    let near_x = x.floor().within(-2.0f32, w as f32 + 2.0).to_int::<i32x8<S>>().simd_eq(left);
    let near_y = y.floor().within(-2.0f32, h as f32 + 2.0).to_int::<i32x8<S>>().simd_eq(top);
    let mut spread = f32x8::splat(simd, 0.0);
    for i in 0..2 {
        spread = spread.at_least(
            a[i].at_least(b[i]).at_least(c[i].at_least(d[i]))
                - a[i].at_most(b[i]).at_most(c[i].at_most(d[i])),
        );
    }
    let alike = spread.simd_le(1.0);
    let mut motion = a;
    for i in 0..2 {
        let nearest = near_y.select(near_x.select(a[i], b[i]), near_x.select(c[i], d[i]));
        let above = (b[i] - a[i]).mul_add(fx, a[i]);
        let below = (d[i] - c[i]).mul_add(fx, c[i]);
        motion[i] = alike.select((below - above).mul_add(fy, above), nearest);
    }
    motion
}

/// The motions at eight places, beside, below, and beside those, clamped to the picture.
#[inline(always)]
pub fn corners2<S: Simd>(simd: S, view: &View<'_>, left: i32x8<S>, top: i32x8<S>) -> [[f32x8<S>; 2]; 4] {
    let ([w, h], x, y) = (view.full(), left[0], top[0]);
    if are_neighbours(simd, left, top) && x >= 0 && x + 8 < w && y >= 0 && y + 1 < h {
        let (above, below) = (Block { x, y, len: 8 }, Block { x, y: y + 1, len: 8 });
        let next = |block: Block| Block { x: x + 1, ..block };
        return [
            above.read(simd, view),
            next(above).read(simd, view),
            below.read(simd, view),
            next(below).read(simd, view),
        ];
    }
    let (right, bottom) = (left + 1, top + 1);
    [
        fetch2(simd, view, left, top),
        fetch2(simd, view, right, top),
        fetch2(simd, view, left, bottom),
        fetch2(simd, view, right, bottom),
    ]
}

/// The motions beside those of a block.
#[inline(always)]
pub fn beside<S: Simd>(simd: S, view: &View<'_>, block: Block, [dx, dy]: [i32; 2]) -> [f32x8<S>; 2] {
    let (window, x, y) = (view.window(), block.x + dx, block.y + dy);
    if window.x0 <= x && x + 8 <= window.x1 {
        return Block { x, y, len: 8 }.read(simd, view);
    }
    fetch2(simd, view, block.columns(simd) + dx, i32x8::splat(simd, y))
}

/// The pixel before a position, on one axis of a picture of `full` pixels, and the next one's share.
#[inline(always)]
fn floor_and_share<S: Simd>(position: f32x8<S>, full: i32) -> (i32x8<S>, f32x8<S>) {
    let position = (position - 0.5).within(-2.0f32, full as f32 + 2.0);
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
            // Neighbours, which are read as rows, are what they are each by itself.
            let near = f32x8::from_slice(simd, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]) + 4.75;
            let row = sample_sharp_covered4(simd, &view, near, f32x8::splat(simd, 4.25));
            let linear = sample_linear_near4(simd, &view, near, f32x8::splat(simd, 4.25));
            for lane in 0..8 {
                let [x, y] = [near[lane], 4.25].map(|v| f32x8::splat(simd, v));
                assert_eq!(sample_sharp_covered4(simd, &view, x, y)[0][0], row[0][lane]);
                assert_eq!(sample_linear4(simd, &view, x, y)[1][0], linear[1][lane]);
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
