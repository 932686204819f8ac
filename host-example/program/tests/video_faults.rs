//! Videos that are hostile, damaged or cut short, and places that do not hold the result: nothing runs or is read that was
//! not asked for, and no video is called written that is not whole.

use std::fs::{self, File};
use std::path::Path;
use std::process::Command;

use isophote_window::jobs::document::{Document, Options};

use crate::support::{IN_PIXELS, cube, fails, isophote, listing, succeeds, video_folder};

const FRAMES: u64 = 50;

fn ffmpeg(folder: &Path, args: &str) {
    let mut command = Command::new("ffmpeg");
    succeeds(command.current_dir(folder).args(["-v", "error", "-y"]).args(args.split(' ')));
}

/// Two seconds of moving stripes.
fn clip(folder: &Path, name: &str, more: &str) {
    ffmpeg(folder, &format!("-f lavfi -i testsrc2=s=160x90:r=25:d=2 {more} {name}"));
}

const H264: &str = "-c:v libx264 -g 12 -pix_fmt yuv420p -movflags +faststart";

fn apply(folder: &Path, args: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(["apply", "gaussian"]).args(args).args(IN_PIXELS);
    command.args(["--backend", "cpu", "--force"]);
    command
}

/// Frames of a file.
fn count(file: &Path) -> u64 {
    let mut command = Command::new("ffprobe");
    command.args(["-v", "error", "-select_streams", "v:0", "-count_frames", "-of", "csv=p=0"]);
    let text = succeeds(command.args(["-show_entries", "stream=nb_read_frames"]).arg(file)).0;
    text.trim().trim_end_matches(',').parse().expect("a number")
}

/// Writes the first part of a file.
fn cut(folder: &Path, from: &str, to: &str, share: f64) {
    let bytes = fs::read(folder.join(from)).expect("a file");
    let length = (bytes.len() as f64 * share) as usize;
    fs::write(folder.join(to), &bytes[..length]).expect("the folder is writable");
}

#[test]
fn headers_of_streams_run_no_filter() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    // Filters that write files of their own; the names have no colon, which separates options.
    for place in [
        "A1:1,vidstabdetect=result=written",
        "A1:1,signature=filename=written",
        "F25:1,signature=filename=written",
        "XCOLORRANGE=FULL,signature=filename=written",
    ] {
        let mut stream = format!("YUV4MPEG2 W16 H16 C420jpeg {place}\n").into_bytes();
        (0..3).for_each(|_| stream.extend(b"FRAME\n".iter().copied().chain([90; 384])));
        fs::write(at.join("in.y4m"), &stream).expect("the folder is writable");
        for input in ["-", "in.y4m"] {
            let mut command = apply(at, &[input, "out.mp4"]);
            command.stdin(File::open(at.join("in.y4m")).expect("a file"));
            let (text, said) = succeeds(&mut command);
            assert_eq!(listing(at), ["in.y4m", "out.mp4"], "{place} writes a file");
            assert!(text.starts_with("3 frames written"), "{place}: {text}");
            assert_eq!(count(&at.join("out.mp4")), 3);
            // No rate and no aspect but good ones are told.
            assert_eq!(said.lines().count(), 1, "{place}: {said}");
            assert_eq!(said.contains("aspect"), place.starts_with('A'), "{place}: {said}");
            assert!(said.contains("rate of frames"), "{place}: {said}");
        }
    }
}

#[test]
fn playlists_are_no_videos() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "in.ts", "-c:v libx264 -pix_fmt yuv420p");
    let hls = "#EXTM3U\n#EXT-X-VERSION:3\n#EXT-X-TARGETDURATION:2\n#EXTINF:2.0,\nin.ts\n#EXT-X-ENDLIST\n";
    for name in ["list.mp4", "list.mkv", "list.ts", "list.y4m"] {
        for text in ["ffconcat version 1.0\nfile in.ts\n", hls] {
            fs::write(at.join(name), text).expect("the folder is writable");
            fails(&mut apply(at, &[name, "out.mp4"]), 2, &[name, "playlist", "name the video itself"]);
            let opened = Document::open(&at.join(name), &Options::default());
            assert!(opened.is_err_and(|e| e.to_string().contains("playlist")), "{name} opens");
        }
    }
    assert!(!at.join("out.mp4").exists());
}

