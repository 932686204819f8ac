//! Files that several archives hold: the licences, the bill of materials, and the dynamic library as systems want it.

use crate::binary;
use crate::error::{Error, Result};
use crate::licences;
use crate::metadata::dependencies;
use crate::pack::write_text;
use crate::sbom;
use crate::tree::{Entry, Tree};
use std::path::Path;

/// The version that everything bears.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The version of the C interface, from the header that declares it.
///
/// # Errors
/// When the header cannot be read or declares none.
pub fn abi_version(root: &Path) -> Result<u32> {
    let header = root.join("include/isophote.h");
    let text = std::fs::read_to_string(&header).map_err(Error::at(&header))?;
    let number = text.lines().find_map(|line| line.strip_prefix("#define ISOPHOTE_ABI_VERSION "));
    number.and_then(|n| n.trim().parse().ok()).ok_or_else(|| Error::malformed(&header, "declares no version"))
}

/// Adds Isophote's licences, and those and the list of all packages that `packages` are compiled of.
///
/// # Errors
/// A licence that is not allowed, and what cannot be read.
pub fn add_licences(tree: &mut Tree, place: &str, root: &Path, packages: &[&str]) -> Result<()> {
    for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
        tree.copy(format!("{place}/{name}"), root.join(name));
    }
    for (name, text) in materials(root, packages, None)? {
        tree.text(format!("{place}/{name}"), text);
    }
    Ok(())
}

/// Writes the licences and the list of all packages that `packages` are compiled of into a folder; of those that are compiled
/// alone for another machine, where it is named.
///
/// # Errors
/// A licence that is not allowed, and what cannot be read or written.
pub fn write_materials(folder: &Path, root: &Path, packages: &[&str], alone: Option<&str>) -> Result<()> {
    materials(root, packages, alone)?
        .into_iter()
        .try_for_each(|(name, text)| write_text(&folder.join(name), &text))
}

/// Names and texts of the files that tell what `packages` are compiled of.
fn materials(root: &Path, packages: &[&str], alone: Option<&str>) -> Result<[(&'static str, String); 2]> {
    let linked = dependencies(root, packages, alone)?;
    Ok([
        ("LICENSES-OF-OTHERS.txt", licences::text(&linked.packages)?),
        (sbom::FILE, sbom::text(VERSION, &linked)?),
    ])
}

/// Names of the installed library: the file, and those that lead to it.
pub struct Names {
    /// The file.
    pub file: String,
    /// Name that programs which link to it look for.
    pub soname: String,
    /// Name that compilers and `dlopen` look for.
    pub plain: String,
}

impl Names {
    /// Packages of this system.
    pub fn new(abi: u32) -> Self {
        let plain = format!("{}isophote{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        if cfg!(windows) {
            return Self { file: plain.clone(), soname: plain.clone(), plain };
        }
        if cfg!(target_os = "macos") {
            let with = |version: &str| format!("libisophote.{version}.dylib");
            return Self { file: with(VERSION), soname: with(&abi.to_string()), plain };
        }
        Self { file: format!("{plain}.{VERSION}"), soname: format!("{plain}.{abi}"), plain }
    }
}

/// Adds the dynamic library, once it is found fit.
///
/// # Errors
/// [`Error::Unfit`] where it is not, and what cannot be read.
pub fn add_library(tree: &mut Tree, root: &Path, built: &Path, draft: bool) -> Result<()> {
    let names = Names::new(abi_version(root)?);
    let library = built.join(&names.plain);
    binary::check(&library, Some(&names.soname), draft)?;
    if cfg!(windows) {
        tree.copy(format!("bin/{}", names.file), library);
        return Ok(());
    }
    tree.add(format!("lib/{}", names.file), Entry::Program(library));
    tree.add(format!("lib/{}", names.soname), Entry::Link(names.file));
    tree.add(format!("lib/{}", names.plain), Entry::Link(names.soname));
    Ok(())
}
