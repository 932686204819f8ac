//! Files that appear under their names only when they are whole.
//!
//! A file is written under another name in its folder and renamed. It is locked meanwhile, by which [`sweep`] tells
//! what is being written from what a killed program left.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// How the names of temporary files begin; [`kernel`] follows.
const TEMPORARY: &str = ".isophote-";

/// Age after which a temporary file that nobody locks was left behind, whoever wrote it: locks of other machines may
/// not show.
const LEFT_BEHIND: Duration = Duration::from_secs(24 * 3600);

/// Most symbolic links that are followed from one to the next, as many as Linux does.
const MOST_LINKS: usize = 40;

/// Temporary files of this process.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What a file is written to by [`write()`].
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
/// [`Error::Input`] when the folder is missing or cannot be written; [`Error::Failure`] when the disk is full.
pub fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<Sink<'_>>) -> std::result::Result<(), String>,
) -> Result<()> {
    let fail = |problem: io::Error| unwritable(path, problem.kind(), problem);
    let target = target(path)?;
    let mut temporary = Temporary::in_folder(folder(&target)).map_err(fail)?;
    let mut writer = BufWriter::new(Sink { file: temporary.file.as_file_mut(), failure: None });
    if let Err(problem) = content(&mut writer) {
        return Err(unwritable(path, writer.get_ref().failure.unwrap_or(ErrorKind::Other), problem));
    }
    writer.flush().map_err(fail)?;
    drop(writer);
    temporary.take_permissions(&target);
    // A name must not appear before what it names is on the disk.
    temporary.file.as_file().sync_all().map_err(fail)?;
    temporary.file.persist(&target).map_err(|e| fail(e.error))?;
    Ok(())
}

/// As [`write()`], by another program that is told the path of the file for the time being.
///
/// # Errors
/// As [`write()`], and what `content` says.
pub fn write_by_path(path: &Path, content: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let fail = |problem: io::Error| unwritable(path, problem.kind(), problem);
    let target = target(path)?;
    let temporary = Temporary::in_folder(folder(&target)).map_err(fail)?;
    content(temporary.file.path())?;
    temporary.take_permissions(&target);
    temporary.file.as_file().sync_all().map_err(fail)?;
    temporary.file.persist(&target).map_err(|e| fail(e.error))?;
    Ok(())
}

/// Whether a file could be written at this place, as far as can be told without touching anything.
///
/// # Errors
/// [`Error::Input`] when the folder is missing or may not be written, or the place is no file.
pub fn check(path: &Path) -> Result<()> {
    let fail = |problem: io::Error| unwritable(path, problem.kind(), problem);
    let target = target(path)?;
    let folder = folder(&target);
    if !fs::metadata(folder).map_err(fail)?.is_dir() {
        return Err(fail(ErrorKind::NotADirectory.into()));
    }
    may_write(folder).map_err(fail)
}

/// Whether a file can be written at this place; asked before any work is done.
///
/// # Errors
/// As [`check`]; also when a file cannot be made there.
pub fn check_writable(path: &Path) -> Result<()> {
    check(path)?;
    let made = Temporary::in_folder(folder(&target(path)?));
    made.map(drop).map_err(|problem| unwritable(path, problem.kind(), problem))
}

/// Removes temporary files from the folder of `path` that nobody writes any more: those that nobody locks, at once
/// where locks are certain to show and else after a day.
pub fn sweep(path: &Path) {
    let Ok(target) = target(path) else { return };
    let kernel = kernel();
    let own = format!("{TEMPORARY}{kernel}-");
    for entry in fs::read_dir(folder(&target)).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|n| n.starts_with(TEMPORARY)) else { continue };
        if !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let path = entry.path();
        // Held until the file is removed, so that its writer notices; see `Temporary::in_folder`.
        let file = OpenOptions::new().write(true).open(&path);
        let locked = file.as_ref().ok().map(File::try_lock);
        if matches!(locked, Some(Err(TryLockError::WouldBlock))) {
            continue;
        }
        let shows = !kernel.is_empty() && name.starts_with(&own) && matches!(locked, Some(Ok(())));
        let modified = entry.metadata().and_then(|m| m.modified());
        let is_old = modified.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > LEFT_BEHIND));
        if shows || is_old {
            // Another process may have been faster.
            let _ = fs::remove_file(path);
        }
    }
}

/// Removes what is being written, and ends the process at once.
pub fn abandon(code: u8) -> ! {
    // Held to the end, so that nothing new is begun.
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // It may have got its final name just now.
        let _ = fs::remove_file(path);
    }
    signal_hook::low_level::exit(code.into())
}

/// A file that is being written: locked, and deleted unless it is renamed.
struct Temporary {
    file: NamedTempFile,
    /// Dropped after the file is gone.
    _listed: Listed,
}

impl Temporary {
    fn in_folder(folder: &Path) -> io::Result<Self> {
        // A sweep may take a file between its making and its locking, over and over only where locks do not work.
        const ATTEMPTS: u32 = 16;
        let mut attempt = 1;
        loop {
            let temporary = Self::unlocked(folder)?;
            let is_swept = match temporary.file.as_file().try_lock() {
                Err(TryLockError::WouldBlock) => true,
                Ok(()) => !temporary.file.path().exists(),
                // Where files cannot be locked their age protects them.
                Err(TryLockError::Error(_)) => false,
            };
            if !is_swept || attempt == ATTEMPTS {
                return Ok(temporary);
            }
            attempt += 1;
        }
    }

