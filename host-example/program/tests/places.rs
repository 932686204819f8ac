//! Places where files are read and written: what is left untouched, links, pipes, names that are no text, and standard
//! output that nobody reads.

#![cfg(unix)]

use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use crate::support::{IN_PIXELS, cube, errors, fails, folder, isophote, listing, picture, succeeds};

fn apply(folder: &Path, more: &[&str]) -> Command {
    let mut command = isophote();
    command
        .current_dir(folder)
        .args(["apply", "gaussian"])
        .args(more)
        .args(IN_PIXELS)
        .args(["--backend", "cpu"]);
    command
}

/// Everything in a folder with the times at which it changed.
fn state(folder: &Path) -> Vec<(String, SystemTime)> {
    let changed = |path: &Path| fs::metadata(path).and_then(|m| m.modified()).expect("a time");
    let mut all: Vec<_> =
        listing(folder).into_iter().map(|name| (name.clone(), changed(&folder.join(name)))).collect();
    all.push((".".into(), changed(folder)));
    all
}

/// A file that a killed run left long ago.
fn leftover(folder: &Path) {
    let left = File::create(folder.join(".isophote-node11-4194304-abcdef")).expect("the folder is writable");
    left.set_modified(SystemTime::now() - Duration::from_secs(3 * 24 * 3600)).expect("a time");
}

#[test]
fn dry_runs_touch_nothing() {
    let folder = folder();
    picture(24, 16).save(folder.path().join("in.0001.png")).expect("the picture can be written");
    leftover(folder.path());
    let before = state(folder.path());
    for (input, output) in
        [("in.####.png", "out.####.png"), ("in.0001.png", "out.png"), ("in.0001.png", "in.0001.png")]
    {
        let (text, _) = succeeds(&mut apply(folder.path(), &[input, output, "--dry-run", "--in-place"]));
        assert!(text.contains("1 frames to be written"), "{text}");
        assert_eq!(state(folder.path()), before);
    }
    for output in ["missing/out.png", "in.0001.png/out.png"] {
        fails(
            &mut apply(folder.path(), &["in.0001.png", output, "--dry-run"]),
            2,
            &[output, "cannot be written"],
        );
    }
    // Both verbs tidy up when they write.
    succeeds(&mut apply(folder.path(), &["in.0001.png", "out.png"]));
    assert_eq!(listing(folder.path()), ["in.0001.png", "out.png"]);
    leftover(folder.path());
    let scene = cube(folder.path());
    succeeds(
        isophote().current_dir(folder.path()).arg("render").arg(scene).args(["r.png", "--size", "16x16"]),
    );
    assert!(!listing(folder.path()).iter().any(|name| name.starts_with('.')));
}

#[test]
fn results_go_through_links_and_keep_modes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(24, 16).save(at("in.png")).expect("the picture can be written");
    fs::create_dir(at("disk")).expect("the folder is writable");
    picture(8, 8).save(at("disk/out.png")).expect("the picture can be written");
    fs::set_permissions(at("disk/out.png"), fs::Permissions::from_mode(0o604)).expect("the file is ours");
    symlink("disk/out.png", at("out.png")).expect("the folder is writable");
    succeeds(&mut apply(folder.path(), &["in.png", "out.png", "--force"]));
    assert!(at("out.png").is_symlink());
    assert_eq!(image::open(at("disk/out.png")).expect("a picture").width(), 24);
    assert_eq!(fs::metadata(at("disk/out.png")).expect("a file").permissions().mode() & 0o777, 0o604);
    assert_eq!(listing(&at("disk")), ["out.png"]);
}

#[test]
fn pipes_and_devices_are_refused() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(24, 16).save(at("in.png")).expect("the picture can be written");
    assert!(Command::new("mkfifo").arg(at("pipe.png")).status().expect("mkfifo").success());
    symlink("/dev/zero", at("zero.png")).expect("the folder is writable");
    for name in ["pipe.png", "zero.png"] {
        fails(
            &mut apply(folder.path(), &[name, "out.png"]),
            2,
            &[name, "pipe or a device", "to a file first"],
        );
        fails(&mut apply(folder.path(), &["in.png", name]), 2, &[name, "device or a pipe", "name a file"]);
        let skipping = ["in.png", name, "--skip-existing"];
        fails(&mut apply(folder.path(), &skipping), 2, &[name, "device or a pipe"]);
    }
    assert!(fs::metadata(at("pipe.png")).expect("a pipe").file_type().is_fifo());
    assert_eq!(listing(folder.path()), ["in.png", "pipe.png", "zero.png"]);
    // So are styles: nobody waits for one to be written.
    fs::rename(at("pipe.png"), at("pipe.json")).expect("the folder is writable");
    for arguments in [&["apply", "pipe.json", "in.png", "out.png"][..], &["preset", "show", "pipe.json"]] {
        fails(isophote().current_dir(folder.path()).args(arguments), 2, &["pipe.json", "pipe or a device"]);
    }
}