#[test]
fn videos_that_are_cut_short_are_not_written_in_silence() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (name, codec) in [
        ("a.mp4", H264),
        ("a.mkv", "-c:v libx264 -pix_fmt yuv420p"),
        ("a.webm", "-c:v libvpx-vp9 -deadline realtime -pix_fmt yuv420p"),
        ("a.avi", "-c:v mpeg4"),
        ("a.mxf", "-c:v mpeg2video"),
        ("a.y4m", "-pix_fmt yuv420p"),
    ] {
        clip(at, name, codec);
        let extension = name.trim_start_matches('a');
        let (cut_name, out) = (format!("cut{extension}"), format!("out{extension}"));
        cut(at, name, &cut_name, 0.405);
        let before = listing(at);
        fails(&mut apply(at, &[&cut_name, &out]), 1, &[&cut_name, "cut short", "--on-error skip"]);
        assert_eq!(listing(at), before, "{name}: nothing is written");
        let (text, said) = succeeds(&mut apply(at, &[&cut_name, &out, "--on-error", "skip"]));
        let written = count(&at.join(&out));
        assert!((10..FRAMES).contains(&written), "{name}: {written} frames");
        assert!(text.starts_with(&format!("{written} frames written")), "{name}: {text}");
        assert!(said.starts_with("warning: ") && said.contains("cut short"), "{name}: {said}");
        assert!(said.contains(&format!("{written} frames could be decoded")), "{name}: {said}");
        if !extension.ends_with("y4m") {
            assert!(said.contains("50 frames"), "{name}: {said}");
        }
        let (text, said) = succeeds(&mut apply(at, &[name, &out]));
        assert!(text.starts_with("50 frames written") && said.is_empty(), "{name}: {text}{said}");
    }
}

#[test]
fn streams_that_are_cut_short_are_not_written_in_silence() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "a.y4m", "-pix_fmt yuv420p");
    cut(at, "a.y4m", "cut.y4m", 0.405);
    // The numbers that programs get say the same as the sentences.
    let output = apply(at, &["cut.y4m", "out.mp4", "--json"]).output().expect("the program runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let end = text.lines().last().expect("an end");
    let end: serde_json::Value = serde_json::from_str(end).expect("lines of JSON");
    assert_eq!((&end["event"], &end["written"]), (&"end".into(), &0.into()), "{text}");
    // Not one frame is whole.
    let mut command = apply(at, &["-", "out.mp4"]);
    fs::write(at.join("piped"), "YUV4MPEG2 W160 H90 F25:1 C420jpeg\nFRAME\nabc")
        .expect("the folder is writable");
    command.stdin(File::open(at.join("piped")).expect("a file"));
    fails(&mut command, 1, &["3 of 21600 bytes of frame 1", "0 frames could be decoded"]);
    fails(
        command.args(["--on-error", "skip"]).stdin(File::open(at.join("piped")).expect("a file")),
        2,
        &["no frames"],
    );
    // A pipe that breaks within a frame, or ends with something else.
    let stream = fs::read(at.join("a.y4m")).expect("a file");
    for (length, more, words) in [
        (stream.len() - 100, &b""[..], ["21500 of 21600 bytes of frame 50", "49 of 50"]),
        (stream.len(), b"FRAM", ["after 50 frames", "50"]),
    ] {
        fs::write(at.join("piped"), [&stream[..length], more].concat()).expect("the folder is writable");
        let mut command = apply(at, &["-", "pipe.mp4"]);
        command.stdin(File::open(at.join("piped")).expect("a file"));
        fails(&mut command, 1, &["standard input", words[0], "frames could be decoded"]);
        assert!(!at.join("pipe.mp4").exists());
    }
}

