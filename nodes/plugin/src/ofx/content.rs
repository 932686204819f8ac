//! Numbers of contents: two images have the same one where all their values are the same, bit for bit.

use isophote::engine::Image;
use isophote::engine::cpu::Threads;
use std::sync::{Mutex, PoisonError};

/// Odd numbers without a pattern, after the fractions of square roots of primes.
const KEYS: [u64; 4] =
    [0x6a09_e667_f3bc_c909, 0xbb67_ae85_84ca_a73b, 0x3c6e_f372_fe94_f82b, 0xa54f_f53a_5f1d_36f1];
/// Values that one job reads.
const VALUES: usize = 1 << 18;

/// Both halves of a product, folded into one.
fn folded(a: u64, b: u64) -> u64 {
    // It fits; a check that it does would take several times as long.
    let product = u128::from(a).wrapping_mul(u128::from(b));
    product as u64 ^ (product >> 64) as u64
}

/// Two sums with a word taken in.
fn mixed([a, b]: [u64; 2], [first, second]: [u64; 2]) -> [u64; 2] {
    [folded(a ^ first, KEYS[2] ^ second), folded(b ^ second.rotate_left(29), KEYS[3] ^ first)]
}

/// 128 bits of a row of words.
pub fn of_words(words: impl IntoIterator<Item = [u64; 2]>) -> u128 {
    let (mut a, mut b, mut count) = (KEYS[0], KEYS[1], 0_u64);
    for word in words {
        [a, b] = mixed([a, b], word);
        count += 1;
    }
    let (a, b) = (folded(a ^ count, KEYS[3]), folded(b ^ count, KEYS[2]));
    u128::from(folded(a ^ b.rotate_left(32), KEYS[0])) << 64 | u128::from(folded(b ^ a, KEYS[1]))
}

/// 128 bits of a text.
pub fn of_text(text: &str) -> u128 {
    let word = |bytes: &[u8]| bytes.iter().fold(0, |word, byte| word << 8 | u64::from(*byte));
    of_words(text.as_bytes().chunks(8).map(|bytes| [word(bytes), bytes.len() as u64]))
}

/// 128 bits of bytes.
pub fn of_bytes(bytes: &[u8]) -> u128 {
    let pair = |word: &[u8; 16]| {
        let word = u128::from_le_bytes(*word);
        [word as u64, (word >> 64) as u64]
    };
    // Four rows of words side by side: each product waits for the one before it in its row.
    let (fours, rest) = bytes.as_chunks::<64>();
    let mut sums = [[KEYS[0], KEYS[1]]; 4];
    for four in fours {
        for (sum, word) in sums.iter_mut().zip(four.as_chunks::<16>().0) {
            *sum = mixed(*sum, pair(word));
        }
    }
    let (words, rest) = rest.as_chunks::<16>();
    let mut last = [0; 16];
    last[..rest.len()].copy_from_slice(rest);
    let rest = words.iter().chain([&last]).map(pair);
    of_words(sums.into_iter().chain(rest).chain([[bytes.len() as u64, 0]]))
}

/// 128 bits of several such.
pub fn of_all(numbers: &[u128]) -> u128 {
    of_words(numbers.iter().map(|number| [*number as u64, (number >> 64) as u64]))
}

/// 128 bits of what an image holds, and where.
pub fn of_image(image: &Image, threads: &dyn Threads) -> u128 {
    let parts: Vec<(&[f32], Mutex<u128>)> =
        image.data().chunks(VALUES).map(|part| (part, Mutex::new(0))).collect();
    threads.run(parts.len(), &|index| {
        let (values, place) = &parts[index];
        let (fours, rest) = values.as_chunks::<4>();
        let pair = |a: f32, b: f32| u64::from(a.to_bits()) | u64::from(b.to_bits()) << 32;
        let words = fours.iter().map(|[a, b, c, d]| [pair(*a, *b), pair(*c, *d)]);
        let number = of_words(words.chain(rest.iter().map(|v| [u64::from(v.to_bits()), 0])));
        *place.lock().unwrap_or_else(PoisonError::into_inner) = number;
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
