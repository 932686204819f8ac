//! `apply` on sequences: which frames, what is skipped, what is left when it is stopped, and presets with
//! keyframes; and from videos to sequences and back.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::support::video::{case, clip, difference, ffmpeg, probe};
use crate::support::{self, IN_PIXELS, fails, folder, isophote, listing, succeeds, video_folder};

/// Writes frames that differ; returns their names.
fn frames(folder: &Path, numbers: impl Iterator<Item = u32>, size: usize) -> Vec<String> {
    let write = |frame: u32| {
        let name = format!("in.{frame:04}.exr");
        exr::prelude::write_rgba_file(folder.join(&name), size, size / 2, |x, y| {
            let wave = ((x as f32 * 0.3 + frame as f32).sin() * (y as f32 * 0.2).cos()).abs();
            (wave * 2.0, (x % 17) as f32 / 17.0, if (x / 8 + y / 8) % 2 == 0 { 0.9f32 } else { 0.1 }, 1.0f32)
        })
        .expect("the frame can be written");
        name
    };
    numbers.map(write).collect()
}

fn apply(folder: &Path, more: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).arg("apply").args(more).args(IN_PIXELS).args(["--backend", "cpu"]);
    command
}

const INPUT: &str = "in.####.exr";
const OUTPUT: &str = "out/o.####.exr";

#[test]
fn frames_are_found_and_chosen() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1001..=1006, 32);
    fs::create_dir(at("out")).expect("a folder");
    let run = |more: &[&str]| succeeds(&mut apply(folder.path(), more));
    let (text, _) = run(&["gaussian", INPUT, OUTPUT, "--dry-run", "--frames", "1001-1005x2"]);
    assert!(
        text.contains("in.1005.exr -> out/o.1005.exr") && text.contains("3 frames to be written"),
        "{text}"
    );
    assert!(listing(&at("out")).is_empty());

    let (text, _) = run(&["gaussian", INPUT, OUTPUT, "--frames", "1001-1005x2,1006"]);
    assert!(text.contains("4 frames written"), "{text}");
    assert_eq!(listing(&at("out")), ["o.1001.exr", "o.1003.exr", "o.1005.exr", "o.1006.exr"]);

    // A frame by itself gives the same file.
    run(&["gaussian", "in.1003.exr", "single.exr"]);
    let bytes = |name: &str| fs::read(at(name)).expect("a result");
    assert_eq!(bytes("single.exr"), bytes("out/o.1003.exr"));

    // Little memory: one frame after the other, and the same files.
    run(&["gaussian", INPUT, "one.####.exr", "--frames", "1001,1003", "--memory", "64MiB", "--threads", "1"]);
    assert_eq!(bytes("one.1003.exr"), bytes("out/o.1003.exr"));
}

#[test]
fn whole_frames_are_skipped() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1001..=1006, 32);
    fs::create_dir(at("out")).expect("a folder");
    let run = |more: &[&str]| succeeds(&mut apply(folder.path(), more));
    let events = |more: &[&str]| -> Vec<Value> {
        let (text, _) = run(&[more, &["--json"]].concat());
        text.lines().map(|line| serde_json::from_str(line).expect("lines of JSON")).collect()
    };
    let statuses = |events: &[Value]| -> Vec<String> {
        let frame = |e: &&Value| e["event"] == "frame";
        events
            .iter()
            .filter(frame)
            .map(|e| format!("{}:{}", e["frame"], e["status"].as_str().unwrap_or("")))
            .collect()
    };
    run(&["gaussian", INPUT, OUTPUT, "--frames", "1001-1005x2,1006"]);
    // What is whole stays; what is cut is written again. Other ways to write a pattern.
    let whole = fs::read(at("out/o.1005.exr")).expect("a result");
    fs::write(at("out/o.1005.exr"), &whole[..900]).expect("the folder is writable");
    let events = events(&["gaussian", "in.%04d.exr", "out/o.@@@@.exr", "--skip-existing"]);
    let mut found = statuses(&events);
    found.sort();
    assert_eq!(
        found,
        ["1001:skipped", "1002:written", "1003:skipped", "1004:written", "1005:written", "1006:skipped"]
    );
    assert_eq!(events.last().map(|e| (&e["event"], &e["written"])), Some((&"end".into(), &3.into())));
    assert_eq!(listing(&at("out")).len(), 6);
}

