//! Kinds of videos, by the names of files.

use std::path::Path;

/// Name for standard input and output, which carry YUV4MPEG.
const PIPE: &str = "-";

/// Extensions of videos with the container's name for ffmpeg.
const CONTAINERS: [(&str, &str); 9] = [
    ("mp4", "mp4"),
    ("m4v", "mp4"),
    ("mov", "mov"),
    ("mkv", "matroska"),
    ("webm", "webm"),
    ("avi", "avi"),
    ("mxf", "mxf"),
    ("ts", "mpegts"),
    ("y4m", Y4M),
];

/// YUV4MPEG, which has no sound.
pub const Y4M: &str = "yuv4mpegpipe";

/// True where a path names a video.
pub fn is_video(path: &Path) -> bool {
    container(path).is_some()
}

/// The name that ffmpeg has for the container of a path; none for other files.
pub fn container(path: &Path) -> Option<&'static str> {
    if is_pipe(path) {
        return Some(Y4M);
    }
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    CONTAINERS.iter().find(|(known, _)| *known == extension).map(|(_, name)| *name)
}

/// True where a path stands for standard input or output.
pub fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == PIPE
}
