//! The compiler as a whole run has cargo call it for the crates of the workspace: it compiles a crate, then lints it and checks its
//! documents by what its dependencies were compiled to.
//!
//! `cargo clippy` and `cargo doc` find the same. But they have all dependencies checked besides, which a build that happens once has no
//! other use for.

use crate::error::{Context, Failure, Result};
use crate::tools::{WRAPPER, cargo_command, root, run as run_command, target_dir};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Options of rustc that have a value of their own in the next argument.
const WITH_VALUE: [&str; 11] = [
    "--crate-name",
    "--crate-type",
    "--cfg",
    "--check-cfg",
    "--extern",
    "--cap-lints",
    "--out-dir",
    "--target",
    "-L",
    "-l",
    "-C",
];
/// Options of rustc that say where its output goes and in which form.
const OF_OUTPUT: [&str; 5] = ["--emit", "--out-dir", "--error-format", "--json", "--diagnostic-width"];
/// Options of rustc that rustdoc has too, by which it finds what a crate is made of.
const OF_DOCUMENTS: [&str; 9] = [
    "--crate-name",
    "--crate-type",
    "--cfg",
    "--check-cfg",
    "--extern",
    "--cap-lints",
    "--target",
    "--edition",
    "-L",
];

/// Folder of what the second compilers write, which nobody reads.
fn folder() -> PathBuf {
    target_dir("lints")
}

/// True in a process whose cargo lints what it compiles.
pub fn lints() -> bool {
    let program = std::env::current_exe().ok();
    program.is_some_and(|program| {
        std::env::var_os(WRAPPER).is_some_and(|wrapper| program == Path::new(&wrapper))
    })
}

/// Runs a copy of this program with the arguments, as the compiler that its cargo calls. The program itself is built anew meanwhile.
///
/// # Errors
/// When clippy is not there, when the copy cannot be made, and when it fails.
pub fn run_linting(arguments: &[&str]) -> Result<()> {
    let version = cargo_command(&["clippy", "--version"]).output();
    if !version.is_ok_and(|version| version.status.success()) {
        return Err(Failure("clippy is not installed; run `rustup component add clippy`".into()));
    }
    let folder = folder();
    std::fs::create_dir_all(&folder).context(|| format!("cannot make {}", folder.display()))?;
    let copy = folder.join(format!("xtask{}", std::env::consts::EXE_SUFFIX));
    let own = std::env::current_exe().context(|| "this program is nowhere".into())?;
    std::fs::copy(own, &copy).context(|| format!("cannot write {}", copy.display()))?;
    let status = Command::new(&copy).args(arguments).current_dir(root()).env(WRAPPER, &copy).status();
    let status = status.context(|| format!("cannot run {}", copy.display()))?;
    if status.success() { Ok(()) } else { Err(Failure("what is said above fails".into())) }
}

/// Compiles where cargo calls this program in the place of rustc; nothing where it does not.
pub fn stand_in() -> Option<ExitCode> {
    let mut arguments = std::env::args_os().skip(1);
    let rustc = arguments.next().filter(|first| Path::new(first).file_stem() == Some(OsStr::new("rustc")))?;
    let arguments: Vec<OsString> = arguments.collect();
    Some(match compile(&rustc, &arguments) {
        Ok(()) => ExitCode::SUCCESS,
        // Rustc, clippy and rustdoc say what is wrong.
        Err(_) => ExitCode::FAILURE,
    })
}

/// An argument of rustc, with its value where that is the next word.
struct Argument<'a> {
    /// The option, or the file to compile.
    name: &'a str,
    words: &'a [OsString],
}

impl Argument<'_> {
    /// True for the option with a value that begins so.
    fn begins(&self, name: &str, value: &str) -> bool {
        let last = self.words.last().map(|word| word.to_string_lossy());
        self.name == name && last.is_some_and(|word| word.starts_with(value))
    }
}

