//! Numbers of contents, 128 bits of XXH3: two images have the same one where all their values are the same, bit for bit.

use isophote::engine::Image;
use isophote::engine::cpu::Threads;
use std::sync::{Mutex, PoisonError};
use twox_hash::XxHash3_128;

/// Values that one job reads.
const VALUES: usize = 1 << 18;

/// 128 bits of bytes.
pub fn of_bytes(bytes: &[u8]) -> u128 {
    XxHash3_128::oneshot(bytes)
}

/// 128 bits of a text.
pub fn of_text(text: &str) -> u128 {
    of_bytes(text.as_bytes())
}

/// 128 bits of several such.
pub fn of_all(numbers: &[u128]) -> u128 {
    of_bytes(bytemuck::cast_slice(numbers))
}

/// 128 bits of what an image holds, and where.
pub fn of_image(image: &Image, threads: &dyn Threads) -> u128 {
    let parts: Vec<(&[f32], Mutex<u128>)> =
        image.data().chunks(VALUES).map(|part| (part, Mutex::new(0))).collect();
    threads.run(parts.len(), &|index| {
        let (values, place) = &parts[index];
        *place.lock().unwrap_or_else(PoisonError::into_inner) = of_bytes(bytemuck::cast_slice(values));
    });
    let window = image.window();
    let mut all = vec![of_text(&format!("{window:?} {}", image.channels()))];
    all.extend(
        parts.into_iter().map(|(_, number)| number.into_inner().unwrap_or_else(PoisonError::into_inner)),
    );
    of_all(&all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::engine::cpu::CallingThread;
    use std::collections::HashSet;

    #[test]
    fn every_bit_and_place_counts() {
        let mut image = Image::new(37, 29, 3).unwrap();
        let mut seen = HashSet::new();
        assert!(seen.insert(of_image(&image, &CallingThread)));
        for at in 0..image.data().len() {
            for value in [1.0, -0.0, f32::from_bits(1)] {
                image.data_mut()[at] = value;
                assert!(seen.insert(of_image(&image, &CallingThread)), "{value} at {at}");
            }
            image.data_mut()[at] = 0.0;
        }
        assert!(!seen.insert(of_image(&image, &CallingThread)));
        assert!(seen.insert(of_image(&Image::new(29, 37, 3).unwrap(), &CallingThread)));
        for len in 1..200 {
            assert!(seen.insert(of_bytes(&vec![0; len])) && seen.insert(of_bytes(&vec![1; len])));
        }
        assert!(seen.insert(of_text("a")) && seen.insert(of_text("a\0")) && seen.insert(of_text("")));
    }
}
