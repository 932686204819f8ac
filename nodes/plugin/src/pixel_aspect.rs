//! Pixel aspect ratios: square pixels for frames that have others, such as anamorphic pictures and proxies
//! that shrink one side more.
//!
//! Filters know lengths in pixels, the same in every direction. So they work on a picture of square
//! pixels that covers the same place, as fine as the finer side of the host's, and the host gets means
//! over its pixels.
//!
//! Both ways take a pixel for what it is, the mean over its area: what a new pixel covers of old ones is
//! summed up. Within a pixel, its neighbours make a parabola of the same mean (the piecewise parabolic
//! method of Colella and Woodward, 1984), no higher and no lower than they are. So nothing rings, alpha
//! stays in 0..=1, and where a whole number of square pixels makes one of the host's, there and back is no
//! change at all. Which square pixels there are depends on the whole picture alone, never on a tile.

use isophote::engine::cpu::Threads;
use isophote::engine::image::MAX_SIDE;
use isophote::engine::{Error, Image, Rect};
use isophote::graph::GraphInput;
use isophote::spec::ImageKind;
use std::sync::{Mutex, PoisonError};

/// Square pixels in one of the host's along one axis, at most: beyond that the finer axis loses detail instead.
const MOST: f64 = 8.0;
/// Pixels are square up to this factor between their sides: proxies have whole numbers of rows and columns.
const SQUARE: f64 = 1.01;
/// Share of a pixel below which differences are rounding.
const ROUNDING: f64 = 1e-6;
/// A pixel that lies outside the picture for all but this share is left out.
const SLIVER: f64 = 0.01;
/// Surfaces are continuous where depths differ by less than this factor.
const SAME_SURFACE: f32 = 1.1;

/// Pixels of one axis in terms of others that cover the same length.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    /// Pixels that there are.
    from: i32,
    /// Pixels that are made.
    to: i32,
    /// The former per one of the latter.
    share: f64,
}

/// Contribution of one pixel to a new one: factors on its value, and on slope and curvature within it.
#[derive(Clone, Copy, Debug)]
struct Tap {
    at: i32,
    mean: f32,
    slope: f32,
    curve: f32,
}

impl Axis {
    fn new(from: i32, share: f64) -> Self {
        let to = (f64::from(from) / share - SLIVER).ceil().clamp(1.0, f64::from(MAX_SIDE)) as i32;
        Self { from, to, share }
    }

    fn reversed(self) -> Self {
        Self { from: self.to, to: self.from, share: 1.0 / self.share }
    }

    /// True where both are the same pixels.
    fn is_same(&self) -> bool {
        self.share == 1.0
    }

    /// Beginning and end of a new pixel.
    fn span(&self, at: i32) -> [f64; 2] {
        [at, at + 1].map(|edge| (f64::from(edge) * self.share).min(f64::from(self.from)))
    }

    /// First and last pixel under a new one.
    fn under(&self, at: i32) -> [i32; 2] {
        let [begin, end] = self.span(at);
        let first = ((begin + ROUNDING).floor() as i32).clamp(0, self.from - 1);
        [first, ((end - ROUNDING).ceil() as i32 - 1).clamp(first, self.from - 1)]
    }

    /// The pixel under the middle of a new one.
    fn middle(&self, at: i32) -> i32 {
        let ([begin, end], [first, last]) = (self.span(at), self.under(at));
        (f64::midpoint(begin, end).floor() as i32).clamp(first, last)
    }

    /// The pixels that those from `first` to before `end` are made from.
    fn needed(&self, first: i32, end: i32) -> [i32; 2] {
        if self.is_same() {
            return [first, end];
        }
        [(self.under(first)[0] - 1).max(0), (self.under(end - 1)[1] + 2).min(self.from)]
    }

