//! Filtering pictures and sequences of pictures from file to file, without any scene.

pub mod asked;
pub mod backend;
pub mod convert;
pub mod dry_run;
pub mod exr;
pub mod filter;
mod jpeg;
pub mod looks;
mod machine;
pub mod masks;
pub mod memory;
mod mix;
mod png;
pub mod primaries;
pub mod read;
pub mod reader;
pub mod reel;
pub mod report;
pub mod sequence;
pub mod space;
pub mod tasks;
pub mod working;
pub mod write;
