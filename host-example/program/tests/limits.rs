//! Resources that the system refuses: memory, threads and room on a disk. The program ends in order or does with less.

#![cfg(target_os = "linux")]

use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::support::{self, cube, errors, fails, folder, isophote, library, picture, succeeds};

/// Path of the program.
const PROGRAM: &str = env!("CARGO_BIN_EXE_isophote");

/// The same command in a process that may have so many MiB of addresses.
fn within(mebibytes: u64, command: &Command) -> Output {
    let mut limited = Command::new("sh");
    limited.arg("-c").arg(format!("ulimit -c 0; ulimit -v {}; exec \"$@\"", mebibytes * 1024)).arg("sh");
    limited.arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        limited.env(name, value.unwrap_or_default());
    }
    // What the standard library prints of memory that is refused is one line then.
    limited.env("RUST_BACKTRACE", "0");
    limited
        .current_dir(command.get_current_dir().expect("a folder"))
        .output()
        .expect("the shell can be started")
}

/// True where the system can load the program at all where it may have so many MiB of addresses.
fn loads(mebibytes: u64, command: &Command) -> bool {
    let mut version = Command::new(command.get_program());
    version.arg("--version").current_dir(command.get_current_dir().expect("a folder"));
    within(mebibytes, &version).status.success()
}

/// Runs the command with more and more memory. It ends well or with a sentence; returns how often it did which.
fn sweep(limits: impl Iterator<Item = u64>, command: &Command) -> [usize; 2] {
    let mut counts = [0; 2];
    for limit in limits {
        let output = within(limit, command);
        let text = errors(&output);
        // Where the system cannot load the program, and where it cannot make room for variables of threads, it ends
        // the process itself.
        let is_loaded = output.status.code().is_some() || loads(limit, command);
        if output.status.code() == Some(127) || !is_loaded {
            continue;
        }
        // A thread without room for the stack of its signals ends the process as well, in words of the standard library.
        let is_of_thread = text.contains("failed to allocate an alternative stack");
        let is_said = text.starts_with("error: ") || text.starts_with("memory allocation of ");
        match output.status.code() {
            Some(0) => counts[0] += 1,
            Some(1 | 2) if is_of_thread || is_said && !text.contains("panicked") => counts[1] += 1,
            _ => panic!("{limit} MiB: {}\n{text}", output.status),
        }
    }
    counts
}

fn apply(folder: &Path, input: &str, output: &str) -> Command {
    let mut command = isophote();
    command.current_dir(folder).args(["apply", "cartoon", input, output, "--force", "--backend", "cpu"]);
    command
}

#[test]
fn apply_ends_in_order_without_memory() {
    let folder = folder();
    picture(900, 700).save(folder.path().join("in.png")).expect("the picture can be written");
    succeeds(&mut apply(folder.path(), "in.png", "in.exr"));
    for (input, output) in [("in.png", "out.png"), ("in.exr", "out.exr"), ("in.png", "out.exr")] {
        let command = apply(folder.path(), input, output);
        let [well, refused] = sweep((40..640).step_by(24).chain([4096]), &command);
        assert!(well > 0 && refused > 0, "{input}: {well} ended well, {refused} were refused");
    }
    let left = support::listing(folder.path());
    assert_eq!(left, ["in.exr", "in.png", "out.exr", "out.png"]);
}

#[test]
fn render_ends_in_order_without_memory() {
    let folder = folder();
    cube(folder.path());
    let mut command = isophote();
    command.current_dir(folder.path()).args("render cube.gltf out.exr --force --size 160x90".split(' '));
    let [well, refused] = sweep((60..1200).step_by(100).chain([8192]), &command);
    assert!(well > 0 && refused > 0, "{well} ended well, {refused} were refused");
}

#[test]
fn without_threads_the_calling_one_does_it_all() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(90, 70).save(at("in.0001.png")).expect("the picture can be written");
    fs::copy(at("in.0001.png"), at("in.0002.png")).expect("the folder is writable");
    // No address space holds such stacks.
    let stack = OsString::from((1_u64 << 60).to_string());
    succeeds(&mut apply(folder.path(), "in.####.png", "many.####.exr"));
    succeeds(apply(folder.path(), "in.####.png", "one.####.exr").env("RUST_MIN_STACK", &stack));
    succeeds(apply(folder.path(), "one.####.exr", "again.####.exr").env("RUST_MIN_STACK", &stack));
    succeeds(&mut apply(folder.path(), "one.####.exr", "twice.####.exr"));
    for frame in ["0001", "0002"] {
        let read = |name: &str| fs::read(at(&format!("{name}.{frame}.exr"))).expect("it was written");
        assert!(read("many") == read("one") && read("again") == read("twice"), "{frame}");
    }
    let mut missing = apply(folder.path(), "in.####.png", "other.####.png");
    fs::write(at("in.0001.png"), "broken").expect("the folder is writable");
    let output = missing.env("RUST_MIN_STACK", &stack).output().expect("the program can be started");
    assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
    assert!(at("other.0002.png").is_file());
}

