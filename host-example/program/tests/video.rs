//! `apply` on videos, through the ffmpeg program of the system.

mod support;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use support::{IN_PIXELS, fails, isophote, listing, succeeds, video_folder};

fn ffmpeg(folder: &Path, args: &str) {
    let mut command = Command::new("ffmpeg");
    succeeds(command.current_dir(folder).args(["-v", "error", "-y"]).args(args.split(' ')));
}

/// Output of ffprobe about a stream.
fn probe(file: &Path, stream: &str, entries: &str) -> String {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", stream, "-show_entries", &format!("stream={entries}")]);
    succeeds(command.args(["-of", "csv=p=0"]).arg(file)).0.trim().to_owned()
}

/// A second of moving stripes with a tone.
fn clip(folder: &Path, name: &str, more: &str) {
    let source = "-f lavfi -i testsrc2=s=160x90:r=30000/1001:d=1,eq=saturation=0.2:contrast=0.7 -f lavfi -i sine=f=440:d=1";
    ffmpeg(folder, &format!("{source} -c:v libx264 -qp 0 -c:a aac {more} {name}"));
}

fn apply(folder: &Path, args: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).arg("apply").args(args).args(IN_PIXELS).args(["--backend", "cpu"]);
    command
}

/// Mean difference of the lightness of two videos, of 255.
fn difference(folder: &Path, a: &str, b: &str) -> f64 {
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

#[test]
fn sound_rate_range_and_matrix_are_kept() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (name, colours) in [
        (
            "video.mp4",
            "-pix_fmt yuv420p -color_range tv -colorspace bt709 -color_primaries bt709 -color_trc bt709",
        ),
        ("full.mkv", "-pix_fmt yuv444p -color_range pc -colorspace smpte170m"),
        ("plain.mov", "-pix_fmt yuv420p"),
    ] {
        clip(at, name, colours);
        let out = format!("out-{name}");
        // Nothing is changed but by rounding.
        let (text, _) = succeeds(&mut apply(
            at,
            &["gaussian", name, &out, "--set", "sigma=0", "--encode", "-c:v libx264 -qp 0"],
        ));
        assert!(text.contains("30 frames written") || text.contains("29 frames written"), "{text}");
        let (before, after) = (at.join(name), at.join(&out));
        let entries =
            "pix_fmt,color_range,color_space,color_transfer,color_primaries,r_frame_rate,width,height";
        assert_eq!(probe(&before, "v:0", entries), probe(&after, "v:0", entries), "{name}");
        assert_eq!(
            probe(&before, "a:0", "codec_name,nb_frames"),
            probe(&after, "a:0", "codec_name,nb_frames")
        );
        let difference = difference(at, name, &out);
        assert!(difference < 0.6, "{name} differs by {difference} of 255");
    }
    // A style is one, and lines are grey.
    for style in ["cartoon", "flow_dog"] {
        succeeds(&mut apply(at, &[style, "video.mp4", "styled.mp4", "--force"]));
        assert!(difference(at, "video.mp4", "styled.mp4") > 3.0, "{style} does nothing");
    }
}

#[test]
fn styles_are_steady_by_the_motion_of_the_pictures() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "video.mp4", "-pix_fmt yuv420p");
    let steady = ["--steadiness", "0.5", "--motion", "estimate"];
    succeeds(&mut apply(at, &["cartoon", "video.mp4", "still.mp4"]));
    succeeds(&mut apply(at, &[&["cartoon", "video.mp4", "steady.mp4"][..], &steady].concat()));
    let difference = difference(at, "still.mp4", "steady.mp4");
    assert!(difference > 0.02 && difference < 8.0, "{difference} of 255");
}

#[test]
fn streams_go_through_pipes() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "video.mp4", "-pix_fmt yuv420p");
    ffmpeg(at, "-i video.mp4 -f yuv4mpegpipe video.y4m");
    succeeds(&mut apply(at, &["ink", "video.y4m", "file.y4m"]));
    let piped = |to: &str| {
        let mut command = apply(at, &["ink", "-", to]);
        let input = fs::File::open(at.join("video.y4m")).expect("a video");
        command.stdin(input).stdout(Stdio::piped()).output().expect("the program runs")
    };
    let output = piped("-");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stdout.starts_with(b"YUV4MPEG2 W160 H90"));
    assert!(
        output.stdout == fs::read(at.join("file.y4m")).expect("a video"),
        "pipes and files hold the same"
    );
    assert!(piped("piped.mp4").status.success());
    assert_eq!(probe(&at.join("piped.mp4"), "v:0", "width,height"), "160,90");
}

