//! `apply` on videos, through the ffmpeg program of the system.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::video::{case, clip, difference, ffmpeg, probe};
use crate::support::{self, IN_PIXELS, fails, isophote, listing, root, succeeds, video_folder};

fn apply(folder: &Path, args: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).arg("apply").args(args).args(IN_PIXELS).args(["--backend", "cpu"]);
    command
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
    refused(&["ink", "video.mp4", "out.png"], &["out.png", "a video has many", "out.####.png"]);
    refused(&["ink", "video.mp4", "out.####.tga"], &["out.####.tga", "not a kind of picture"]);
    refused(&["ink", "video.mp4", "out.####.png", "--frames", "0-2"], &["--frames", "is 1"]);
    refused(&["ink", "video.mp4", "out.####.png", "--encode", "-c:v ffv1"], &["--encode"]);
    refused(&["ink", "video.mp4", "out.mp4", "--fps", "12"], &["--fps"]);
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

/// Changes nothing of a file in the folder of cases, into `output`; returns what was warned of.
fn unchanged(folder: &Path, case: &str, output: &str) -> String {
    let input = root().join("tests/data/cases").join(case);
    let input = input.to_str().expect("a name of letters");
    succeeds(&mut apply(folder, &["gaussian", input, output, "--set", "sigma=0", "--force"])).1
}

/// Frames as raw bytes of this form.
fn raw(file: &Path, form: &str, decoder: &[&str]) -> Vec<u8> {
    let mut command = Command::new("ffmpeg");
    command.args(["-v", "error"]).args(decoder).arg("-i").arg(file);
    command.args(["-map", "0:V:0", "-fps_mode", "passthrough", "-f", "rawvideo", "-pix_fmt", form, "-"]);
    command.output().expect("ffmpeg runs").stdout
}

/// Greatest difference of two videos, of 255.
fn greatest(a: &[u8], b: &[u8]) -> u8 {
    assert!(!a.is_empty() && a.len() == b.len(), "{} and {} bytes", a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

/// Times of pictures, in seconds and in order.
fn times(file: &Path) -> Vec<f64> {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0", "-of", "csv=p=0"]);
    command.args(["-show_entries", "packet=pts_time,flags"]);
    let text = succeeds(command.arg(file)).0;
    // What is marked by D is not shown.
    let shown =
        text.lines().filter_map(|line| line.split_once(',').filter(|(_, flags)| !flags.contains('D')));
    let mut times: Vec<f64> = shown.map(|(time, _)| time.parse().expect("a time")).collect();
    times.sort_by(f64::total_cmp);
    times
}

#[test]
fn cases_of_other_tracks_are_kept_or_made_anew() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (input, output, codecs) in [
        ("srt.mkv", "srt.mp4", "h264 aac mov_text"),
        ("ass.mkv", "ass.mp4", "h264 aac mov_text"),
        ("a.mp4", "a.webm", "vp9 opus"),
        ("movtext.mp4", "movtext.mkv", "h264 aac subrip"),
        ("pcm.mov", "pcm.mp4", "h264 aac"),
        ("pcm.mov", "pcm.mov", "h264 pcm_s16le"),
    ] {
        assert_eq!(unchanged(at, &format!("video_streams/{input}"), output), "", "{output}");
        let mut command = Command::new("ffprobe");
        command.args(["-v", "error", "-show_entries", "stream=codec_name", "-of", "csv=p=0"]);
        let text = succeeds(command.arg(at.join(output))).0;
        let found: Vec<&str> = text.lines().map(|line| line.trim_end_matches(',')).collect();
        assert_eq!(found.join(" "), codecs, "{output}");
    }
    let said = unchanged(at, "video_streams/srt.mkv", "srt.avi");
    assert!(said.lines().count() == 1 && said.contains("subtitles (subrip, track 2)"), "{said}");
}

#[test]
fn cases_of_times_are_kept() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for output in ["late.mp4", "late.mkv", "late.mov"] {
        assert_eq!(unchanged(at, "video_start/late.mp4", output), "", "{output}");
        let [video, sound] = ["v:0", "a:0"].map(|stream| {
            let text = probe(&at.join(output), stream, "start_time");
            text.trim_end_matches(',').parse::<f64>().expect("a time")
        });
        assert!((video - sound - 0.667).abs() < 0.04, "{output}: pictures at {video}, sound at {sound}");
    }
    unchanged(at, "video_timecode/tc.mov", "tc.mov");
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0", "-show_entries", "stream_tags=timecode"]);
    let text = succeeds(command.args(["-of", "csv=p=0"]).arg(at.join("tc.mov"))).0;
    assert_eq!(text.trim(), "01:00:00:00");
    for (input, outputs) in
        [("vfr.mp4", &["vfr.mp4", "vfr.mkv", "vfr.webm"][..]), ("vfrl.mp4", &["vfrl.mov"])]
    {
        let input = format!("video_vfr/{input}");
        let before = times(&case(&input));
        for output in outputs {
            assert_eq!(unchanged(at, &input, output), "", "{output}");
            let after = times(&at.join(output));
            assert_eq!(before.len(), after.len(), "{output}");
            let off = before.iter().zip(&after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 0.0011, "{output}: frames are off by {off} s");
            let [a, b] = [case(&input), at.join(output)].map(|file| raw(&file, "gray", &[]));
            let sum: u64 = a.iter().zip(&b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
            assert!(a.len() == b.len() && sum < 4 * a.len() as u64, "{output} has other frames");
        }
    }
    let said = unchanged(at, "video_vfr/vfr.mp4", "vfr.avi");
    assert!(said.contains("unequally long") && said.lines().count() == 1, "{said}");
}

#[test]
fn cases_of_fields_become_whole_pictures_with_a_warning() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    let said = unchanged(at, "video_interlaced/inter.mp4", "whole.mp4");
    assert!(said.contains("is interlaced") && said.contains("bwdif") && said.lines().count() == 1, "{said}");
    assert_eq!(probe(&at.join("whole.mp4"), "v:0", "field_order,nb_frames"), "progressive,15");
}

