//! Arguments: text, structs and places to write, behind pointers that may be null or unaligned.

use super::failure::{Failure, Outcome};
use isophote_abi::{ISOPHOTE_ERROR_TRUNCATED, IsophoteText};
use std::ffi::{CStr, c_char};

/// Text from the host.
///
/// # Errors
/// Invalid argument when the pointer is null or the text is not UTF-8.
///
/// # Safety
/// `pointer` is null or points to bytes that end with a zero and stay unchanged for `'a`.
pub unsafe fn text<'a>(pointer: *const c_char, what: &str) -> Outcome<&'a str> {
    if pointer.is_null() {
        return Err(Failure::argument(format!("{what} is null")));
    }
    // SAFETY: not null, and ends with a zero as the caller promised.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| Failure::argument(format!("{what} is not UTF-8")))
}

/// A copy of what `pointer` points to.
///
/// # Errors
/// Invalid argument when it is null.
///
/// # Safety
/// `pointer` is null or points to a `T` that any bytes are valid for.
pub unsafe fn get<T: Copy>(pointer: *const T, what: &str) -> Outcome<T> {
    if pointer.is_null() {
        return Err(Failure::argument(format!("{what} is null")));
    }
    // SAFETY: not null and readable as the caller promised; alignment is not taken for granted.
    Ok(unsafe { pointer.read_unaligned() })
}

/// Writes `value` where `pointer` points.
///
/// # Errors
/// Invalid argument when it is null.
///
/// # Safety
/// `pointer` is null or points to a `T` that may be written.
pub unsafe fn put<T: Copy>(pointer: *mut T, value: T, what: &str) -> Outcome<()> {
    if pointer.is_null() {
        return Err(Failure::argument(format!("{what} is null")));
    }
    // SAFETY: not null and writable as the caller promised; alignment is not taken for granted.
    unsafe { pointer.write_unaligned(value) };
    Ok(())
}

/// Writes `value` where `pointer` points, unless it is null.
///
/// # Safety
/// As [`put`].
pub unsafe fn put_if_wanted<T: Copy>(pointer: *mut T, value: T) {
    if !pointer.is_null() {
        // SAFETY: as the caller promised.
        unsafe { pointer.write_unaligned(value) };
    }
}

/// Writes text into the host's buffer.
///
/// # Errors
/// Invalid argument when there is no buffer; truncated when it is too small.
///
/// # Safety
/// `target` is null or points to an `IsophoteText` whose `data` is null or has room for `capacity` bytes.
pub unsafe fn fill(target: *mut IsophoteText, value: &str) -> Outcome<()> {
    // SAFETY: as the caller promised.
    let mut buffer = unsafe { get(target, "the text to fill")? };
    if buffer.data.is_null() && buffer.capacity > 0 {
        return Err(Failure::argument("the text to fill has a capacity and no data"));
    }
    // A reader takes the first zero for the end of the text; none of ours holds one.
    let mut end = value.len();
    if end >= buffer.capacity {
        end = buffer.capacity.saturating_sub(1);
        while !value.is_char_boundary(end) {
            end -= 1;
        }
    }
    if buffer.capacity > 0 {
        let data = buffer.data.cast::<u8>();
        // SAFETY: `end` is below `capacity`, for which there is room as the caller promised.
        unsafe {
            data.copy_from(value.as_ptr(), end);
            data.add(end).write(0);
        }
    }
    buffer.length = value.len();
    // SAFETY: `target` was read before.
    unsafe { target.write_unaligned(buffer) };
    if end < value.len() && buffer.capacity > 0 {
        return Err(Failure::new(
            ISOPHOTE_ERROR_TRUNCATED,
            format!("{} bytes are needed, there is room for {}", value.len() + 1, buffer.capacity),
        ));
    }
    Ok(())
}

/// As [`fill`], for messages: what does not fit is cut, and a useless buffer is ignored.
///
/// # Safety
/// As [`fill`].
pub unsafe fn fill_message(target: *mut IsophoteText, message: &str) {
    if !target.is_null() {
        // The call has failed already; a message that does not fit is no further failure.
        // SAFETY: as the caller promised.
        let _ = unsafe { fill(target, message) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(value: &str, capacity: usize) -> (Outcome<()>, Vec<u8>, usize) {
        let mut bytes = vec![b'#'; capacity + 1];
        let mut text = IsophoteText { data: bytes.as_mut_ptr().cast(), capacity, length: 0 };
        // SAFETY: there is room for `capacity` bytes and one more.
        let outcome = unsafe { fill(&raw mut text, value) };
        (outcome, bytes, text.length)
    }

    #[test]
    fn text_is_cut_between_characters_and_never_written_beyond_its_room() {
        let (outcome, bytes, length) = filled("schön", 7);
        assert!(outcome.is_ok());
        assert_eq!((bytes.as_slice(), length), (b"sch\xc3\xb6n\0#".as_slice(), 6));
        let (outcome, bytes, length) = filled("schön", 5);
        assert_eq!(outcome.unwrap_err().status, ISOPHOTE_ERROR_TRUNCATED);
        assert_eq!((bytes.as_slice(), length), (b"sch\0##".as_slice(), 6));
        let (outcome, bytes, length) = filled("schön", 0);
        assert!(outcome.is_ok());
        assert_eq!((bytes.as_slice(), length), (b"#".as_slice(), 6));
    }
}
