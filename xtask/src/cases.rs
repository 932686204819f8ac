//! The cases of `tests/data/cases`: files of kinds that other programs write, one folder a case, each with a note of what is
//! right. Tests that name `cases` assert them; `cargo xtask test cases` runs these, and tells of folders that none names.

use crate::error::{Context, Failure, Result};
use crate::tools::root;
use std::path::{Path, PathBuf};

/// Filter that means them.
pub const FILTER: &str = "cases";
/// Folder of the cases.
const FOLDER: &str = "tests/data/cases";
/// Folders of tests.
const SOURCES: [&str; 3] = ["host-example", "nodes", "tests"];

/// Makes sure that every folder has its note and is named by a test that the filter finds.
///
/// # Errors
/// The folders that are not.
pub fn check() -> Result<()> {
    let folder = root().join(FOLDER);
    let tests = tests()?;
    let (mut problems, mut count) = (Vec::new(), 0);
    for entry in std::fs::read_dir(&folder).context(|| format!("cannot read {}", folder.display()))? {
        let path = entry.context(|| format!("cannot read {}", folder.display()))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        count += 1;
        if !path.join("note.txt").is_file() {
            problems.push(format!("{FOLDER}/{name} has no note.txt"));
        }
        if !tests.iter().any(|test| names(test, &name)) {
            problems.push(format!("no test named 'cases' names {FOLDER}/{name}"));
        }
    }
    if count == 0 {
        problems.push(format!("{FOLDER} is empty"));
    }
    if problems.is_empty() { Ok(()) } else { Err(Failure(problems.join("; "))) }
}

/// True where a test names a case: alone in quotes, or as a folder of a path.
fn names(test: &str, case: &str) -> bool {
    [format!("\"{case}\""), format!("\"{case}/"), format!("cases/{case}\""), format!("cases/{case}/")]
        .iter()
        .any(|form| test.contains(form))
}

/// The texts of tests that the filter finds: of files that bear its name, and those that declare a test that does.
fn tests() -> Result<Vec<String>> {
    let mut found = Vec::new();
    let mut folders: Vec<PathBuf> = SOURCES.iter().map(|folder| root().join(folder)).collect();
    while let Some(folder) = folders.pop() {
        let failed = || format!("cannot read {}", folder.display());
        for entry in std::fs::read_dir(&folder).context(failed)? {
            let path = entry.context(failed)?.path();
            if path.is_dir() {
                folders.push(path);
            } else if is_source(&path) {
                let text =
                    std::fs::read_to_string(&path).context(|| format!("cannot read {}", path.display()))?;
                if is_found(&path, &text) {
                    found.push(text);
                }
            }
        }
    }
    Ok(found)
}

fn is_source(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "rs" || extension == "py")
}

fn is_found(path: &Path, text: &str) -> bool {
    let is_named = path.file_stem().is_some_and(|stem| stem.to_string_lossy().contains(FILTER));
    let declares = |line: &str| {
        let name = line.trim_start().strip_prefix("fn ").or_else(|| line.strip_prefix("def test_"));
        name.and_then(|name| name.split_once('(')).is_some_and(|(name, _)| name.contains(FILTER))
    };
    is_named || text.lines().any(declares)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_folder_of_cases_is_named_by_a_test() {
        check().unwrap();
    }

    #[test]
    fn names_are_whole() {
        assert!(names("case(\"obj_tr\")", "obj_tr") && names("read(\"cases/obj_tr/a.obj\")", "obj_tr"));
        assert!(!names("case(\"obj_tr_more\")", "obj_tr") && !names("// obj_tr", "obj_tr"));
        assert!(is_found(Path::new("a.rs"), "    fn cases_of_a_kind_are_right() {"));
        assert!(!is_found(Path::new("a.rs"), "// fn cases of a kind"));
    }
}