    /// Taps that `at` is made from.
    fn taps(&self, at: i32) -> impl Iterator<Item = Tap> {
        let ([begin, end], [first, last]) = (self.span(at), self.under(at));
        let inside = move |cell: i32, edge: f64| (edge - f64::from(cell)).clamp(0.0, 1.0) - 0.5;
        let covered = move |cell| inside(cell, end) - inside(cell, begin);
        let all: f64 = (first..=last).map(covered).sum::<f64>().max(f64::MIN_POSITIVE);
        (first..=last).map(move |cell| {
            // Integrals of 1, t and t^2 - 1/12 over the covered part of -1/2..1/2.
            let (a, b) = (inside(cell, begin), inside(cell, end));
            let curve = (b.powi(3) - a.powi(3)) / 3.0 - (b - a) / 12.0;
            let [mean, slope, curve] = [b - a, (b * b - a * a) / 2.0, curve].map(|v| (v / all) as f32);
            Tap { at: cell, mean, slope, curve }
        })
    }
}

/// The square pixels of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SquarePixels {
    /// From the host's pixels to square ones, in x and y.
    axes: [Axis; 2],
    /// Square pixels per canonical unit.
    pub scale: f32,
}

impl SquarePixels {
    /// Pixels of a picture with so many of its own per canonical unit in x and y, as fine as its finer side.
    pub fn of(size: [u32; 2], ratio: [f64; 2]) -> Self {
        let [x, y] = ratio;
        Self::new(size, ratio, x.max(y).min(MOST * x.min(y)))
    }

    /// As many as the picture has: less detail on its finer side, no more memory.
    pub fn as_many(size: [u32; 2], ratio: [f64; 2]) -> Self {
        Self::new(size, ratio, (ratio[0] * ratio[1]).sqrt())
    }

    /// Pixels of twice the side of the finer of the picture's own, for drafts.
    pub fn halved(size: [u32; 2], ratio: [f64; 2]) -> Self {
        Self::new(size, ratio, ratio[0].max(ratio[1]) / 2.0)
    }

    fn new(size: [u32; 2], ratio: [f64; 2], density: f64) -> Self {
        let size = size.map(f64::from);
        let side = |i: usize| size[i] * density / ratio[i];
        let density = density * (f64::from(MAX_SIDE) / side(0).max(side(1))).min(1.0);
        let axis = |i: usize| Axis::new(size[i] as i32, ratio[i] / density);
        Self { axes: [axis(0), axis(1)], scale: density.clamp(1.0 / 1024.0, 64.0) as f32 }
    }

    /// Size of the picture in square pixels.
    pub fn size(&self) -> [u32; 2] {
        self.axes.map(|axis| axis.to as u32)
    }

    /// Square pixels in the length of one of the picture's own, in x and y.
    pub fn per_pixel(&self) -> [f64; 2] {
        self.axes.map(|axis| 1.0 / axis.share)
    }

    /// The square pixels that the host's in `window` are made from.
    pub fn square_window(&self, window: Rect) -> Rect {
        needed(self.axes.map(Axis::reversed), window)
    }

    /// The host's pixels that square ones in `window` are made from.
    pub fn host_window(&self, window: Rect) -> Rect {
        needed(self.axes, window)
    }

    /// The square pixels of `window` from the host's of [`SquarePixels::host_window`].
    ///
    /// # Errors
    /// Memory.
    pub fn to_square(
        self,
        pixels: Image,
        window: Rect,
        input: GraphInput,
        threads: &dyn Threads,
    ) -> Result<Image, Error> {
        resampled(self.axes, pixels, window, By::input(input), threads)
    }

    /// The host's pixels of `window` from the square ones of [`SquarePixels::square_window`].
    ///
    /// # Errors
    /// Memory.
    pub fn to_host(self, pixels: Image, window: Rect, threads: &dyn Threads) -> Result<Image, Error> {
        resampled(self.axes.map(Axis::reversed), pixels, window, By::Mean, threads)
    }
}

/// True where pixels with so many per canonical unit in x and y are square, as far as anyone can see.
pub fn is_square([x, y]: [f64; 2]) -> bool {
    x.max(y) <= SQUARE * x.min(y)
}

/// Colour times alpha.
pub fn multiply(image: &mut Image) {
    for pixel in image.data_mut().chunks_exact_mut(4) {
        let alpha = pixel[3];
        pixel[..3].iter_mut().for_each(|v| *v *= alpha);
    }
}

/// Colour over alpha, where there is any.
pub fn divide(image: &mut Image) {
    for pixel in image.data_mut().chunks_exact_mut(4).filter(|pixel| pixel[3] > 0.0) {
        let alpha = pixel[3];
        pixel[..3].iter_mut().for_each(|v| *v /= alpha);
    }
}

