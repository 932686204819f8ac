//! Keeps the dynamic library in memory once it is used, on Windows. Elsewhere the linker does; `build.rs` says
//! how and why.

/// Pins the library: `FreeLibrary` leaves it loaded from now on.
#[cfg(windows)]
pub fn pin() {
    use std::ffi::c_void;
    use std::ptr::null_mut;
    use std::sync::Once;

    const PIN: u32 = 1;
    const FROM_ADDRESS: u32 = 4;

    #[link(name = "kernel32")]
    unsafe extern "system" {
        fn GetModuleHandleExW(flags: u32, name: *const u16, module: *mut *mut c_void) -> i32;
    }

    static PINNED: Once = Once::new();
    PINNED.call_once(|| {
        let mut module = null_mut();
        // SAFETY: by the flags, the second argument is an address inside the library and no name; the third is a
        // place for the answer. A refusal leaves the library as it was loaded.
        unsafe { GetModuleHandleExW(PIN | FROM_ADDRESS, (&raw const PINNED).cast(), &raw mut module) };
    });
}

/// The linker did it.
#[cfg(not(windows))]
pub const fn pin() {}
