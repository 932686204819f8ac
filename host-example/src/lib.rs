//! The sample host as a library: scenes, their rendering, and the verbs of the program `isophote`.

#![forbid(unsafe_code)]

pub mod apply;
pub mod bench;
pub mod cli;
pub mod looks;
pub mod sheet;
pub mod shot;
pub mod stylize;
pub mod verbs;
pub mod video;
pub mod view;
