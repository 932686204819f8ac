//! Kinds of videos, by the names of files, and of pictures that move by what is in them.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Name for standard input and output, which carry YUV4MPEG.
const PIPE: &str = "-";

/// Extensions of videos with the container's name for ffmpeg.
const CONTAINERS: [(&str, &str); 24] = [
    ("mp4", "mp4"),
    ("m4v", "mp4"),
    ("mov", "mov"),
    ("qt", "mov"),
    ("mkv", "matroska"),
    ("webm", "webm"),
    ("avi", "avi"),
    ("mxf", "mxf"),
    ("ts", "mpegts"),
    ("m2ts", "mpegts"),
    ("mts", "mpegts"),
    ("mpg", "vob"),
    ("mpeg", "vob"),
    ("vob", "vob"),
    ("wmv", "asf"),
    ("asf", "asf"),
    ("3gp", "3gp"),
    ("3g2", "3g2"),
    ("ogv", "ogv"),
    ("dv", "dv"),
    ("y4m", Y4M),
    ("gif", "gif"),
    ("apng", "apng"),
    ("webp", WEBP),
];

/// YUV4MPEG, which has no sound.
pub const Y4M: &str = "yuv4mpegpipe";
/// WebP, of which ffmpeg writes what moves and reads what does not.
pub const WEBP: &str = "webp";
/// Containers by whose name ffmpeg reads another than it writes.
const READ_AS: [(&str, &str); 4] = [("webm", "matroska"), ("vob", "mpeg"), ("ogv", "ogg"), ("3g2", "3gp")];

/// Beginning of a PNG file.
const PNG: &[u8; 8] = b"\x89PNG\r\n\x1A\n";
/// Most parts of a PNG file before its pixels that are looked at.
const MOST_PARTS: usize = 1000;

/// True where a path names a video that can be read: by its extension, or by what is in a PNG or WebP file.
pub fn is_video(path: &Path) -> bool {
    match container(path) {
        Some(WEBP) => is_moving_webp(path),
        Some(_) => true,
        None => has_extension(path, "png") && is_moving_png(path).unwrap_or(false),
    }
}

/// True where a result of this name is a video.
pub fn becomes_video(path: &Path) -> bool {
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

/// The name by which ffmpeg reads a container.
pub fn read_as(container: &'static str) -> &'static str {
    READ_AS.iter().find(|(written, _)| *written == container).map_or(container, |(_, read)| *read)
}

/// True where a path stands for standard input or output.
pub fn is_pipe(path: &Path) -> bool {
    path.as_os_str() == PIPE
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// True for a WebP file that says so in its first part.
pub fn is_moving_webp(path: &Path) -> bool {
    const MOVES: u8 = 2;
    let mut start = [0; 21];
    // Pipes are not opened: whoever does that waits for their other end.
    let is_read = has_extension(path, WEBP)
        && path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok();
    is_read && start.starts_with(b"RIFF") && &start[8..16] == b"WEBPVP8X" && start[20] & MOVES != 0
}

/// True for a PNG file that says before its pixels that it moves; nothing for what cannot be read.
fn is_moving_png(path: &Path) -> Option<bool> {
    let mut file = BufReader::new(path.is_file().then(|| File::open(path).ok())??);
    let mut start = [0; PNG.len()];
    file.read_exact(&mut start).ok()?;
    if start != *PNG {
        return Some(false);
    }
    for _ in 0..MOST_PARTS {
        let mut head = [0; 8];
        file.read_exact(&mut head).ok()?;
        let [a, b, c, d, name @ ..] = head;
        match &name {
            b"acTL" => return Some(true),
            b"IDAT" | b"IEND" => return Some(false),
            _ => file.seek_relative(i64::from(u32::from_be_bytes([a, b, c, d])) + 4).ok()?,
        }
    }
    Some(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_that_move_are_videos() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            is_video(&path)
        };
        let part = |name: &[u8], bytes: &[u8]| {
            [&(bytes.len() as u32).to_be_bytes()[..], name, bytes, &[0; 4]].concat()
        };
        let png = |parts: &[Vec<u8>]| [&PNG[..], &parts.concat()].concat();
        let [head, moves, pixels] = [part(b"IHDR", &[0; 13]), part(b"acTL", &[0; 8]), part(b"IDAT", b"x")];
        assert!(file("a.png", &png(&[head.clone(), moves.clone(), pixels.clone()])));
        assert!(!file("b.png", &png(&[head.clone(), pixels, moves])));
        assert!(!file("c.png", &png(&[head])) && !file("d.png", b"no PNG") && !file("e.png", b""));
        let webp = |kind: &[u8], flags: u8| [b"RIFF\0\0\0\0WEBP", kind, &[10, 0, 0, 0, flags, 0, 0]].concat();
        assert!(file("a.webp", &webp(b"VP8X", 0x12)));
        assert!(!file("b.webp", &webp(b"VP8X", 0x10)) && !file("c.webp", &webp(b"VP8L", 0xFF)));
        assert!(file("a.gif", b"") && file("a.M2TS", b"") && !file("a.jpg", b""));
        let named = Path::new("out.webp");
        assert!(becomes_video(named) && !is_video(named));
    }
}