/// The way in which new pixels come from old ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum By {
    /// As means.
    Mean,
    /// As means within a surface.
    Surface,
    /// By the one in the middle: what lies between two vectors, points or numbers of objects may be neither.
    Middle,
}

impl By {
    fn input(input: GraphInput) -> Self {
        match input.kind() {
            ImageKind::Depth => Self::Surface,
            ImageKind::ObjectId | ImageKind::Cryptomatte | ImageKind::Motion | ImageKind::Position => {
                Self::Middle
            }
            ImageKind::Color
            | ImageKind::Normal
            | ImageKind::Scalar
            | ImageKind::Tensor
            | ImageKind::Control
            | ImageKind::Hatching
            | ImageKind::Flow => Self::Mean,
        }
    }
}

fn needed([x, y]: [Axis; 2], window: Rect) -> Rect {
    if window.is_empty() {
        return Rect::default();
    }
    let ([x0, x1], [y0, y1]) = (x.needed(window.x0, window.x1), y.needed(window.y0, window.y1));
    Rect { x0, y0, x1, y1 }
}

fn resampled(
    [x, y]: [Axis; 2],
    mut image: Image,
    window: Rect,
    by: By,
    threads: &dyn Threads,
) -> Result<Image, Error> {
    if !matches!(image.channels(), 1 | 4) && by != By::Middle {
        return Err(Error::Input(format!("an image of {} channels is no picture", image.channels())));
    }
    if !x.is_same() {
        let image_window = image.window();
        let columns = Rect { x0: window.x0, x1: window.x1, ..image_window };
        // The same for every row.
        let taps: Vec<Vec<Tap>> = (window.x0..window.x1).map(|column| x.taps(column).collect()).collect();
        image = by_rows(columns, image.channels(), threads, |row, target| {
            let (row, channels) = (image.row(row), image.channels() as usize);
            match image.channels() {
                _ if by == By::Middle => {
                    for (column, target) in (window.x0..window.x1).zip(target.chunks_exact_mut(channels)) {
                        let at = (x.middle(column) - image_window.x0) as usize * channels;
                        target.copy_from_slice(&row[at..at + channels]);
                    }
                }
                1 if by == By::Surface => {
                    for (column, target) in (window.x0..window.x1).zip(target) {
                        *target = surface(&x, column, |x| row[(x - image_window.x0) as usize]);
                    }
                }
                1 => along_row::<1>(&taps, row, image_window.x0, target),
                _ => along_row::<4>(&taps, row, image_window.x0, target),
            }
        })?;
    }
    if !y.is_same() {
        let image_window = image.window();
        let rows = Rect { y0: window.y0, y1: window.y1, ..image_window };
        image = by_rows(rows, image.channels(), threads, |row, target| {
            across_rows(&y, &image, row, by, target);
        })?;
    }
    Ok(image)
}

/// An image whose rows `fill` writes, each one once.
fn by_rows(
    window: Rect,
    channels: u32,
    threads: &dyn Threads,
    fill: impl Fn(i32, &mut [f32]) + Sync,
) -> Result<Image, Error> {
    const ROWS: usize = 16;
    let mut image = Image::with_window(window, channels)?;
    let len = window.width() as usize * channels as usize;
    let parts: Vec<Mutex<&mut [f32]>> = image.data_mut().chunks_mut(ROWS * len).map(Mutex::new).collect();
    threads.run(parts.len(), &|index| {
        let mut part = parts[index].lock().unwrap_or_else(PoisonError::into_inner);
        for (row, target) in part.chunks_exact_mut(len).enumerate() {
            fill(window.y0 + (index * ROWS + row) as i32, target);
        }
    });
    drop(parts);
    Ok(image)
}

