//! Memory that may be refused: images as an error, what kernels work with by unwinding to the executor, since
//! kernels themselves know no failure.

use crate::error::{Error, Result};
use bytemuck::Zeroable;
use std::panic::resume_unwind;
#[cfg(feature = "cpu")]
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Bytes that must be there beside what is asked for here: small allocations elsewhere cannot fail, and are to find
/// some. An allocator that keeps a reserve for them refuses this much when it has none.
const SPARE: usize = 4 << 20;

/// Payload that unwinds when a kernel is refused so many bytes.
#[cfg_attr(not(feature = "cpu"), expect(dead_code, reason = "the CPU executor alone reads it"))]
struct Refused(usize);

/// So many zeros, on pages that the system gives when they are first touched.
///
/// # Errors
/// [`Error::Memory`] when there is not enough.
pub(crate) fn zeroed<T: Zeroable>(len: usize) -> Result<Vec<T>> {
    let refused = || refused(len.saturating_mul(size_of::<T>()));
    if is_scarce() {
        return Err(refused());
    }
    bytemuck::allocation::try_zeroed_vec(len).map_err(|()| refused())
}

/// Makes sure that the system has so many bytes to give now.
///
/// # Errors
/// [`Error::Memory`] when it has not.
pub fn must_have(bytes: u64) -> Result<()> {
    let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
    // Pages that are not touched take no memory.
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| refused(bytes))
}

/// Makes `values` `len` long, for kernels and what they call; new ones are `value`. Where there is no memory for
/// them, the kernel ends here and the run with [`Error::Memory`].
pub fn resize<T: Clone>(values: &mut Vec<T>, len: usize, value: T) {
    if values.capacity() < len && (is_scarce() || values.try_reserve(len - values.len()).is_err()) {
        // Unwinds without the message of a panic, which would call it a mistake.
        resume_unwind(Box::new(Refused(len.saturating_mul(size_of::<T>()))));
    }
    values.resize(len, value);
}

/// Runs a kernel, which may end by [`resize`].
///
/// # Errors
/// [`Error::Memory`] when it did.
#[cfg(feature = "cpu")]
pub(crate) fn caught(kernel: impl FnOnce()) -> Result<()> {
    // The outputs of a kernel that was refused memory are dropped.
    catch_unwind(AssertUnwindSafe(kernel)).or_else(|payload| match payload.downcast::<Refused>() {
        Ok(bytes) => Err(refused(bytes.0)),
        Err(payload) => resume_unwind(payload),
    })
}

fn is_scarce() -> bool {
    Vec::<u8>::new().try_reserve_exact(SPARE).is_err()
}

fn refused(bytes: usize) -> Error {
    Error::Memory(format!(
        "there is no memory for {} MiB more; compute smaller regions",
        bytes.div_ceil(1 << 20)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_refused_is_an_error() {
        let most = isize::MAX as usize / 16;
        assert!(matches!(zeroed::<f32>(most), Err(Error::Memory(_))));
        assert_eq!(zeroed::<u64>(3).unwrap(), [0; 3]);
        assert!(matches!(must_have(most as u64 * 8), Err(Error::Memory(_))));
        must_have(1).unwrap();
        assert!(matches!(caught(|| resize(&mut vec![1.0_f32], most, 0.0)), Err(Error::Memory(_))));
        let mut values = vec![1.0_f32];
        caught(|| resize(&mut values, 2, 7.0)).unwrap();
        assert_eq!(values, [1.0, 7.0]);
        assert!(catch_unwind(|| caught(|| panic!("another"))).is_err());
    }
}
