//! `isophote-dist`, run by `cargo xtask dist`: packs what was built into what users install, and writes the checksums.
//! Every file appears under its name only when all of them are complete. Wheel, Blender extension, npm
//! package and page are made by tools of other languages; this gives them the licences of others and the bill of materials, and publishes them with the rest.

mod archives;
mod binary;
mod desktop;
mod editors;
mod error;
mod licences;
mod metadata;
mod notes;
mod pack;
mod sbom;
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
enum Options {
    /// Writes all that users install
    Pack(Pack),
    /// Prints the version of the C library that a binary needs
    Needs {
        /// The binary
        #[arg(value_name = "FILE")]
        binary: PathBuf,
    },
    /// Writes the licences and the bill of materials of all packages that some of the workspace's are compiled of
    Materials {
        /// The folder that they go to
        #[arg(value_name = "DIR")]
        to: PathBuf,
        /// The machine that they are compiled for, without the rest of the workspace
        #[arg(long, value_name = "TRIPLE")]
        alone: Option<String>,
        /// Packages of the workspace
        #[arg(value_name = "PACKAGE", required = true)]
        of: Vec<String>,
    },
}

#[derive(clap::Args)]
struct Pack {
    /// Folder of the build: the library and the program
    #[arg(long, value_name = "DIR")]
    built: PathBuf,
    /// The OpenFX bundle, with its catalogue beside it
    #[arg(long, value_name = "DIR")]
    bundle: PathBuf,
    /// Folder of the program's icons
    #[arg(long, value_name = "DIR")]
    icons: PathBuf,
    /// Folder of the wheel, the Blender extension, the npm package and the page
    #[arg(long, value_name = "DIR")]
    packed: PathBuf,
    /// Folder that all goes to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Takes binaries with symbols, and packs fast instead of small
    #[arg(long)]
    draft: bool,
}

fn main() -> ExitCode {
    let done = match Options::parse() {
        Options::Pack(options) => pack_all(&options),
        Options::Needs { binary } => {
            binary::needed_glibc(&binary).map(|version| println!("{}", version.unwrap_or_default()))
        }
        Options::Materials { to, alone, of } => {
            let of: Vec<&str> = of.iter().map(String::as_str).collect();
            share::write_materials(&to, &root(), &of, alone.as_deref())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-dist: {error}");
            ExitCode::FAILURE
        }
    }
}

fn pack_all(options: &Pack) -> Result<()> {
    std::fs::create_dir_all(&options.out).map_err(Error::at(&options.out))?;
    let built = Built {
        root: root(),
        folder: options.built.clone(),
        bundle: options.bundle.clone(),
        icons: options.icons.clone(),
        packed: options.packed.clone(),
        draft: options.draft,
    };
    built.check()?;
    let half_done = tempfile::Builder::new()
        .prefix(".packing-")
        .tempdir_in(&options.out)
        .map_err(Error::at(&options.out))?;
    let mut sums = String::new();
    let mut names = Vec::new();
    for archive in &ARCHIVES {
        let (name, sum) = archive.write(&built, half_done.path())?;
        sums.push_str(&format!("{sum}  {name}\n"));
        names.push(name);
    }
    let notes = half_done.path().join(notes::FILE);
    std::fs::write(&notes, notes::of_version(&built.root)?).map_err(Error::at(&notes))?;
    names.extend([notes::FILE, "SHA256SUMS"].map(str::to_owned));
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
