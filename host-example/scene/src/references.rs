//! Files that a scene names: found as they are meant on another system, and only near the scene. A name may have
//! backslashes, a drive, quotes or letters of the other case; a path that leads nowhere ends in a file that may lie
//! beside the scene. Opening a scene from anywhere can read nothing else.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Folders in which files of a scene are looked for.
pub struct Folders {
    /// Folders that names are relative to, tried in this order.
    bases: Vec<PathBuf>,
    /// Files lie in this folder or below.
    folder: PathBuf,
    /// Files whose names lead upwards lie in this folder or below.
    root: PathBuf,
}

impl Folders {
    /// The folder of the file at `owner`, and nothing outside it.
    pub fn of(owner: &Path) -> Self {
        let folder = folder_of(owner).to_path_buf();
        Self { bases: vec![folder.clone()], root: folder.clone(), folder }
    }

    /// The folder of the file at `owner`, and where a name leads upwards, what lies beside that folder.
    pub fn around(owner: &Path) -> Self {
        let folder = folder_of(owner).to_path_buf();
        let real = fs::canonicalize(&folder).ok();
        // The root of a file system is everything.
        let parent = real.as_deref().and_then(Path::parent).filter(|parent| parent.parent().is_some());
        let root = parent.map_or_else(|| folder.clone(), Path::to_path_buf);
        Self { bases: vec![folder.clone()], folder, root }
    }

    /// Names are relative to the folder of `other` first.
    #[must_use]
    pub fn beside(mut self, other: &Path) -> Self {
        let folder = folder_of(other).to_path_buf();
        if !self.bases.contains(&folder) {
            self.bases.insert(0, folder);
        }
        self
    }

    /// Opens a file that is named so; yields its path too.
    ///
    /// # Errors
    /// A clause saying why the name is refused.
    pub fn open(&self, name: &str) -> Result<(File, PathBuf), String> {
        let (path, root) = self.resolve(name)?;
        let opened = || {
            let file = File::open(&path)?;
            let place = place_of(&file, &path)?;
            Ok::<_, io::Error>((place.starts_with(fs::canonicalize(root)?), file))
        };
        // A link may have come in the way since the path was checked, so the file itself is checked again.
        match opened() {
            Ok((true, file)) => Ok((file, path)),
            Ok((false, _)) => Err(format!("refers to '{name}', which leads outside its folder")),
            Err(e) => Err(format!("refers to '{name}', which cannot be read: {e}")),
        }
    }

    /// The path of a file that is named so, and the folder that it lies in or below.
    fn resolve(&self, name: &str) -> Result<(PathBuf, &Path), String> {
        let refuse = |why: &str| Err(format!("refers to '{name}', which {why}"));
        let (parts, absolute) = match parts(name) {
            Ok(parts) => parts,
            Err(why) => return refuse(why),
        };
        let first = self.bases.iter().map(|base| self.look(base, &parts)).reduce(Result::or);
        let first = match first.unwrap_or(Err("does not exist")) {
            Ok(path) if !absolute => return Ok(path),
            Ok(_) => "lies outside its folder",
            Err(why) => why,
        };
        // Ends of the path, the longest first: what lies beside the scene was elsewhere when it was exported.
        let known = parts.iter().rposition(|part| *part == "..").map_or(0, |at| at + 1);
        let ends = (known..parts.len()).map(|at| &parts[at..]);
        let mut found = ends.flat_map(|end| self.bases.iter().map(move |base| self.look(base, end)));
        found.find_map(Result::ok).map_or_else(|| refuse(first), Ok)
    }

    /// The file at the end of a path from a folder, or why there is none.
    fn look(&self, base: &Path, parts: &[&str]) -> Result<(PathBuf, &Path), &'static str> {
        let bound = if parts.contains(&"..") { &self.root } else { &self.folder };
        let root = fs::canonicalize(bound).map_err(|_| "does not exist")?;
        let mut path = base.to_path_buf();
        for part in parts {
            path = match *part {
                ".." => path.join(".."),
                part => entry(&path, part).ok_or_else(|| outside_or_missing(&root, &path))?,
            };
        }
        let real = fs::canonicalize(&path).map_err(|_| "does not exist")?;
        if !real.starts_with(&root) {
            return Err("leads outside its folder");
        }
        if real.is_file() { Ok((path, bound)) } else { Err("is not a file") }
    }
}

/// Reason why there is nothing in a folder; of folders outside `root` nothing is told.
fn outside_or_missing(root: &Path, folder: &Path) -> &'static str {
    match fs::canonicalize(folder) {
        Ok(real) if !real.starts_with(root) => "lies outside its folder",
        _ => "does not exist",
    }
}

/// The entry of a folder with this name, or else with this name in other letters of the same kind.
fn entry(folder: &Path, name: &str) -> Option<PathBuf> {
    let exact = folder.join(name);
    if exact.symlink_metadata().is_ok() {
        return Some(exact);
    }
    let wanted = name.to_lowercase();
    let names = fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    // Of several the first in order, so that the same one is found everywhere.
    names.filter(|name| name.to_lowercase() == wanted).min().map(|name| folder.join(name))
}

