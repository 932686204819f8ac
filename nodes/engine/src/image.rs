//! Images in memory: 32-bit float, channels interleaved, rows top-down, no padding.
//!
//! An image knows which window of a larger picture it holds, so that a kernel can speak of
//! absolute pixel positions whether it is given the full frame or a tile with its halo.

use crate::error::{Error, Result};
use crate::memory;

/// A half-open rectangle of pixels, `x0 <= x < x1` and `y0 <= y < y1`, y down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Rect {
    /// Left column, inclusive.
    pub x0: i32,
    /// Top row, inclusive.
    pub y0: i32,
    /// Right column, exclusive.
    pub x1: i32,
    /// Bottom row, exclusive.
    pub y1: i32,
}

impl Rect {
    /// The rectangle of a whole picture, with its origin at (0, 0).
    pub const fn of_size(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width as i32, y1: height as i32 }
    }

    /// Columns covered; 0 when empty.
    #[inline]
    pub const fn width(&self) -> u32 {
        if self.x1 > self.x0 { (self.x1 - self.x0) as u32 } else { 0 }
    }

    /// Rows covered; 0 when empty.
    #[inline]
    pub const fn height(&self) -> u32 {
        if self.y1 > self.y0 { (self.y1 - self.y0) as u32 } else { 0 }
    }

    /// Pixels covered.
    #[inline]
    pub const fn area(&self) -> u64 {
        self.width() as u64 * self.height() as u64
    }

    /// True when no pixel lies inside.
    #[inline]
    pub const fn is_empty(&self) -> bool {
        self.width() == 0 || self.height() == 0
    }

    /// Grown by `n` pixels on every side.
    pub const fn grown(&self, n: i32) -> Self {
        self.grown_by([n, n])
    }

    /// Grown by `x` pixels to the left and right, and by `y` above and below.
    pub const fn grown_by(&self, [x, y]: [i32; 2]) -> Self {
        Self { x0: self.x0 - x, y0: self.y0 - y, x1: self.x1 + x, y1: self.y1 + y }
    }

    /// The pixels that lie in both.
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }

    /// The smallest rectangle that holds both; an empty one counts for nothing.
    pub fn union(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        Self {
            x0: self.x0.min(other.x0),
            y0: self.y0.min(other.y0),
            x1: self.x1.max(other.x1),
            y1: self.y1.max(other.y1),
        }
    }

    /// True when every pixel of `other` lies inside.
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty()
            || (self.x0 <= other.x0 && self.y0 <= other.y0 && self.x1 >= other.x1 && self.y1 >= other.y1)
    }
}

/// The largest side of an image. Products of sizes stay far from overflow below it, and sub-pixel
/// positions in f32 keep at least seven bits of fraction.
pub const MAX_SIDE: u32 = 1 << 16;

/// A 32-bit float image: `channels` (1..=4) interleaved values a pixel, covering `window` of a
/// picture.
#[derive(Debug, Default)]
pub struct Image {
    window: Rect,
    channels: u32,
    /// The values, and behind them what an image of another shape has left: to clear that for the next one would take as long as a
    /// pass, in which all threads but one wait.
    data: Vec<f32>,
}

impl Clone for Image {
    fn clone(&self) -> Self {
        Self { data: self.data().to_vec(), ..*self }
    }
}

impl PartialEq for Image {
    fn eq(&self, other: &Self) -> bool {
        (self.window, self.channels) == (other.window, other.channels) && self.data() == other.data()
    }
}

/// Access of the CPU executor to the memory of images.
#[cfg(feature = "cpu")]
impl Image {
    /// An image without pixels, for places that must hold one.
    pub(crate) const EMPTY: Self =
        Self { window: Rect { x0: 0, y0: 0, x1: 0, y1: 0 }, channels: 1, data: Vec::new() };