#[test]
fn missing_frames_are_named_before_any_work() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1001..=1006, 32);
    let run = |more: &[&str]| succeeds(&mut apply(folder.path(), more));
    let refused = |more: &[&str], words: &[&str]| fails(&mut apply(folder.path(), more), 2, words);
    refused(&["gaussian", INPUT, "no.####.exr", "--memory", "5k"], &["--memory", "a frame needs about"]);

    refused(
        &["gaussian", INPUT, "no.####.exr", "--frames", "1005-1009,2000"],
        &["frames 1007-1009,2000", "--on-missing"],
    );
    refused(&["gaussian", "in.####.exr", "no.exr"], &["no.exr", "frame number"]);
    refused(&["gaussian", "in.1001.exr", "no.exr", "--frames", "1-2"], &["in.1001.exr", "frame number"]);
    refused(&["gaussian", "nothing.####.exr", "no.####.exr"], &["matches no file"]);
    refused(&["gaussian", INPUT, "no.####.exr", "--frames", "5-"], &["'5-'", "1001-1100x2"]);
    refused(&["gaussian", INPUT, "missing/no.####.exr"], &["missing/no.1001.exr", "cannot be written"]);
    assert!(!listing(folder.path()).iter().any(|n| n.starts_with("no.") || n.starts_with('.')));
    fs::remove_file(at("in.1002.exr")).expect("a frame");
    refused(&["gaussian", INPUT, "no.####.exr"], &["frames 1002"]);
    let (text, warnings) = run(&["gaussian", INPUT, "some.####.exr", "--on-missing", "skip"]);
    assert!(text.contains("5 frames written") && text.contains("1 missing"), "{text}");
    assert!(warnings.contains("1002"), "{warnings}");
}

#[test]
fn no_frame_takes_more_memory_than_allowed() {
    let folder = folder();
    frames(folder.path(), 1..=1, 32);
    frames(folder.path(), 2..=2, 1024);
    frames(folder.path(), 3..=3, 32);
    let run = |more: &[&str]| {
        apply(folder.path(), &[&["gaussian", INPUT, "o.####.exr", "--memory", "20MiB"], more].concat())
    };
    let output = run(&["--dry-run"]).output().expect("the program can be started");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("2 frames to be written, 1 refused"), "{text}");
    assert!(
        text.contains("in.0002.exr: a frame needs about") && text.contains("20MiB may be used"),
        "{text}"
    );
    assert!(support::errors(&output).contains("1 of 3 frames") && output.status.code() == Some(2));
    fails(
        &mut run(&[]),
        2,
        &["warning: in.0002.exr: a frame needs about", "20MiB may be used", "1 of 3 frames"],
    );
    assert_eq!(
        listing(folder.path()),
        ["in.0001.exr", "in.0002.exr", "in.0003.exr", "o.0001.exr", "o.0003.exr"]
    );
    // By itself, and with enough.
    let one = ["gaussian", "in.0002.exr", "one.exr", "--memory"];
    fails(
        &mut apply(folder.path(), &[&one[..], &["20MiB"]].concat()),
        2,
        &["in.0002.exr", "20MiB", "--memory"],
    );
    succeeds(&mut apply(folder.path(), &[&one[..], &["200MiB"]].concat()));
}

#[test]
fn damaged_frames_are_left_out_and_reported() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1003..=1005, 32);
    let damaged = fs::read(at("in.1004.exr")).expect("a frame");
    fs::write(at("in.1004.exr"), &damaged[..700]).expect("the folder is writable");
    let more = ["gaussian", INPUT, "rest.####.exr", "--frames", "1003-1005"];
    fails(&mut apply(folder.path(), &more), 2, &["warning: in.1004.exr: is damaged", "1 of 3 frames"]);
    assert!(at("rest.1003.exr").is_file() && at("rest.1005.exr").is_file() && !at("rest.1004.exr").exists());
}

