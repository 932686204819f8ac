//! Videos that tests make and look into by ffmpeg.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::{root, succeeds};

/// Runs ffmpeg with these words in a folder.
pub fn ffmpeg(folder: &Path, args: &str) {
    let mut command = Command::new("ffmpeg");
    succeeds(command.current_dir(folder).args(["-v", "error", "-y"]).args(args.split(' ')));
}

/// Output of ffprobe about a stream.
pub fn probe(file: &Path, stream: &str, entries: &str) -> String {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", stream, "-show_entries", &format!("stream={entries}")]);
    succeeds(command.args(["-of", "csv=p=0"]).arg(file)).0.trim().to_owned()
}

/// A second of moving stripes with a tone.
pub fn clip(folder: &Path, name: &str, more: &str) {
    let source = "-f lavfi -i testsrc2=s=160x90:r=30000/1001:d=1,eq=saturation=0.2:contrast=0.7 -f lavfi -i sine=f=440:d=1";
    ffmpeg(folder, &format!("{source} -c:v libx264 -qp 0 -c:a aac {more} {name}"));
}

/// Mean difference of the lightness of two videos, of 255.
pub fn difference(folder: &Path, a: &str, b: &str) -> f64 {
    let frames = |name: &str| {
        let mut command = Command::new("ffmpeg");
        command.current_dir(folder).args([
            "-v",
            "error",
            "-i",
            name,
            "-fps_mode",
            "passthrough",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "gray",
            "-",
        ]);
        command.output().expect("ffmpeg runs").stdout
    };
    let (a, b) = (frames(a), frames(b));
    assert_eq!(a.len(), b.len(), "as many frames of the same size");
    let sum: u64 = a.iter().zip(&b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / a.len() as f64
}

/// A file in the folder of cases.
pub fn case(name: &str) -> PathBuf {
    root().join("tests/data/cases").join(name)
}
