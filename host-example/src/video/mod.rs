//! Videos, frame by frame through the `ffmpeg` program of the system: raw pictures come from one process of it and go to
//! another, which takes sound, subtitles and metadata from the input.

mod container;
mod process;
mod run;
mod stream;

pub use self::container::is_video;
pub use self::run::{Job, run};
