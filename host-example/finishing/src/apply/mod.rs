//! Filtering pictures and sequences of pictures from file to file, without any scene.

pub mod backend;
mod card;
pub mod dry_run;
pub mod filter;
pub mod frame_cache;
pub mod looks;
mod machine;
pub mod masks;
pub mod materials;
pub mod memory;
pub mod objects;
pub mod painted;
pub mod picture_request;
pub mod planner;
pub mod reader;
pub mod report;
pub mod sequence;
pub mod square;
pub(crate) mod stages;
pub mod tasks;
