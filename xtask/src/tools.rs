//! Running cargo and the host from a chore.

use crate::error::{Context, Failure, Result};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Instant;

/// The root of the repository.
pub fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_owned()
}

/// Options of a chore that are those of the program which does the work.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct HandedOn {
    /// --help lists what may be chosen
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub arguments: Vec<String>,
}

/// The variable by which cargo is told of a compiler for the crates of the workspace, which gets rustc and its arguments.
pub const WRAPPER: &str = "RUSTC_WORKSPACE_WRAPPER";

/// Prints the heading of the next step, and how long the chore has run since its first heading.
pub fn heading(what: &str) {
    static STARTED: OnceLock<Instant> = OnceLock::new();
    let seconds = STARTED.get_or_init(Instant::now).elapsed().as_secs();
    println!("\n== {what} ({}:{:02})", seconds / 60, seconds % 60);
}

/// A cargo command at the root of the repository. Warnings of documents are errors, and tests that
/// need a graphics adapter must find one.
pub fn cargo_command(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command
        .args(arguments)
        .current_dir(root())
        .env("RUSTDOCFLAGS", "-D warnings")
        .env("ISOPHOTE_REQUIRE_GPU", "1");
    // Mesa's layer that orders devices complains on machines without a desktop.
    command.env("NODEVICE_SELECT", "1");
    command
}

/// Runs cargo at the root of the repository.
///
/// # Errors
/// The command line, when it fails.
pub fn cargo(arguments: &[&str]) -> Result<()> {
    run(&mut cargo_command(arguments))
}

/// Folder where a build leaves its programs and libraries: `debug`, or the name of another profile.
pub fn target_dir(profile: &str) -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    target.join(profile)
}

/// Builds programs of the workspace. Their dependencies have the features that they have when the whole
/// workspace is built, so that nothing is compiled twice.
///
/// # Errors
/// The command line, when it fails.
pub fn build(profile: &str, programs: &[&str]) -> Result<()> {
    let mut command = cargo_command(&["build", "--workspace"]);
    command.args(programs.iter().flat_map(|program| ["--bin", program]));
    run(command.args(chosen(profile)))
}

/// Builds the dynamic library, the sample host and some more programs. The libraries of the workspace come along,
/// for a choice of packages would give their dependencies other features and compile them anew.
///
/// # Errors
/// The command line, when it fails.
pub fn build_with_host(profile: &str, more: &[&str]) -> Result<()> {
    let mut command = cargo_command(&["build", "--workspace", "--lib", "--bin", "isophote"]);
    command.args(more.iter().flat_map(|program| ["--bin", program]));
    run(command.args(chosen(profile)))
}

/// Arguments that tell cargo the profile of that folder.
fn chosen(profile: &str) -> Vec<&str> {
    if profile == "debug" { Vec::new() } else { vec!["--profile", profile] }
}

/// Builds the dynamic library, the others of the workspace as [`build_with_host`] does, and some programs.
///
/// # Errors
/// The command line, when it fails.
pub fn build_library(profile: &str, programs: &[&str]) -> Result<()> {
    let mut command = cargo_command(&["build", "--quiet", "--workspace", "--lib"]);
    command.args(programs.iter().flat_map(|program| ["--bin", program]));
    run(command.args(chosen(profile)))
}

/// The dynamic library of a build.
pub fn library_file(profile: &str) -> PathBuf {
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    target_dir(profile).join(format!("{prefix}isophote{suffix}"))
}

/// The dynamic library where it lies after a build that was asked for a program alone.
pub fn built_library(profile: &str) -> PathBuf {
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    target_dir(profile).join("deps").join(format!("{prefix}isophote{suffix}"))
}

fn program_file(name: &str, profile: &str) -> PathBuf {
    target_dir(profile).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// A program of a build.
pub fn program(name: &str, profile: &str) -> Command {
    let mut command = Command::new(program_file(name, profile));
    command.env("NODEVICE_SELECT", "1");
    command
}

/// The file of the sample host of a build.
pub fn host_file(profile: &str) -> PathBuf {
    program_file("isophote", profile)
}

/// The sample host of a build.
pub fn host(profile: &str) -> Command {
    program("isophote", profile)
}

/// Runs a command to its end.
///
/// # Errors
/// The command line, when it fails or cannot be started.
pub fn run(command: &mut Command) -> Result<()> {
    let line = || {
        let words = std::iter::once(command.get_program()).chain(command.get_args());
        words.map(|w| w.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
    };
    let line = line();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Failure(format!("`{line}` ended with {status}"))),
        Err(error) => Err(Failure(format!("`{line}` cannot be started: {error}"))),
    }
}

/// The files of the looks that ship, each with its id, in their order.
///
/// # Errors
/// When the list cannot be read.
pub fn looks() -> Result<Vec<(String, PathBuf)>> {
    let folder = root().join("nodes/library/looks");
    let order = folder.join("order.txt");
    let text = std::fs::read_to_string(&order).context(|| format!("cannot read {}", order.display()))?;
    let list = text.split_once('{').and_then(|(_, rest)| rest.split_once('}'));
    let (ids, _) = list.ok_or_else(|| Failure(format!("{} has no list", order.display())))?;
    Ok(ids.split_whitespace().map(|id| (id.to_owned(), folder.join(format!("{id}.json")))).collect())
}
