//! The program that packs, asked for what it knows of binaries: their licences and the C library that they need.

use crate::error::{Context, Failure, Result};
use crate::tools::{program, run};
use std::path::Path;

/// The package of the program. It must be built before it is asked.
pub const PACKAGE: &str = "isophote-dist";

/// Name of the file that holds the licences of others.
pub const OTHERS: &str = "LICENSES-OF-OTHERS.txt";

/// Writes the licences of all that some of the workspace's packages are compiled of.
///
/// # Errors
/// A licence that is not allowed, and what cannot be read or written.
pub fn write_licences(of: &[&str], profile: &str, to: &Path) -> Result<()> {
    run(program(PACKAGE, profile).arg("licences").arg(to).args(of))
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
