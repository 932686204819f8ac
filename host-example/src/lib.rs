//! The sample host as a library: scenes, their rendering, and the verbs of the program `isophote`.

pub mod cli;
pub mod error;
pub mod output;
pub mod render;
pub mod render_verb;
pub mod scene;
