//! Decoders that others wrote, of files that anybody wrote.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a decoder, whose panic is taken as damage of what it reads.
///
/// # Errors
/// The decoder's own, or a clause saying that it failed.
pub fn guarded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    // What the decoder made is dropped, so nothing half made is seen.
    catch_unwind(AssertUnwindSafe(decode))
        .unwrap_or_else(|_| Err("it is damaged in a way that its decoder fails at".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error() {
        assert_eq!(guarded(|| Ok(1)), Ok(1));
        let none: Vec<u8> = Vec::new();
        assert!(guarded(|| Ok(none[std::hint::black_box(3)])).is_err());
    }
}