/// Two frames at a time are on their way to the device, and each comes back as the one that it is.
#[test]
fn a_device_takes_frames_in_turn() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=7, 48);
    fs::write(at("in.0004.exr"), b"not a picture").expect("a file");
    fs::create_dir(at("out")).expect("a folder");
    let run = |input: &str, output: &str| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", "gaussian", input, output, "--backend", "gpu"]);
        command.arg("--force");
        command.args(IN_PIXELS);
        command
    };
    // Lines tell of frames in their order, however many are on their way.
    let output = run(INPUT, OUTPUT).arg("--json").output().expect("it starts");
    assert!(!output.status.success());
    let text = String::from_utf8(output.stdout).expect("lines of text");
    let events = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("a line of JSON"));
    let written = events.filter(|event| event["status"] == "written");
    let written: Vec<i64> = written.filter_map(|event| event["frame"].as_i64()).collect();
    assert_eq!(written, [1, 2, 3, 5, 6, 7]);
    for frame in written {
        let (input, result) = (format!("in.{frame:04}.exr"), format!("out/o.{frame:04}.exr"));
        succeeds(&mut run(&input, "single.exr"));
        assert!(
            fs::read(at("single.exr")).expect("a result") == fs::read(at(&result)).expect("a result"),
            "{frame}"
        );
    }
}

/// All files of a folder with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    listing(folder).into_iter().map(|n| (n.clone(), fs::read(folder.join(n)).expect("a file"))).collect()
}

#[test]
fn killed_runs_go_on() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=6, 160);
    for name in ["whole", "killed"] {
        fs::create_dir(at(name)).expect("a folder");
    }
    let arguments = |to: &str| ["cartoon", "in.####.exr", &format!("{to}/o.####.exr")].map(str::to_owned);
    let run = |to: &str| {
        let mut command = isophote();
        command.current_dir(folder.path()).arg("apply").args(arguments(to)).args(["--backend", "cpu"]);
        command
    };
    let started = std::time::Instant::now();
    succeeds(&mut run("whole"));
    let time = started.elapsed();
    let whole = contents(&at("whole"));
    assert_eq!(whole.len(), 6);
    let mut random = 12345u64;
    for round in 0..10 {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut child = run("killed")
            .arg("--skip-existing")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a process");
        std::thread::sleep(time.mul_f64((random >> 33) as f64 / f64::from(1u32 << 31)));
        child.kill().expect("the process can be killed");
        child.wait().expect("the process ended");
        for (name, bytes) in contents(&at("killed")).iter().filter(|(n, _)| !n.starts_with('.')) {
            assert!(whole.iter().any(|(n, b)| n == name && b == bytes), "round {round}: {name} is another");
        }
        // Half of the rounds begin anew, so that some are killed early.
        if round % 2 == 1 {
            for name in listing(&at("killed")) {
                fs::remove_file(at("killed").join(name)).expect("a file");
            }
        }
    }
    succeeds(run("killed").arg("--skip-existing"));
    assert!(contents(&at("killed")) == whole, "{:?}", listing(&at("killed")));
}

