//! The licences of everything of others that a binary holds: checked against those that are allowed, and collected as
//! one text in which each licence stands once, above the names of those that are under it.

use crate::error::{Error, Result};
use crate::metadata::Package;
use spdx::{Expression, LicenseReq, Licensee, ParseMode};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Licences that have been read and ask for nothing but their text; where a package offers several, the first counts.
const ALLOWED: [&str; 13] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "Zlib",
    "0BSD",
    "BSL-1.0",
    "CC0-1.0",
    "Unicode-3.0",
    // Fonts, which are part of the program and not sold by themselves.
    "OFL-1.1",
    "Ubuntu-font-1.0",
];

/// Beginnings of the names of files with licences, in capitals.
const NAMES: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];

/// Package that every Rust program holds and no manifest names.
fn standard_library() -> Package {
    Package {
        name: "the Rust standard library".into(),
        version: String::new(),
        licence: "MIT OR Apache-2.0".into(),
        authors: vec!["The Rust Project Developers".into()],
        folder: PathBuf::new(),
        licence_file: None,
        purl: String::new(),
        needs: Vec::new(),
    }
}

/// All licences as one text.
///
/// # Errors
/// [`Error::Licence`] for a package whose licences are not allowed, and for what cannot be read.
pub fn text(packages: &[Package]) -> Result<String> {
    let mut texts: BTreeMap<String, (String, BTreeSet<String>)> = BTreeMap::new();
    for package in packages.iter().chain([&standard_library()]) {
        for text in of_package(package)? {
            // Copies differ in blanks and line ends.
            let key = text.split_whitespace().collect::<Vec<_>>().join(" ");
            texts.entry(key).or_insert_with(|| (text, BTreeSet::new())).1.insert(package.named());
        }
    }
    let mut all: Vec<(String, BTreeSet<String>)> = texts.into_values().collect();
    all.sort_by(|a, b| b.1.len().cmp(&a.1.len()).then_with(|| a.1.cmp(&b.1)));
    let mut page = String::from("Isophote holds software of others, under these licences.\n");
    for (text, names) in all {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let line = "=".repeat(78);
        let _ = write!(page, "\n{line}\n{}\n{line}\n\n{}\n", wrapped(&names.join(", ")), text.trim());
    }
    Ok(page)
}

/// The texts of one package: its own files, and those of the licences that it is used under where it has none.
fn of_package(package: &Package) -> Result<Vec<String>> {
    let used = requirements(package)?;
    let files = files(package)?;
    let mut texts = Vec::new();
    for file in &files {
        let bytes = std::fs::read(file).map_err(Error::at(file))?;
        texts.push(String::from_utf8_lossy(&bytes).replace('\r', "").trim_matches('\n').to_owned());
    }
    if !files.iter().any(|file| file.parent() == Some(&package.folder)) {
        texts.extend(used.iter().filter_map(|licence| standard_text(package, licence)));
    }
    if texts.is_empty() {
        return Err(package.refused());
    }
    Ok(texts)
}

/// The licences that a package is used under.
fn requirements(package: &Package) -> Result<Vec<LicenseReq>> {
    let allowed: Vec<Licensee> = ALLOWED.iter().filter_map(|name| Licensee::parse(name).ok()).collect();
    let expression =
        Expression::parse_mode(&package.licence, ParseMode::LAX).map_err(|_| package.refused())?;
    expression.minimized_requirements(&allowed).map_err(|_| package.refused())
}

/// The text of the SPDX list, with the names of the authors in it.
fn standard_text(package: &Package, licence: &LicenseReq) -> Option<String> {
    let text = licence.license.id()?.text();
    let authors = match package.authors.as_slice() {
        [] => format!("the authors of {}", package.name),
        authors => authors.join(", "),
    };
    Some(text.replace("<year> <copyright holders>", &authors).replace("<year> <owner>", &authors))
}

/// Files with licences: at the top of the package, beside fonts, and where the manifest says.
fn files(package: &Package) -> Result<Vec<PathBuf>> {
    let mut found: BTreeSet<PathBuf> = package.licence_file.iter().cloned().collect();
    if package.folder.as_os_str().is_empty() {
        return Ok(Vec::new());
    }
    for path in listed(&package.folder)? {
        let name = name(&path).to_uppercase();
        if path.is_file() && NAMES.iter().any(|begin| name.starts_with(begin)) && !name.ends_with(".RS") {
            found.insert(path);
        }
    }
    let fonts = package.folder.join("fonts");
    if fonts.is_dir() {
        found.extend(listed(&fonts)?.into_iter().filter(|path| name(path).ends_with(".txt")));
    }
    Ok(found.into_iter().collect())
}

fn listed(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(Error::at(folder))?;
    entries.map(|entry| entry.map(|e| e.path()).map_err(Error::at(folder))).collect()
}

fn name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        if !lines[last].is_empty() && lines[last].len() + word.len() > 77 {
            lines.push(word.to_owned());
        } else {
            let gap = if lines[last].is_empty() { "" } else { " " };
            lines[last].push_str(gap);
            lines[last].push_str(word);
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, licence: &str, folder: &Path) -> Package {
        let (name, version) = name.split_once(' ').unwrap();
        Package {
            name: name.to_owned(),
            version: version.to_owned(),
            licence: licence.to_owned(),
            authors: vec!["Ann".into()],
            folder: folder.to_owned(),
            licence_file: None,
            purl: String::new(),
            needs: Vec::new(),
        }
    }

    #[test]
    fn all_allowed_names_are_licences() {
        for name in ALLOWED {
            assert!(Licensee::parse(name).is_ok(), "{name}");
        }
    }

    #[test]
    fn a_licence_that_is_not_allowed_fails() {
        let folder = tempfile::tempdir().unwrap();
        for licence in ["GPL-3.0-only", "MIT AND AGPL-3.0-only", "LicenseRef-Own", "", "no licence"] {
            let error = text(&[package("bad 1.0.0", licence, folder.path())]).unwrap_err().to_string();
            assert!(error.contains("bad 1.0.0"), "{error}");
        }
        for licence in ["GPL-3.0-only OR MIT", "MIT/Apache-2.0", "(Zlib OR MIT) AND OFL-1.1"] {
            text(&[package("good 1.0.0", licence, folder.path())]).unwrap();
        }
    }

    #[test]
    fn equal_texts_stand_once_and_missing_ones_are_filled_in() {
        let folders = [(); 3].map(|()| tempfile::tempdir().unwrap());
        std::fs::write(folders[0].path().join("LICENSE"), "Do as\nyou like.\n").unwrap();
        std::fs::write(folders[1].path().join("COPYING.txt"), "Do as you  like.\r\n").unwrap();
        let packages = ["a 1", "b 2", "c 3"];
        let packages: Vec<Package> =
            packages.iter().zip(&folders).map(|(name, folder)| package(name, "MIT", folder.path())).collect();
        let page = text(&packages).unwrap();
        assert_eq!(page.matches("Do as").count(), 1);
        assert!(page.contains("a 1, b 2\n"), "{page}");
        assert!(page.contains("Copyright (c) Ann\n") && page.contains("c 3\n"), "{page}");
        assert!(page.contains("Copyright (c) The Rust Project Developers"), "{page}");
    }

    #[test]
    fn licences_of_fonts_are_found_beside_them() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("fonts")).unwrap();
        std::fs::write(folder.path().join("fonts/Font.txt"), "Font licence").unwrap();
        let page = text(&[package("fonts 1", "MIT AND OFL-1.1", folder.path())]).unwrap();
        assert!(page.contains("Font licence") && page.contains("SIL OPEN FONT LICENSE"), "{page}");
    }
}