#[test]
fn cases_of_red_green_and_blue_are_exact() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (input, output) in [
        ("video_gbr/ffv1.mkv", "ffv1.mkv"),
        ("video_gbr/ffv1.mkv", "ffv1.mp4"),
        ("video_gbr/ffv1.mkv", "ffv1.webm"),
        ("video_gbr/x264rgb.mp4", "x264rgb.mp4"),
        ("video_gbr/x264rgb.mp4", "x264rgb.avi"),
        ("video_rgb_range/png.mov", "png.mov"),
        ("video_rgb_range/oddpng.mov", "oddpng.mkv"),
        ("video_rgb_range/white.mov", "white.mov"),
        ("video_rgb_range/black.mov", "black.mov"),
        ("video_rgb_range/white.mov", "white.mp4"),
        ("video_rgb_range/white.mov", "white.apng"),
    ] {
        unchanged(at, input, output);
        let [before, after] = [case(input), at.join(output)].map(|file| raw(&file, "rgb24", &[]));
        assert!(greatest(&before, &after) <= 1, "{output} differs by {}", greatest(&before, &after));
    }
    // By encoders that hold luma and chroma, too.
    let white = case("video_rgb_range/white.mov");
    let args = [
        "gaussian",
        white.to_str().expect("letters"),
        "x.mov",
        "--set",
        "sigma=0",
        "--encode",
        "-c:v libx264",
    ];
    succeeds(&mut apply(at, &args));
    assert!(raw(&at.join("x.mov"), "rgb24", &[]).iter().all(|value| *value >= 254));
}

#[test]
fn cases_of_odd_sizes_keep_them() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (input, output) in
        [("odd.mkv", "a.mkv"), ("odd.mkv", "a.mp4"), ("odd.webm", "a.webm"), ("odd.webm", "b.mkv")]
    {
        assert_eq!(unchanged(at, &format!("video_odd/{input}"), output), "", "{output}");
        assert_eq!(probe(&at.join(output), "v:0", "width,height"), "161,91", "{output}");
    }
    let said = unchanged(at, "video_odd/odd.mkv", "a.wmv");
    assert!(said.contains("161x91") && said.contains("160x90") && said.lines().count() == 1, "{said}");
    assert_eq!(probe(&at.join("a.wmv"), "v:0", "width,height"), "160,90");
}

