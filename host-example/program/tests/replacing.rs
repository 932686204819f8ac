//! Files that are replaced: none that is there unless that was asked for, and never one that is read.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{self, IN_PIXELS, cube, errors, fails, folder, isophote, listing, picture, succeeds};

fn run(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(arguments);
    command
}

fn apply(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = run(folder, &["apply", "gaussian"]);
    command.args(arguments).args(IN_PIXELS).args(["--backend", "cpu"]);
    command
}

/// Writes a picture that no other number has.
fn save(folder: &Path, name: &str, number: u32) {
    picture(24 + number, 16).save(folder.join(name)).expect("the picture can be written");
}

/// All files of a folder with their contents.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let files = listing(folder).into_iter().filter(|name| folder.join(name).is_file());
    files.map(|name| (name.clone(), fs::read(folder.join(name)).expect("a file"))).collect()
}

/// Runs the command, which must be refused in these words and change nothing.
fn refused(folder: &Path, command: &mut Command, words: &[&str]) {
    let before = contents(folder);
    fails(command, 2, words);
    assert!(contents(folder) == before, "{command:?} changes what is there");
}

#[test]
#[cfg(unix)]
fn a_picture_that_a_shell_names_is_no_place_for_a_result() {
    let folder = folder();
    let two = folder.path().join("two");
    fs::create_dir(&two).expect("the folder is writable");
    for (number, name) in ["a.png", "b.png"].into_iter().enumerate() {
        save(&two, name, number as u32);
    }
    let shell = |more: &str| {
        let mut command = Command::new("sh");
        command.current_dir(folder.path()).env("ISOPHOTE_LIBRARY", support::library());
        command.arg("-c").arg(format!("exec \"$0\" apply gaussian two/*.png --backend cpu {more}"));
        command.arg(env!("CARGO_BIN_EXE_isophote"));
        command
    };
    refused(&two, &mut shell(""), &["two/b.png: is there already, and would be replaced", "--force"]);
    refused(&two, &mut shell("--dry-run"), &["two/b.png: is there already", "--force"]);
    let [first, second] = ["a.png", "b.png"].map(|name| fs::read(two.join(name)).expect("a picture"));
    succeeds(&mut shell("--force"));
    assert!(fs::read(two.join("a.png")).expect("a picture") == first);
    assert!(fs::read(two.join("b.png")).expect("a picture") != second);
}

#[test]
#[cfg(unix)]
fn a_picture_is_its_own_result_only_in_place() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    save(at, "in.png", 0);
    fs::create_dir(place("inner")).expect("the folder is writable");
    symlink("in.png", place("symbolic.png")).expect("the folder is writable");
    symlink(".", place("here")).expect("the folder is writable");
    let whole = place("in.png").display().to_string();
    for output in ["in.png", "./in.png", "inner/../in.png", "symbolic.png", "here/in.png", &whole] {
        let same =
            if output == "in.png" { "in.png: is the input as well" } else { "same file as the input in.png" };
        refused(at, &mut apply(at, &["in.png", output]), &[output, same, "--in-place"]);
        refused(at, &mut apply(at, &["in.png", output, "--force"]), &[output, same, "--in-place"]);
    }
    fs::hard_link(place("in.png"), place("hard.png")).expect("the folder is writable");
    refused(at, &mut apply(at, &["in.png", "hard.png", "--force"]), &["hard.png", "same file", "--in-place"]);
    let before = fs::read(place("in.png")).expect("a picture");
    succeeds(&mut apply(at, &["in.png", "symbolic.png", "--in-place"]));
    assert!(fs::read(place("in.png")).expect("a picture") != before && place("symbolic.png").is_symlink());
    // Consent to one is no consent to another.
    save(at, "other.png", 1);
    refused(at, &mut apply(at, &["in.png", "other.png", "--in-place"]), &["other.png", "is there already"]);
    let both = ["in.png", "in.png", "--in-place", "--skip-existing"];
    refused(at, &mut apply(at, &both), &["--in-place", "--skip-existing"]);
}