#[test]
fn nothing_but_ours_is_said_where_nobody_is_logged_in() {
    let folder = folder();
    cube(folder.path());
    picture(40, 30).save(folder.path().join("in.png")).expect("the picture can be written");
    for arguments in [
        ["render", "cube.gltf", "out.png", "--size=64x36", "--quiet"],
        ["apply", "gaussian", "in.png", "other.png", "--quiet"],
    ] {
        let mut command = Command::new(PROGRAM);
        command.current_dir(folder.path()).args(arguments).env_clear().env("ISOPHOTE_LIBRARY", library());
        let (printed, said) = succeeds(&mut command);
        assert_eq!((printed.as_str(), said.as_str()), ("", ""), "{arguments:?}");
    }
}

/// Every writer but that of videos, which other programs fill.
#[test]
fn a_full_disk_leaves_no_half_of_any_file() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    cube(folder.path());
    fs::create_dir(at("small")).expect("the folder is writable");
    picture(64, 48).save(at("in.1.png")).expect("the picture can be written");
    fs::write(at("old"), "old").expect("the folder is writable");
    let bench =
        ["bench", "--backend", "cpu", "--size", "16x16", "--runs", "1", "--node", "gaussian", "--save"];
    let job = ["--", "apply", "gaussian", "in.#.png", "o.#.png"];
    let apply = ["apply", "gaussian", "in.1.png", "--backend", "cpu"];
    for (verb, name, more) in [
        (&apply[..], "a.png", &[][..]),
        (&apply, "a.jpg", &[]),
        (&apply, "a.tif", &[]),
        (&apply, "a.exr", &[]),
        (&["render", "cube.gltf", "--size", "32x24"], "a.png", &[]),
        (&["render", "cube.gltf", "--size", "32x24"], "a.exr", &[]),
        (&["sheet"], "a.png", &["in.1.png"]),
        (&["preset", "save", "ink"], "a.json", &["--all"]),
        (&["farm", "openjd", "-o"], "a.json", &job),
        (&bench, "a.json", &[]),
        (&["documents"], "share", &[]),
    ] {
        let place = format!("small/{name}");
        // The disk has room for names alone. What was there stays, whole.
        for (force, kept) in [(&[][..], "filler\n"), (&["--force"], "filler\nold\n")] {
            if verb == ["documents"] && !force.is_empty() {
                continue;
            }
            let old = if force.is_empty() { String::new() } else { format!("echo old > {place}") };
            let before = format!("{old}\ncat /dev/zero > small/filler 2> /dev/null");
            let after =
                format!("(cd small; find . -type f -printf '%P\\n' | sort; cat {name} 2> /dev/null) > left");
            let arguments = [verb, &[place.as_str()], force, more].concat();
            let lines = [before.as_str(), after.as_str()];
            let Some(mut command) = support::on_a_small_disk(folder.path(), lines, &arguments) else {
                return;
            };
            let output = command.output().expect("the shell can be started");
            let said = errors(&output);
            assert_eq!(output.status.code(), Some(1), "{arguments:?}: {said}");
            assert!(said.lines().count() == 1 && said.starts_with("error: small/"), "{arguments:?}: {said}");
            assert!(said.contains("cannot be written: the disk is full; make room on it"), "{said}");
            let left = fs::read_to_string(at("left")).expect("a list").replace(&format!("{name}\n"), "");
            assert_eq!(left, kept, "{arguments:?}");
        }
    }
}

/// A result on standard output needs room like one in a file.
#[test]
fn a_full_disk_takes_no_result_from_standard_output() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    picture(24, 16).save(at("in.1.png")).expect("the picture can be written");
    fs::write(at("look.json"), r#"{"style": "gaussian"}"#).expect("the folder is writable");
    for arguments in [
        &["preset", "show", "look.json"][..],
        &["preset", "check", "look.json"],
        &["preset", "list", "--json"],
        &["nodes", "gaussian"],
        &["farm", "openjd", "--", "apply", "gaussian", "in.#.png", "out.#.png"],
        &["apply", "--help"],
        &["--version"],
    ] {
        let mut command = isophote();
        let full = fs::File::options().write(true).open("/dev/full").expect("/dev/full");
        command.current_dir(folder.path()).args(arguments).stdout(full);
        fails(&mut command, 1, &["cannot write to standard output", "No space left"]);
    }
}
