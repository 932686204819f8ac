//! Documents of the window that have frames: sequences and videos, read ahead, in any order, and ended with the document.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use isophote_window::jobs::document::{Document, Options};
use isophote_window::state::document::frame::Frame;
use isophote_window::state::document::kind::Kind;

use crate::support::{folder, has_ffmpeg, picture, succeeds};

/// This only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(60);

fn wait_until(is_so: impl Fn() -> bool) {
    let started = Instant::now();
    while !is_so() {
        assert!(started.elapsed() < PATIENCE, "it does not come to that");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn ffmpeg(folder: &Path, args: &str) {
    let mut command = Command::new("ffmpeg");
    succeeds(command.current_dir(folder).args(["-v", "error", "-y"]).args(args.split(' ')));
}

#[test]
fn sequences_are_read_ahead_within_their_bound() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for number in [1, 2, 3, 4, 5, 6, 9] {
        let mut picture = picture(40, 30);
        picture.put_pixel(0, 0, image::Rgb([number, 0, 0]));
        picture.save(at(&format!("shot.000{number}.png"))).expect("the folder is writable");
    }
    fs::write(at("shot.0005.png"), "no picture").expect("the folder is writable");
    let bytes = 40 * 30 * 16;
    let options = Options { cache: bytes * 3, ..Options::default() };
    let open = |name: &str, as_sequence| {
        Document::open(&at(name), &Options { as_sequence, ..options.clone() })
            .unwrap_or_else(|e| panic!("{e}"))
    };
    assert_eq!(open("shot.0003.png", false).kind(), Kind::Picture);
    for document in [open("shot.####.png", false), open("shot.0003.png", true), open("", false)] {
        assert_eq!((document.kind(), document.path()), (Kind::Sequence, at("shot.####.png").as_path()));
        let frames = document.frames().expect("frames");
        assert_eq!(*frames.numbers, [1, 2, 3, 4, 5, 6, 9]);
        assert_eq!((frames.first(), frames.last(), frames.rate), (1, 9, 24.0));
    }
    let document = open("shot.####.png", false);
    let red = |number: i64| document.wait(number).map(|frame| (frame.number, frame.color[0][0] * 255.0));
    document.play(1);
    for number in [1, 2, 3, 4, 6, 9, 1, 4] {
        assert_eq!(red(number).expect("a frame"), (Some(number), number as f32));
        let cached = document.frames().expect("frames").cached;
        assert!(cached.len() <= 3 && cached.contains(&number), "{cached:?} at {number}");
    }
    // Frame 5 is no picture, which the others do not suffer from; 7 there is none.
    assert!(red(5).unwrap_err().to_string().contains("shot.0005.png"));
    assert!(red(7).unwrap_err().to_string().contains("frame 7"));
    red(3).expect("a frame");
    wait_until(|| document.frames().is_some_and(|f| f.cached == [3, 4, 6]));
    document.play(-1);
    wait_until(|| document.frames().is_some_and(|f| f.cached == [1, 2, 3]));
    document.play(0);
    assert!(document.frame(3).is_some_and(|frame| frame.is_ok()), "frames in memory are there at once");
}

#[test]
fn any_frame_of_a_video_is_the_same_as_in_order() {
    if !has_ffmpeg() {
        return;
    }
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let source = "-f lavfi -i testsrc2=s=64x48:r=30000/1001:d=4";
    let h264 = "-c:v libx264 -g 30 -bf 3 -pix_fmt yuv420p";
    for (name, codec) in [
        ("a.mp4", h264),
        ("a.mkv", "-c:v libx264 -g 50 -bf 3 -pix_fmt yuv420p"),
        ("a.webm", "-c:v libvpx-vp9 -g 40 -pix_fmt yuv420p"),
        ("a.mov", "-c:v prores_ks"),
        ("a.avi", "-c:v mpeg4 -bf 2"),
        ("a.ts", h264),
        ("a.y4m", "-pix_fmt yuv420p"),
        ("late.mkv", &format!("{h264} -output_ts_offset 3.3")),
        // Frames of unequal length.
        ("uneven.mp4", &format!("-vf select=gt(mod(n\\,4)\\,0) -fps_mode vfr {h264}")),
        ("few.mp4", &format!("-vf select=not(eq(n\\,50)) -fps_mode vfr {h264}")),
    ] {
        ffmpeg(folder.path(), &format!("{source} {codec} {name}"));
        any_frame_is_the_same(&at(name));
    }
    // Of a copy, frames before the cut are decoded and not shown.
    ffmpeg(folder.path(), "-ss 1.21 -i a.mp4 -c copy cut.mp4");
    any_frame_is_the_same(&at("cut.mp4"));
}

/// Frames of a video in any order are those in order, which are those that `apply` reads.
fn any_frame_is_the_same(path: &Path) {
    let name = path.display();
    let open = || Document::open(path, &Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let ordered = open();
    ordered.play(1);
    let mut all: Vec<Arc<Frame>> = Vec::new();
    while let Ok(frame) = ordered.wait(all.len() as i64 + 1) {
        all.push(frame);
    }
    let frames = ordered.frames().expect("frames");
    assert_eq!((frames.first(), frames.last()), (1, all.len() as i64), "{name}");
    assert!(all.len() > 70, "{name} has {} frames", all.len());
    let document = open();
    for number in [999, 1, 61, 60, 59, 30, 31, 32, 70, 2, 69].map(|n| n.min(all.len() as i64)) {
        let frame = document.wait(number).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(frame == all[number as usize - 1], "{name}: frame {number} is another");
    }
    document.play(-1);
    for number in (20..60).rev() {
        let frame = document.wait(number).expect("a frame");
        assert!(frame == all[number as usize - 1], "{name}: frame {number} is another backward");
    }
    let raw = Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(path)
        .args(["-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", "gray", "-"])
        .output()
        .expect("ffmpeg runs");
    if !name.to_string().contains("uneven") {
        assert_eq!(raw.stdout.len() / (64 * 48), all.len(), "{name} has as many frames");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_document_that_is_dropped_leaves_no_thread_and_no_process() {
    if !has_ffmpeg() {
        return;
    }
    let folder = folder();
    ffmpeg(folder.path(), "-f lavfi -i testsrc2=s=320x240:r=25:d=20 -c:v libx264 -preset ultrafast a.mp4");
    let path = folder.path().join("a.mp4");
    // Processes that hold the video open, by what the system tells of their command lines.
    let busy = || {
        let entries = fs::read_dir("/proc").expect("a list of processes").flatten();
        let lines = entries.filter_map(|entry| fs::read(entry.path().join("cmdline")).ok());
        let name = path.to_string_lossy().into_owned();
        lines.filter(|line| String::from_utf8_lossy(line).contains(&name)).count()
    };
    let document = Document::open(&path, &Options { cache: 8 << 20, ..Options::default() }).expect("a video");
    document.play(1);
    document.wait(5).expect("a frame");
    assert_eq!(busy(), 1, "the decoder waits for the frames to be shown");
    drop(document);
    wait_until(|| busy() == 0);
}
