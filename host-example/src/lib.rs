//! The sample host as a library: scenes, their rendering, and the verbs of the program `isophote`.

#![forbid(unsafe_code)]

pub mod bench;
pub mod cli;
pub mod verbs;