#[test]
fn bad_videos_are_refused_and_nothing_is_left() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "video.mp4", "-pix_fmt yuv420p");
    let bytes = fs::read(at.join("video.mp4")).expect("a video");
    fs::write(at.join("cut.mp4"), &bytes[..bytes.len() / 2]).expect("the folder is writable");
    fs::write(at.join("text.mp4"), "no video").expect("the folder is writable");
    ffmpeg(at, "-f lavfi -i sine=d=1 -c:a aac sound.mp4");
    let before = listing(at);
    let refused = |args: &[&str], words: &[&str]| fails(&mut apply(at, args), 2, words);
    refused(&["ink", "missing.mp4", "out.mp4"], &["missing.mp4"]);
    refused(&["ink", "text.mp4", "out.mp4"], &["text.mp4", "ffmpeg"]);
    refused(&["ink", "cut.mp4", "out.mp4"], &["cut.mp4", "ffmpeg"]);
    refused(&["ink", "sound.mp4", "out.mp4"], &["sound.mp4", "no pictures"]);
    refused(&["ink", "video.mp4", "video.mp4"], &["is the input"]);
    refused(&["ink", "video.mp4", "out.png"], &["out.png", "a video becomes a video"]);
    refused(&["ink", "video.mp4", "no/out.mp4"], &["no/out.mp4"]);
    refused(&["ink", "video.mp4", "out.mp4", "--frames", "1-2"], &["--frames"]);
    refused(&["ink", "video.mp4", "out.mp4", "--encode", "-c:v nonsense"], &["out.mp4", "nonsense"]);
    let mut command = apply(at, &["ink", "-", "out.mp4"]);
    fails(command.stdin(Stdio::null()), 2, &["standard input", "YUV4MPEG"]);
    let mut command = apply(at, &["ink", "video.mp4", "out.mp4"]);
    fails(command.env("ISOPHOTE_FFMPEG", "/nowhere"), 1, &["ffmpeg", "install"]);
    assert_eq!(listing(at), before, "nothing half-written is left");
}

#[test]
fn scenes_become_videos() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    support::cube(at);
    let render = |args: &[&str]| {
        let mut command = isophote();
        command.current_dir(at).args(["render", "cube.gltf"]).args(args).args(["--size", "97x64"]);
        command
    };
    let turn = ["--turntable", "--frames", "4"];
    let (text, _) = succeeds(&mut render(&[&["turn.mp4", "--fps", "12", "--json"][..], &turn].concat()));
    let events: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("lines of JSON")).collect();
    let kinds: Vec<&str> = events.iter().filter_map(|e| e["event"].as_str()).collect();
    assert_eq!(kinds, ["start", "frame", "frame", "frame", "frame", "end"]);
    assert_eq!((&events[0]["frames"], &events[5]["written"]), (&4.into(), &4.into()));
    assert_eq!((&events[2]["frame"], &events[2]["status"]), (&2.into(), &"written".into()));
    // A last odd column is left out.
    assert_eq!(
        probe(&at.join("turn.mp4"), "v:0", "width,height,pix_fmt,r_frame_rate,nb_frames"),
        "96,64,yuv420p,12/1,4"
    );
    // The pictures of the sequence, but for what is lost on the way.
    succeeds(&mut render(&[&["turn.png"][..], &turn].concat()));
    ffmpeg(at, "-framerate 12 -i turn.%04d.png -vf crop=96:64:0:0 -c:v ffv1 -pix_fmt gray own.mkv");
    let difference = difference(at, "turn.mp4", "own.mkv");
    assert!(difference < 3.0, "{difference} of 255");
    let before = listing(at);
    let (text, _) = succeeds(&mut render(&["turn.mp4", "--skip-existing", "--json"]));
    assert!(text.contains("skipped"), "{text}");
    let refused = |args: &[&str], words: &[&str]| fails(&mut render(args), 2, words);
    refused(&["out.mp4", "--encode", "-c:v nonsense"], &["out.mp4", "nonsense"]);
    refused(&["out.png", "--encode", "-c:v libx264"], &["--encode", "videos"]);
    refused(&["no/out.mp4"], &["no/out.mp4"]);
    refused(&["-"], &["is not a kind of picture"]);
    fails(render(&["out.mp4"]).env("ISOPHOTE_FFMPEG", "/nowhere"), 1, &["ffmpeg", "install"]);
    assert_eq!(listing(at), before, "nothing half-written is left");
}