#[test]
fn folders_and_patterns_of_shells_say_how_to_write_them() {
    let folder = folder();
    fs::create_dir(folder.path().join("shot")).expect("the folder is writable");
    fs::write(folder.path().join("shot/notes 2.txt"), "").expect("the folder is writable");
    for frame in [8, 9] {
        let path = folder.path().join(format!("shot/a.00{frame}.png"));
        picture(8, 8).save(path).expect("the picture can be written");
    }
    for input in
        ["shot", "shot/a.*.png", "shot/a.00?.png", "shot/a.{008,009}.png", "shot/*", "shot/a.$FRAME.png"]
    {
        fails(
            &mut apply(folder.path(), &[input, "out.png"]),
            2,
            &[input, "cannot be read", "write shot/a.###.png"],
        );
    }
    // Houdini's own is a pattern, and so is a sign for any number of digits.
    for input in ["shot/a.$F3.png", "shot/a.#.png"] {
        fails(
            &mut apply(folder.path(), &[input, "out.png"]),
            2,
            &["out.png", "has no place for a frame number"],
        );
    }
    let wrong = ["shot/a.####.png", "out.####.png"];
    fails(&mut apply(folder.path(), &wrong), 2, &["matches no file", "write shot/a.###.png"]);
    fails(&mut apply(folder.path(), &[".", "out.png"]), 2, &["is a folder", "name a picture"]);
    fails(&mut apply(folder.path(), &["none.*.png", "out.png"]), 2, &["cannot be read", "name a picture"]);
}

#[test]
fn names_need_not_be_text() {
    let folder = folder();
    let name = |text: &[u8]| OsString::from_vec(text.to_vec());
    let at = |text: &[u8]| folder.path().join(OsStr::from_bytes(text));
    let run = |arguments: &[OsString]| succeeds(isophote().current_dir(folder.path()).args(arguments));
    for frame in ["1", "2"] {
        let bytes = [b"in-\xff.", frame.as_bytes(), b".png"].concat();
        picture(24, 16)
            .save_with_format(at(&bytes), image::ImageFormat::Png)
            .expect("the picture can be written");
    }
    fs::create_dir(at(b"\xfe")).expect("the folder is writable");
    let [apply, gaussian, cpu] = ["apply", "gaussian", "--backend=cpu"].map(OsString::from);
    run(&[
        apply.clone(),
        gaussian.clone(),
        name(b"in-\xff.#.png"),
        name(b"\xfe/out-\xff.##.png"),
        cpu.clone(),
    ]);
    assert!(at(b"\xfe/out-\xff.01.png").is_file() && at(b"\xfe/out-\xff.02.png").is_file());
    let preset = name(b"look-\xff.json");
    run(&["preset".into(), "save".into(), gaussian.clone(), preset.clone(), "--set=sigma=3".into()]);
    run(&["preset".into(), "check".into(), preset.clone()]);
    run(&[apply.clone(), preset.clone(), name(b"in-\xff.1.png"), name(b"\xfe/by-preset.png"), cpu.clone()]);
    run(&["sheet".into(), name(b"\xfe/sheet.png"), name(b"in-\xff.1.png"), name(b"in-\xff.2.png")]);
    cube(folder.path());
    let out = name(b"\xfe/r-\xff.png");
    let more = ["--frames=2", "--size=16x16", "--style"].map(OsString::from);
    run(&[&["render".into(), "cube.gltf".into(), out][..], &more, &[preset]].concat());
    assert!(at(b"\xfe/r-\xff.0002.png").is_file());
    let graph = r#"{"format":"isophote-graph","version":1,"output":"a",
        "nodes":[{"name":"a","node":"gaussian","inputs":{"color":"@color"}}]}"#;
    fs::write(at(b"graph-\xff.json"), graph).expect("the folder is writable");
    run(&[apply, name(b"graph-\xff.json"), name(b"in-\xff.1.png"), name(b"\xfe/by-graph.png"), cpu]);
    let save = ["preset".into(), "save".into(), name(b"graph-\xff.json"), "look.json".into()];
    fails(isophote().current_dir(folder.path()).args(save), 2, &["graph-", "is no UTF-8"]);
}

#[test]
fn extreme_frame_numbers_are_frames() {
    let folder = folder();
    for frame in [i64::MIN, 0, i64::MAX] {
        let path = folder.path().join(format!("in.{frame}.png"));
        picture(8, 8).save(path).expect("the picture can be written");
    }
    fails(&mut apply(folder.path(), &["in.#.png", "out.#.png"]), 2, &["no files of the frames -1"]);
    let skipping = ["in.#.png", "out.#.png", "--on-missing", "skip"];
    let (text, _) = succeeds(&mut apply(folder.path(), &skipping));
    assert!(text.contains("3 frames written") && text.contains("1 missing"), "{text}");
    assert!(folder.path().join(format!("out.{}.png", i64::MIN)).is_file());
    for list in ["-9223372036854775808", "1-9223372036854775807", "99999999999999999999"] {
        fails(&mut apply(folder.path(), &["in.#.png", "o.#.png", "--frames", list]), 2, &["--frames", list]);
    }
    let many = format!("in.{}.png", "#".repeat(70_000));
    fails(&mut apply(folder.path(), &[&many, "o.#.png"]), 2, &["70000 digits"]);
}