#[test]
fn damaged_videos_are_not_written_in_silence() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    for (name, codec) in [
        ("a.mp4", H264),
        ("a.mkv", "-c:v libx264 -pix_fmt yuv420p"),
        ("a.avi", "-c:v mpeg4"),
        ("a.ts", "-c:v mpeg2video"),
        ("a.mov", "-c:v prores_ks"),
    ] {
        clip(at, name, codec);
        let bad = format!("bad-{name}");
        let mut bytes = fs::read(at.join(name)).expect("a file");
        let middle = bytes.len() / 2;
        bytes[middle..middle + 400].fill(0xA5);
        fs::write(at.join(&bad), bytes).expect("the folder is writable");
        let before = listing(at);
        fails(&mut apply(at, &[&bad, "out.mkv"]), 1, &[&bad, " 50 frames", "use an intact file"]);
        assert_eq!(listing(at), before, "{name}: nothing is written");
        let (text, said) = succeeds(&mut apply(at, &[&bad, "out.mkv", "--on-error", "skip"]));
        let written = count(&at.join("out.mkv"));
        assert!((20..=FRAMES).contains(&written) && text.starts_with(&format!("{written} frames")), "{text}");
        let numbers =
            [format!("and {written} of 50 frames could be"), format!("and {written} frames could be")];
        assert!(numbers.iter().any(|n| said.contains(n)) && said.contains("50 frames"), "{name}: {said}");
        fs::remove_file(at.join("out.mkv")).expect("it was written");
    }
    // Sound that breaks off is copied short only where that was asked for.
    let sound = "-f lavfi -i sine=d=9 -c:a pcm_s16le";
    ffmpeg(at, &format!("-f lavfi -i testsrc2=s=160x90:r=25:d=1 {sound} {H264} sound.mov"));
    cut(at, "sound.mov", "short.mov", 0.6);
    fails(&mut apply(at, &["short.mov", "out.mov"]), 1, &["short.mov", "cut short", "partial file"]);
    let (_, said) = succeeds(&mut apply(at, &["short.mov", "out.mov", "--on-error", "skip"]));
    assert!(said.contains("partial file") && said.contains("25 frames could be decoded"), "{said}");
    let mut pictures = apply(at, &["a.png", "b.png", "--on-error", "skip"]);
    fails(&mut pictures, 2, &["--on-error", "is for videos"]);
}

#[test]
fn whole_videos_pass_whatever_their_containers_count() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    let x264 = "-c:v libx264 -g 30 -bf 3 -pix_fmt yuv420p";
    let uneven = format!("-vf select=gt(mod(n\\,4)\\,0) -fps_mode vfr {x264}");
    let few = format!("-vf select=not(eq(n\\,20)) -fps_mode vfr {x264}");
    for (name, codec) in [
        ("a.mp4", x264),
        ("parts.mp4", "-c:v libx264 -g 12 -movflags frag_keyframe+empty_moov"),
        ("late.mkv", "-c:v libx264 -output_ts_offset 3.3"),
        ("uneven.mp4", &uneven),
        ("uneven.mkv", &uneven),
        ("few.mkv", &few),
        // Packets that show nothing.
        ("hidden.webm", "-c:v libvpx -auto-alt-ref 1 -lag-in-frames 16 -b:v 300k"),
        ("a.ts", x264),
        ("rgb.mp4", "-c:v libx264rgb"),
    ] {
        clip(at, name, codec);
        let (text, said) = succeeds(&mut apply(at, &[name, "out.mkv"]));
        let written = count(&at.join("out.mkv"));
        assert!(written > 30 && text.starts_with(&format!("{written} frames")), "{name}: {text}");
        assert_eq!(said, "", "{name}");
    }
    // Frames before the cut are there and not shown.
    ffmpeg(at, "-ss 0.81 -i a.mp4 -c copy trimmed.mp4");
    // Sound that lasts longer than the pictures.
    ffmpeg(at, "-i a.mp4 -f lavfi -i sine=d=9 -c:v copy long.mkv");
    for (name, encode) in [
        ("trimmed.mp4", "-c:v libx264"),
        ("long.mkv", "-c:v libx264"),
        ("hidden.webm", "-c:v libvpx -auto-alt-ref 1 -lag-in-frames 16 -b:v 300k"),
    ] {
        let output = format!("out-{name}");
        let (_, said) = succeeds(&mut apply(at, &[name, &output, "--encode", encode]));
        assert_eq!(said, "", "{name}");
        assert_eq!(count(&at.join(name)), count(&at.join(&output)), "{name}");
    }
}