    /// Turns this image into one of another shape, keeping its memory where that is enough. Values are
    /// unspecified.
    ///
    /// # Errors
    /// [`Error::Geometry`] for a shape that no image can have, [`Error::Memory`] when there is not enough; the image has
    /// then no pixel.
    pub fn reshaped(mut self, window: Rect, channels: u32) -> Result<Self> {
        check_shape(window, channels)?;
        self.reshape(window, channels)?;
        Ok(self)
    }

    /// The same in place, for a shape that was checked.
    ///
    /// # Errors
    /// [`Error::Memory`] when there is not enough; the image has then no pixel.
    pub(crate) fn reshape(&mut self, window: Rect, channels: u32) -> Result<()> {
        let len = window.width() as usize * window.height() as usize * channels as usize;
        let mut data = std::mem::take(self).data;
        if data.len() < len {
            drop(data);
            data = memory::zeroed(len)?;
        }
        *self = Self { window, channels, data };
        Ok(())
    }

    /// Lets go of the rows before `y0` and makes room for as many below: the memory stays the same, and the
    /// rows from `y0` to `y1` keep their values.
    pub(crate) fn slide(&mut self, y0: i32, y1: i32) {
        let stride = self.stride();
        let at = |y: i32| (y - self.window.y0) as usize * stride;
        let kept = at(y0)..at(y1);
        self.data.copy_within(kept, 0);
        let height = self.window.height() as i32;
        self.window = Rect { y0, y1: y0 + height, ..self.window };
    }
}

impl Image {
    /// A picture of `width` x `height` pixels, all zero.
    ///
    /// # Errors
    /// [`Error::Geometry`] when a side is 0 or above [`MAX_SIDE`], or `channels` is not 1..=4;
    /// [`Error::Memory`] when there is not enough.
    pub fn new(width: u32, height: u32, channels: u32) -> Result<Self> {
        Self::with_window(Rect::of_size(width, height), channels)
    }

    /// An image that covers `window` of a picture, all zero.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn with_window(window: Rect, channels: u32) -> Result<Self> {
        check_shape(window, channels)?;
        let data = memory::zeroed(window.width() as usize * window.height() as usize * channels as usize)?;
        Ok(Self { window, channels, data })
    }

    /// Wraps values in row order.
    ///
    /// # Errors
    /// As [`Image::new`], and when `data` has another length than width x height x channels.
    pub fn from_vec(width: u32, height: u32, channels: u32, data: Vec<f32>) -> Result<Self> {
        check_size(width, height)?;
        let expected = width as usize * height as usize * channels as usize;
        if !(1..=4).contains(&channels) || data.len() != expected {
            return Err(Error::Geometry(format!(
                "{width}x{height} pixels of {channels} channels need {expected} values, not {}",
                data.len()
            )));
        }
        Ok(Self { window: Rect::of_size(width, height), channels, data })
    }

    /// The part of the picture that is held.
    pub fn window(&self) -> Rect {
        self.window
    }

    /// Columns held.
    pub fn width(&self) -> u32 {
        self.window.width()
    }

    /// Rows held.
    pub fn height(&self) -> u32 {
        self.window.height()
    }

    /// Values a pixel, 1..=4.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// Bytes of memory that it has, which may be more than its values take.
    pub fn memory(&self) -> u64 {
        (self.data.capacity() * size_of::<f32>()) as u64
    }

    /// All values, row by row.
    pub fn data(&self) -> &[f32] {
        &self.data[..self.len()]
    }

    /// All values, row by row.
    pub fn data_mut(&mut self) -> &mut [f32] {
        let len = self.len();
        &mut self.data[..len]
    }

    /// The values of all pixels, giving up the image.
    pub fn into_data(mut self) -> Vec<f32> {
        self.data.truncate(self.len());
        self.data
    }

    /// Number of values.
    fn len(&self) -> usize {
        self.stride() * self.window.height() as usize
    }

    /// Values from one row to the next.
    #[inline]
    pub fn stride(&self) -> usize {
        self.window.width() as usize * self.channels as usize
    }

    /// Row `y` of the picture (absolute, within the window).
    pub fn row(&self, y: i32) -> &[f32] {
        let start = (y - self.window.y0) as usize * self.stride();
        &self.data[start..start + self.stride()]
    }

    /// Row `y` of the picture (absolute, within the window).
    pub fn row_mut(&mut self, y: i32) -> &mut [f32] {
        let stride = self.stride();
        let start = (y - self.window.y0) as usize * stride;
        &mut self.data[start..start + stride]
    }

    /// The values of one pixel (absolute position, within the window).
    pub fn pixel(&self, x: i32, y: i32) -> &[f32] {
        let c = self.channels as usize;
        let start = (x - self.window.x0) as usize * c;
        &self.row(y)[start..start + c]
    }

    /// A copy of the pixels of `window`, which must lie inside this image's own window.
    ///
    /// # Errors
    /// [`Error::Geometry`] when it does not.
    pub fn crop(&self, window: Rect) -> Result<Self> {
        if window.is_empty() || !self.window.contains(&window) {
            return Err(Error::Geometry(format!("cannot cut {window:?} out of {:?}", self.window)));
        }
        let mut out = Self::with_window(window, self.channels)?;
        let c = self.channels as usize;
        for y in window.y0..window.y1 {
            let start = (window.x0 - self.window.x0) as usize * c;
            let len = window.width() as usize * c;
            out.row_mut(y).copy_from_slice(&self.row(y)[start..start + len]);
        }
        Ok(out)
    }
}