#[test]
fn a_png_file_cut_in_its_last_chunk_is_not_whole() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(24, 16).save(at("in.1.png")).expect("the picture can be written");
    succeeds(&mut apply(folder.path(), &["in.#.png", "out.#.png"]));
    let whole = fs::read(at("out.1.png")).expect("a result");
    for cut in [1, 4, 11] {
        fs::write(at("out.1.png"), &whole[..whole.len() - cut]).expect("the folder is writable");
        fails(&mut apply(folder.path(), &["out.1.png", "no.png"]), 2, &["out.1.png", "damaged", "intact"]);
        succeeds(&mut apply(folder.path(), &["in.#.png", "out.#.png", "--skip-existing"]));
        assert!(fs::read(at("out.1.png")).expect("a result") == whole, "{cut} bytes less");
    }
}

/// Runs a command with standard output into a full disk, or into a pipe that nobody reads.
fn unread(command: &mut Command, is_full: bool) -> (Option<i32>, String) {
    if is_full {
        command.stdout(File::options().write(true).open("/dev/full").expect("/dev/full"));
    } else {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        command.stdout(writer);
    }
    let output = command.stderr(Stdio::piped()).output().expect("the program can be started");
    (output.status.code(), errors(&output))
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_nobody_reads_is_no_panic() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for frame in 1..=2 {
        picture(24, 16).save(at(&format!("in.{frame}.png"))).expect("the picture can be written");
    }
    let verb = |arguments: &[&str]| {
        let mut command = isophote();
        command.current_dir(folder.path()).args(arguments);
        command
    };
    let bench = ["bench", "--backend", "cpu", "--size", "16x16", "--runs", "1", "--node", "gaussian"];
    let farm = ["farm", "openjd", "--", "apply", "gaussian", "in.#.png", "out.#.png"];
    let dry = ["apply", "gaussian", "in.#.png", "out.#.png", "--dry-run"];
    for arguments in [&["nodes"][..], &["nodes", "--json"], &bench, &farm, &dry] {
        let (code, text) = unread(&mut verb(arguments), true);
        assert_eq!((code, text.lines().count()), (Some(1), 1), "{arguments:?}: {text}");
        assert!(text.starts_with("error: cannot write to standard output"), "{arguments:?}: {text}");
        assert_eq!(unread(&mut verb(arguments), false), (Some(0), String::new()), "{arguments:?}");
    }
    // The frames are there, whoever is told of them.
    for (is_full, more, words) in [
        (true, &[][..], "warning: cannot write to standard output"),
        (true, &["--json"], "warning: cannot write to standard output"),
        (false, &[], ""),
        (false, &["--json"], ""),
    ] {
        let arguments = [&["in.#.png", "out.#.png"], more].concat();
        let (code, text) = unread(&mut apply(folder.path(), &arguments), is_full);
        assert_eq!(code, Some(0), "{arguments:?}: {text}");
        assert!(
            text.starts_with(words) && text.lines().count() == usize::from(is_full),
            "{arguments:?}: {text}"
        );
        for frame in 1..=2 {
            fs::remove_file(at(&format!("out.{frame}.png"))).expect("a result");
        }
    }
}

#[test]
fn an_interrupted_picture_is_given_up() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(4000, 3000).save(at("in.png")).expect("the picture can be written");
    picture(8, 8).save(at("out.png")).expect("the picture can be written");
    let before = fs::read(at("out.png")).expect("a picture");
    for (signal, wait) in [("-INT", 0.5), ("-TERM", 2.0)] {
        let mut command = isophote();
        command
            .current_dir(folder.path())
            .args("apply oil_paint in.png out.png --force --backend cpu".split(' '));
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a process");
        // It has started when it has looked whether it may write.
        let patience = Instant::now();
        let folder_time = || fs::metadata(folder.path()).and_then(|m| m.modified()).expect("a time");
        let start = folder_time();
        while folder_time() == start && patience.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
        }
        std::thread::sleep(Duration::from_secs_f64(wait));
        let kill = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(kill.expect("kill").success());
        let output = child.wait_with_output().expect("the process ended");
        assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
        assert!(
            errors(&output).contains("error: stopped before the picture was written"),
            "{}",
            errors(&output)
        );
        assert_eq!(listing(folder.path()), ["in.png", "out.png"]);
        assert!(fs::read(at("out.png")).expect("a picture") == before, "the picture is replaced");
    }
}
