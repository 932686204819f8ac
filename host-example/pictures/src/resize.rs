//! Sizes of results other than the picture's, and pixels at such a size.
//!
//! Bicubic interpolation by Catmull and Rom, widened where a picture gets smaller so that every pixel counts; results stay within
//! the values that they are made of, so that borders get no halos and light no negative numbers. About 16 multiplications a
//! sample and direction where a picture becomes half as large.

use std::fmt;
use std::str::FromStr;

use crate::pixels::{MOST_PIXELS, Pixels, Samples};

/// Pixels to each side that the interpolation reaches where nothing gets smaller.
const REACH: f64 = 2.0;

/// Size of a result in relation to its picture's, whose shape it keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resize {
    /// Share of both sides, above 0.
    Share(f64),
    /// Pixels across.
    Width(u32),
    /// Pixels down.
    Height(u32),
}

impl Resize {
    /// Size of what is made of a picture of a size.
    ///
    /// # Errors
    /// The problem with a size that has more pixels than a picture may have.
    pub fn of(self, (width, height): (u32, u32)) -> Result<(u32, u32), String> {
        let [across, down] = [width, height].map(f64::from);
        let whole = |v: f64| v.round().clamp(1.0, f64::from(u32::MAX)) as u32;
        let (width, height) = match self {
            Self::Share(share) => (whole(across * share), whole(down * share)),
            Self::Width(width) => (width.max(1), whole(down * f64::from(width) / across.max(1.0))),
            Self::Height(height) => (whole(across * f64::from(height) / down.max(1.0)), height.max(1)),
        };
        match u64::from(width).saturating_mul(u64::from(height)) {
            ..=MOST_PIXELS => Ok((width, height)),
            _ => {
                Err(format!("{self} would make {width}x{height} pixels, and at most {MOST_PIXELS} are made"))
            }
        }
    }
}

impl fmt::Display for Resize {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Share(share) => write!(to, "{}%", share * 100.0),
            Self::Width(width) => write!(to, "{width}x"),
            Self::Height(height) => write!(to, "x{height}"),
        }
    }
}

impl FromStr for Resize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |text: &str| text.parse::<u32>().ok().filter(|side| *side > 0);
        let parsed = if let Some(percent) = text.strip_suffix('%') {
            let percent = percent.trim().parse::<f64>().ok();
            percent.filter(|percent| (0.1..=1000.0).contains(percent)).map(|v| Self::Share(v / 100.0))
        } else if let Some(width) = text.strip_suffix(['x', 'X']) {
            side(width).map(Self::Width)
        } else {
            text.strip_prefix(['x', 'X']).and_then(side).map(Self::Height)
        };
        parsed
            .ok_or_else(|| "write 50% for half, 1920x for a width or x1080 for a height in pixels".to_owned())
    }
}

/// Pixels at another size and of the same precision. Colour that is apart from alpha counts by its alpha, so that what is
/// transparent does not shine through.
pub fn resized(pixels: &Pixels, (width, height): (u32, u32), is_premultiplied: bool) -> Pixels {
    if (width, height) == (pixels.width(), pixels.height()) {
        return pixels.clone();
    }
    let (channels, is_straight) = (pixels.channels() as usize, pixels.channels() == 4 && !is_premultiplied);
    let mut samples = pixels.to_f32();
    if is_straight {
        samples.as_chunks_mut::<4>().0.iter_mut().for_each(|[r, g, b, a]| {
            [r, g, b].into_iter().for_each(|v| *v *= *a);
        });
    }
    let [from, down] = [pixels.width(), pixels.height()].map(|side| side as usize);
    let rows = samples.chunks_exact(from * channels);
    let taps = taps(from, width as usize);
    let narrow: Vec<f32> = rows.flat_map(|row| across(row, &taps, channels)).collect();
    let taps = self::taps(down, height as usize);
    let row = width as usize * channels;
    let mut result: Vec<f32> = taps.iter().flat_map(|tap| below(&narrow, tap, row)).collect();
    if is_straight {
        result.as_chunks_mut::<4>().0.iter_mut().filter(|pixel| pixel[3] > 0.0).for_each(|[r, g, b, a]| {
            [r, g, b].into_iter().for_each(|v| *v /= *a);
        });
    }
    let made = Pixels::new(width, height, pixels.channels(), Samples::F32(result));
    // As many samples as the size says.
    made.map_or_else(|| pixels.clone(), |made| made.converted(pixels.precision()))
}

/// First of the pixels that one is made of, and their weights.
type Tap = (usize, Vec<f32>);

