//! The plugin for Bevy, which is a workspace of its own.

use crate::error::Result;
use crate::setup::{self, C_COMPILER, VULKAN};
use crate::tools::{cargo_command, heading, root, run as run_command, target_dir};
use std::process::Command;

/// Looks at its code and runs those of its tests whose names contain the filter; without one all.
///
/// # Errors
/// Things that are missing, and the first step that fails.
pub fn run(filter: Option<&str>) -> Result<()> {
    setup::ensure(&[&C_COMPILER, &VULKAN])?;
    heading("lints");
    run_command(cargo("clippy").args(["--all-targets", "--", "-D", "warnings"]))?;
    heading("tests");
    // An application takes the threads of all cores by itself.
    run_command(cargo("test").args(["--all-targets", "--", "--test-threads", "1"]).args(filter))
}

/// A command of cargo on its manifest.
fn cargo(verb: &str) -> Command {
    let mut command = cargo_command(&[verb, "--locked", "--quiet", "--manifest-path"]);
    command.arg(root().join("nodes/bevy/Cargo.toml")).arg("--target-dir").arg(target_dir("bevy"));
    // Bevy asks for a later compiler than it needs.
    command.arg("--ignore-rust-version");
    command
}
