//! The brush: the number that it paints, its size and its hardness.

use super::channel::Channel;

/// A round brush.
#[derive(Clone, Debug, PartialEq)]
pub struct Brush {
    /// Number that it paints.
    pub channel: Channel,
    /// Strength in each channel, -1 for the least, 0 for no change, 1 for the most; of the mask -1 takes the look away.
    pub strengths: [f32; Channel::ALL.len()],
    /// Diameter in pixels of the picture.
    pub size: f32,
    /// Share of its radius that is painted in full, 0..=1.
    pub hardness: f32,
    /// True where it takes back what was painted.
    pub erases: bool,
}

/// Least and greatest diameter in pixels of the picture.
pub const SIZES: [f32; 2] = [1.0, 2000.0];

impl Default for Brush {
    fn default() -> Self {
        let strengths = [0.5, 0.5, 0.5, 0.5, -1.0];
        Self { channel: Channel::Detail, strengths, size: 100.0, hardness: 0.5, erases: false }
    }
}

impl Brush {
    /// The strength with which it paints its channel.
    pub fn strength(&self) -> f32 {
        self.strengths[self.channel as usize]
    }

    /// The number that it leaves where it paints in full.
    pub fn value(&self) -> u8 {
        if self.erases { self.channel.plain() } else { self.channel.painted(self.strength()) }
    }

    /// A size by so many steps larger, or smaller.
    pub fn grow(&mut self, steps: f32) {
        self.size = (self.size * 1.2_f32.powf(steps)).clamp(SIZES[0], SIZES[1]);
    }

    /// The share of what it paints at a distance from the middle of a stroke, in pixels: 1 within, 0 outside, over one pixel
    /// at least.
    pub fn share(&self, distance: f32) -> f32 {
        let radius = self.size * 0.5 + 0.5;
        let soft = (radius * (1.0 - self.hardness)).max(1.0);
        let within = ((radius - distance) / soft).clamp(0.0, 1.0);
        within * within * (3.0 - 2.0 * within)
    }
}

#[cfg(test)]
mod tests {
    use super::super::channel::MOST;
    use super::*;

    #[test]
    fn strengths_are_bytes_whose_half_changes_nothing() {
        let mut brush = Brush::default();
        for (strength, byte) in [(-1.0, 0), (0.0, 127), (1.0, MOST), (7.0, MOST)] {
            brush.strengths[0] = strength;
            assert_eq!(brush.value(), byte);
        }
        brush.channel = Channel::Mask;
        assert_eq!(brush.value(), 0);
        brush.erases = true;
        assert_eq!(brush.value(), 255);
        assert_eq!(
            [0.5, 127.0 / 255.0, 128.0 / 255.0, 1.0].map(|v| Channel::Detail.stored(v)),
            [127, 127, 127, MOST]
        );
    }

    #[test]
    fn hard_brushes_end_within_a_pixel_and_soft_ones_fall_off() {
        let mut brush = Brush { size: 40.0, hardness: 1.0, ..Brush::default() };
        assert_eq!([0.0, 19.5, 20.5].map(|distance| brush.share(distance)), [1.0, 1.0, 0.0]);
        brush.hardness = 0.0;
        assert!(brush.share(0.0) == 1.0 && brush.share(10.0) > 0.4 && brush.share(10.0) < 0.6);
        let mut last = 1.0;
        for distance in 0..22 {
            let share = brush.share(distance as f32);
            assert!(share <= last);
            last = share;
        }
        brush.grow(100.0);
        assert_eq!(brush.size, SIZES[1]);
    }
}
