//! The contract of Isophote's dynamic library, declared once.
//!
//! `include/isophote.h` is generated from these files (`cargo xtask header`). They hold declarations only and depend on
//! nothing but `core`. A host in Rust has safe types over them in `isophote-loader`. [`openfx`] declares the part of the
//! OpenFX standard that the library speaks.
//!
//! Everything is plain data of fixed layout. What comes from outside is never a Rust enum, reference
//! or `bool`, so that a wrong value is an error and not undefined behaviour.

#![no_std]

pub mod constants;
pub mod guides;
pub mod memory;
pub mod openfx;
pub mod pixel_aspect;
pub mod precision;
pub mod presets;
pub mod sequences;
pub mod table;
pub mod types;
pub mod vulkan;

pub use constants::*;
pub use guides::*;
pub use memory::*;
pub use pixel_aspect::*;
pub use precision::*;
pub use presets::*;
pub use sequences::*;
pub use table::*;
pub use types::*;
pub use vulkan::*;
