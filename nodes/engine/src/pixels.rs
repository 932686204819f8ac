//! Pixel formats in and out: rows of u8, u16, f16 or f32 samples, converted to and from f32.
//!
//! Integers map 0..=max to 0..=1, rounding half up and clamping on the way out. Floats pass
//! unclamped. On entry NaN becomes 0 and infinities the largest half, each counted: bad pixels
//! must not spread through a filter.

use half::f16;

/// Type in which one sample is stored, in the machine's byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// 8-bit unsigned, 255 = 1.
    U8,
    /// 16-bit unsigned, 65535 = 1.
    U16,
    /// IEEE half.
    F16,
    /// IEEE single.
    F32,
}

impl Sample {
    /// Size in bytes.
    pub const fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }
}

/// The largest finite half: what infinities become.
pub const LARGEST_HALF: f32 = 65504.0;

/// One value made fit to be filtered; counts it in `replaced` when it was not.
#[inline]
pub fn sanitized(value: f32, replaced: &mut u64) -> f32 {
    if value.is_finite() {
        return value;
    }
    *replaced += 1;
    if value.is_nan() { 0.0 } else { LARGEST_HALF.copysign(value) }
}

/// Reads one row of pixels.
///
/// `bytes` holds `width` pixels of `channels` samples (1, 3 or 4); `row` receives `width` pixels of
/// `out_channels` values: missing colour channels repeat grey, missing alpha is 1, surplus channels
/// are dropped. Returns how many samples were NaN or infinite. Pixels beyond the shorter of the two
/// slices are left alone.
pub fn read_row(bytes: &[u8], sample: Sample, channels: usize, row: &mut [f32], out_channels: usize) -> u64 {
    if is_copy(sample, channels, out_channels) {
        return read_floats(bytes, row);
    }
    let mut replaced = 0;
    let size = sample.size();
    let pixels = bytes.chunks_exact(size * channels).zip(row.chunks_exact_mut(out_channels));
    for (source, pixel) in pixels {
        for (c, value) in pixel.iter_mut().enumerate() {
            let from = if c < channels && !(channels == 2 && c == 1) {
                c
            } else if c < 3 && channels < 3 {
                0
            } else if c == 3 && channels == 2 {
                1
            } else {
                *value = 1.0;
                continue;
            };
            *value = sanitized(read_sample(&source[from * size..], sample), &mut replaced);
        }
    }
    replaced
}

/// True where samples are values as they are, pixel by pixel.
fn is_copy(sample: Sample, channels: usize, values: usize) -> bool {
    sample == Sample::F32 && channels == values && channels != 2
}

/// [`read_row`] of samples that are values as they are.
fn read_floats(bytes: &[u8], row: &mut [f32]) -> u64 {
    let count = row.len().min(bytes.len() / 4);
    let row = &mut row[..count];
    // Branches would keep the compiler from taking several at a time: there are hardly ever any to be replaced.
    let mut found = 0u32;
    for (value, bytes) in row.iter_mut().zip(bytes.as_chunks::<4>().0) {
        *value = f32::from_ne_bytes(*bytes);
        found += u32::from(!value.is_finite());
    }
    let mut replaced = 0;
    if found > 0 {
        row.iter_mut().for_each(|value| *value = sanitized(*value, &mut replaced));
    }
    replaced
}

/// Decodes one row of vectors of `channels` samples to the first `out_channels` of each, which are no fewer; those of
/// vectors that are not finite are `unknown`.
pub fn read_vectors(
    bytes: &[u8],
    sample: Sample,
    channels: usize,
    row: &mut [f32],
    out_channels: usize,
    unknown: f32,
) {
    let size = sample.size();
    let vectors = bytes.chunks_exact(size * channels).zip(row.chunks_exact_mut(out_channels));
    for (source, vector) in vectors {
        for (value, bytes) in vector.iter_mut().zip(source.chunks_exact(size)) {
            *value = read_sample(bytes, sample);
        }
        if !vector.iter().all(|v| v.is_finite()) {
            vector.fill(unknown);
        }
    }
}