/// One row of new pixels from the old ones of that row, which begins at column `x0`.
fn along_row<const N: usize>(taps: &[Vec<Tap>], row: &[f32], x0: i32, target: &mut [f32]) {
    let row = row.as_chunks::<N>().0;
    let pixel = |x: i32| &row[(x - x0).clamp(0, row.len() as i32 - 1) as usize];
    for (taps, target) in taps.iter().zip(target.as_chunks_mut::<N>().0) {
        let Some(first) = taps.first().map(|tap| pixel(tap.at)) else { continue };
        *target = *first;
        for tap in taps {
            add(target, first, [-1, 0, 1].map(|beside| &pixel(tap.at + beside)[..]), tap);
        }
    }
}

/// One row of new pixels from the old ones of its columns.
fn across_rows(axis: &Axis, image: &Image, y: i32, by: By, target: &mut [f32]) {
    let image_window = image.window();
    let row = |y: i32| image.row(y.clamp(image_window.y0, image_window.y1 - 1));
    if by == By::Middle {
        target.copy_from_slice(row(axis.middle(y)));
        return;
    }
    if by == By::Surface {
        for (x, target) in target.iter_mut().enumerate() {
            *target = surface(axis, y, |y| row(y)[x]);
        }
        return;
    }
    let first = row(axis.under(y)[0]);
    target.copy_from_slice(first);
    for tap in axis.taps(y) {
        add(target, first, [-1, 0, 1].map(|beside| row(tap.at + beside)), &tap);
    }
}

/// Adds what a pixel contributes: the difference to the `first` one, so that what is flat stays so exactly, and
/// the parabola that it makes with the pixels before and after it.
#[inline(always)]
fn add(target: &mut [f32], first: &[f32], [before, here, after]: [&[f32]; 3], tap: &Tap) {
    let values = target.iter_mut().zip(first).zip(before.iter().zip(here).zip(after));
    for ((target, first), ((before, here), after)) in values {
        *target += tap.mean * (here - first);
        let slope = 0.5 * (after - before);
        let curve = 0.5 * (before + after) - here;
        // How far the parabola goes from the mean: at its ends and in the middle.
        let (end, tilt, middle) = (curve / 6.0, 0.5 * slope.abs(), curve / -12.0);
        let (up, down) = ((end + tilt).max(middle), (end - tilt).min(middle));
        let (above, below) = (before.max(*after).max(*here) - here, before.min(*after).min(*here) - here);
        let mut kept = 1.0_f32;
        if up > above {
            kept = kept.min(above / up);
        }
        if down < below {
            kept = kept.min(below / down);
        }
        *target += kept * (tap.slope * slope + tap.curve * curve);
    }
}

