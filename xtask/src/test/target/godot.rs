//! The extension for Godot, which is a workspace of its own, in a project that Godot runs.

use crate::error::{Context, Failure, Result};
use crate::setup::{self, C_COMPILER, VULKAN, XVFB};
use crate::tools::{cargo_command, heading, root, run as run_command, target_dir};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Variable that names the program.
const VARIABLE: &str = "GODOT";

/// Scene that runs the tests and ends with the number of those that fail.
const TESTS: &str = "res://tests/run.tscn";

/// Looks at the extension's code, and runs its tests in Godot.
///
/// # Errors
/// Things that are missing, and the first step that fails.
pub fn run() -> Result<()> {
    let Some(godot) = program() else {
        return Err(Failure(format!(
            "Godot 4.4 or newer is not there: install it, or set {VARIABLE} to its program"
        )));
    };
    setup::ensure(&[&C_COMPILER, &VULKAN, &XVFB])?;
    heading("lints");
    run_command(cargo("clippy").args(["--all-targets", "--", "-D", "warnings"]))?;
    heading("extension");
    run_command(&mut cargo("build"))?;
    let project = target_dir("godot").join("project");
    if project.exists() {
        std::fs::remove_dir_all(&project).context(|| format!("cannot replace {}", project.display()))?;
    }
    copy(&root().join("nodes/godot/project"), &project)?;
    let library = format!("{DLL_PREFIX}isophote_godot{DLL_SUFFIX}");
    copy(&target_dir("godot").join("debug").join(&library), &project.join("addons/isophote").join(&library))?;
    heading("Godot");
    // A project knows its extensions once it was imported.
    run_command(display(&godot).arg("--path").arg(&project).arg("--import"))?;
    run_command(display(&godot).arg("--path").arg(&project).args(["--audio-driver", "Dummy", TESTS]))
}

/// Godot: what the variable names, or a program that is found.
pub fn program() -> Option<PathBuf> {
    if let Some(named) = std::env::var_os(VARIABLE) {
        return Some(named.into());
    }
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
    let names = ["godot4", "godot"].into_iter();
    names.flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|path| path.is_file())
}

/// The program on the display that is there, or one without a screen.
fn display(godot: &Path) -> Command {
    let mut command = if cfg!(target_os = "linux") && std::env::var_os("DISPLAY").is_none() {
        let mut command = Command::new("xvfb-run");
        command.arg("--auto-servernum").arg(godot);
        command
    } else {
        Command::new(godot)
    };
    command.env("NODEVICE_SELECT", "1");
    command
}

/// A command of cargo on the extension's manifest.
fn cargo(verb: &str) -> Command {
    let mut command = cargo_command(&[verb, "--locked", "--quiet", "--manifest-path"]);
    command.arg(root().join("nodes/godot/Cargo.toml")).arg("--target-dir").arg(target_dir("godot"));
    command
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let failed = || format!("cannot copy {} to {}", from.display(), to.display());
    if !from.is_dir() {
        std::fs::copy(from, to).context(failed)?;
        return Ok(());
    }
    std::fs::create_dir_all(to).context(failed)?;
    for entry in std::fs::read_dir(from).context(failed)? {
        let path = entry.context(failed)?.path();
        copy(&path, &to.join(path.file_name().unwrap_or_default()))?;
    }
    Ok(())
}
