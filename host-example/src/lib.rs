//! The sample host as a library: scenes, their rendering, and the verbs of the program `isophote`.

pub mod apply;
pub mod bench;
pub mod cli;
pub mod error;
pub mod farm_verb;
pub mod loader;
pub mod nodes_verb;
pub mod output;
pub mod pixels;
pub mod preset_verb;
pub mod render;
pub mod render_verb;
pub mod scene;
pub mod stylize;
pub mod view;