/// Pixels and weights that each of `to` pixels is made of, out of `from`.
fn taps(from: usize, to: usize) -> Vec<Tap> {
    let scale = from as f64 / to as f64;
    let wide = scale.max(1.0);
    let tap = |at: usize| {
        let centre = (at as f64 + 0.5) * scale - 0.5;
        let first = (centre - REACH * wide).ceil().max(0.0) as usize;
        let last = ((centre + REACH * wide).floor() as usize).min(from - 1);
        let weights: Vec<f64> = (first..=last).map(|i| catmull_rom((i as f64 - centre) / wide)).collect();
        let sum: f64 = weights.iter().sum();
        (first, weights.into_iter().map(|weight| (weight / sum) as f32).collect())
    };
    (0..to).map(tap).collect()
}

/// Weight at a distance.
fn catmull_rom(x: f64) -> f64 {
    match x.abs() {
        x if x < 1.0 => (1.5 * x - 2.5) * x * x + 1.0,
        x if x < 2.0 => ((2.5 - 0.5 * x) * x - 4.0) * x + 2.0,
        _ => 0.0,
    }
}

/// A row of another width.
fn across<'a>(row: &'a [f32], taps: &'a [Tap], channels: usize) -> impl Iterator<Item = f32> + 'a {
    taps.iter().flat_map(move |(first, weights)| {
        (0..channels).map(move |channel| {
            let samples = row[first * channels + channel..].iter().step_by(channels);
            mixed(samples.zip(weights))
        })
    })
}

/// A row made of those that a tap names.
fn below(samples: &[f32], (first, weights): &Tap, row: usize) -> Vec<f32> {
    let at = |x: usize| mixed(samples[first * row + x..].iter().step_by(row).zip(weights));
    (0..row).map(at).collect()
}

/// Samples by their weights, within the least and the largest.
fn mixed<'a>(samples: impl Iterator<Item = (&'a f32, &'a f32)>) -> f32 {
    let (mut sum, mut least, mut most) = (0.0, f32::INFINITY, f32::NEG_INFINITY);
    for (sample, weight) in samples {
        sum += sample * weight;
        (least, most) = (least.min(*sample), most.max(*sample));
    }
    sum.max(least).min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_written_as_shares_widths_and_heights() {
        for (text, from, to) in [
            ("50%", (4000, 2669), (2000, 1335)),
            ("1920x", (3840, 2160), (1920, 1080)),
            ("x1080", (1000, 500), (2160, 1080)),
            ("0.1%", (10, 10), (1, 1)),
        ] {
            let resize: Resize = text.parse().unwrap();
            assert_eq!((resize.of(from), resize.to_string().as_str()), (Ok(to), text));
        }
        for bad in ["", "x", "%", "0x", "x0", "-5%", "0%", "1e9%", "1920", "1920x1080", "nan%"] {
            assert!(bad.parse::<Resize>().is_err(), "{bad}");
        }
        assert!(Resize::Share(10.0).of((20_000, 20_000)).is_err());
    }

    #[test]
    fn flat_areas_stay_and_borders_get_no_halos() {
        let half: Vec<u8> = (0..16 * 8).map(|i| if i % 16 < 8 { 40 } else { 200 }).collect();
        let picture = Pixels::new(16, 8, 1, Samples::U8(half)).unwrap();
        for size in [(8, 4), (7, 3), (31, 17), (1, 1)] {
            let Samples::U8(made) = resized(&picture, size, false).into_samples() else { panic!() };
            assert_eq!(made.len() as u32, size.0 * size.1);
            assert!(made.iter().all(|v| (40..=200).contains(v)), "{made:?}");
            if size.0 > 1 {
                assert_eq!((made[0], made[made.len() - 1]), (40, 200));
            }
        }
        let wide = Pixels::new(2, 1, 1, Samples::F32(vec![0.0, 8.0])).unwrap();
        let Samples::F32(made) = resized(&wide, (6, 1), false).into_samples() else { panic!() };
        assert!(made.iter().all(|v| (0.0..=8.0).contains(v)) && made[5] == 8.0, "{made:?}");
    }

    #[test]
    fn what_is_transparent_does_not_shine_through() {
        let pixels: Vec<u8> =
            (0..8).flat_map(|x| if x < 4 { [255, 0, 0, 255] } else { [0, 255, 0, 0] }).collect();
        let picture = Pixels::new(8, 1, 4, Samples::U8(pixels)).unwrap();
        let Samples::U8(made) = resized(&picture, (4, 1), false).into_samples() else { panic!() };
        assert_eq!((&made[..4], made[15]), (&[255, 0, 0, 255][..], 0));
        assert!(made.as_chunks::<4>().0.iter().all(|[_, green, ..]| *green == 0), "{made:?}");
    }
}
