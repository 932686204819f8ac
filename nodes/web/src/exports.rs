//! The functions of the module, and the two places in its memory through which texts come and go.
//!
//! `isophote_request(n)` makes room for the `n` bytes of a request and says where; `isophote_answer()` answers what lies
//! there and says how many bytes the answer has, which begins at `isophote_answer_at()` and is there until the next call.
//! `isophote_pixels(n)` makes room for pixels that a request is about; the answer takes them.

// Symbols must have the names that the page calls them by; nothing else here is unsafe.
#![allow(unsafe_code)]

use crate::plans::Planner;
use std::cell::RefCell;

#[derive(Default)]
struct Module {
    planner: Planner,
    request: Vec<u8>,
    pixels: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static MODULE: RefCell<Module> = RefCell::default();
}

/// Makes room for a request of so many bytes, and says where they go.
// SAFETY: no other symbol of this module has the name.
#[unsafe(no_mangle)]
extern "C" fn isophote_request(length: usize) -> *mut u8 {
    MODULE.with_borrow_mut(|module| {
        module.request.clear();
        module.request.resize(length, 0);
        module.request.as_mut_ptr()
    })
}

/// Makes room for so many bytes of pixels, and says where they go.
// SAFETY: no other symbol of this module has the name.
#[unsafe(no_mangle)]
extern "C" fn isophote_pixels(length: usize) -> *mut u8 {
    MODULE.with_borrow_mut(|module| {
        module.pixels.clear();
        module.pixels.resize(length, 0);
        module.pixels.as_mut_ptr()
    })
}

/// Answers the request, and says how many bytes the answer has.
// SAFETY: no other symbol of this module has the name.
#[unsafe(no_mangle)]
extern "C" fn isophote_answer() -> usize {
    MODULE.with_borrow_mut(|module| {
        module.answer = module.planner.answer(&module.request, &module.pixels).into_bytes();
        module.pixels.clear();
        module.answer.len()
    })
}

/// Address of the last answer.
// SAFETY: no other symbol of this module has the name.
#[unsafe(no_mangle)]
extern "C" fn isophote_answer_at() -> *const u8 {
    MODULE.with_borrow(|module| module.answer.as_ptr())
}
