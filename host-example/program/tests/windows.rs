//! Names of files that only Windows has, or that it alone refuses.

use std::fs;
use std::path::{Path, PathBuf};

use super::support::video::{clip, probe};
use super::support::{IN_PIXELS, errors, folder, has_ffmpeg, isophote, listing, picture, succeeds};

/// Writes a picture, or two frames of a sequence, and applies a style to them in this folder, by its whole path.
fn is_worked_in(folder: &Path) {
    let at = |name: &str| folder.join(name);
    for name in ["in.png", "shot.01.png", "shot.02.png"] {
        picture(24, 16).save(at(name)).expect("the picture can be written");
    }
    for (from, to) in [("in.png", "out.png"), ("shot.##.png", "made.##.png")] {
        let mut command = isophote();
        command.args(["apply", "gaussian", "--backend", "cpu"]).args(IN_PIXELS).arg(at(from)).arg(at(to));
        succeeds(&mut command);
        // What is there is kept, and replaced when asked.
        assert_eq!(command.output().expect("the program can be started").status.code(), Some(2));
        succeeds(command.arg("--force"));
    }
    let made = ["in.png", "made.01.png", "made.02.png", "out.png", "shot.01.png", "shot.02.png"];
    assert_eq!(listing(folder), made);
    let bytes = |name: &str| fs::read(at(name)).expect("a picture");
    assert!(bytes("out.png") == bytes("made.02.png") && bytes("out.png") != bytes("in.png"));
}

/// A folder whose path has more characters than the 260 that old programs of Windows know.
fn deep(folder: &Path) -> PathBuf {
    let mut deep = folder.to_owned();
    while deep.as_os_str().len() < 300 {
        deep.push("a folder whose name has 41 characters, so");
    }
    fs::create_dir_all(&deep).expect("a folder");
    deep
}

#[test]
fn paths_of_more_than_260_characters_are_read_and_written() {
    let folder = folder();
    is_worked_in(&deep(folder.path()));
}

#[test]
fn videos_at_long_paths_are_read_and_written() {
    if !has_ffmpeg() {
        return;
    }
    let folder = folder();
    let deep = deep(folder.path());
    clip(folder.path(), "in.mp4", "-shortest");
    let frames = |name: &str| probe(&folder.path().join(name), "v", "nb_frames");
    let before = frames("in.mp4");
    fs::rename(folder.path().join("in.mp4"), deep.join("in.mp4")).expect("the video is moved");
    let out = deep.join("out.mp4");
    succeeds(isophote().args(["apply", "gaussian"]).arg(deep.join("in.mp4")).arg(&out));
    assert_eq!(listing(&deep), ["in.mp4", "out.mp4"]);
    fs::rename(out, folder.path().join("out.mp4")).expect("the video is moved");
    assert_eq!(frames("out.mp4"), before);
}

#[test]
fn folders_of_other_machines_are_read_and_written() {
    let folder = folder();
    let path = folder.path().to_str().expect("text");
    // Every Windows shares its disks with those who look after it.
    let shared = PathBuf::from(format!(r"\\localhost\{}", path.replacen(':', "$", 1)));
    if !shared.is_dir() {
        eprintln!("\n*** SKIPPED: {} is not shared ***\n", shared.display());
        return;
    }
    is_worked_in(&shared);
    let verbatim = PathBuf::from(format!(r"\\?\{path}")).join("verbatim");
    fs::create_dir(&verbatim).expect("a folder");
    is_worked_in(&verbatim);
}

#[test]
fn names_of_all_languages_are_names() {
    let folder = folder();
    let inner = folder.path().join("Füße und 漢字 😀 & co (1) 100% ^!");
    fs::create_dir(&inner).expect("a folder");
    is_worked_in(&inner);
}

#[test]
fn names_that_windows_refuses_leave_nothing_behind() {
    let folder = folder();
    picture(24, 16).save(folder.path().join("in.png")).expect("the picture can be written");
    for name in ["con.png", "nul.png", "a|b.png", "a?b.png", "a\"b.png", "a:b.png", "no folder/a.png"] {
        let mut command = isophote();
        command.current_dir(folder.path()).args(["apply", "gaussian", "--backend", "cpu", "in.png", name]);
        let output = command.output().expect("the program can be started");
        let code = output.status.code();
        // Newer ones know `con.png` as a name like others.
        let is_new = code == Some(0) && folder.path().join(name).is_file();
        if is_new {
            fs::remove_file(folder.path().join(name)).expect("the picture is removed");
        } else {
            let said = errors(&output);
            assert!(
                matches!(code, Some(1 | 2)) && said.starts_with("error: ") && said.contains(name),
                "{name}: {said}"
            );
        }
        assert_eq!(listing(folder.path()), ["in.png"], "{name}");
    }
}
