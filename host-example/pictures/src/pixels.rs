//! Pixels in main memory as files hold them: 8 or 16-bit integers, half or single floats.

use half::f16;
use isophote_loader::{AsImage, AsTarget, Image, Target};

/// Precision of samples.
pub use isophote_loader::Sample as Precision;

/// Most pixels of one picture, so that sizes in files and on the command line cannot ask for all memory.
pub const MOST_PIXELS: u64 = 1 << 28;

/// Samples of one precision.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// 255 is 1.
    U8(Vec<u8>),
    /// 65535 is 1.
    U16(Vec<u16>),
    /// IEEE half.
    F16(Vec<f16>),
    /// IEEE single.
    F32(Vec<f32>),
}

/// An image: interleaved channels, rows from the top. Always holds as many samples as its size says.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    width: u32,
    height: u32,
    channels: u32,
    samples: Samples,
}

impl Pixels {
    /// An image of the given samples, or nothing when their number does not fit.
    pub fn new(width: u32, height: u32, channels: u32, samples: Samples) -> Option<Self> {
        let needed = u128::from(width) * u128::from(height) * u128::from(channels);
        (samples.len() as u128 == needed).then_some(Self { width, height, channels, samples })
    }

    /// A black image.
    pub fn zeroed(width: u32, height: u32, channels: u32, precision: Precision) -> Self {
        let length = width as usize * height as usize * channels as usize;
        let samples = match precision {
            Precision::U8 => Samples::U8(vec![0; length]),
            Precision::U16 => Samples::U16(vec![0; length]),
            Precision::F16 => Samples::F16(vec![f16::ZERO; length]),
            Precision::F32 => Samples::F32(vec![0.0; length]),
        };
        Self { width, height, channels, samples }
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Samples a pixel.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// The samples.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// The samples alone.
    pub fn into_samples(self) -> Samples {
        self.samples
    }

    /// Precision in which samples are stored.
    pub fn precision(&self) -> Precision {
        match self.samples {
            Samples::U8(_) => Precision::U8,
            Samples::U16(_) => Precision::U16,
            Samples::F16(_) => Precision::F16,
            Samples::F32(_) => Precision::F32,
        }
    }

    /// The samples' memory.
    pub fn bytes(&self) -> &[u8] {
        match &self.samples {
            Samples::U8(v) => v,
            Samples::U16(v) => bytemuck::cast_slice(v),
            Samples::F16(v) => bytemuck::cast_slice(v),
            Samples::F32(v) => bytemuck::cast_slice(v),
        }
    }

    /// The samples' memory, to be written.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        match &mut self.samples {
            Samples::U8(v) => v,
            Samples::U16(v) => bytemuck::cast_slice_mut(v),
            Samples::F16(v) => bytemuck::cast_slice_mut(v),
            Samples::F32(v) => bytemuck::cast_slice_mut(v),
        }
    }

    /// The samples as numbers, integers from 0 to 1.
    pub fn to_f32(&self) -> Vec<f32> {
        match &self.samples {
            Samples::U8(v) => v.iter().map(|s| f32::from(*s) / 255.0).collect(),
            Samples::U16(v) => v.iter().map(|s| f32::from(*s) / 65535.0).collect(),
            Samples::F16(v) => v.iter().map(|s| s.to_f32()).collect(),
            Samples::F32(v) => v.clone(),
        }
    }

    /// As another precision: integers hold 0 to 1, rounded to the nearest.
    pub fn converted(self, precision: Precision) -> Self {
        if self.precision() == precision {
            return self;
        }
        let numbers = self.to_f32();
        let samples = match precision {
            Precision::U8 => {
                Samples::U8(numbers.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8).collect())
            }
            Precision::U16 => {
                Samples::U16(numbers.iter().map(|v| (v.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16).collect())
            }
            Precision::F16 => Samples::F16(numbers.iter().map(|v| f16::from_f32(*v)).collect()),
            Precision::F32 => Samples::F32(numbers),
        };
        Self { samples, ..self }
    }
}

/// Reason why an image of the library can always be made of [`Pixels`].
const FITS: &str = "pixels hold as many samples as their size says";

impl AsImage for Pixels {
    fn image(&self) -> Image<'_> {
        let size = (self.width, self.height);
        Image::new(self.bytes(), size, self.channels, self.precision()).expect(FITS)
    }
}

impl AsTarget for Pixels {
    fn target(&mut self) -> Target<'_> {
        let (size, channels, precision) = ((self.width, self.height), self.channels, self.precision());
        Target::new(self.bytes_mut(), size, channels, precision).expect(FITS)
    }
}

impl Samples {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::F16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// True where there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_samples_are_checked() {
        assert!(Pixels::new(2, 2, 3, Samples::U8(vec![0; 12])).is_some());
        assert!(Pixels::new(2, 2, 3, Samples::U8(vec![0; 11])).is_none());
        assert!(Pixels::new(u32::MAX, u32::MAX, u32::MAX, Samples::U8(vec![])).is_none());
    }

    #[test]
    fn integers_survive_the_way_through_floats() {
        let all = Pixels::new(256, 1, 1, Samples::U8((0..=255).collect())).unwrap();
        for precision in [Precision::U16, Precision::F16, Precision::F32] {
            assert_eq!(all.clone().converted(precision).converted(Precision::U8), all);
        }
        let out = Pixels::new(3, 1, 1, Samples::F32(vec![-1.0, f32::NAN, 7.0])).unwrap();
        assert_eq!(out.converted(Precision::U8).samples(), &Samples::U8(vec![0, 0, 255]));
    }
}
