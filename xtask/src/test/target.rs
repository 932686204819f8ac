//! `cargo xtask test --target`: the tests of pixels on another kind of processor, emulated, and what can be said of systems
//! that are not there.
//!
//! Tests of what must be the same everywhere are run as they are run here: engine, library, plugin, and the program `bits`,
//! which compares the bits of every node with the committed table. Nothing of it needs a graphics device.
//!
//! The target's standard library is that of the compiler, where `rustup target add` brought it. Otherwise compiler and
//! library are Debian's; the library's package is unpacked beside the build, since to install it would need a second
//! architecture in the system's list of packages.

use super::programs::{self, Program};
use super::report;
use crate::error::{Context, Failure, Result};
use crate::setup::{self, AARCH64, AARCH64_TARGET, C_COMPILER, STD_SOURCES, SYSTEM_RUSTC};
use crate::tools::{cargo_command, heading, run as run_command, target_dir};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Machines other than this one.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum Target {
    /// 64-bit ARM with Linux, in QEMU
    Aarch64,
    /// Only types: the library, the plugin and the program for macOS on ARM and for Windows by Microsoft's compiler
    Check,
}

/// Targets whose types are checked.
const CHECKED: [&str; 2] = ["aarch64-apple-darwin", "x86_64-pc-windows-msvc"];

/// Packages that are checked for them: all that users install but the wheel, which asks the interpreter of the target.
const INSTALLED: [&str; 3] = ["isophote", "isophote-plugin", "isophote-program"];

/// Emulator of its programs, with the system's libraries of the cross compiler.
const RUNNER: [&str; 3] = ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"];

const PACKAGES: [&str; 4] = ["isophote-engine", "isophote", "isophote-plugin", "isophote-tests"];

/// Programs of tests beside the packages' own.
const PROGRAMS: [&str; 12] = [
    "plan",
    "control",
    "cpu",
    "directives",
    "graph",
    "importance",
    "line_wobble",
    "lines",
    "smoothing",
    "toon_shading",
    "bits",
    "goldens",
];

/// Package of Debian that holds its standard library.
const STD: &str = "libstd-rust-web-dev";

/// Runs the tests of a target whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the programs that fail.
pub fn run(target: Target, filter: Option<&str>) -> Result<()> {
    match target {
        Target::Aarch64 => emulate(filter),
        Target::Check => CHECKED.iter().try_for_each(|target| check(target)),
    }
}

/// Checks types. Where the compiler lacks the target's standard library, that of Debian's compiler is checked along.
fn check(target: &str) -> Result<()> {
    setup::ensure(&[&C_COMPILER])?;
    heading(target);
    let mut check = cargo_command(&["check", "--quiet", "--target", target]);
    check.args(INSTALLED.iter().flat_map(|package| ["--package", package]));
    check.env("CARGO_TARGET_DIR", target_dir("checks"));
    if !setup::has_target(target) {
        setup::ensure(&[&STD_SOURCES])?;
        check.arg("-Zbuild-std=std,panic_abort,panic_unwind");
        check.env("RUSTC", SYSTEM_RUSTC).env("RUSTC_BOOTSTRAP", "1");
    }
    run_command(&mut check)
}

/// Runs the tests of ARM.
fn emulate(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &AARCH64])?;
    let mut build = cargo_command(&["test", "--target", AARCH64_TARGET, "--lib"]);
    build.args(PACKAGES.iter().flat_map(|package| ["--package", package]));
    build.args(PROGRAMS.iter().flat_map(|program| ["--test", program]));
    build.env(variable("LINKER"), "aarch64-linux-gnu-gcc").env("CARGO_TARGET_DIR", target_dir("aarch64"));
    if !setup::has_target(AARCH64_TARGET) {
        heading("standard library");
        let sysroot = debian_sysroot()?;
        build
            .env("RUSTC", SYSTEM_RUSTC)
            .env(variable("RUSTFLAGS"), format!("--sysroot={}", sysroot.display()));
    }
    heading("build");
    let programs = programs::build(build)?;
    heading("tests");
    let ran = programs.into_iter().filter_map(|program| run_program(program, filter).transpose());
    let failed = report::sum_up(ran.collect::<Result<_>>()?);
    heading("end");
    if failed.is_empty() { Ok(()) } else { Err(Failure(format!("these tests fail: {}", failed.join(", ")))) }
}

