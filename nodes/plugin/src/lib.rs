//! The dynamic library: what hosts in other languages link or load.
//!
//! [`abi`] is the C face, described by `include/isophote.h`, and [`ofx`] the OpenFX face. Nothing else
//! is exported, and no Rust crate can depend on this one.

#![allow(unsafe_code, reason = "foreign pointers come in here; nowhere else in the library")]

pub mod abi;
pub mod ofx;
mod pinned;
mod reserve;
