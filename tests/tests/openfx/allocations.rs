//! Allocations that are alive in this process, those of libraries that it loads among them: the functions of
//! the C library, counted. Elsewhere than on Linux with the GNU library nothing is counted.

/// Number of allocations that are alive.
pub fn alive() -> i64 {
    counted::ALIVE.load(std::sync::atomic::Ordering::SeqCst)
}

/// True where they are counted.
pub fn are_counted() -> bool {
    alive() > 0
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
mod counted {
    pub static ALIVE: std::sync::atomic::AtomicI64 = std::sync::atomic::AtomicI64::new(0);
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod counted {
    use std::ffi::{c_int, c_void};
    use std::sync::atomic::{AtomicI64, Ordering};

    pub static ALIVE: AtomicI64 = AtomicI64::new(0);

    unsafe extern "C" {
        fn __libc_malloc(size: usize) -> *mut c_void;
        fn __libc_calloc(count: usize, size: usize) -> *mut c_void;
        fn __libc_realloc(old: *mut c_void, size: usize) -> *mut c_void;
        fn __libc_memalign(alignment: usize, size: usize) -> *mut c_void;
        fn __libc_free(old: *mut c_void);
    }

    fn given(new: *mut c_void) -> *mut c_void {
        if !new.is_null() {
            ALIVE.fetch_add(1, Ordering::Relaxed);
        }
        new
    }

    // SAFETY: these stand for the functions of their names, for the whole process, and pass on what they are
    // asked to those of the C library, whose memory everyone gets and gives back.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn malloc(size: usize) -> *mut c_void {
        // SAFETY: the caller's promises are those that the function asks for.
        given(unsafe { __libc_malloc(size) })
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn calloc(count: usize, size: usize) -> *mut c_void {
        // SAFETY: as above.
        given(unsafe { __libc_calloc(count, size) })
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn realloc(old: *mut c_void, size: usize) -> *mut c_void {
        // SAFETY: as above.
        let new = unsafe { __libc_realloc(old, size) };
        if old.is_null() {
            return given(new);
        }
        if new.is_null() && size == 0 {
            ALIVE.fetch_sub(1, Ordering::Relaxed);
        }
        new
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn memalign(alignment: usize, size: usize) -> *mut c_void {
        // SAFETY: as above.
        given(unsafe { __libc_memalign(alignment, size) })
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn aligned_alloc(alignment: usize, size: usize) -> *mut c_void {
        // SAFETY: as above.
        given(unsafe { __libc_memalign(alignment, size) })
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn posix_memalign(place: *mut *mut c_void, alignment: usize, size: usize) -> c_int {
        const NO_MEMORY: c_int = 12;
        // SAFETY: as above; alignments are powers of two.
        let new = given(unsafe { __libc_memalign(alignment, size) });
        if new.is_null() {
            return NO_MEMORY;
        }
        // SAFETY: the caller gave a place for the answer.
        unsafe { *place = new };
        0
    }

    // SAFETY: as above.
    #[unsafe(no_mangle)]
    unsafe extern "C" fn free(old: *mut c_void) {
        if !old.is_null() {
            ALIVE.fetch_sub(1, Ordering::Relaxed);
        }
        // SAFETY: as above.
        unsafe { __libc_free(old) };
    }
}
