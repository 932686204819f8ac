//! The display window: what of a picture is shown, for files that hold no more than that.

use crate::meaning::{Meaning, Window};
use crate::pixels::{MOST_PIXELS, Pixels, Samples};

/// The pixels of the display window. What the data window does not hold is transparent, or black where there is no alpha; what it
/// holds beyond is left out. The same pixels where both windows are one, and where the display window has more pixels than a
/// picture may have.
pub fn shown(pixels: Pixels, meaning: &Meaning) -> Pixels {
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    let (Some(data), Some(display)) = (meaning.data, meaning.display) else { return pixels };
    let is_whole = data == display || (data.width, data.height) != (width, height);
    if is_whole || (display.width as u64).saturating_mul(display.height as u64) > MOST_PIXELS {
        return pixels;
    }
    let channels = pixels.channels();
    let samples = match pixels.samples() {
        Samples::U8(v) => Samples::U8(moved(v, channels, data, display)),
        Samples::U16(v) => Samples::U16(moved(v, channels, data, display)),
        Samples::F16(v) => Samples::F16(moved(v, channels, data, display)),
        Samples::F32(v) => Samples::F32(moved(v, channels, data, display)),
    };
    // As many samples as the window has.
    Pixels::new(display.width as u32, display.height as u32, channels, samples).unwrap_or(pixels)
}

/// Pixels in a length across and down by which files tell the shape of pixels, each from 1 to 65535.
pub fn densities(pixel_aspect: f32) -> [u32; 2] {
    // As many as can be, so that the ratio is near.
    let across = if pixel_aspect <= 6.0 { 10_000.0 } else { 600.0 };
    let down = (across * pixel_aspect).round().clamp(1.0, 65535.0) as u32;
    if pixel_aspect == 1.0 { [1, 1] } else { [across as u32, down.max(1)] }
}

/// Samples of one window as those of another, 0 where there are none.
fn moved<T: Copy + Default>(samples: &[T], channels: u32, from: Window, to: Window) -> Vec<T> {
    let channels = channels as usize;
    let mut result = vec![T::default(); to.width * to.height * channels];
    let [first, end] = overlap((from.x, from.width), (to.x, to.width));
    let [top, bottom] = overlap((from.y, from.height), (to.y, to.height));
    if first >= end {
        return result;
    }
    let at = |window: Window, x: i64, y: i64| {
        ((y - i64::from(window.y)) as usize * window.width + (x - i64::from(window.x)) as usize) * channels
    };
    let length = (end - first) as usize * channels;
    for y in top..bottom {
        let (source, target) = (at(from, first, y), at(to, first, y));
        result[target..target + length].copy_from_slice(&samples[source..source + length]);
    }
    result
}

/// The part that two ranges share, which may be none.
fn overlap(a: (i32, usize), b: (i32, usize)) -> [i64; 2] {
    let [a, b] = [a, b].map(|(begin, length)| (i64::from(begin), i64::from(begin) + length as i64));
    [a.0.max(b.0), a.1.min(b.1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(data: [i32; 4], display: [i32; 4]) -> Meaning {
        let window =
            |[x, y, width, height]: [i32; 4]| Window { x, y, width: width as usize, height: height as usize };
        Meaning { data: Some(window(data)), display: Some(window(display)), ..Meaning::light() }
    }

    fn numbers(pixels: &Pixels) -> Vec<u8> {
        let Samples::U8(samples) = pixels.samples() else { return Vec::new() };
        samples.clone()
    }

    #[test]
    fn shapes_of_pixels_are_ratios() {
        assert_eq!(densities(1.0), [1, 1]);
        assert_eq!(densities(2.0), [10_000, 20_000]);
        assert_eq!(densities(0.75), [10_000, 7500]);
        assert_eq!(densities(100.0), [600, 60_000]);
        assert_eq!(densities(f32::NAN), [600, 1]);
    }

    #[test]
    fn parts_and_overscan_become_the_window_that_is_shown() {
        let pixels = Pixels::new(2, 2, 1, Samples::U8(vec![1, 2, 3, 4])).unwrap();
        let part = shown(pixels.clone(), &meaning([1, 1, 2, 2], [0, 0, 4, 3]));
        assert_eq!(numbers(&part), [0, 0, 0, 0, 0, 1, 2, 0, 0, 3, 4, 0]);
        let overscan = shown(pixels.clone(), &meaning([-1, -1, 2, 2], [0, 0, 1, 1]));
        assert_eq!(numbers(&overscan), [4]);
        let apart = shown(pixels.clone(), &meaning([-9, 0, 2, 2], [0, 0, 2, 1]));
        assert_eq!(numbers(&apart), [0, 0]);
        assert_eq!(shown(pixels.clone(), &meaning([5, 5, 2, 2], [5, 5, 2, 2])), pixels);
        let endless = meaning([0, 0, 2, 2], [0, 0, i32::MAX, i32::MAX]);
        assert_eq!(shown(pixels.clone(), &endless), pixels);
        assert_eq!(shown(pixels.clone(), &Meaning::display()), pixels);
    }
}
