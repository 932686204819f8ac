//! Files that appear under their names only when they are whole.
//!
//! A file is written under another name in its folder and renamed.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::temporary::{self, Temporary};

/// Most symbolic links that are followed from one to the next, as many as Linux does.
const MOST_LINKS: usize = 40;

/// Treatment of a file that has the name of a new one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It stays, and the new one is refused.
    Keep,
    /// It gives way to the new one.
    Replace,
}

/// Sink that [`write()`] has a file written to.
#[derive(Debug)]
pub struct Sink<'a> {
    file: &'a mut File,
    /// Of what kind the first failure was; encoders make texts of it.
    failure: Option<ErrorKind>,
}

impl Sink<'_> {
    fn noted<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result
            && error.kind() != ErrorKind::Interrupted
        {
            self.failure.get_or_insert(error.kind());
        }
        result
    }
}

impl Write for Sink<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.file.write(bytes);
        self.noted(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.file.flush();
        self.noted(result)
    }
}

impl Seek for Sink<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let result = self.file.seek(to);
        self.noted(result)
    }
}

/// Writes a file under another name in its folder and renames it when `content` has succeeded. A file that was there
/// leaves its permissions to the new one; a symbolic link stays, and what it points to is replaced.
///
/// # Errors
/// [`Error::Input`] when the folder is missing or cannot be written, and when a file is there that is to be kept, even one
/// that has come meanwhile; [`Error::Failure`] when the disk is full.
pub fn write(
    path: &Path,
    existing: Existing,
    content: impl FnOnce(&mut BufWriter<Sink<'_>>) -> std::result::Result<(), String>,
) -> Result<()> {
    let (target, mut temporary) = begin(path, existing, Temporary::in_folder)?;
    fill(temporary.file(), path, content)?;
    finish(temporary, path, &target, existing)
}

/// Writes bytes as [`write()`] does.
///
/// # Errors
/// As [`write()`].
pub fn write_bytes(path: &Path, existing: Existing, bytes: &[u8]) -> Result<()> {
    write(path, existing, |file| file.write_all(bytes).map_err(|e| e.to_string()))
}

/// As [`write()`], by another program that is told the path of the file for the time being.
///
/// # Errors
/// As [`write()`], and what `content` says.
pub fn write_by_path(
    path: &Path,
    existing: Existing,
    content: impl FnOnce(&Path) -> Result<()>,
) -> Result<()> {
    let (target, temporary) = begin(path, existing, Temporary::for_another)?;
    content(temporary.path())?;
    finish(temporary, path, &target, existing)
}

/// The place of a file, and another one beside it that is to be written, which `make` makes in a folder.
fn begin(
    path: &Path,
    existing: Existing,
    make: impl FnOnce(&Path) -> io::Result<Temporary>,
) -> Result<(PathBuf, Temporary)> {
    let target = target(path)?;
    refuse_existing(path, &target, existing)?;
    let temporary =
        make(folder(&target)).map_err(|problem| unwritable(path, Some(problem.kind()), problem))?;
    Ok((target, temporary))
}

/// Writes the content of the file that will be `path`.
fn fill(
    file: &mut File,
    path: &Path,
    content: impl FnOnce(&mut BufWriter<Sink<'_>>) -> std::result::Result<(), String>,
) -> Result<()> {
    let mut writer = BufWriter::new(Sink { file, failure: None });
    let written = content(&mut writer).and_then(|()| writer.flush().map_err(|e| e.to_string()));
    // Encoders may keep to themselves what failed at the very end.
    match (written, writer.get_ref().failure) {
        (Ok(()), None) => Ok(()),
        (Ok(()), Some(kind)) => Err(unwritable(path, Some(kind), kind)),
        (Err(problem), kind) => Err(unwritable(path, kind, problem)),
    }
}

/// Gives a file its name.
fn finish(temporary: Temporary, path: &Path, target: &Path, existing: Existing) -> Result<()> {
    temporary.rename(target, existing == Existing::Replace).map_err(|problem| match problem.kind() {
        ErrorKind::AlreadyExists => exists(path),
        kind => unwritable(path, Some(kind), problem),
    })
}

/// Refuses a file that is there and to be kept. `target` is where `path` leads.
fn refuse_existing(path: &Path, target: &Path, existing: Existing) -> Result<()> {
    match existing {
        Existing::Keep if target.exists() => Err(exists(path)),
        _ => Ok(()),
    }
}

/// The error of a file that is there and to be kept.
pub fn exists(path: &Path) -> Error {
    Error::file(
        path,
        "is there already, and would be replaced",
        "name another file, or add --force to replace it",
    )
}

/// Checks that a file could be written at this place, as far as can be told without touching anything.
///
/// # Errors
/// [`Error::Input`] when the folder is missing or may not be written, or the place is no file or has one that is to be kept.
pub fn check(path: &Path, existing: Existing) -> Result<()> {
    let fail = |problem: io::Error| unwritable(path, Some(problem.kind()), problem);
    let target = target(path)?;
    let folder = folder(&target);
    if !fs::metadata(folder).map_err(fail)?.is_dir() {
        return Err(fail(ErrorKind::NotADirectory.into()));
    }
    may_write(folder).map_err(fail)?;
    refuse_existing(path, &target, existing)
}

/// Checks that a file can be written at this place; asked before any work is done.
///
/// # Errors
/// As [`check`]; also when a file cannot be made there.
pub fn check_writable(path: &Path, existing: Existing) -> Result<()> {
    check(path, existing)?;
    begin(path, existing, Temporary::in_folder).map(drop)
}

/// Removes from the folder of `path` what nobody writes any more.
pub fn sweep(path: &Path) {
    if let Ok(target) = target(path) {
        temporary::sweep(folder(&target));
    }
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Path that a path leads to over symbolic links, whether or not there is a file.
fn target(path: &Path) -> Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(link) = fs::read_link(&target) else { break };
        target = folder(&target).join(link);
    }
    match fs::metadata(&target) {
        Ok(found) if found.is_dir() => Err(Error::file(path, "is a folder", "name a file")),
        Ok(found) if !found.is_file() => {
            Err(Error::file(path, "is a device or a pipe and no file", "name a file"))
        }
        _ if target.is_symlink() => Err(Error::file(path, "is a link to itself", "name a file")),
        _ => Ok(target),
    }
}

#[cfg(unix)]
fn may_write(folder: &Path) -> io::Result<()> {
    use rustix::fs::Access;
    Ok(rustix::fs::access(folder, Access::WRITE_OK | Access::EXEC_OK)?)
}

#[cfg(not(unix))]
fn may_write(_folder: &Path) -> io::Result<()> {
    Ok(())
}

/// The error of a file. A name is the caller's fault, and so is what an encoder refuses, which is of no kind; a disk that is full or
/// fails is not.
pub fn unwritable(path: &Path, kind: Option<ErrorKind>, problem: impl std::fmt::Display) -> Error {
    use ErrorKind as K;
    let failure = |problem: &str, fix: &str| {
        Error::failure(format!("{}: cannot be written: {problem}", path.display()), fix)
    };
    let input =
        |problem| Error::file(path, format!("cannot be written: {problem}"), "name a writable folder");
    match kind {
        Some(K::StorageFull) => failure("the disk is full", "make room on it, or name a place on another"),
        Some(K::QuotaExceeded) => {
            failure("your share of the disk is used up", "make room on it, or name a place on another")
        }
        Some(K::FileTooLarge) => failure(
            "it is too large for the disk or the limit of files",
            "name a place on another disk, or raise the limit (ulimit -f)",
        ),
        None | Some(K::NotFound | K::PermissionDenied | K::ReadOnlyFilesystem | K::InvalidFilename) => {
            input(problem.to_string())
        }
        Some(K::NotADirectory | K::IsADirectory | K::InvalidInput) => input(problem.to_string()),
        Some(_) => {
            failure(&problem.to_string(), "see whether the disk is in order, or name a place on another")
        }
    }
}

#[cfg(test)]
mod tests {
    #[cfg(target_os = "linux")]
    use std::fs::OpenOptions;
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;
    use crate::temporary::tests::names;

    fn put(bytes: &[u8]) -> impl FnOnce(&mut BufWriter<Sink<'_>>) -> std::result::Result<(), String> {
        |file| file.write_all(bytes).map_err(|e| e.to_string())
    }

    #[test]
    fn sweeping_disturbs_no_writer() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !is_over.load(Ordering::Relaxed) {
                    sweep(&path("a"));
                }
            });
            let writers = ["a", "b"].map(|name| {
                let path = path(name);
                scope.spawn(move || (0..300).try_for_each(|_| write(&path, Existing::Replace, put(b"whole"))))
            });
            let results = writers.map(|writer| writer.join().unwrap());
            is_over.store(true, Ordering::Relaxed);
            results.into_iter().for_each(|result| result.unwrap());
        });
        assert_eq!(names(folder.path()), ["a", "b"]);
        assert!(temporary::unfinished().iter().all(|file| !file.starts_with(folder.path())));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("inner")).unwrap();
        fs::write(path("inner/file"), "old").unwrap();
        fs::set_permissions(path("inner/file"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("inner/file", path("link")).unwrap();
        symlink("link", path("second")).unwrap();
        symlink("inner/new", path("dangling")).unwrap();
        symlink("loop", path("loop")).unwrap();
        write(&path("second"), Existing::Replace, put(b"new")).unwrap();
        write(&path("dangling"), Existing::Keep, put(b"new")).unwrap();
        for name in ["link", "second", "dangling"] {
            assert!(path(name).is_symlink() && fs::read(path(name)).unwrap() == b"new", "{name}");
        }
        let mode = |name: &str| fs::metadata(path(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode("inner/file"), 0o640);
        assert_eq!(names(&path("inner")), ["file", "new"]);
        for (name, words) in [("loop", "a link to itself"), ("inner", "is a folder")] {
            let refused = write(&path(name), Existing::Replace, put(b"new")).unwrap_err();
            assert!(refused.to_string().contains(words), "{name}");
        }
        // A file that was not there is as public as others that this process makes.
        fs::write(path("usual"), "").unwrap();
        assert_eq!(mode("inner/new"), mode("usual"));
    }

    #[test]
    fn a_file_that_is_there_stays_unless_it_is_to_be_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let refused = |result: Result<()>| {
            let error = result.unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains("is there already") && error.to_string().contains("--force"));
        };
        write(&path("new"), Existing::Keep, put(b"new")).unwrap();
        refused(write(&path("new"), Existing::Keep, |_| panic!("no work is done for it")));
        refused(write_by_path(&path("new"), Existing::Keep, |_| panic!("no work is done for it")));
        refused(check(&path("new"), Existing::Keep));
        refused(check_writable(&path("new"), Existing::Keep));
        check_writable(&path("new"), Existing::Replace).unwrap();
        // One that comes while another one is made.
        let come = |name: &str| fs::write(path(name), "theirs").unwrap();
        refused(write(&path("later"), Existing::Keep, |file| {
            come("later");
            put(b"ours")(file)
        }));
        refused(write_by_path(&path("by path"), Existing::Keep, |_| {
            come("by path");
            Ok(())
        }));
        for name in ["later", "by path"] {
            assert_eq!(fs::read(path(name)).unwrap(), b"theirs");
        }
        write(&path("later"), Existing::Replace, put(b"ours")).unwrap();
        assert_eq!(fs::read(path("later")).unwrap(), b"ours");
        assert_eq!(names(folder.path()), ["by path", "later", "new"], "nothing half-written is left");
    }

    #[test]
    fn another_may_write_what_no_sweep_takes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film");
        let result = write_by_path(&path, Existing::Keep, |path| {
            // As another program does: it opens the file anew, and empties it.
            fs::write(path, "frames").unwrap();
            sweep(path);
            assert_eq!(names(folder.path()).len(), 2, "the file and its lock");
            Ok(())
        });
        result.unwrap();
        assert_eq!(names(folder.path()), ["film"]);
        assert_eq!(fs::read(path).unwrap(), b"frames");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_an_encoder_does_not_tell_is_a_failure_too() {
        let mut full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let error = fill(&mut full, Path::new("a.png"), |file| {
            // More than the buffer holds goes to the disk at once; what is dropped there cannot say so.
            let _ = file.write_all(&[0; 1 << 20]);
            Ok(())
        });
        let error = error.unwrap_err();
        assert_eq!(error.exit_code(), 1);
        assert!(error.to_string().contains("a.png: cannot be written: the disk is full"), "{error}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_no_bad_input() {
        let mut full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut writer = BufWriter::new(Sink { file: &mut full, failure: None });
        writer.write_all(b"picture").unwrap();
        let problem = writer.flush().unwrap_err();
        let kind = writer.get_ref().failure;
        assert_eq!(kind, Some(ErrorKind::StorageFull));
        let error = unwritable(Path::new("a.png"), Some(ErrorKind::StorageFull), &problem);
        assert_eq!(error.exit_code(), 1);
        assert!(error.to_string().contains("a.png: cannot be written: the disk is full"), "{error}");
        let code = |kind| unwritable(Path::new("a.png"), kind, &problem).exit_code();
        assert_eq!([None, Some(ErrorKind::PermissionDenied)].map(code), [2, 2]);
        // Numbers of Linux: the disk fails, its quota is used up, another machine lost the file.
        assert_eq!([5, 122, 116].map(|n| code(Some(io::Error::from_raw_os_error(n).kind()))), [1; 3]);
    }
}
