//! Pictures: pixels, colour spaces, and the files that pictures are read from and written to.
//!
//! | module | content |
//! |---|---|
//! | [`pixels`] | pixels in the precision of their file |
//! | [`floats`] | pictures of 32-bit floats, saved as PNG or EXR |
//! | [`space`], [`primaries`] | colour spaces and their primaries |
//! | [`meaning`] | meaning of the numbers of a picture |
//! | [`transfer`] | relation of numbers to light |
//! | [`cicp`] | primaries, transfers and matrices by their numbers in video and PNG |
//! | [`convert`] | changes from one meaning to another |
//! | [`working`] | space in which a picture is filtered |
//! | [`read`] | PNG, JPEG, TIFF, WebP, HDR and EXR files to pictures |
//! | [`webp`] | frames of animated WebP files |
//! | [`write`](mod@write) | pictures to files |
//! | [`exr`] | layers, guides, masks and mattes of EXR files |
//! | [`resize`] | pixels at another size |
//! | [`mix`] | mixing of two pictures by a mask |
//! | [`material`] | paper and hatching, of files and those that ship |
//! | [`palette`] | colours of files of painting programs, and those that are found in pictures |

#![forbid(unsafe_code)]

pub mod cicp;
mod colours;
pub mod convert;
pub mod display;
mod exif;
pub mod exr;
pub mod floats;
mod hdr;
mod icc;
mod inks;
mod jpeg;
pub mod material;
pub mod meaning;
pub mod mix;
pub mod palette;
pub mod pixels;
mod png;
mod random;
pub mod read;
pub mod resize;
mod said;
pub mod space;
mod svg;
mod tiff;
mod tiff_write;
pub mod webp;
mod weight;
pub mod working;
pub mod write;

pub use isophote_colour::{primaries, transfer};
