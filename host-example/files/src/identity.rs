//! Identity of the file that a path leads to, whatever it is called: by links, by `..`, or in letters of another case.

use std::fs::{self, File};
use std::path::Path;

/// A file on a disk. Equal ones are one file under two names.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Identity(Id);

/// The device and the number of the file there.
#[cfg(unix)]
type Id = (u64, u64);

/// The path without links, as the disk writes it. It does not tell that two names are links to one file.
#[cfg(not(unix))]
type Id = std::path::PathBuf;

impl Identity {
    /// The file that a path leads to; nothing where there is none.
    pub fn of(path: &Path) -> Option<Self> {
        #[cfg(unix)]
        return Some(Self::of_found(&fs::metadata(path).ok()?));
        #[cfg(not(unix))]
        return fs::canonicalize(path).ok().map(Self);
    }

    /// A file that is open; nothing where the system does not tell.
    pub fn of_open(file: &File) -> Option<Self> {
        #[cfg(unix)]
        return Some(Self::of_found(&file.metadata().ok()?));
        #[cfg(not(unix))]
        return {
            let _ = file;
            None
        };
    }

    #[cfg(unix)]
    fn of_found(found: &fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self((found.dev(), found.ino()))
    }
}

/// True where two paths lead to one file.
pub fn is_same(a: &Path, b: &Path) -> bool {
    Identity::of(a).is_some_and(|a| Some(a) == Identity::of(b))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_file_is_known_under_all_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("file"), "text").unwrap();
        fs::write(at("other"), "text").unwrap();
        fs::create_dir(at("inner")).unwrap();
        symlink("file", at("symbolic")).unwrap();
        fs::hard_link(at("file"), at("hard")).unwrap();
        for name in ["file", "symbolic", "hard", "inner/../file", "./file"] {
            assert!(is_same(&at("file"), &at(name)), "{name}");
            assert_eq!(Identity::of(&at(name)), Identity::of_open(&File::open(at(name)).unwrap()));
        }
        assert!(!is_same(&at("file"), &at("other")));
        assert!(!is_same(&at("missing"), &at("missing")), "where there is no file, there is not the same");
    }
}
