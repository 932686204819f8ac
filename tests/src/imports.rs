//! Imports among the files of a workspace, read from the text alone, and the circles among them.
//!
//! An import is a `use`, re-exports included, or a path of modules in the code, such as `crate::x::y` or
//! `x::y` where `x` is a module. It counts for the file in which the module lies that the path names
//! something of. `mod child;` is no import, `pub(in path)` is none, and what is `#[cfg(test)]` may
//! import what it tests.

mod graph;
mod modules;
pub(crate) mod tokens;

use graph::Imports;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use tokens::{Kind, Token};

/// All circles of files that import each other, over all packages below `root`: of each its files in one line,
/// then its imports. Paths are relative to `root`.
///
/// # Panics
/// When a file cannot be read.
pub fn circles(root: &Path) -> Vec<String> {
    let root = root.canonicalize().unwrap();
    read(&root, |_| true).circles(&root)
}

/// All circles of folders, and of folders and files beside them, as [`circles`] has those of files.
///
/// # Panics
/// When a file cannot be read.
pub fn folder_circles(root: &Path) -> Vec<String> {
    let root = root.canonicalize().unwrap();
    read(&root, |_| true).of_folders().circles(&root)
}

/// Imports of files in one folder below `root` from files in another: the importing file and the other.
///
/// # Panics
/// When a file cannot be read.
pub fn between(root: &Path, from: &str, to: &str) -> Vec<[PathBuf; 2]> {
    let root = root.canonicalize().unwrap();
    // Files import files of their own package alone.
    let importing = root.join(from);
    read(&root, |package| importing.starts_with(package)).between(&root, from, to)
}

/// Imports of those packages below `root` that are wanted.
fn read(root: &Path, is_wanted: impl Fn(&Path) -> bool) -> Imports {
    let mut imports = Imports::default();
    for package in packages(root).into_iter().filter(|package| is_wanted(package)) {
        modules::read_package(&package, &mut imports);
    }
    imports
}

/// Code of one package that another takes by its path, by `#[path]` or `include!`: the file that names it, its line and the
/// path.
///
/// # Panics
/// When a file cannot be read.
pub fn taken_from_elsewhere(root: &Path) -> Vec<String> {
    let root = root.canonicalize().unwrap();
    let packages = packages(&root);
    let home =
        |file: &Path| packages.iter().filter(|p| file.starts_with(p)).max_by_key(|p| p.as_os_str().len());
    let mut found = Vec::new();
    for file in
        packages.iter().flat_map(|package| modules::rust_files(package, true)).collect::<BTreeSet<_>>()
    {
        let source = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        for (path, line) in named_files(&tokens::tokens(&source)) {
            let named = file.with_file_name(&path);
            let named = named.canonicalize().unwrap_or(named);
            if home(&named) != home(&file) {
                let file = file.strip_prefix(&root).unwrap_or(&file).display();
                found.push(format!("{file} takes {path} in line {line}"));
            }
        }
    }
    found
}

/// Paths in `#[path = "..."]` and `include!("...")`, with their lines.
fn named_files(tokens: &[Token]) -> Vec<(String, usize)> {
    let is = |at: usize, kind: &Kind| tokens.get(at).is_some_and(|token| token.kind == *kind);
    let word = |at: usize, word: &str| is(at, &Kind::Word(word.to_owned()));
    let mut found = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        let Kind::Text(path) = &token.kind else { continue };
        let Some(begin) = at.checked_sub(3) else { continue };
        let is_attribute =
            is(begin, &Kind::Sign('[')) && word(begin + 1, "path") && is(begin + 2, &Kind::Sign('='));
        let is_macro =
            word(begin, "include") && is(begin + 1, &Kind::Sign('!')) && is(begin + 2, &Kind::Sign('('));
        if is_attribute || is_macro {
            found.push((path.clone(), token.line));
        }
    }
    found
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