fn check_shape(window: Rect, channels: u32) -> Result<()> {
    check_size(window.width(), window.height())?;
    if !(1..=4).contains(&channels) {
        return Err(Error::Geometry(format!("an image has 1 to 4 channels, not {channels}")));
    }
    Ok(())
}

/// Refuses sizes that no image can have.
///
/// # Errors
/// [`Error::Geometry`] when a side is 0 or above [`MAX_SIDE`].
pub fn check_size(width: u32, height: u32) -> Result<()> {
    if width == 0 || height == 0 {
        return Err(Error::Geometry(format!("an image of {width}x{height} has no pixel")));
    }
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(Error::Geometry(format!("{width}x{height} is larger than {MAX_SIDE} on a side")));
    }
    Ok(())
}

/// Input as a kernel sees it: the values held, where they lie in the picture, and how large
/// the picture is. Positions are absolute and clamp to the picture's edge.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    data: &'a [f32],
    window: Rect,
    channels: u32,
    full: [i32; 2],
}

impl<'a> View<'a> {
    /// A view of `image` as part of a picture of `full` pixels.
    #[inline]
    pub fn new(image: &'a Image, full: [i32; 2]) -> Self {
        Self { data: image.data(), window: image.window, channels: image.channels, full }
    }

    /// The same of the rows of `image` down to `y1`, exclusive.
    #[cfg(feature = "cpu")]
    pub(crate) fn down_to(image: &'a Image, full: [i32; 2], y1: i32) -> Self {
        let window = Rect { y1: y1.min(image.window.y1), ..image.window };
        let len = window.height() as usize * image.stride();
        Self { data: &image.data[..len], window, channels: image.channels, full }
    }

    /// Size of the whole picture, of which the window may be a part.
    #[inline(always)]
    pub fn full(&self) -> [i32; 2] {
        self.full
    }

    /// The part of the picture that is held.
    #[inline(always)]
    pub fn window(&self) -> Rect {
        self.window
    }

    /// Values a pixel.
    #[inline(always)]
    pub fn channels(&self) -> usize {
        self.channels as usize
    }

