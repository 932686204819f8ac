//! ffmpeg and ffprobe for Windows, of packages that hold the programs themselves. Wine hands pipes to these, and not to those of
//! the system.

use crate::error::{Context, Failure, Result};
use crate::python;
use crate::setup::{self, NODE, PYTHON};
use crate::tools::run as run_command;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Python's package that holds ffmpeg 9.
const FFMPEG: &str = "imageio-ffmpeg==0.8.1";

/// npm's package that holds ffprobe 6.
const FFPROBE: &str = "@ffprobe-installer/win32-x64@5.1.0";

/// Puts both into a folder of programs. `folder` holds the packages, which are fetched at the first call.
///
/// # Errors
/// Packages that cannot be had.
pub fn put(folder: &Path, programs: &Path) -> Result<()> {
    let [by_python, by_npm] = ["python", "npm"].map(|part| folder.join(part));
    let binaries = by_python.join("imageio_ffmpeg/binaries");
    if program(&binaries).is_none() {
        setup::ensure(&[&PYTHON])?;
        python::unpack_for_windows(FFMPEG, &by_python)?;
    }
    let probe = by_npm.join("node_modules/@ffprobe-installer/win32-x64/ffprobe.exe");
    if !probe.is_file() {
        setup::ensure(&[&NODE])?;
        let mut npm = Command::new("npm");
        // By force, since it is for another system.
        npm.args(["install", "--force", "--no-save", "--no-audit", "--no-fund", "--ignore-scripts"]);
        run_command(npm.args(["--loglevel=error", "--prefix"]).arg(&by_npm).arg(FFPROBE))?;
    }
    let ffmpeg = program(&binaries)
        .ok_or_else(|| Failure(format!("{FFMPEG} has no program in {}", binaries.display())))?;
    for (from, name) in [(ffmpeg, "ffmpeg.exe"), (probe, "ffprobe.exe")] {
        fs::copy(&from, programs.join(name)).context(|| format!("cannot copy {}", from.display()))?;
    }
    Ok(())
}

/// The program in a folder, if there is one.
fn program(folder: &Path) -> Option<PathBuf> {
    let files = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    files.into_iter().find(|file| file.extension().is_some_and(|end| end == "exe"))
}