/// Runs a program's tests whose names contain the filter; `None` where there are none.
fn run_program(program: Program, filter: Option<&str>) -> Result<Option<report::Ran>> {
    let tests = program.tests(filter.unwrap_or_default(), &RUNNER)?;
    if tests.is_empty() {
        return Ok(None);
    }
    let mut command = program.command(&RUNNER);
    command.args(filter.filter(|filter| !program.name.contains(filter)));
    // Tests that can use a graphics device must not insist on one.
    command.env_remove("CI").env_remove("ISOPHOTE_REQUIRE_GPU");
    let started = Instant::now();
    let output = command.output();
    Ok(Some(report::show(program, &output, started.elapsed().as_secs_f64())))
}

/// Name of a variable that tells cargo something of the target.
fn variable(what: &str) -> String {
    format!("CARGO_TARGET_{}_{what}", AARCH64_TARGET.to_uppercase().replace('-', "_"))
}

/// Folder of the standard library of Debian's compiler for the target, fetched at the first call and when the compiler changed.
fn debian_sysroot() -> Result<PathBuf> {
    let version = debian_version()?;
    let folder = target_dir("aarch64").join("std").join(version.replace([':', '~', '+'], "-"));
    let sysroot = folder.join("usr");
    if !sysroot.is_dir() {
        let unpacked = folder.with_extension("part");
        fetch(&format!("{STD}={version}"), &unpacked)?;
        fs::rename(&unpacked, &folder).context(|| format!("cannot create {}", folder.display()))?;
    }
    Ok(sysroot)
}

/// Version of Debian's compiler, which its standard library must have, too.
fn debian_version() -> Result<String> {
    let mut query = Command::new("dpkg-query");
    let output = query.args(["--show", "--showformat=${Version}", "rustc-web"]).output();
    let output = output.context(|| "dpkg-query cannot be started".into())?;
    if !output.status.success() {
        return Err(Failure(format!(
            "Debian's rustc-web is not installed; rustup target add {AARCH64_TARGET} does as well"
        )));
    }
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Unpacks a package for ARM into a folder. Its lists of packages lie there, apart from those of the system.
fn fetch(package: &str, folder: &Path) -> Result<()> {
    let cannot = || format!("cannot write to {}", folder.display());
    let _ = fs::remove_dir_all(folder);
    let apt = folder.join("apt");
    for part in ["lists/partial", "cache/archives/partial"] {
        fs::create_dir_all(apt.join(part)).context(cannot)?;
    }
    fs::write(apt.join("status"), "").context(cannot)?;
    let configuration = apt.join("apt.conf");
    let at = apt.display();
    let text = format!(
        "APT::Architecture \"arm64\";\nAPT::Architectures {{ \"arm64\"; }};\nDir::State \"{at}\";\n\
         Dir::State::lists \"{at}/lists\";\nDir::State::status \"{at}/status\";\nDir::Cache \"{at}/cache\";\n\
         APT::Sandbox::User \"\";\n"
    );
    fs::write(&configuration, text).context(cannot)?;
    let get = |arguments: &[&str]| {
        let mut get = Command::new("apt-get");
        get.args(["-q", "-q"]).args(arguments).current_dir(folder).env("APT_CONFIG", &configuration);
        run_command(get.stdout(Stdio::null()))
    };
    get(&["update"])?;
    get(&["download", package])?;
    let entries = fs::read_dir(folder).context(cannot)?.filter_map(|entry| Some(entry.ok()?.path()));
    for file in entries.filter(|path| path.extension().is_some_and(|e| e == "deb")) {
        run_command(Command::new("dpkg").arg("--extract").arg(&file).arg(folder))?;
        fs::remove_file(&file).context(cannot)?;
    }
    fs::remove_dir_all(&apt).context(cannot)
}

#[cfg(test)]
mod tests {
    #[test]
    fn variables_are_named_as_cargo_names_them() {
        assert_eq!(super::variable("LINKER"), "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER");
    }
}
