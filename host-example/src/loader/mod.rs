//! The dynamic library: finding it, opening it, and safe types over its table of functions.
//!
//! This is the whole of what a viewer needs to use Isophote, and the only place of the host with `unsafe`.
//! The declarations are the library's own ([`contract`]); handles become types that destroy what they hold,
//! statuses become [`Refusal`]s, pointers become slices and text.

#![allow(unsafe_code, reason = "foreign functions are called here and nowhere else in the host")]

pub mod catalogue;
#[path = "../../../include/rust/mod.rs"]
pub mod contract;
pub mod device;
pub mod graph;
mod library;
mod open;
pub mod plan;
pub mod process;
mod refusal;
pub mod sequence;
mod text;

pub use catalogue::Catalogue;
pub use device::Device;
pub use graph::Graph;
pub use library::Library;
pub use plan::Plan;
pub use process::{Control, Input, Report};
pub use refusal::{Answer, Refusal};
pub use sequence::Sequence;
