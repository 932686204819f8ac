//! Histograms: how often each value occurs in a picture as it is shown.

/// Values that are told apart.
pub const BINS: usize = 128;

/// Counts of one picture's pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Brightness, red, green and blue; each from the darkest value to the lightest.
    pub channels: [[u32; BINS]; 4],
    /// Pixels that were counted: those that cover more than half of what is behind them.
    pub pixels: u32,
    /// Pixels that have a channel at the lower end of the scale, and at the upper end.
    pub clipped: [u32; 2],
}

/// Histograms of what is shown and of what it was made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Histograms {
    /// The picture that is shown.
    pub shown: Histogram,
    /// The picture as it was.
    pub original: Histogram,
}

impl Histogram {
    /// Counts pixels: red, green, blue and alpha as a screen shows them.
    pub fn of<'p>(pixels: impl Iterator<Item = &'p [u8; 4]>) -> Self {
        let mut counted = Self { channels: [[0; BINS]; 4], pixels: 0, clipped: [0; 2] };
        for [red, green, blue, alpha] in pixels {
            if *alpha < 128 {
                continue;
            }
            let colour = [*red, *green, *blue];
            // Parts of 256 that each colour has of what is seen as bright.
            let weights = [54, 183, 19];
            let bright: u32 =
                colour.iter().zip(weights).map(|(value, weight)| u32::from(*value) * weight).sum();
            let values = [(bright >> 8) as u8, *red, *green, *blue];
            for (channel, value) in counted.channels.iter_mut().zip(values) {
                channel[usize::from(value) * BINS / 256] += 1;
            }
            counted.pixels += 1;
            counted.clipped[0] += u32::from(colour.contains(&0));
            counted.clipped[1] += u32::from(colour.contains(&255));
        }
        counted
    }

    /// Shares of the pixels that are clipped at the lower end of the scale, and at the upper end.
    pub fn clipped_shares(&self) -> [f32; 2] {
        self.clipped.map(|count| count as f32 / self.pixels.max(1) as f32)
    }

    /// The greatest count of a value between the ends of the scale, where single values often are so many that all others would
    /// lie flat.
    pub fn most(&self) -> u32 {
        let inner = self.channels.iter().flat_map(|channel| &channel[1..BINS - 1]);
        inner.copied().max().unwrap_or_default().max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_counted_by_channel_and_clipped_ones_by_themselves() {
        let pixels = [[0, 0, 0, 255], [255, 128, 10, 255], [10, 20, 30, 255], [255, 255, 255, 0]];
        let counted = Histogram::of(pixels.iter());
        assert_eq!((counted.pixels, counted.clipped), (3, [1, 1]), "what is not there does not count");
        assert_eq!((counted.channels[1][0], counted.channels[1][127], counted.channels[2][64]), (1, 1, 1));
        assert_eq!(counted.channels[0].iter().sum::<u32>(), 3);
        assert_eq!(counted.channels[0][255 * BINS / 256], 0);
        assert!((counted.clipped_shares()[0] - 1.0 / 3.0).abs() < 1e-6);
        let none = Histogram::of([].iter());
        assert_eq!((none.clipped_shares(), none.most()), ([0.0; 2], 1));
    }
}