#[cfg(unix)]
#[test]
fn interrupted_runs_leave_whole_files() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=40, 160);
    fs::create_dir(at("out")).expect("a folder");
    let child = apply(folder.path(), &["cartoon", "in.####.exr", "out/o.####.exr"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a process");
    let patience = std::time::Instant::now();
    while listing(&at("out")).iter().all(|n| n.starts_with('.'))
        && patience.elapsed() < std::time::Duration::from_secs(60)
    {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let status = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(status.success());
    let output = child.wait_with_output().expect("the process ended");
    assert_eq!(output.status.code(), Some(1), "{}", support::errors(&output));
    assert!(support::errors(&output).contains("start again with --skip-existing"));
    let left = listing(&at("out"));
    assert!(!left.is_empty() && left.len() < 40 && left.iter().all(|n| n.starts_with("o.")), "{left:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn full_disks_and_read_only_folders_are_reported() {
    let folder = folder();
    frames(folder.path(), 1..=2, 256);
    // A limit on the size of files fails as a full disk does, once its signal is ignored.
    let mut command = Command::new("sh");
    command.current_dir(folder.path()).env("ISOPHOTE_LIBRARY", support::library());
    command.args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\""]).arg(env!("CARGO_BIN_EXE_isophote"));
    command.args(["apply", "gaussian", "in.####.exr", "o.####.exr", "--backend", "cpu"]);
    fails(&mut command, 1, &["o.0001.exr", "cannot be written", "too large"]);
    assert_eq!(listing(folder.path()), ["in.0001.exr", "in.0002.exr"]);
    // Not even the superuser writes there.
    let more = ["gaussian", "in.####.exr", "/proc/o.####.exr"];
    fails(&mut apply(folder.path(), &more), 2, &["/proc/o.0001.exr", "cannot be written"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_has_its_own_sentence() {
    let folder = folder();
    frames(folder.path(), 1..=2, 256);
    fs::create_dir(folder.path().join("small")).expect("a folder");
    let picture = image::RgbImage::from_fn(256, 256, |x, y| {
        image::Rgb([(x * y) as u8, (x ^ y) as u8, (x * x + y) as u8])
    });
    picture.save(folder.path().join("in.png")).expect("the picture can be written");
    for (input, output) in
        [("in.####.exr", "small/o.####.exr"), ("in.png", "small/o.png"), ("in.png", "small/o.tif")]
    {
        let more = ["apply", "gaussian", input, output, "--set", "mix=0", "--backend", "cpu"];
        let Some(mut command) = support::on_a_small_disk(folder.path(), [""; 2], &more) else { return };
        fails(&mut command, 1, &["small/o.", "cannot be written: the disk is full", "make room"]);
    }
}

#[test]
fn keyframes_follow_the_frames() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    frames(folder.path(), 1..=3, 48);
    let preset = r#"{"style": "gaussian", "parameters": {"sigma": {"1": 1, "3": 4}}}"#;
    fs::write(at("keys.json"), preset).expect("the folder is writable");
    succeeds(&mut apply(folder.path(), &["--preset", "keys.json", "in.####.exr", "key.####.exr"]));
    succeeds(&mut apply(folder.path(), &["keys.json", "in.####.exr", "too.####.exr"]));
    let bytes = |name: &str| fs::read(at(name)).expect("a result");
    for (frame, sigma) in [(1, "1"), (2, "2.5"), (3, "4")] {
        let (input, set) = (format!("in.{frame:04}.exr"), format!("sigma={sigma}"));
        succeeds(&mut apply(folder.path(), &["gaussian", &input, "one.exr", "--set", &set, "--force"]));
        assert_eq!(bytes("one.exr"), bytes(&format!("key.{frame:04}.exr")), "frame {frame}");
        assert_eq!(bytes("one.exr"), bytes(&format!("too.{frame:04}.exr")), "frame {frame}");
    }
    let more = ["--preset", "keys.json", "gaussian", "in.0001.exr", "no.exr"];
    fails(&mut apply(folder.path(), &more), 2, &["--preset", "the preset names the style"]);
}

#[test]
fn frames_of_a_video_become_numbered_pictures() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "video.mp4", "-pix_fmt yuv420p -t 0.2");
    let (text, warnings) = succeeds(&mut apply(at, &["gaussian", "video.mp4", "out.####.png"]));
    assert!(text.contains("6 frames written") && text.contains("out.####.png"), "{text}");
    assert!(warnings.contains("sound") && warnings.lines().count() == 1, "{warnings}");
    // The same as of pictures that ffmpeg takes out.
    ffmpeg(
        at,
        "-i video.mp4 -vf scale=flags=bicubic+accurate_rnd+full_chroma_int+full_chroma_inp -pix_fmt rgb24 in.%04d.png",
    );
    succeeds(&mut apply(at, &["gaussian", "in.####.png", "own.####.png"]));
    for number in 1..=6 {
        let open = |name: &str| image::open(at.join(format!("{name}.000{number}.png"))).expect("a picture");
        let [made, own] = [open("out"), open("own")];
        assert_eq!((made.color(), made.width()), (own.color(), 160));
        let sum: u64 =
            made.as_bytes().iter().zip(own.as_bytes()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        assert!(sum < made.as_bytes().len() as u64, "frame {number} differs by {sum}");
    }
    let before = listing(at);
    assert!(
        before.contains(&"out.0006.png".into()) && !before.contains(&"out.0007.png".into()),
        "{before:?}"
    );
    // A run that was interrupted goes on, and nothing is replaced unasked.
    fails(&mut apply(at, &["ink", "video.mp4", "out.####.png"]), 2, &["out.0001.png", "--skip-existing"]);
    fs::remove_file(at.join("out.0004.png")).expect("a picture");
    let (text, _) = succeeds(&mut apply(at, &["ink", "video.mp4", "out.####.png", "--skip-existing"]));
    assert!(text.contains("1 frames written") && text.contains("5 there already"), "{text}");
    assert_eq!(listing(at), before);
    let few = ["ink", "video.mp4", "few.%03d.exr", "--frames", "2,4"];
    succeeds(&mut apply(at, &few));
    let made: Vec<String> = listing(at).into_iter().filter(|name| name.starts_with("few")).collect();
    assert_eq!(made, ["few.002.exr", "few.004.exr"]);
    fails(&mut apply(at, &["ink", "video.mp4", "far.#.jpg", "--frames", "9"]), 2, &["video.mp4", "frame 6"]);
    let (_, warnings) = succeeds(&mut apply(
        at,
        &["ink", case("video_vfr/vfr.mp4").to_str().expect("a name"), "vfr.###.jpg", "--frames", "1"],
    ));
    assert!(warnings.contains("unequally long"), "{warnings}");
    succeeds(&mut apply(
        at,
        &["ink", case("pixel_aspect/sar.mp4").to_str().expect("a name"), "sar.#.png", "--frames", "1"],
    ));
    let source =
        isophote_pictures::read::read(&at.join("sar.1.png"), &Default::default()).expect("a picture");
    assert!((source.pictures[0].meaning.pixel_aspect - 8.0 / 9.0).abs() < 0.001);
}

#[test]
fn numbered_pictures_become_a_video() {
    let Some(folder) = video_folder() else { return };
    let at = folder.path();
    clip(at, "video.mp4", "-pix_fmt yuv420p -t 0.2 -colorspace bt709");
    ffmpeg(at, "-i video.mp4 in.%04d.png");
    let before = listing(at);
    for (args, words) in [
        (&["ink", "in.0001.png", "out.mp4"][..], &["out.mp4", "numbered pictures"][..]),
        (&["ink", "in.####.png", "-"], &["made of videos", "out.mp4"]),
        (&["ink", "in.####.png", "out.####.png", "--fps", "9"], &["--fps"]),
        (&["ink", "in.####.png", "out.mp4", "--fps", "0"], &["--fps"]),
        (&["ink", "in.####.png", "out.mp4", "--into", "a"], &["--into"]),
        (&["ink", "in.####.png", "no/out.mp4"], &["no/out.mp4"]),
        (&["ink", "in.####.png", "out.mp4", "--frames", "5-7"], &["in.####.png", "7"]),
    ] {
        fails(&mut apply(at, args), 2, words);
    }
    assert_eq!(listing(at), before, "nothing half-written is left");
    let film = ["gaussian", "in.####.png", "out.mp4", "--set", "sigma=0", "--fps", "12"];
    let (text, _) = succeeds(&mut apply(at, &film));
    assert!(text.contains("6 frames written") && text.contains("out.mp4"), "{text}");
    assert_eq!(probe(&at.join("out.mp4"), "v:0", "width,height,r_frame_rate,nb_frames"), "160,90,12/1,6");
    let difference = difference(at, "video.mp4", "out.mp4");
    assert!(difference < 3.0, "{difference} of 255");
    fails(&mut apply(at, &film), 2, &["out.mp4", "--force"]);
    succeeds(&mut apply(at, &[&film[..], &["--skip-existing"]].concat()));
    // Pixels keep their shape, and masks and steadiness know the frames.
    fs::copy(case("pixel_aspect/imp2.exr"), at.join("wide.1.exr")).expect("the folder is writable");
    fs::copy(case("pixel_aspect/imp2.exr"), at.join("wide.2.exr")).expect("the folder is writable");
    let steady = ["--steadiness", "0.5", "--motion", "estimate"];
    succeeds(&mut apply(at, &[&["cartoon", "wide.#.exr", "wide.mkv"][..], &steady].concat()));
    assert_eq!(probe(&at.join("wide.mkv"), "v:0", "sample_aspect_ratio,r_frame_rate"), "2:1,24/1");
    let mut job = isophote();
    job.current_dir(at).args(["farm", "openjd", "--", "apply", "ink", "in.####.png", "job.mp4"]);
    let output = job.output().expect("the program runs");
    assert!(!output.status.success(), "frames of one video are shared by jobs");
}
