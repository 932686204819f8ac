//! The program that packs, asked for what it knows of binaries: what they are made of, and the C library that they need.

use crate::error::{Context, Failure, Result};
use crate::tools::{program, run};
use std::path::Path;

/// The package of the program. It must be built before it is asked.
pub const PACKAGE: &str = "isophote-dist";

/// Writes the licences and the bill of materials of all that some of the workspace's packages are compiled of into a folder.
/// `alone` is the machine of packages that are compiled without the rest of the workspace.
///
/// # Errors
/// A licence that is not allowed, and what cannot be read or written.
pub fn write_materials(of: &[&str], alone: Option<&str>, profile: &str, to: &Path) -> Result<()> {
    let mut materials = program(PACKAGE, profile);
    materials.arg("materials").arg(to).args(alone.iter().flat_map(|machine| ["--alone", machine])).args(of);
    run(&mut materials)
}

/// The version of the GNU C library that a binary needs; none on other systems.
///
/// # Errors
/// When the binary cannot be read.
pub fn needed_glibc(binary: &Path, profile: &str) -> Result<Option<String>> {
    let failed = || format!("cannot ask what {} needs", binary.display());
    let output = program(PACKAGE, profile).arg("needs").arg(binary).output().context(failed)?;
    if !output.status.success() {
        return Err(Failure(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
    }
    let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    Ok(Some(version).filter(|version| !version.is_empty()))
}
