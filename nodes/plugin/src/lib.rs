//! The dynamic library: what hosts in other languages link or load.
//!
//! [`abi`] is the C face, described by `include/isophote.h`, and [`ofx`] the OpenFX face. Nothing else
//! is exported, and no Rust crate can depend on this one.

#![allow(unsafe_code, reason = "foreign pointers come in here; nowhere else in the library")]

/// The library starts where the C library is older.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[used]
static OWN: isophote_glibc::Kept = isophote_glibc::KEPT;

pub mod abi;
pub mod ofx;
mod pinned;
mod pixel_aspect;
mod pool;
mod reserve;
