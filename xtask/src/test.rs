//! `cargo xtask test`: everything that must hold before a change lands.

use crate::error::Result;
use crate::setup::{self, BINUTILS, C_COMPILER, CPP_COMPILER, VALGRIND, VULKAN, VULKAN_HEADERS, XVFB};
use crate::tools::{cargo, heading};

/// Options of `cargo xtask test`.
#[derive(clap::Args)]
pub struct Options {
    /// Only the tests; no formatting, lints, documents or generated files
    #[arg(long)]
    tests_only: bool,
}

/// Sets up what the tests need, then runs them all.
///
/// # Errors
/// The first check that fails.
pub fn run(options: &Options) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &CPP_COMPILER, &BINUTILS, &VULKAN, &VULKAN_HEADERS, &VALGRIND, &XVFB])?;
    if !options.tests_only {
        heading("formatting");
        cargo(&["fmt", "--all", "--", "--check"])?;
        heading("lints");
        cargo(&["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])?;
        heading("generated files");
        crate::header::run(&crate::header::Options { check: true })?;
        crate::readme::run(&crate::readme::Options { check: true })?;
        heading("documents");
        cargo(&["doc", "--workspace", "--no-deps", "--quiet"])?;
    }
    heading("build");
    cargo(&["build", "--workspace", "--quiet"])?;
    heading("tests");
    // The declared OpenFX interface has a workspace of its own; its manifest says why.
    let manifest = crate::tools::root().join("tests/interface/Cargo.toml");
    let results = crate::tools::target_dir("interface");
    let mut interface = crate::tools::cargo_command(&["test", "--locked", "--quiet", "--manifest-path"]);
    crate::tools::run(interface.arg(manifest).arg("--target-dir").arg(results))?;
    cargo(&["test", "--workspace", "--no-fail-fast"])
}

/// Makes the golden images anew. Look at them before they are committed.
///
/// # Errors
/// When they cannot be made.
pub fn bless() -> Result<()> {
    let mut command = crate::tools::cargo_command(&["test", "--workspace", "--test", "goldens"]);
    crate::tools::run(command.env("ISOPHOTE_BLESS", "1"))
}
