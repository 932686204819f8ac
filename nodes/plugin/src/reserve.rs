//! The allocator of the library: the system's, with a reserve for what cannot fail.
//!
//! Images, rows and what kernels work with are allocated so that a failure is an error. Small things (a text, a
//! list, a lock) are allocated by code that knows no failure, and would end the host's process. When there is no
//! memory for one of those, the reserve goes back to the system, which then has enough until the call that is under
//! way has failed and freed its images. Nothing large is given while there is no reserve, so that it is there again
//! before images take what is left.

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicPtr, Ordering};

/// From this size on, in bytes, who allocates can take a refusal.
const LARGE: usize = 2 << 20;
/// The reserve. Its pages are never touched, so that it takes addresses and, but on Windows, no memory. It is larger
/// than what the GNU C library keeps when it is freed.
const RESERVE: Layout = Layout::new::<[u64; 8 << 20]>();

/// The reserve, or null.
static KEPT: AtomicPtr<u8> = AtomicPtr::new(null_mut());

struct Reserving;

#[global_allocator]
static ALLOCATOR: Reserving = Reserving;

// SAFETY: memory comes from the system's allocator and goes back to it, with the layouts that it was given.
unsafe impl GlobalAlloc for Reserving {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promised.
        allocate(layout.size(), || unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as the caller promised.
        allocate(layout.size(), || unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as the caller promised; a refusal leaves the old memory as it was.
        allocate(size, || unsafe { System.realloc(old, layout, size) })
    }

    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        // SAFETY: as the caller promised.
        unsafe { System.dealloc(old, layout) };
    }
}

fn allocate(size: usize, allocate: impl Fn() -> *mut u8) -> *mut u8 {
    if size >= LARGE {
        return if keep() { allocate() } else { null_mut() };
    }
    loop {
        let given = allocate();
        if !given.is_null() {
            return given;
        }
        let kept = KEPT.swap(null_mut(), Ordering::AcqRel);
        if kept.is_null() {
            // Another thread may just have given the reserve back.
            return allocate();
        }
        // Another thread may take a new reserve before this one has its memory.
        // SAFETY: `keep` allocated it with this layout, and the exchange gave it to this thread alone.
        unsafe { System.dealloc(kept, RESERVE) };
    }
}

/// Takes the reserve where there is none, which hosts' first calls do; says whether there is one.
pub fn keep() -> bool {
    if !KEPT.load(Ordering::Acquire).is_null() {
        return true;
    }
    // SAFETY: the layout has a size.
    let new = unsafe { System.alloc(RESERVE) };
    if new.is_null() {
        return false;
    }
    let kept = KEPT.compare_exchange(null_mut(), new, Ordering::AcqRel, Ordering::Acquire);
    if kept.is_err() {
        // SAFETY: it was allocated above, and nobody else has seen it.
        unsafe { System.dealloc(new, RESERVE) };
    }
    true
}
