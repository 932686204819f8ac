//! Videos, frame by frame through the `ffmpeg` program of the system: raw pictures come from one process of it and go to
//! another, which takes sound, subtitles and metadata from the input. Files and streams are not trusted; `closed.rs` says how.

mod clip;
mod closed;
mod container;
mod decode;
mod encode;
mod film;
mod form;
#[cfg(test)]
mod hostile;
mod input;
mod opaque;
mod packets;
mod probe;
mod process;
mod recount;
mod results;
mod run;
mod stream;
mod timed;
mod tracks;
mod webp;
mod y4m;

pub use self::clip::Clip;
pub use self::container::{becomes_video, is_video};
pub use self::decode::OnError;
pub use self::film::{Film, shown};
pub use self::results::Numbered;
pub use self::run::{VideoJob, run};