    fn unlocked(folder: &Path) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        let prefix = format!("{TEMPORARY}{}-", kernel());
        builder.prefix(&prefix);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Temporary files are private by default; pictures are as public as the umask lets them be.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut unfinished = unfinished();
        let file = builder.tempfile_in(folder)?;
        unfinished.push(file.path().to_owned());
        let listed = Listed(file.path().to_owned());
        Ok(Self { file, _listed: listed })
    }

    /// Gives the file the permissions and the owner of the one that it will replace.
    #[cfg(unix)]
    fn take_permissions(&self, target: &Path) {
        use std::os::unix::fs::{MetadataExt, fchown};
        let Ok(old) = fs::metadata(target) else { return };
        // Not every disk knows permissions, and not everybody may give files away: the picture counts more.
        let _ = fchown(self.file.as_file(), Some(old.uid()), Some(old.gid()));
        let _ = self.file.as_file().set_permissions(old.permissions());
    }

    /// Folders decide who may use the files in them.
    #[cfg(not(unix))]
    fn take_permissions(&self, _target: &Path) {}
}

/// An entry of [`UNFINISHED`].
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The kernel that runs, whose processes see each other's locks in whatever container they are; empty where it does
/// not tell.
fn kernel() -> String {
    let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    id.chars().filter(char::is_ascii_hexdigit).take(32).collect()
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Where a path leads over symbolic links, whether or not there is a file.
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

/// The error of a file; a disk that is full is not the caller's fault.
fn unwritable(path: &Path, kind: ErrorKind, problem: impl std::fmt::Display) -> Error {
    let failure = |problem: &str, fix: &str| {
        Error::failure(format!("{}: cannot be written: {problem}", path.display()), fix)
    };
    match kind {
        ErrorKind::StorageFull => failure("the disk is full", "make room on it, or name a place on another"),
        ErrorKind::QuotaExceeded => {
            failure("your share of the disk is used up", "make room on it, or name a place on another")
        }
        ErrorKind::FileTooLarge => failure(
            "it is too large for the disk or the limit of files",
            "name a place on another disk, or raise the limit (ulimit -f)",
        ),
        _ => Error::file(path, format!("cannot be written: {problem}"), "name a writable folder"),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::SystemTime;

    use super::*;

    fn put(bytes: &[u8]) -> impl FnOnce(&mut BufWriter<Sink<'_>>) -> std::result::Result<(), String> {
        |file| file.write_all(bytes).map_err(|e| e.to_string())
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn only_what_nobody_writes_is_swept() {
        let folder = tempfile::tempdir().unwrap();
        let make = |name: &str, days: u64| {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(days * 24 * 3600)).unwrap();
            file
        };
        // Hosts of one name in two containers, of names that look alike without their signs, and of other kernels.
        let others = ["-node11-4194304-a", "-node111-4194304-b", "-00000000000000000000000000000000-c"];
        for name in others {
            drop(make(&format!(".isophote{name}"), 0));
            drop(make(&format!(".isophote{name}-old"), 2));
        }
        let own = format!("{TEMPORARY}{}-", kernel());
        let held = [format!("{TEMPORARY}-locked"), format!("{own}locked")].map(|name| make(&name, 2));
        held.iter().for_each(|file| file.lock().unwrap());
        drop(make(&format!("{own}killed"), 0));
        drop(make("a.png", 9));
        sweep(&folder.path().join("a.png"));
        let mut left: Vec<String> = others.iter().map(|name| format!(".isophote{name}")).collect();
        left.extend([format!("{TEMPORARY}-locked"), format!("{own}locked"), "a.png".into()]);
        if kernel().is_empty() {
            left.push(format!("{own}killed"));
        }
        left.sort();
        assert_eq!(names(folder.path()), left);
        drop(held);
        sweep(&folder.path().join("a.png"));
        assert!(!names(folder.path()).iter().any(|name| name.ends_with("locked")));
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
                scope.spawn(move || (0..300).try_for_each(|_| write(&path, put(b"whole"))))
            });
            let results = writers.map(|writer| writer.join().unwrap());
            is_over.store(true, Ordering::Relaxed);
            results.into_iter().for_each(|result| result.unwrap());
        });
        assert_eq!(names(folder.path()), ["a", "b"]);
        assert!(unfinished().iter().all(|file| !file.starts_with(folder.path())));
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
        write(&path("second"), put(b"new")).unwrap();
        write(&path("dangling"), put(b"new")).unwrap();
        for name in ["link", "second", "dangling"] {
            assert!(path(name).is_symlink() && fs::read(path(name)).unwrap() == b"new", "{name}");
        }
        let mode = |name: &str| fs::metadata(path(name)).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode("inner/file"), 0o640);
        assert_eq!(names(&path("inner")), ["file", "new"]);
        for (name, words) in [("loop", "a link to itself"), ("inner", "is a folder")] {
            assert!(write(&path(name), put(b"new")).unwrap_err().to_string().contains(words), "{name}");
        }
        // A file that was not there is as public as others that this process makes.
        fs::write(path("usual"), "").unwrap();
        assert_eq!(mode("inner/new"), mode("usual"));
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
        let error = unwritable(Path::new("a.png"), ErrorKind::StorageFull, &problem);
        assert_eq!(error.exit_code(), 1);
        assert!(error.to_string().contains("a.png: cannot be written: the disk is full"), "{error}");
        assert_eq!(unwritable(Path::new("a.png"), ErrorKind::PermissionDenied, &problem).exit_code(), 2);
    }
}
