//! Images in main memory, as functions of the library take them.

use std::marker::PhantomData;

use isophote_abi::{
    ISOPHOTE_SAMPLE_F16, ISOPHOTE_SAMPLE_F32, ISOPHOTE_SAMPLE_U8, ISOPHOTE_SAMPLE_U16, IsophoteImage,
    IsophoteSample, IsophoteTarget,
};

/// Type of an image's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// 8-bit integers; 255 is 1.
    U8,
    /// 16-bit integers; 65535 is 1.
    U16,
    /// Half floats.
    F16,
    /// Single floats.
    F32,
}

impl Sample {
    /// Bytes of one sample.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }

    /// Its number in the contract.
    pub const fn number(self) -> IsophoteSample {
        match self {
            Self::U8 => ISOPHOTE_SAMPLE_U8,
            Self::U16 => ISOPHOTE_SAMPLE_U16,
            Self::F16 => ISOPHOTE_SAMPLE_F16,
            Self::F32 => ISOPHOTE_SAMPLE_F32,
        }
    }
}

/// Image that is read: interleaved samples, rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    pub(crate) raw: IsophoteImage,
    memory: PhantomData<&'a [u8]>,
}

impl<'a> Image<'a> {
    /// An image whose rows follow each other without gaps; none where `bytes` are not exactly those of its size.
    pub fn new(bytes: &'a [u8], size: (u32, u32), channels: u32, sample: Sample) -> Option<Self> {
        let row_stride = row_stride(bytes.len(), size, channels, sample)?;
        let raw = IsophoteImage {
            data: bytes.as_ptr().cast(),
            row_stride,
            sample: sample.number(),
            channels,
            width: size.0,
            height: size.1,
            x: 0,
            y: 0,
        };
        Some(Self { raw, memory: PhantomData })
    }

    /// An image as the contract describes it.
    ///
    /// # Safety
    /// The memory that it names may be read for `'a`.
    pub const unsafe fn from_raw(raw: IsophoteImage) -> Self {
        Self { raw, memory: PhantomData }
    }
}

/// Image that is written: interleaved samples, rows from the top.
#[derive(Debug)]
pub struct Target<'a> {
    pub(crate) raw: IsophoteTarget,
    memory: PhantomData<&'a mut [u8]>,
}

impl<'a> Target<'a> {
    /// As [`Image::new`].
    pub fn new(bytes: &'a mut [u8], size: (u32, u32), channels: u32, sample: Sample) -> Option<Self> {
        let IsophoteImage { row_stride, sample, channels, width, height, x, y, .. } =
            Image::new(bytes, size, channels, sample)?.raw;
        let data = bytes.as_mut_ptr().cast();
        let raw = IsophoteTarget { data, row_stride, sample, channels, width, height, x, y };
        Some(Self { raw, memory: PhantomData })
    }

    /// An image as the contract describes it.
    ///
    /// # Safety
    /// The memory that it names may be written for `'a`, and nobody relies on its contents meanwhile. Every pattern of bits
    /// is a sample.
    pub const unsafe fn from_raw(raw: IsophoteTarget) -> Self {
        Self { raw, memory: PhantomData }
    }
}

/// Bytes of a row, where `length` bytes are those of the whole image.
fn row_stride(length: usize, (width, height): (u32, u32), channels: u32, sample: Sample) -> Option<isize> {
    let row = u128::from(width) * u128::from(channels) * sample.bytes() as u128;
    (row * u128::from(height) == length as u128).then(|| isize::try_from(row).ok()).flatten()
}

/// Pixels of a host that the library can read.
pub trait AsImage {
    /// Image in which they are.
    fn image(&self) -> Image<'_>;
}

/// Pixels of a host that the library can write.
pub trait AsTarget {
    /// Image in which they are.
    fn target(&mut self) -> Target<'_>;
}

impl<T: AsImage + ?Sized> AsImage for &T {
    fn image(&self) -> Image<'_> {
        (**self).image()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_have_exactly_the_bytes_of_their_size() {
        let mut bytes = [0; 24];
        let image = Image::new(&bytes, (2, 1), 3, Sample::F32).unwrap();
        assert_eq!((image.raw.row_stride, image.raw.sample), (24, ISOPHOTE_SAMPLE_F32));
        assert!(Image::new(&bytes, (2, 2), 3, Sample::U16).is_some());
        for (size, channels) in [((2, 2), 3), ((1, 1), 3), ((0, 0), 0), ((u32::MAX, u32::MAX), u32::MAX)] {
            assert!(Image::new(&bytes, size, channels, Sample::F32).is_none(), "{size:?}");
            assert!(Target::new(&mut bytes, size, channels, Sample::F32).is_none(), "{size:?}");
        }
    }
}
