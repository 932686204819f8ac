//! `cargo xtask card`: a folder, and an archive of it, that measures graphics cards on other machines, where there is no Rust.
//! It is one of the archives of `cargo xtask dist`, unpacked.

use crate::dist;
use crate::error::{Context, Failure, Result};
use crate::tools::{heading, root, run as run_command};
use std::path::Path;
use std::process::Command;

/// Most bytes of the folder, so that it can be sent.
const MOST: u64 = 60 << 20;

/// Makes the archives, unpacks the one for cards, and says how large it is.
///
/// # Errors
/// The first step that fails; a folder that is too large to be sent.
pub fn run(options: &dist::Options) -> Result<()> {
    dist::run(options)?;
    heading("folder");
    let (system, machine) = (std::env::consts::OS, std::env::consts::ARCH);
    let name = format!("isophote-card-{}-{system}-{machine}", env!("CARGO_PKG_VERSION"));
    let out = root().join(&options.out);
    let folder = out.join(&name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).context(|| format!("cannot replace {}", folder.display()))?;
    }
    let archive = out.join(format!("{name}.tar.gz"));
    run_command(Command::new("tar").arg("-xzf").arg(&archive).arg("-C").arg(&out))?;
    let bytes = size(&folder)?;
    println!("{} ({:.1} MB)", folder.display(), bytes as f64 / 1e6);
    if bytes > MOST && !options.is_draft() {
        return Err(Failure(format!("{} has {bytes} bytes, more than {MOST}", folder.display())));
    }
    Ok(())
}

/// Bytes of a file, or of all files of a folder; links have none.
fn size(path: &Path) -> Result<u64> {
    let failed = || format!("cannot read {}", path.display());
    let data = std::fs::symlink_metadata(path).context(failed)?;
    if !data.is_dir() {
        return Ok(if data.is_file() { data.len() } else { 0 });
    }
    let entries = std::fs::read_dir(path).context(failed)?;
    entries.flatten().map(|entry| size(&entry.path())).sum()
}
