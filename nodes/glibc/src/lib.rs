//! Functions of the GNU C library that are newer than the oldest system that is promised: Rocky Linux 9, on which studios
//! work.
//!
//! Linkers take the newest version of a function that they find, and programs then start nowhere else. The standard library
//! and others call two functions of which there is a version of 2022; ours have their names within the binary that [`KEPT`]
//! is part of, and nowhere outside.

#![cfg(all(target_os = "linux", target_env = "gnu"))]
// Symbols must have the C library's names.
#![allow(unsafe_code)]

use std::arch::global_asm;

/// Has the linker take these functions: a binary says `#[used] static OWN: isophote_glibc::Kept = isophote_glibc::KEPT;`.
pub const KEPT: Kept = (hypot, hypotf);

/// Both functions.
pub type Kept = (extern "C" fn(f64, f64) -> f64, extern "C" fn(f32, f32) -> f32);

#[cfg(target_arch = "x86_64")]
macro_rules! jump {
    () => {
        "jmp {}"
    };
}
#[cfg(target_arch = "aarch64")]
macro_rules! jump {
    () => {
        "b {}"
    };
}

// Hidden: what else is in the process keeps its own.
// SAFETY: each symbol is a jump to a function with the signature and the meaning that C demands of its name.
global_asm!(".globl hypot", ".hidden hypot", ".type hypot, @function", "hypot:", jump!(), sym hypot);
// SAFETY: as above.
global_asm!(".globl hypotf", ".hidden hypotf", ".type hypotf, @function", "hypotf:", jump!(), sym hypotf);

/// sqrt(x^2 + y^2), without overflow or underflow on the way; infinite if one of them is.
extern "C" fn hypot(x: f64, y: f64) -> f64 {
    let [x, y] = [x.abs(), y.abs()];
    if x.is_infinite() || y.is_infinite() {
        return f64::INFINITY;
    }
    let (low, high) = if x < y { (x, y) } else { (y, x) };
    if high == 0.0 {
        return high + low;
    }
    // A power of two scales exactly.
    let exponent = (high.to_bits() >> 52).clamp(1, 2045);
    let [scale, back] = [f64::from_bits((2046 - exponent) << 52), f64::from_bits(exponent << 52)];
    let [low, high] = [low * scale, high * scale];
    (low * low + high * high).sqrt() * back
}

/// The same in single precision.
extern "C" fn hypotf(x: f32, y: f32) -> f32 {
    let [x, y] = [f64::from(x), f64::from(y)];
    if x.is_infinite() || y.is_infinite() {
        return f32::INFINITY;
    }
    // Squares of all of them are finite, and differ from zero.
    (x * x + y * y).sqrt() as f32
}

#[cfg(test)]
mod tests {
    use super::{hypot, hypotf};

    #[test]
    fn results_are_right_to_the_last_bits() {
        let pairs = [
            (3.0, 4.0),
            (-5.0, 12.0),
            (0.0, -2.0),
            (1e300, 1e300),
            (1e-310, 2e-310),
            (1e-3, 7e5),
            (0.0, 0.0),
        ];
        for (x, y) in pairs {
            let (wanted, found) = (by_another_way(x, y), hypot(x, y));
            // The smallest numbers have few bits.
            let bound = 2.0 * f64::EPSILON * wanted + f64::from_bits(1);
            assert!((found - wanted).abs() <= bound, "{x} {y}: {found} {wanted}");
            // The same where single precision has such numbers.
            let [x, y] = [x as f32, y as f32];
            if x.is_finite() && y.is_finite() {
                let (wanted, found) = (by_another_way(x.into(), y.into()) as f32, hypotf(x, y));
                assert!((found - wanted).abs() <= f32::EPSILON * wanted, "{x} {y}: {found} {wanted}");
            }
        }
    }

    /// The larger side times a root near one.
    fn by_another_way(x: f64, y: f64) -> f64 {
        let (low, high) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
        if high == 0.0 { 0.0 } else { high * (1.0 + (low / high).powi(2)).sqrt() }
    }

    #[test]
    fn what_is_no_number_is_as_c_has_it() {
        assert_eq!(hypot(f64::NAN, f64::NEG_INFINITY), f64::INFINITY);
        assert_eq!(hypotf(f32::INFINITY, f32::NAN), f32::INFINITY);
        assert!(
            hypot(f64::NAN, 1.0).is_nan() && hypot(0.0, f64::NAN).is_nan() && hypotf(1.0, f32::NAN).is_nan()
        );
    }
}
