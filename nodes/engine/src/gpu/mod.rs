//! The GPU executor of a plan, on wgpu.
//!
//! A [`Device`] is a graphics device of the library's own or a host's. An [`Executor`]
//! turns programs into [`Prepared`] ones, which record their dispatches into a command encoder that
//! the caller owns and submits; once warm they create nothing. [`Executor::run_images`] does the
//! same for images in memory, in tiles where they are larger than the device takes.
//!
//! Nothing here panics on what a driver says: shaders that do not compile, exhausted memory and lost
//! devices are [`Error`](crate::Error)s.

mod device;
mod executor;
mod pipeline;
mod prepared;
mod staging;
mod texture;
mod tiles;
mod timing;
mod transfer;

pub use device::{Counts, Device, Options};
pub use executor::Executor;
pub use pipeline::texture_format;
pub use prepared::Prepared;
pub use wgpu;
