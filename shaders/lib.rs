//! The WGSL texts of Isophote's filters, `GROUP/KERNEL.wgsl`, for the builds of crates that compile them.
//!
//! A text is not a module yet: lines that begin with `#` stand for the text of another file or for bindings. The build of
//! `isophote` puts modules together, validates them, and refuses a shader without a function of its own for CPUs.

#![forbid(unsafe_code)]

use std::path::Path;

/// The folder of the texts, on the machine that this crate is compiled on.
pub fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