#[test]
#[cfg(unix)]
fn what_is_read_beside_the_picture_is_no_result() {
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    save(at, "in.png", 0);
    save(at, "mask.png", 0);
    let write = |name: &str, text: &str| fs::write(place(name), text).expect("the folder is writable");
    write("look.json", r#"{"style": "gaussian"}"#);
    write("looks.json", r#"[{"style": "gaussian", "mask": "mask.png"}]"#);
    for name in ["look", "looks"] {
        fs::hard_link(place(&format!("{name}.json")), place(&format!("{name}.png"))).expect("as above");
    }
    let refused = |arguments: &[&str], words: &[&str]| {
        for more in [&["--force"][..], &["--force", "--in-place"]] {
            let mut command = run(at, &["apply", "--backend", "cpu"]);
            refused(at, command.args(arguments).args(more), words);
        }
    };
    refused(
        &["gaussian", "in.png", "mask.png", "--mask", "mask.png"],
        &["mask.png: is read, and would be replaced"],
    );
    refused(
        &["look.json", "in.png", "look.png"],
        &["look.png: is the same file as look.json, which is read"],
    );
    refused(&["--preset", "look.json", "in.png", "look.png"], &["look.png: is the same file as look.json"]);
    refused(
        &["--layered", "looks.json", "in.png", "looks.png"],
        &["looks.png: is the same file as looks.json"],
    );
    refused(
        &["--layered", "looks.json", "in.png", "mask.png"],
        &["mask.png: is read, and would be replaced"],
    );
    refused(
        &["gaussian", "in.png", "mask.png", "--mask", "cryptomatte:a", "--mask-from", "mask.png"],
        &["mask.png"],
    );
}

#[test]
fn a_sequence_that_was_begun_is_resumed_or_made_again() {
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    (1..=4).for_each(|number| save(at, &format!("in.000{number}.png"), number));
    let sequence = ["in.####.png", "out.####.png"];
    let with = |more: &[&'static str]| apply(at, &[&sequence, more].concat());
    succeeds(&mut with(&["--frames", "2,4"]));
    let whole = fs::read(place("out.0002.png")).expect("a result");
    fs::write(place("out.0002.png"), "mine").expect("the folder is writable");
    let words =
        ["out.0002.png: is there already, the first of 2 among 4 results", "--skip-existing", "--force"];
    refused(at, &mut with(&[]), &words);
    refused(at, &mut with(&["--dry-run"]), &words);
    refused(
        at,
        &mut with(&["--frames", "2"]),
        &["out.0002.png", "the only one of 1 results", "--skip-existing"],
    );
    refused(at, &mut with(&["--force", "--skip-existing"]), &["--force", "--skip-existing"]);
    let (text, _) = succeeds(&mut with(&["--skip-existing"]));
    assert!(text.contains("3 frames written") && text.contains("1 there already"), "{text}");
    assert!(fs::read(place("out.0002.png")).expect("a result") == whole, "what was not whole is made again");
    fs::copy(place("out.0001.png"), place("out.0003.png")).expect("the folder is writable");
    let (text, _) = succeeds(&mut with(&["--force"]));
    assert!(text.contains("4 frames written"), "{text}");
    assert!(
        fs::read(place("out.0003.png")).expect("a result") != fs::read(place("out.0001.png")).expect("one")
    );
    // In the place of the frames themselves.
    let own = ["in.####.png", "in.%04d.png"];
    refused(
        at,
        &mut apply(at, &[&own[..], &["--force"]].concat()),
        &["in.0001.png", "is the input", "--in-place"],
    );
    let before = fs::read(place("in.0003.png")).expect("a frame");
    succeeds(&mut apply(at, &[&own[..], &["--in-place"]].concat()));
    assert!(fs::read(place("in.0003.png")).expect("a frame") != before);
}

#[test]
#[cfg(unix)]
fn frames_that_are_read_for_others_are_no_results() {
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    let scene = cube(at);
    let mut render = run(at, &["render"]);
    render.arg(scene).args(["in.####.exr", "--size", "48x32", "--turntable", "--frames", "1-6"]);
    succeeds(&mut render);
    (1..=6).for_each(|n| drop(fs::copy(place(&format!("in.000{n}.exr")), place(&format!("mv.000{n}.exr")))));
    let steady = |more: &[&'static str]| {
        let fixed = ["apply", "cartoon", "in.####.exr", "out.####.exr", "--frames", "3", "--backend", "cpu"];
        run(at, &[&fixed[..], &["--steadiness", "0.5", "--force"], more].concat())
    };
    // A neighbour that is no frame of the run, motion in files of its own, a mask of a frame.
    for (name, more) in [
        ("in.0004.exr", &[][..]),
        ("mv.0003.exr", &["--motion", "mv.####.exr"]),
        ("mv.0002.exr", &["--motion", "mv.####.exr"]),
        ("mv.0003.exr", &["--mask", "mv.####.exr"]),
        ("mv.0003.exr", &["--mask", "id", "--mask-from", "mv.####.exr"]),
    ] {
        fs::hard_link(place(name), place("out.0003.exr")).expect("the folder is writable");
        refused(at, &mut steady(more), &["out.0003.exr", &format!("same file as {name}, which is read")]);
        fs::remove_file(place("out.0003.exr")).expect("a link");
    }
    // The frame of another number.
    fs::hard_link(place("in.0001.exr"), place("out.0002.exr")).expect("the folder is writable");
    let all = ["in.####.exr", "out.####.exr", "--force"];
    for more in [&[][..], &["--in-place"]] {
        refused(
            at,
            &mut apply(at, &[&all[..], more].concat()),
            &["out.0002.exr", "same file as in.0001.exr"],
        );
    }
}

#[test]
fn a_file_that_comes_meanwhile_stays() {
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    picture(700, 500).save(place("in.png")).expect("the picture can be written");
    let mut command = run(at, &["apply", "oil_paint", "in.png", "out.png", "--backend", "cpu", "--json"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a process");
    let mut lines = BufReader::new(child.stdout.take().expect("its output")).lines();
    // The work goes on when some of it is done.
    assert!(lines.by_ref().flatten().any(|line| line.contains("progress")));
    fs::write(place("out.png"), "theirs").expect("the folder is writable");
    lines.for_each(drop);
    let output = child.wait_with_output().expect("the process ended");
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).starts_with("error: out.png: is there already"), "{}", errors(&output));
    assert_eq!(fs::read(place("out.png")).expect("a file"), b"theirs");
    assert_eq!(listing(at), ["in.png", "out.png"]);
}

#[test]
fn every_verb_asks_before_it_replaces() {
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    cube(at);
    save(at, "in.1.png", 0);
    let bench = ["bench", "--backend", "cpu", "--size", "16x16", "--runs", "1", "--node", "gaussian"];
    let job = ["--", "apply", "gaussian", "in.#.png", "o.#.png"];
    let render = ["render", "cube.gltf", "--size", "16x16"];
    for (verb, name, more) in [
        (&["sheet"][..], "sheet.png", &["in.1.png"][..]),
        (&["preset", "save", "ink"], "ink.json", &[]),
        (&["farm", "openjd", "-o"], "job.json", &job),
        (&["farm", "slurm", "-o"], "job.sh", &job),
        (&["farm", "opencue", "-o"], "job.outline", &job),
        (&[&bench[..], &["--save"]].concat(), "bench.json", &[]),
        (&render, "picture.png", &[]),
        (&render, "picture.exr", &[]),
    ] {
        let run = |force: &[&'static str]| run(at, &[verb, &[name], force, more].concat());
        succeeds(&mut run(&[]));
        let made = fs::read(place(name)).expect("it was written");
        fs::write(place(name), "mine").expect("the folder is writable");
        refused(at, &mut run(&[]), &[name, "is there already", "--force"]);
        succeeds(&mut run(&["--force"]));
        let again = fs::read(place(name)).expect("it was written");
        assert!(again == made || name == "bench.json" && again.starts_with(b"{"), "{name}");
    }
    let documents = |more: &[&'static str]| run(at, &[&["documents", "share"][..], more].concat());
    succeeds(&mut documents(&[]));
    let page = place("share/man/man1/isophote-apply.1");
    fs::remove_file(place("share/fish/vendor_completions.d/isophote.fish")).expect("completions");
    fs::write(&page, "mine").expect("the folder is writable");
    refused(at, &mut documents(&[]), &["share/man/man1/", "is there already", "--force"]);
    assert!(!place("share/fish/vendor_completions.d/isophote.fish").exists(), "some were written");
    succeeds(&mut documents(&["--force"]));
    assert!(fs::read(&page).expect("a page") != b"mine");
    // Frames of a scene.
    let frames =
        |more: &[&'static str]| run(at, &[&render[..], &["f.#.png", "--frames", "3"], more].concat());
    succeeds(&mut frames(&[]));
    fs::remove_file(place("f.2.png")).expect("a frame");
    refused(at, &mut frames(&[]), &["f.1.png", "the first of 2 among 3", "--skip-existing", "--force"]);
    succeeds(&mut frames(&["--skip-existing"]));
    succeeds(&mut frames(&["--force"]));
}

#[test]
#[cfg(unix)]
fn no_verb_replaces_what_it_reads() {
    let folder = folder();
    let (at, place) = (folder.path(), |name: &str| folder.path().join(name));
    cube(at);
    save(at, "in.1.png", 0);
    let write = |name: &str, text: &str| fs::write(place(name), text).expect("the folder is writable");
    write("look.json", r#"{"style": "gaussian", "parameters": {"sigma": 3}}"#);
    write(
        "graph.json",
        r#"{"format": "isophote-graph", "version": 1, "output": "a",
            "nodes": [{"name": "a", "node": "gaussian", "inputs": {"color": "@color"}}]}"#,
    );
    write("graph-look.json", r#"{"style": "graph.json"}"#);
    write("model.mtl", "newmtl wall\nmap_Kd wall.png\n");
    write("model.obj", "mtllib model.mtl\nusemtl wall\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    save(at, "wall.png", 1);
    save(at, "brick.png", 2);
    let refused = |arguments: &[&str], words: &[&str]| {
        refused(at, run(at, arguments).arg("--force"), words);
    };
    refused(&["sheet", "in.1.png", "wall.png", "in.1.png"], &["in.1.png: is read, and would be replaced"]);
    refused(
        &["preset", "save", "look.json", "look.json", "--set", "sigma=2"],
        &["is the input", "--in-place"],
    );
    refused(&["preset", "save", "graph-look.json", "graph.json"], &["graph.json", "is the graph"]);
    let save_before = ["bench", "--backend", "cpu", "--save", "look.json", "--compare", "look.json"];
    refused(&save_before, &["look.json: is read"]);
    let obj = ["render", "model.obj", "--size", "16x16"];
    refused(&[&obj[..], &["brick.png", "--texture", "brick.png"]].concat(), &["brick.png: is read"]);
    refused(&[&obj[..], &["wall.png"]].concat(), &["wall.png: is read with the scene"]);
    let job = ["farm", "openjd", "--force", "-o", "look.json", "--", "apply"];
    let command = ["--preset", "look.json", "in.#.png", "out.#.png"];
    refused(&[&job[..], &command].concat(), &["look.json: is read"]);
    let before = fs::read(place("look.json")).expect("a preset");
    succeeds(&mut run(at, &["preset", "save", "look.json", "look.json", "--set", "sigma=2", "--in-place"]));
    assert!(fs::read(place("look.json")).expect("a preset") != before);
}

#[test]
fn videos_follow_the_same_rule() {
    let Some(folder) = support::video_folder() else { return };
    let at = folder.path();
    let mut ffmpeg = Command::new("ffmpeg");
    let source =
        ["-v", "error", "-f", "lavfi", "-i", "testsrc2=s=64x48:r=10:d=0.5", "-c:v", "ffv1", "in.mkv"];
    succeeds(ffmpeg.current_dir(at).args(source));
    fs::write(at.join("out.mkv"), "mine").expect("the folder is writable");
    refused(at, &mut apply(at, &["in.mkv", "out.mkv"]), &["out.mkv", "is there already", "--force"]);
    succeeds(&mut apply(at, &["in.mkv", "out.mkv", "--skip-existing"]));
    assert_eq!(fs::read(at.join("out.mkv")).expect("a file"), b"mine");
    succeeds(&mut apply(at, &["in.mkv", "out.mkv", "--force"]));
    assert!(fs::read(at.join("out.mkv")).expect("a video").len() > 1000);
    refused(at, &mut apply(at, &["in.mkv", "in.mkv", "--force"]), &["in.mkv", "is the input", "--in-place"]);
    let before = fs::read(at.join("in.mkv")).expect("a video");
    succeeds(&mut apply(at, &["in.mkv", "in.mkv", "--in-place"]));
    assert!(fs::read(at.join("in.mkv")).expect("a video") != before);
    cube(at);
    let render = ["render", "cube.gltf", "out.mkv", "--size", "32x32", "--frames", "2"];
    refused(at, &mut run(at, &render), &["out.mkv", "is there already", "--force"]);
    succeeds(run(at, &render).arg("--force"));
}

#[test]
fn jobs_run_again_and_never_in_place() {
    let folder = folder();
    let at = folder.path();
    (1..=2).for_each(|number| save(at, &format!("in.{number}.png"), number));
    // A node stays one, whatever lies beside it.
    fs::write(at.join("gaussian"), "no node").expect("the folder is writable");
    let job = |more: &[&'static str]| {
        let fixed = ["farm", "openjd", "--", "apply", "gaussian", "in.#.png", "out.#.png"];
        run(at, &[&fixed[..], more].concat())
    };
    for (more, kept) in
        [(&[][..], "--skip-existing"), (&["--skip-existing"], "--skip-existing"), (&["--force"], "--force")]
    {
        let (text, _) = succeeds(&mut job(more));
        let template: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let words =
            template["steps"][0]["script"]["actions"]["onRun"]["args"].as_array().expect("words").clone();
        let words: Vec<String> = words.iter().filter_map(|w| w.as_str().map(str::to_owned)).collect();
        let about = words.iter().filter(|word| ["--skip-existing", "--force"].contains(&word.as_str()));
        assert_eq!(about.collect::<Vec<_>>(), [kept]);
        assert_eq!(words[..2], ["apply", "gaussian"]);
        for _ in 0..2 {
            let words = words.iter().map(|word| word.replace("{{Task.Param.Frame}}", "1-2"));
            succeeds(isophote().current_dir("/").args(words));
        }
    }
    fails(&mut job(&["--in-place"]), 2, &["--in-place", "runs twice"]);
}