/// The arguments, each with its value.
fn parted(arguments: &[OsString]) -> Vec<Argument<'_>> {
    let (mut rest, mut parted) = (arguments, Vec::new());
    while let Some(first) = rest.first() {
        let text = first.to_str().unwrap_or_default();
        let name = text.split_once('=').map_or(text, |(name, _)| name);
        let count = if WITH_VALUE.contains(&text) { 2.min(rest.len()) } else { 1 };
        let (words, others) = rest.split_at(count);
        parted.push(Argument { name, words });
        rest = others;
    }
    parted
}

fn compile(rustc: &OsStr, arguments: &[OsString]) -> Result<()> {
    run_command(Command::new(rustc).args(arguments))?;
    let arguments = parted(arguments);
    // Cargo also asks what there is on the machine.
    if !arguments.iter().any(|argument| argument.name == "--out-dir") {
        return Ok(());
    }
    run_command(&mut linter(rustc, &arguments))?;
    let is_test = arguments.iter().any(|argument| argument.name == "--test");
    let source = arguments.iter().find(|argument| argument.name.ends_with(".rs"));
    // Examples, tests and build scripts have no documents.
    let is_documented = source
        .is_some_and(|source| Path::new(source.name).components().any(|part| part.as_os_str() == "src"));
    if is_documented && !is_test { run_command(&mut documenter(rustc, &arguments)) } else { Ok(()) }
}

/// Clippy on what rustc compiles. Warnings are errors.
fn linter(rustc: &OsStr, arguments: &[Argument<'_>]) -> Command {
    let mut clippy = Command::new(Path::new(rustc).with_file_name("clippy-driver"));
    clippy.arg(rustc).arg("--emit=metadata").arg("--out-dir").arg(folder());
    // The driver takes arguments of its own from this variable, in this form.
    clippy.env("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__");
    let kept = arguments
        .iter()
        .filter(|argument| !OF_OUTPUT.contains(&argument.name) && !argument.begins("-C", "incremental="));
    clippy.args(kept.flat_map(|argument| argument.words));
    clippy
}

/// Rustdoc on what rustc compiles. Warnings are errors.
fn documenter(rustc: &OsStr, arguments: &[Argument<'_>]) -> Command {
    let mut rustdoc = Command::new(Path::new(rustc).with_file_name("rustdoc"));
    let kept = arguments
        .iter()
        .filter(|argument| OF_DOCUMENTS.contains(&argument.name) || argument.name.ends_with(".rs"));
    rustdoc.args(kept.flat_map(|argument| argument.words));
    rustdoc.args(["-D", "warnings", "--out-dir"]).arg(folder().join("documents"));
    // Nobody but its authors reads of a program or a plugin.
    if !arguments.iter().any(|argument| argument.begins("--crate-type", "lib")) {
        rustdoc.args(["--document-private-items", "-A", "rustdoc::private-intra-doc-links"]);
    }
    rustdoc
}

#[cfg(test)]
mod tests {
    use super::{OsStr, OsString, linter, parted};

    #[test]
    fn the_linter_gets_what_the_compiler_gets_but_for_its_output() {
        let line = "--crate-name a --edition=2024 a/src/lib.rs --error-format=json --json=artifacts --crate-type lib \
                    --emit=dep-info,metadata,link -C opt-level=1 -C incremental=/t/incremental --out-dir /t --extern b=/t/libb.rmeta";
        let words: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
        let arguments = parted(&words);
        assert_eq!(arguments.iter().map(|argument| argument.words.len()).sum::<usize>(), words.len());
        let command = linter(OsStr::new("/bin/rustc"), &arguments);
        assert_eq!(command.get_program(), "/bin/clippy-driver");
        let given: Vec<_> = command.get_args().map(|word| word.to_string_lossy()).collect();
        let kept = "--crate-name a --edition=2024 a/src/lib.rs --crate-type lib -C opt-level=1 --extern b=/t/libb.rmeta";
        assert_eq!(given[4..].join(" "), kept);
    }
}
