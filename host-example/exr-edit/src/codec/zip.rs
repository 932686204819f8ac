//! ZIP: bytes of even and odd places apart, differences of neighbours, deflate.
//!
//! It is done here with zlib's fast levels: it is what nearly all frames of a farm use, and the writing of large frames
//! must keep up with filtering.

use std::io::{Read, Write};

use flate2::bufread::ZlibDecoder;
use flate2::write::ZlibEncoder;

/// Effort, 1 to 9. OpenEXR itself takes 4.
const LEVEL: u32 = 4;

/// Undoes ZIP: deflate, then differences of neighbours, then even and odd bytes apart.
pub fn unzip(data: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut packed = Vec::with_capacity(size);
    ZlibDecoder::new(data).take(size as u64 + 1).read_to_end(&mut packed).ok()?;
    if packed.len() != size {
        return None;
    }
    let mut last = packed.first().copied().unwrap_or(0);
    for byte in packed.iter_mut().skip(1) {
        last = last.wrapping_add(*byte).wrapping_sub(128);
        *byte = last;
    }
    let mut raw = vec![0; size];
    let (even, odd) = packed.split_at(size.div_ceil(2));
    for (pair, (a, b)) in raw.chunks_exact_mut(2).zip(even.iter().zip(odd)) {
        pair[0] = *a;
        pair[1] = *b;
    }
    if size % 2 == 1 {
        raw[size - 1] = *even.last()?;
    }
    Some(raw)
}

/// Compresses.
pub fn zip(raw: &[u8]) -> Vec<u8> {
    let mut packed = vec![0; raw.len()];
    let (even, odd) = packed.split_at_mut(raw.len().div_ceil(2));
    for (pair, (a, b)) in raw.chunks_exact(2).zip(even.iter_mut().zip(odd)) {
        *a = pair[0];
        *b = pair[1];
    }
    if raw.len() % 2 == 1
        && let (Some(last), Some(end)) = (raw.last(), even.last_mut())
    {
        *end = *last;
    }
    let mut last = packed.first().copied().unwrap_or(0);
    for byte in packed.iter_mut().skip(1) {
        let value = *byte;
        *byte = value.wrapping_sub(last).wrapping_add(128);
        last = value;
    }
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(raw.len() / 2), flate2::Compression::new(LEVEL));
    // Memory takes everything that is written to it.
    let written = encoder.write_all(&packed).and_then(|()| encoder.finish());
    written.unwrap_or_else(|_| raw.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zip_is_undone() {
        for length in [0usize, 1, 2, 3, 1000, 1001] {
            let raw: Vec<u8> = (0..length).map(|i| (i * i / 7) as u8).collect();
            assert_eq!(unzip(&zip(&raw), length), Some(raw));
        }
        assert_eq!(unzip(b"nonsense", 12), None);
    }
}