/// Depth of a new pixel: the mean on a surface; no value between one and the next.
fn surface(axis: &Axis, at: i32, depth: impl Fn(i32) -> f32) -> f32 {
    let [first, last] = axis.under(at);
    let depths = || (first..=last).map(&depth);
    let (near, far) = (depths().fold(f32::INFINITY, f32::min), depths().fold(0.0, f32::max));
    if near > 0.0 && far < SAME_SURFACE * near {
        let start = depth(first);
        return start + axis.taps(at).map(|tap| tap.mean * (depth(tap.at) - start)).sum::<f32>();
    }
    depth(axis.middle(at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::engine::cpu::CallingThread;

    fn square(size: [i32; 2], ratio: [f64; 2]) -> SquarePixels {
        assert!(!is_square(ratio));
        SquarePixels::of(size.map(|side| side as u32), ratio)
    }

    fn picture(size: [i32; 2], value: impl Fn(i32, i32, usize) -> f32) -> Image {
        let [width, height] = size;
        let values = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let values = values.flat_map(|(x, y)| (0..4).map(move |c| (x, y, c)));
        let values = values.map(|(x, y, c)| value(x, y, c)).collect();
        Image::from_vec(width as u32, height as u32, 4, values).unwrap()
    }

    fn noise(x: i32, y: i32, c: usize) -> f32 {
        ((x * 7919 + y * 104_729 + c as i32 * 31) % 97) as f32 / 97.0
    }

    fn worst(a: &Image, b: &Image) -> f32 {
        a.data().iter().zip(b.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn the_finer_side_counts_and_nearly_square_pixels_are_square() {
        assert_eq!(square([100, 60], [0.5, 1.0]).size(), [200, 60]);
        assert_eq!(square([100, 60], [2.0, 1.0]).size(), [100, 120]);
        assert_eq!(square([100, 60], [1.0 / 1.0667, 1.0]).size(), [107, 60]);
        assert!(square([10_000, 10], [0.01, 1.0]).size()[0] <= MAX_SIDE);
        assert!(is_square([0.5, 0.5002]));
        let even = SquarePixels::as_many([100, 60], [0.5, 1.0]).size();
        assert!((i64::from(even[0]) * i64::from(even[1]) - 6000).abs() < 200, "{even:?}");
    }

    #[test]
    fn there_and_back_is_no_change_for_whole_numbers_and_little_for_others() {
        let size = [37, 29];
        let whole = Rect::of_size(37, 29);
        for (ratio, noisy, smooth) in
            [([0.5, 1.0], 1e-6, 1e-6), ([3.0, 1.0], 1e-6, 1e-6), ([1.0 / 1.0667, 1.0], 0.6, 0.005)]
        {
            let square = square(size, ratio);
            let back = |image: &Image| {
                let window = Rect::of_size(square.size()[0], square.size()[1]);
                let there =
                    square.to_square(image.clone(), window, GraphInput::Color, &CallingThread).unwrap();
                square.to_host(there, whole, &CallingThread).unwrap()
            };
            let noise = picture(size, noise);
            assert!(worst(&back(&noise), &noise) <= noisy, "{ratio:?}: {}", worst(&back(&noise), &noise));
            let waves = picture(size, |x, y, _| 0.5 + 0.4 * (x as f32 * 0.3 + y as f32 * 0.2).sin());
            // At the border half of a slope is not known.
            let inner = Rect { x0: 2, y0: 0, x1: 35, y1: 29 };
            let far = worst(&back(&waves).crop(inner).unwrap(), &waves.crop(inner).unwrap());
            assert!(far <= smooth, "{ratio:?}: {far}");
            let flat = picture(size, |_, _, c| [0.3, 17.0, -1.0, 1.0][c]);
            assert_eq!(back(&flat), flat);
        }
    }

    #[test]
    fn parts_equal_the_whole_and_nothing_rings() {
        let size = [37, 29];
        let image = picture(size, |x, y, c| if (x / 5 + y / 3) % 2 == 0 { noise(x, y, c) } else { 60.0 });
        for ratio in [[0.5, 1.0], [1.0, 0.7], [1.0 / 1.0667, 1.0], [1.3, 0.9]] {
            let square = square(size, ratio);
            let [width, height] = square.size();
            let all = Rect::of_size(width, height);
            let make = |window: Rect| {
                let under = image.crop(square.host_window(window)).unwrap();
                square.to_square(under, window, GraphInput::Color, &CallingThread).unwrap()
            };
            let full = make(all);
            assert!(full.data().iter().all(|v| (-1e-5..=60.0001).contains(v)));
            let part = Rect { x0: 9, y0: 4, x1: 20, y1: 23 };
            assert!(make(part) == full.crop(part).unwrap(), "{ratio:?}");
            let back = |window: Rect| {
                let over = full.crop(square.square_window(window)).unwrap();
                square.to_host(over, window, &CallingThread).unwrap()
            };
            let part = Rect { x0: 3, y0: 11, x1: 36, y1: 12 };
            assert!(back(part) == back(Rect::of_size(37, 29)).crop(part).unwrap(), "{ratio:?}");
        }
    }

    #[test]
    fn depths_are_those_of_surfaces() {
        let square = square([30, 4], [1.0 / 1.0667, 1.0]);
        let depth = |x: i32| if x < 15 { 5.0 + 0.02 * x as f32 } else { f32::INFINITY };
        let image = Image::from_vec(30, 4, 1, (0..120).map(|i| depth(i % 30)).collect()).unwrap();
        let window = Rect::of_size(square.size()[0], 4);
        let made = square.to_square(image, window, GraphInput::Depth, &CallingThread).unwrap();
        for (x, v) in made.row(2).iter().enumerate() {
            let place = (x as f32 + 0.5) / 1.0667 - 0.5;
            let (low, high) = (depth(place.floor().max(0.0) as i32), depth(place.ceil().min(29.0) as i32));
            assert!((low..=high).contains(v) && (v.is_infinite() || *v < 6.0), "{x}: {v}");
        }
    }
}
