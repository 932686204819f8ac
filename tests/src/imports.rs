//! Which file of a workspace imports from which, read from the text alone, and the circles among them.
//!
//! An import is a `use`, re-exports included, or a path of modules in the code, such as `crate::x::y` or
//! `x::y` where `x` is a module. It counts for the file in which the module lies that the path names
//! something of. `mod child;` is no import, `pub(in path)` is none, and what is `#[cfg(test)]` may
//! import what it tests.

mod graph;
mod modules;
pub(crate) mod tokens;

use graph::Imports;
use std::path::{Path, PathBuf};

/// All circles of files that import each other, over all packages below `root`: of each its files in one line,
/// then its imports. Paths are relative to `root`.
///
/// # Panics
/// When a file cannot be read.
pub fn circles(root: &Path) -> Vec<String> {
    let root = root.canonicalize().unwrap();
    all(&root).circles(&root)
}

/// Imports of files in one folder below `root` from files in another: the importing file and the other.
///
/// # Panics
/// When a file cannot be read.
pub fn between(root: &Path, from: &str, to: &str) -> Vec<[PathBuf; 2]> {
    let root = root.canonicalize().unwrap();
    all(&root).between(&root, from, to)
}

/// Imports of all packages below `root`.
fn all(root: &Path) -> Imports {
    let mut imports = Imports::default();
    for package in packages(root) {
        modules::read_package(&package, &mut imports);
    }
    imports
}

/// Folders with a `Cargo.toml` that describes a package, without build results.
fn packages(root: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root.to_owned()];
    while let Some(folder) = folders.pop() {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap_or_default();
        if manifest.lines().any(|line| line.trim() == "[package]") {
            found.push(folder.clone());
        }
        for entry in std::fs::read_dir(&folder).unwrap().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if entry.path().is_dir() && !name.starts_with('.') && name != "target" && name != "out" {
                folders.push(entry.path());
            }
        }
    }
    found.sort();
    found
}
