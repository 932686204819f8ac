//! `apply --to`: several pictures and folders, each to a file of its own name in one folder.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{errors, fails, folder, isophote, listing, picture, succeeds};

fn apply(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(["apply", "gaussian"]).args(arguments).args(["--backend", "cpu"]);
    command
}

/// A folder with pictures in the folder `in`, of which two have signs of patterns in their names.
fn pictures() -> tempfile::TempDir {
    let folder = folder();
    fs::create_dir(folder.path().join("in")).expect("a folder");
    for (name, size) in [("a.jpg", 24), ("b@2x.png", 32), ("photo #1.png", 16), ("50%d.png", 8)] {
        picture(size, 16).save(folder.path().join("in").join(name)).expect("the picture can be written");
    }
    fs::write(folder.path().join("in/notes.txt"), "").expect("the folder is writable");
    fs::write(folder.path().join("in/._a.jpg"), "").expect("the folder is writable");
    folder
}

#[test]
fn folders_and_several_pictures_keep_their_names() {
    let folder = pictures();
    let at = folder.path();
    let (text, _) = succeeds(&mut apply(at, &["in", "--to", "out/new"]));
    assert_eq!(listing(&at.join("out/new")), ["50%d.png", "a.jpg", "b@2x.png", "photo #1.png"]);
    assert_eq!(text.lines().count(), 4, "{text}");
    assert!(text.contains("in/photo #1.png -> out/new/photo #1.png"), "{text}");
    // One by itself is the same, and a file that exists is no pattern.
    succeeds(&mut apply(at, &["in/photo #1.png", "one.png"]));
    let bytes = |name: &str| fs::read(at.join(name)).expect("a result");
    assert_eq!(bytes("one.png"), bytes("out/new/photo #1.png"));
    succeeds(&mut apply(at, &["in/photo #1.png", "--to", "single"]));
    assert_eq!(bytes("one.png"), bytes("single/photo #1.png"));
    // The arguments without a name are pictures where a preset names the style.
    succeeds(isophote().current_dir(at).args(["preset", "save", "gaussian", "look.json"]));
    let preset =
        ["apply", "--preset", "look.json", "in/a.jpg", "in/50%d.png", "--to", "by", "--backend", "cpu"];
    succeeds(isophote().current_dir(at).args(preset));
    assert_eq!(listing(&at.join("by")), ["50%d.png", "a.jpg"]);
}

#[test]
fn results_that_are_there_stay() {
    let folder = pictures();
    let at = folder.path();
    let run = ["in/a.jpg", "in/b@2x.png", "--to", "out"];
    succeeds(&mut apply(at, &run));
    fails(
        &mut apply(at, &run),
        2,
        &["out/a.jpg", "the first of 2 among 2 results", "--force", "--skip-existing"],
    );
    succeeds(&mut apply(at, &[&run[..], &["--force"]].concat()));
    let (text, _) = succeeds(&mut apply(at, &[&run[..], &["in/50%d.png", "--skip-existing"]].concat()));
    assert_eq!(text.matches("(there already)").count(), 2, "{text}");
    fails(&mut apply(at, &["in", "--to", "in"]), 2, &["is the input as well", "--in-place"]);
    fs::create_dir(at.join("second")).expect("a folder");
    fs::copy(at.join("in/a.jpg"), at.join("second/a.jpg")).expect("a copy");
    fails(&mut apply(at, &["in/a.jpg", "second/a.jpg", "--to", "both"]), 2, &["both/a.jpg", "second/a.jpg"]);
    assert!(!at.join("both").exists());
}

#[test]
fn a_picture_that_fails_does_not_take_the_rest_with_it() {
    let folder = pictures();
    let at = folder.path();
    fs::write(at.join("in/bad.png"), "no picture").expect("the folder is writable");
    for threads in ["0", "1"] {
        let out = format!("out{threads}");
        let output =
            apply(at, &["in", "in/none.png", "--to", &out, "--threads", threads]).output().expect("a run");
        let text = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert_eq!(listing(&at.join(&out)), ["50%d.png", "a.jpg", "b@2x.png", "photo #1.png"]);
        assert!(
            text.contains("in/bad.png: is neither") && text.contains("in/none.png: cannot be read"),
            "{text}"
        );
        assert!(text.contains("2 of 6 pictures could not be done"), "{text}");
    }
}

#[test]
fn what_belongs_to_sequences_is_refused() {
    let folder = pictures();
    let at = folder.path();
    fails(&mut apply(at, &["in", "--to", "out", "--frames", "1-3"]), 2, &["--frames", "one sequence"]);
    fails(&mut apply(at, &["--to", "out"]), 2, &["--to", "no picture"]);
    fs::create_dir(at.join("empty")).expect("a folder");
    fails(&mut apply(at, &["empty", "--to", "out"]), 2, &["empty", "without pictures"]);
    fails(&mut apply(at, &["in/a.jpg", "b.jpg", "c.jpg"]), 2, &["c.jpg: is one more", "--to"]);
    let (text, _) = succeeds(&mut apply(at, &["in", "--to", "out", "--dry-run"]));
    assert!(text.contains("4 pictures to be written"), "{text}");
    assert!(!at.join("out").exists());
}
