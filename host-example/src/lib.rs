//! The sample host as a library: scenes, their rendering, and the verbs of the program `isophote`.

#![forbid(unsafe_code)]

pub mod apply;
pub mod bench;
pub mod cli;
pub mod drivers;
pub mod error;
pub mod files;
pub mod floats;
pub mod frames;
pub mod identity;
pub mod input;
pub mod limits;
pub mod looks;
pub mod output;
pub mod pixels;
pub mod render;
pub mod replacing;
pub mod scene;
pub mod sheet;
pub mod shot;
pub mod stop;
pub mod stylize;
mod temporary;
pub mod verbs;
pub mod video;
pub mod view;
