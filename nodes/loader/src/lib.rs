//! Safe types over the table of Isophote's dynamic library: finding it, opening it, and calling it.
//!
//! This is all that a host in Rust needs of Isophote. Handles become types that destroy what they hold, statuses become
//! [`Error`]s, pointers become slices and text, and images are whatever implements [`AsImage`]. The declarations are those
//! of `isophote-abi`. For hosts that run plans themselves, [`history`] counts the images of past frames and [`uniforms`]
//! places uniform bytes in a buffer.
//!
//! ```no_run
//! # fn main() -> isophote_loader::Result<()> {
//! let library = isophote_loader::Library::open()?;
//! let graph = library.single("cartoon")?;
//! graph.set(0, "detail", "0.4")?;
//! let plan = graph.plan(&library.request((1920, 1080))?)?;
//! for pass in plan.passes()? {
//!     println!("{} in {:?} workgroups", pass.kernel, pass.workgroups);
//! }
//! # Ok(())
//! # }
//! ```

#![allow(unsafe_code, reason = "foreign functions are called here")]

pub mod catalogue;
pub mod device;
mod error;
pub mod graph;
pub mod guides;
pub mod history;
mod image;
mod library;
mod open;
pub mod pixel_aspect;
pub mod plan;
pub mod preset;
mod printable;
pub mod process;
pub mod sequence;
pub mod style;
mod text;
pub mod uniforms;

pub use catalogue::Catalogue;
pub use device::Device;
pub use error::{Error, Fault, Result};
pub use graph::{Graph, GraphHandle};
pub use guides::Guide;
pub use image::{AsImage, AsTarget, Image, Sample, Target};
/// The declarations of the library's table.
pub use isophote_abi as abi;
pub use library::Library;
pub use plan::Plan;
pub use preset::{Lengths, Look, Preset, StyleText, Title, Track};
pub use printable::printable;
pub use process::{Control, Input, Report};
pub use sequence::Sequence;
pub use style::Style;
