//! 64-bit ARM with Linux, in QEMU.
//!
//! Tests of what must be the same everywhere are run as they are run here: engine, library, plugin, and the trials `bits`,
//! which compares the bits of every node with the committed table. Nothing of it needs a graphics device.
//!
//! The target's standard library is that of the compiler, where `rustup target add` brought it. Otherwise compiler and
//! library are Debian's; the library's package is unpacked beside the build, since to install it would need a second
//! architecture in the system's list of packages.

use super::running::{run_programs, variable};
use crate::error::{Context, Failure, Result};
use crate::setup::{self, AARCH64, AARCH64_TARGET, C_COMPILER, SYSTEM_RUSTC};
use crate::test::programs;
use crate::tools::{cargo_command, heading, run as run_command, target_dir};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Emulator of its programs, with the system's libraries of the cross compiler.
const RUNNER: [&str; 3] = ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"];

const PACKAGES: [&str; 4] = ["isophote-engine", "isophote", "isophote-plugin", "isophote-tests"];

/// Files of tests beside the packages' own.
const FILES: [&str; 15] = [
    "plan",
    "cel_light",
    "control",
    "cpu",
    "shader_directives",
    "graph",
    "importance",
    "line_sets",
    "line_wobble",
    "lines",
    "materials",
    "smoothing",
    "toon_shading",
    "bits",
    "goldens",
];

/// Package of Debian that holds its standard library.
const STD: &str = "libstd-rust-web-dev";

/// Runs the tests of ARM whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the programs that fail.
pub fn run(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &AARCH64])?;
    let mut build = cargo_command(&["test", "--target", AARCH64_TARGET, "--lib"]);
    build.args(PACKAGES.iter().flat_map(|package| ["--package", package]));
    build.args(["--test", "tests", "--test", "trials"]);
    build
        .env(variable(AARCH64_TARGET, "LINKER"), "aarch64-linux-gnu-gcc")
        .env("CARGO_TARGET_DIR", target_dir("aarch64"));
    if !setup::has_target(AARCH64_TARGET) {
        heading("standard library");
        let sysroot = debian_sysroot()?;
        build
            .env("RUSTC", SYSTEM_RUSTC)
            .env(variable(AARCH64_TARGET, "RUSTFLAGS"), format!("--sysroot={}", sysroot.display()));
    }
    heading("build");
    let programs = programs::build(build)?;
    // Tests that can use a graphics device must not insist on one.
    run_programs(programs, &FILES, filter, &RUNNER, |command| {
        command.env_remove("CI").env_remove("ISOPHOTE_REQUIRE_GPU");
    })
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
