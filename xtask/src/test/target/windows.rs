//! Windows, in Wine.
//!
//! Programs are built by MinGW and run by Wine, which is not Windows: it locks files for those alone that ask, and has rules of
//! its own for names that are in use. Graphics devices are those of Vulkan.
//!
//! The target's standard library is that of the compiler, where `rustup target add` brought it. Otherwise it is built from
//! the sources of Debian's compiler, once.

use super::running::{run_programs, variable};
use crate::error::{Context, Result};
use crate::setup::{self, C_COMPILER, MINGW, STD_SOURCES, SYSTEM_RUSTC, VULKAN, WINDOWS_TARGET, WINE, XVFB};
use crate::test::programs;
use crate::tools::{cargo_command, heading, run as run_command, target_dir};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use wine::{LINKER, Wine};

mod videos;
mod wine;

/// Packages whose tests are run.
const PACKAGES: [&str; 11] = [
    "isophote-files",
    "isophote-loader",
    "isophote-exr-edit",
    "isophote-pictures",
    "isophote-scene",
    "isophote-finishing",
    "isophote-render",
    "isophote-window",
    "isophote-program",
    "isophote-plugin",
    "isophote-tests",
];

/// Files of tests beside the packages' own: of the program, then of the library and the plugin.
const FILES: [&str; 38] = [
    "apply",
    "bad_input",
    "command_line",
    "compose",
    "cryptomatte",
    "drawing",
    "example",
    "export",
    "exr",
    "farms",
    "guides",
    "info",
    "masks",
    "objects",
    "palettes",
    "rendered_mattes",
    "replacing",
    "sequence",
    "several",
    "sheet",
    "staging",
    "stylize",
    "time",
    "video",
    "video_faults",
    "view_chain",
    "view_frames",
    "view_looks",
    "view_panel",
    "view_previews",
    "windows",
    "abi_images",
    "abi_sequences",
    "bits",
    "goldens",
    "looks",
    "openfx",
    "presets",
];

/// Manifest of a crate of nothing.
const CRATE: &str = "[package]\nname = \"standard\"\nedition = \"2024\"\n\n[workspace]\n";

/// Runs the tests of Windows whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the programs that fail.
pub fn run(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &MINGW, &WINE, &XVFB, &VULKAN])?;
    let folder = target_dir("windows");
    let sysroot = if setup::has_target(WINDOWS_TARGET) {
        None
    } else {
        setup::ensure(&[&STD_SOURCES])?;
        heading("standard library");
        Some(sysroot(&folder.join("std"))?)
    };
    let build = |arguments: &[&str]| {
        let mut build = cargo_command(arguments);
        build.args(["--target", WINDOWS_TARGET]).env("CARGO_TARGET_DIR", &folder);
        build.env(variable(WINDOWS_TARGET, "LINKER"), LINKER);
        if let Some(sysroot) = &sysroot {
            build.env("RUSTC", SYSTEM_RUSTC);
            build.env(variable(WINDOWS_TARGET, "RUSTFLAGS"), format!("--sysroot={}", sysroot.display()));
        }
        build
    };
    heading("build");
    run_command(
        build(&["build", "--quiet"])
            .args(named("--package", &["isophote-plugin", "isophote-program", "isophote-example"])),
    )?;
    let mut tests = build(&["test", "--lib", "--bins"]);
    tests.args(named("--package", &PACKAGES)).args(["--test", "tests", "--test", "trials"]);
    let programs = programs::build(tests)?;
    let library = folder.join(WINDOWS_TARGET).join("debug/isophote.dll");
    let wine = Wine::start(&folder.join("wine"))?;
    videos::put(&folder.join("videos"), &wine.programs())?;
    run_programs(programs, &FILES, filter, &["wine"], |command| {
        wine.prepare(command);
        command.env("ISOPHOTE_LIBRARY", wine::path(&library));
    })
}

/// Each of some names after the argument that takes it.
fn named<'a>(argument: &'a str, names: &'a [&'a str]) -> impl Iterator<Item = &'a str> {
    names.iter().flat_map(move |name| [argument, *name])
}

/// Sysroot of the system's compiler with the standard library for Windows, built at the first call and when the compiler
/// changed.
fn sysroot(folder: &Path) -> Result<PathBuf> {
    let cannot = || format!("cannot write to {}", folder.display());
    let version = Command::new(SYSTEM_RUSTC).arg("--version").output();
    let version = version.context(|| format!("{SYSTEM_RUSTC} cannot be started"))?;
    let version =
        String::from_utf8_lossy(&version.stdout).trim().replace(|c: char| !c.is_alphanumeric(), "-");
    let sysroot = folder.join(version);
    let libraries = sysroot.join("lib/rustlib").join(WINDOWS_TARGET).join("lib");
    if !libraries.is_dir() {
        let whole = libraries.with_extension("part");
        let _ = fs::remove_dir_all(&whole);
        fs::create_dir_all(&whole).context(cannot)?;
        build_std(&folder.join("build"), &whole)?;
        fs::rename(&whole, &libraries).context(cannot)?;
    }
    Ok(sysroot)
}

/// Builds the standard library in a folder and puts its files into another.
fn build_std(folder: &Path, out: &Path) -> Result<()> {
    let cannot = || format!("cannot write to {}", folder.display());
    let sources = setup::sysroot(SYSTEM_RUSTC).unwrap_or_default().join("lib/rustlib/src/rust/library");
    // Cargo builds them along with any crate.
    fs::create_dir_all(folder.join("src")).context(cannot)?;
    fs::write(folder.join("Cargo.toml"), CRATE).context(cannot)?;
    fs::write(folder.join("src/lib.rs"), "").context(cannot)?;
    let mut build = cargo_command(&["build", "--quiet", "--release", "--target", WINDOWS_TARGET]);
    build.arg("-Zbuild-std=std,test,panic_abort,panic_unwind").current_dir(folder);
    build
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env("RUSTC", SYSTEM_RUSTC)
        .env("RUSTC_BOOTSTRAP", "1");
    run_command(&mut build)?;
    // Not among what cargo builds: every program begins and ends with them.
    for part in ["rsbegin", "rsend"] {
        let mut compile = Command::new(SYSTEM_RUSTC);
        compile.args(["--target", WINDOWS_TARGET, "--emit=obj", "--crate-type=lib", "-o"]);
        compile.arg(out.join(format!("{part}.o"))).arg(sources.join(format!("rtstartup/{part}.rs")));
        run_command(compile.env("RUSTC_BOOTSTRAP", "1"))?;
    }
    let built = folder.join("target").join(WINDOWS_TARGET).join("release/deps");
    for entry in fs::read_dir(&built).context(cannot)? {
        let file = entry.context(cannot)?.path();
        if file.extension().is_some_and(|end| end == "rlib") {
            fs::copy(&file, out.join(file.file_name().unwrap_or_default())).context(cannot)?;
        }
    }
    Ok(())
}
