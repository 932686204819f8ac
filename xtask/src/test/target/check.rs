//! Types for systems that are not there.

use crate::error::Result;
use crate::setup::{self, C_COMPILER, STD_SOURCES, SYSTEM_RUSTC};
use crate::tools::{cargo_command, heading, run as run_command, target_dir};

/// Targets whose types are checked.
const CHECKED: [&str; 2] = ["aarch64-apple-darwin", "x86_64-pc-windows-msvc"];

/// Packages that are checked for them: all that users install but the wheel, which asks the interpreter of the target, and what
/// packs it on such machines.
const PACKAGES: [&str; 5] = ["isophote", "isophote-plugin", "isophote-program", "isophote-dist", "xtask"];

/// Checks types for all of them.
///
/// # Errors
/// Things that are missing, and the first target of which the compiler refuses something.
pub fn run() -> Result<()> {
    CHECKED.iter().try_for_each(|target| check(target))
}

/// Checks types. Where the compiler lacks the target's standard library, that of Debian's compiler is checked along.
fn check(target: &str) -> Result<()> {
    setup::ensure(&[&C_COMPILER])?;
    heading(target);
    let mut check = cargo_command(&["check", "--quiet", "--target", target]);
    check.args(PACKAGES.iter().flat_map(|package| ["--package", package]));
    check.env("CARGO_TARGET_DIR", target_dir("checks"));
    if !setup::has_target(target) {
        setup::ensure(&[&STD_SOURCES])?;
        check.arg("-Zbuild-std=std,panic_abort,panic_unwind");
        check.env("RUSTC", SYSTEM_RUSTC).env("RUSTC_BOOTSTRAP", "1");
    }
    run_command(&mut check)
}
