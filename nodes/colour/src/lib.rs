//! Named colour spaces, and changes of pixels from one to another: one list for the program, OpenFX and Python.
//!
//! The library computes in three spaces. A face changes pixels of the others to one of these, and results back.
//!
//! | module | content |
//! |---|---|
//! | [`space`] | the list |
//! | [`primaries`] | primaries, and the matrices between them |
//! | [`transfer`] | relation of numbers to light |
//! | [`conversion`] | changes of pixels |

#![forbid(unsafe_code)]

pub mod conversion;
pub mod primaries;
pub mod space;
pub mod transfer;

pub use conversion::{Conversion, Encoding};
pub use space::Space;