    /// All values held, row by row, `stride` apart.
    #[inline(always)]
    pub fn data(&self) -> &'a [f32] {
        self.data
    }

    /// Values from one row to the next.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.window.width() as usize * self.channels as usize
    }

    /// Index at which pixel (x, y) begins in `data`; the position is clamped to the picture first and must
    /// then lie in the window.
    #[inline(always)]
    pub fn offset(&self, x: i32, y: i32) -> usize {
        let x = x.clamp(0, self.full[0] - 1) - self.window.x0;
        let y = y.clamp(0, self.full[1] - 1) - self.window.y0;
        debug_assert!(x >= 0 && y >= 0 && x < self.window.width() as i32 && y < self.window.height() as i32);
        y as usize * self.stride() + x as usize * self.channels as usize
    }

    /// The pixel at (x, y) of a four-channel image.
    #[inline(always)]
    pub fn pixel4(&self, x: i32, y: i32) -> [f32; 4] {
        let at = self.offset(x, y);
        let mut out = [0.0; 4];
        out.copy_from_slice(&self.data[at..at + 4]);
        out
    }

    /// The value at (x, y) of a one-channel image.
    #[inline(always)]
    pub fn pixel1(&self, x: i32, y: i32) -> f32 {
        self.data[self.offset(x, y)]
    }

    /// Row `y`, columns `x0..x1`, clamped to the picture's edge. Borrows the image where the columns
    /// lie inside it and otherwise assembles them in `scratch`.
    #[inline]
    pub fn padded_row<'s>(&self, y: i32, x0: i32, x1: i32, scratch: &'s mut Vec<f32>) -> &'s [f32]
    where
        'a: 's,
    {
        let c = self.channels as usize;
        let y = y.clamp(0, self.full[1] - 1);
        let row_start = (y - self.window.y0) as usize * self.stride();
        let row = &self.data[row_start..row_start + self.stride()];
        if x0 >= self.window.x0 && x1 <= self.window.x1 {
            let start = (x0 - self.window.x0) as usize * c;
            return &row[start..start + (x1 - x0) as usize * c];
        }
        scratch.clear();
        // Outside the window there is only the picture's edge: the support promised all the rest.
        let (first, last) = (&row[..c], &row[row.len() - c..]);
        for _ in x0..x1.min(self.window.x0) {
            scratch.extend_from_slice(first);
        }
        let (inner0, inner1) = (x0.max(self.window.x0), x1.min(self.window.x1));
        if inner0 < inner1 {
            let at = |x: i32| (x - self.window.x0) as usize * c;
            scratch.extend_from_slice(&row[at(inner0)..at(inner1)]);
        }
        for _ in x0.max(self.window.x1)..x1 {
            scratch.extend_from_slice(last);
        }
        scratch
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_padded_row_clamps_to_the_picture() {
        let image = Image::from_vec(3, 1, 1, vec![1.0, 2.0, 3.0]).unwrap();
        let view = View::new(&image, [3, 1]);
        let mut scratch = Vec::new();
        assert_eq!(view.padded_row(5, -2, 5, &mut scratch), [1.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0]);
        assert_eq!(view.padded_row(0, 1, 3, &mut scratch), [2.0, 3.0]);
        assert_eq!(view.padded_row(0, -3, -1, &mut scratch), [1.0, 1.0]);
        assert_eq!(view.padded_row(0, 4, 6, &mut scratch), [3.0, 3.0]);
    }

    #[test]
    fn a_crop_keeps_absolute_positions() {
        let image = Image::from_vec(3, 2, 1, (0..6).map(|v| v as f32).collect()).unwrap();
        let part = image.crop(Rect { x0: 1, y0: 1, x1: 3, y1: 2 }).unwrap();
        assert_eq!(part.pixel(2, 1), [5.0]);
        assert!(image.crop(Rect { x0: 1, y0: 1, x1: 4, y1: 2 }).is_err());
    }

    #[test]
    fn impossible_sizes_are_refused() {
        assert!(Image::new(0, 4, 4).is_err());
        assert!(Image::new(4, MAX_SIDE + 1, 4).is_err());
        assert!(Image::new(4, 4, 5).is_err());
        assert!(Image::from_vec(2, 2, 1, vec![0.0; 3]).is_err());
    }
}
