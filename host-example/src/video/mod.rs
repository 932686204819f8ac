//! Videos, frame by frame through the `ffmpeg` program of the system: raw pictures come from one process of it and go to
//! another, which takes sound, subtitles and metadata from the input.

mod clip;
mod container;
mod decode;
mod encode;
mod film;
mod process;
mod run;
mod stream;

pub use self::clip::Clip;
pub use self::container::is_video;
pub use self::film::{Film, shown};
pub use self::run::{Job, run};