#[test]
fn a_video_without_all_frames_is_not_called_written() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "a.mp4", H264);
    let before = listing(at);
    let encode = |options: &str| apply(at, &["a.mp4", "out.mp4", "--encode", options]);
    let fewer = "-c:v libx264 -vf fps=5,format=yuv420p";
    fails(&mut encode(fewer), 1, &["out.mp4", "10 frames of 50", "--encode must keep"]);
    fails(&mut encode("-c:v libx264 -r 5"), 2, &["--encode", "-r changes how many frames"]);
    // What is said first says why.
    fails(&mut encode("-c:v libx264 -crf nonsense"), 2, &["out.mp4", "'nonsense'"]);
    assert_eq!(listing(at), before);
    cube(at);
    let mut render = isophote();
    render.current_dir(at).args(["render", "cube.gltf", "turn.mp4", "--size", "64x48", "--turntable"]);
    render.args(["--frames", "12", "--encode", "-c:v libx264 -vf fps=5,format=yuv420p"]);
    fails(&mut render, 1, &["turn.mp4", "of 12"]);
    render.args(["--fps", "1e9"]);
    fails(&mut render, 2, &["turn.mp4", "frames a second"]);
    assert!(!at.join("turn.mp4").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn full_disks_hold_no_video() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "a.mp4", H264);
    cube(at);
    fs::create_dir(at.join("small")).expect("the folder is writable");
    let before = listing(at);
    // A limit on the size of files fails as a full disk does once its signal is ignored, and else ends the encoder.
    let limited = |script: &str, args: &[&str]| {
        let mut command = Command::new("sh");
        command.current_dir(at).env("ISOPHOTE_LIBRARY", crate::support::library());
        command.args(["-c", &format!("{script}; exec \"$0\" \"$@\"")]).arg(env!("CARGO_BIN_EXE_isophote"));
        command.args(args);
        command
    };
    let ignored = "trap '' XFSZ; ulimit -f 2";
    for output in ["out.mp4", "out.mov", "out.mkv", "out.webm", "out.avi", "out.mxf", "out.ts", "out.y4m"] {
        let args = ["apply", "gaussian", "a.mp4", output, "--backend", "cpu", "--lengths", "pixels"];
        fails(&mut limited(ignored, &args), 1, &[output, "cannot be written", "too large"]);
        assert_eq!(listing(at), before, "{output}");
    }
    let args = ["apply", "gaussian", "a.mp4", "out.mp4", "--backend", "cpu", "--lengths", "pixels"];
    fails(&mut limited("ulimit -c 0; ulimit -f 2", &args), 1, &["out.mp4", "is not whole", "signal"]);
    let render = ["render", "cube.gltf", "turn.mkv", "--size", "128x96", "--turntable", "--frames", "12"];
    fails(&mut limited(ignored, &render), 1, &["turn.mkv", "cannot be written"]);
    assert_eq!(listing(at), before);
    // Where a disk may be mounted, it is a small one.
    let mount = "mount -t tmpfs -o size=16k none small || exit 99";
    let is_allowed = Command::new("unshare").args(["-rm", "sh", "-c", mount]).current_dir(at).output();
    if !is_allowed.is_ok_and(|output| output.status.success()) {
        eprintln!("\n*** no disk may be mounted here: the limit of files stands for it ***\n");
        return;
    }
    for output in ["small/out.mp4", "small/out.mkv", "small/out.avi", "small/out.y4m"] {
        let inner = limited(
            mount,
            &["apply", "gaussian", "a.mp4", output, "--backend", "cpu", "--lengths", "pixels"],
        );
        let mut command = Command::new("unshare");
        command.current_dir(at).env("ISOPHOTE_LIBRARY", crate::support::library());
        command.args(["-rm", "sh"]).args(inner.get_args());
        fails(&mut command, 1, &[output, "cannot be written", "the disk is full"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_takes_no_more_is_no_success() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "a.mp4", H264);
    // One frame stays within what ffmpeg holds back to the end.
    ffmpeg(at, "-i a.mp4 -frames:v 1 -vf scale=16:16 one.mp4");
    for input in ["a.mp4", "one.mp4"] {
        let mut full = apply(at, &[input, "-"]);
        full.stdout(File::options().write(true).open("/dev/full").expect("/dev/full"));
        let mut closed = apply(at, &[input, "-"]);
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        closed.stdout(writer);
        for (mut command, why) in [(full, "No space left"), (closed, "Broken pipe")] {
            let output = command
                .stderr(std::process::Stdio::piped())
                .spawn()
                .and_then(std::process::Child::wait_with_output);
            let output = output.expect("the program runs");
            let said = crate::support::errors(&output);
            assert_eq!(output.status.code(), Some(1), "{said}");
            assert!(
                said.starts_with("error: cannot write to standard output") && said.contains(why),
                "{said}"
            );
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }
}