/// Writes one row of pixels, the reverse of [`read_row`]: alpha is added as 1 or dropped, and a grey
/// target takes the first channel.
pub fn write_row(row: &[f32], in_channels: usize, bytes: &mut [u8], sample: Sample, channels: usize) {
    if is_copy(sample, channels, in_channels) {
        for (value, target) in row.iter().zip(bytes.as_chunks_mut::<4>().0) {
            *target = value.to_ne_bytes();
        }
        return;
    }
    let size = sample.size();
    let pixels = row.chunks_exact(in_channels).zip(bytes.chunks_exact_mut(size * channels));
    for (pixel, target) in pixels {
        for (c, target) in target.chunks_exact_mut(size).enumerate() {
            let value = match (in_channels, c) {
                (1, 0..=2) => pixel[0],
                (_, c) if channels == 2 && c == 1 => pixel.get(3).copied().unwrap_or(1.0),
                (_, c) => pixel.get(c).copied().unwrap_or(1.0),
            };
            write_sample(value, target, sample);
        }
    }
}

fn read_sample(bytes: &[u8], sample: Sample) -> f32 {
    match sample {
        Sample::U8 => f32::from(bytes[0]) / 255.0,
        Sample::U16 => f32::from(u16::from_ne_bytes([bytes[0], bytes[1]])) / 65535.0,
        Sample::F16 => f16::from_ne_bytes([bytes[0], bytes[1]]).to_f32(),
        Sample::F32 => f32::from_ne_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}

fn write_sample(value: f32, target: &mut [u8], sample: Sample) {
    match sample {
        Sample::U8 => target[0] = quantized(value, 255.0) as u8,
        Sample::U16 => target.copy_from_slice(&(quantized(value, 65535.0) as u16).to_ne_bytes()),
        // Beyond the range of half a finite value must not become an infinity.
        Sample::F16 => {
            let value = if value.is_finite() { value.clamp(-LARGEST_HALF, LARGEST_HALF) } else { value };
            target.copy_from_slice(&f16::from_f32(value).to_ne_bytes());
        }
        Sample::F32 => target.copy_from_slice(&value.to_ne_bytes()),
    }
}

/// Round half up, clamped to 0..=max; NaN gives 0.
fn quantized(value: f32, max: f32) -> u32 {
    (value.clamp(0.0, 1.0) * max + 0.5) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_survive_a_round_trip() {
        let bytes: Vec<u8> = (0..=255).collect();
        let mut row = vec![0.0; 256];
        assert_eq!(read_row(&bytes, Sample::U8, 4, &mut row, 4), 0);
        let mut back = vec![0; 256];
        write_row(&row, 4, &mut back, Sample::U8, 4);
        assert_eq!(back, bytes);
    }

    #[test]
    fn channels_are_added_and_dropped() {
        let mut row = [0.0; 4];
        read_row(&[255, 0, 51], Sample::U8, 3, &mut row, 4);
        assert_eq!(row, [1.0, 0.0, 0.2, 1.0]);
        read_row(&[51], Sample::U8, 1, &mut row, 4);
        assert_eq!(row, [0.2, 0.2, 0.2, 1.0]);
        let mut rgb = [0; 3];
        write_row(&[0.5], 1, &mut rgb, Sample::U8, 3);
        assert_eq!(rgb, [128, 128, 128]);
    }

    #[test]
    fn bad_values_are_replaced_and_counted() {
        let values = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0];
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
        let mut row = [9.0; 4];
        assert_eq!(read_row(&bytes, Sample::F32, 4, &mut row, 4), 3);
        assert_eq!(row, [0.0, LARGEST_HALF, -LARGEST_HALF, -3.0]);
        let mut grey = [9.0; 5];
        assert_eq!(read_row(&bytes, Sample::F32, 1, &mut grey, 1), 3);
        assert_eq!(grey, [0.0, LARGEST_HALF, -LARGEST_HALF, -3.0, 9.0]);
    }

    #[test]
    fn floats_are_copied() {
        let row = [0.25, -7.0, 1e30, f32::MIN_POSITIVE, 0.5, 0.75, 1.0, 2.0];
        let (mut bytes, mut back) = ([0; 32], [0.0; 8]);
        write_row(&row, 4, &mut bytes, Sample::F32, 4);
        assert_eq!(read_row(&bytes, Sample::F32, 4, &mut back, 4), 0);
        assert_eq!(back, row);
    }

    #[test]
    fn halves_saturate_instead_of_overflowing() {
        let mut bytes = [0; 2];
        write_row(&[1e6], 1, &mut bytes, Sample::F16, 1);
        assert_eq!(f16::from_ne_bytes(bytes).to_f32(), LARGEST_HALF);
    }
}
