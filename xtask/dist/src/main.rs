//! `isophote-dist`, run by `cargo xtask dist`: packs what was built into the archives that users install, and writes
//! their checksums. Every archive appears under its name only when all of them are complete.

mod archives;
mod binary;
mod editors;
mod error;
mod licences;
mod metadata;
mod pack;
mod share;
mod tree;

use archives::{ARCHIVES, Built};
use clap::Parser;
use error::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Packs what was built.
#[derive(Parser)]
#[command(bin_name = "cargo xtask dist")]
struct Options {
    /// Folder of the build: the library and the program
    #[arg(long, value_name = "DIR")]
    built: PathBuf,
    /// The OpenFX bundle, with its catalogue beside it
    #[arg(long, value_name = "DIR")]
    bundle: PathBuf,
    /// Where the archives go
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Takes binaries with symbols, and packs fast instead of small
    #[arg(long)]
    draft: bool,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-dist: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<()> {
    std::fs::create_dir_all(&options.out).map_err(Error::at(&options.out))?;
    let built = Built::find(&root(), &options.built, &options.bundle, options.draft)?;
    let half_done = tempfile::Builder::new()
        .prefix(".packing-")
        .tempdir_in(&options.out)
        .map_err(Error::at(&options.out))?;
    let mut sums = String::new();
    let mut names = Vec::new();
    for archive in &ARCHIVES {
        let name = archive.name();
        let file = half_done.path().join(format!("{name}.tar.gz"));
        let sum = pack::pack(&archive.tree(&built)?, &name, &file, options.draft)?;
        sums.push_str(&format!("{sum}  {name}.tar.gz\n"));
        names.push(format!("{name}.tar.gz"));
    }
    names.push("SHA256SUMS".to_owned());
    let list = half_done.path().join("SHA256SUMS");
    std::fs::write(&list, sums).map_err(Error::at(&list))?;
    publish(half_done.path(), &options.out, &names)
}

/// Gives complete files their names. Checksums come last, and never beside archives of another run.
fn publish(from: &Path, to: &Path, names: &[String]) -> Result<()> {
    let sums = to.join("SHA256SUMS");
    if sums.exists() {
        std::fs::remove_file(&sums).map_err(Error::at(&sums))?;
    }
    for name in names {
        let target = to.join(name);
        std::fs::rename(from.join(name), &target).map_err(Error::at(&target))?;
        let size = std::fs::metadata(&target).map_err(Error::at(&target))?.len();
        println!("{} ({:.1} MB)", target.display(), size as f64 / 1e6);
    }
    Ok(())
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