#[test]
fn cases_of_containers_are_videos() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (name, others) in [
        ("a.gif", &["a.gif", "a.apng", "a.webp", "gif.mp4"][..]),
        ("a.mpg", &["a.mpg", "mpg.mp4"]),
        ("a.m2ts", &["a.m2ts"]),
        ("a.wmv", &["a.wmv"]),
        ("a.3gp", &["a.3gp", "3gp.gif"]),
        ("a.ogv", &["a.ogv"]),
    ] {
        for output in others {
            let said = unchanged(at, &format!("video_containers/{name}"), output);
            let is_silent = *output == "3gp.gif" || said.is_empty();
            assert!(is_silent, "{name} to {output}: {said}");
            if *output == "a.webp" {
                continue;
            }
            let frames = raw(&at.join(output), "gray", &[]).len() / (160 * 90);
            assert_eq!(frames, 15, "{name} to {output}");
        }
    }
    // Pictures that move are videos, and those that do not are pictures.
    fs::copy(at.join("a.apng"), at.join("moving.png")).expect("the folder is writable");
    for (input, output) in [("a.webp", "webp.mkv"), ("moving.png", "png.mkv")] {
        succeeds(&mut apply(at, &["gaussian", input, output, "--set", "sigma=0"]));
        let [before, after] = [at.join("a.gif"), at.join(output)].map(|file| raw(&file, "rgb24", &[]));
        let sum: u64 = before.iter().zip(&after).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        assert!(before.len() == after.len() && sum < 8 * before.len() as u64, "{input} has other frames");
    }
    fails(&mut apply(at, &["ink", "moving.png", "out.png"]), 2, &["a video has many", ".apng"]);
    // Their frames are pictures with alpha.
    for input in ["a.gif", "a.webp", "moving.png"] {
        succeeds(&mut apply(at, &["ink", input, "frame.##.tif", "--force"]));
        let frames = listing(at).iter().filter(|name| name.starts_with("frame.")).count();
        assert_eq!(frames, 15, "{input}");
    }
    ffmpeg(at, "-i a.gif -frames:v 1 still.webp");
    succeeds(&mut apply(at, &["ink", "still.webp", "still.png"]));
}

#[test]
fn cases_of_alpha_keep_it_where_they_can() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    let vp9 = ["-c:v", "libvpx-vp9"];
    for (input, output, most) in [
        ("pr4444.mov", "pr4444.mov", 2),
        ("pr4444.mov", "pr4444.mkv", 1),
        ("qtrle.mov", "qtrle.mov", 0),
        ("qtrle.mov", "qtrle.mkv", 0),
        ("alpha.webm", "alpha.webm", 12),
        ("alpha.webm", "alpha.mkv", 1),
        ("qtrle.mov", "qtrle.webm", 12),
    ] {
        let input = format!("video_alpha/{input}");
        assert_eq!(unchanged(at, &input, output), "", "{output}");
        let decoder = |name: &str| if name.ends_with("webm") { &vp9[..] } else { &[] };
        let alpha = |file: &Path, name: &str| {
            let pixels = raw(file, "rgba", decoder(name));
            pixels.into_iter().skip(3).step_by(4).collect::<Vec<u8>>()
        };
        let (before, after) = (alpha(&case(&input), &input), alpha(&at.join(output), output));
        let difference = greatest(&before, &after);
        assert!(difference <= most, "{output}: alpha differs by {difference}");
        assert!(before.iter().any(|a| *a < 255), "{input} has alpha");
    }
    let said = unchanged(at, "video_alpha/pr4444.mov", "opaque.mp4");
    assert!(said.contains("cannot hold alpha") && said.lines().count() == 1, "{said}");
}

#[test]
fn cases_of_pixel_aspect_turn_with_the_picture() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (input, size_and_aspect) in [("rotated_sar.mp4", "480,720,9:8"), ("sar.mp4", "720,480,8:9")] {
        assert_eq!(unchanged(at, &format!("pixel_aspect/{input}"), input), "");
        assert_eq!(probe(&at.join(input), "v:0", "width,height,sample_aspect_ratio"), size_and_aspect);
    }
    // Marks are round when they are shown: a dot of pixels that are twice as wide as high.
    ffmpeg(
        at,
        "-f lavfi -i color=black:s=96x96:d=0.1,drawbox=48:48:1:1:white,setsar=2 -c:v ffv1 -pix_fmt gray dot.mkv",
    );
    succeeds(&mut apply(
        at,
        &["gaussian", "dot.mkv", "blur.mkv", "--set", "sigma=6", "--encode", "-c:v ffv1"],
    ));
    let pixels = raw(&at.join("blur.mkv"), "gray16le", &[]);
    let mut sums = [0.0; 3];
    for (index, value) in pixels[..96 * 96 * 2].as_chunks::<2>().0.iter().enumerate() {
        let weight = f64::from(u16::from_le_bytes(*value));
        let [x, y] = [index % 96, index / 96].map(|at| at as f64 - 48.0);
        sums = [sums[0] + weight, sums[1] + weight * x * x, sums[2] + weight * y * y];
    }
    let [across, down] = [sums[1], sums[2]].map(|sum| (sum / sums[0]).sqrt());
    assert!((down / across - 2.0).abs() < 0.25, "{across} pixels across, {down} down");
}