/// The parts of a path with any kind of slash, and true where it does not start at the scene.
fn parts(name: &str) -> Result<(Vec<&str>, bool), &'static str> {
    let (mut rest, mut absolute) = (name.trim(), false);
    for quote in ['"', '\''] {
        rest = rest.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote)).unwrap_or(rest);
    }
    if let Some((scheme, path)) = rest.split_once("://") {
        if !scheme.eq_ignore_ascii_case("file") {
            return Err("is a URL and not a file beside it");
        }
        (rest, absolute) = (path, true);
    }
    let bytes = rest.trim_start_matches('/').as_bytes();
    if let [drive, b':', ..] = bytes
        && drive.is_ascii_alphabetic()
    {
        (rest, absolute) = (&rest.trim_start_matches('/')[2..], true);
    }
    absolute |= rest.starts_with(['/', '\\']);
    let parts: Vec<&str> = rest.split(['/', '\\']).filter(|part| !matches!(*part, "" | ".")).collect();
    // A colon names a stream of a file on some systems.
    if parts.is_empty() || rest.contains('\0') || cfg!(windows) && rest.contains(':') {
        return Err("is not a valid file reference");
    }
    Ok((parts, absolute))
}

/// Path at which an open file really lies. Only Linux says so; elsewhere its path is followed once more.
fn place_of(file: &File, path: &Path) -> io::Result<PathBuf> {
    #[cfg(target_os = "linux")]
    if let Ok(place) = fs::read_link(format!("/proc/self/fd/{}", std::os::fd::AsRawFd::as_raw_fd(file))) {
        return Ok(place);
    }
    let _ = file;
    fs::canonicalize(path)
}

fn folder_of(owner: &Path) -> &Path {
    match owner.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with `secret.bin`, `maps/Up.png` and `inner`, in which are `a b.bin` and `tex/wood.png`.
    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for path in ["secret.bin", "maps/Up.png", "inner/a b.bin", "inner/tex/wood.png"] {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, b"x").unwrap();
        }
        folder
    }

    #[test]
    fn names_stay_in_the_folder() {
        let folder = folder();
        let owner = folder.path().join("inner/scene.obj");
        let absolute = folder.path().join("secret.bin").display().to_string();
        for bad in [
            "../secret.bin",
            "x/../../secret.bin",
            "..\\secret.bin",
            "..\\inner\\..\\secret.bin",
            "file:///etc/passwd",
            "http://localhost/a b.bin",
            "C:/a.bin",
            "/etc/passwd",
            "",
            ".",
            "tex",
            "missing.bin",
            &absolute,
        ] {
            assert!(Folders::of(&owner).resolve(bad).is_err(), "{bad} was accepted");
        }
        assert!(Folders::of(&owner).resolve("../secret.bin").unwrap_err().contains("outside"));
        assert!(Folders::around(&owner).resolve("../secret.bin").is_ok());
        for bad in ["../../etc/passwd", "/etc/passwd", &absolute, "../gone.bin"] {
            assert!(Folders::around(&owner).resolve(bad).is_err(), "{bad} was accepted");
        }
    }

    #[test]
    fn files_are_found_where_they_clearly_are() {
        let folder = folder();
        let owner = folder.path().join("inner/scene.obj");
        let found = |name: &str| {
            let folders = Folders::around(&owner);
            let found = folders.resolve(name).unwrap_or_else(|e| panic!("{e}"));
            fs::canonicalize(found.0)
                .unwrap()
                .strip_prefix(fs::canonicalize(folder.path()).unwrap())
                .unwrap()
                .to_owned()
        };
        for name in [
            "tex/wood.png",
            "tex\\wood.png",
            ".\\TEX\\Wood.PNG",
            "\"tex/wood.png\"",
            "C:\\art\\tex\\wood.png",
            "C:tex\\wood.png",
            "\\\\server\\share\\tex\\wood.png",
            "/home/someone/tex/wood.png",
            "file:///C:/art/tex/wood.png",
            "../inner/tex/wood.png",
            "../../elsewhere/tex/wood.png",
            "old/tex/wood.png",
        ] {
            assert_eq!(found(name), Path::new("inner/tex/wood.png"), "{name}");
        }
        assert_eq!(found("../maps/up.png"), Path::new("maps/Up.png"));
        assert_eq!(found("A B.bin"), Path::new("inner/a b.bin"));
        let beside = Folders::of(&owner).beside(&folder.path().join("inner/tex/a.mtl"));
        assert!(beside.resolve("wood.png").is_ok() && beside.resolve("../a b.bin").is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_folder_are_refused() {
        let folder = folder();
        let inner = folder.path().join("inner");
        std::os::unix::fs::symlink("../secret.bin", inner.join("link.bin")).unwrap();
        let owner = inner.join("scene.gltf");
        for folders in [Folders::of(&owner), Folders::around(&owner)] {
            assert!(folders.resolve("link.bin").unwrap_err().contains("outside"));
        }
    }
}
