//! Files that are written under other names than their own, locked meanwhile, by which [`sweep`] tells what is being written
//! from what a killed program left.
//!
//! What another program writes is not locked itself, since on Windows nobody else may write to what is locked. An empty file
//! beside it is, whose name is the other's without [`CONTENT`].

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tempfile::TempPath;

use crate::patience::patiently;

/// Beginning of the names of temporary files; [`kernel`] follows.
const TEMPORARY: &str = ".isophote-";

/// End of the names of those that another program writes.
const CONTENT: &str = ".content";

/// Age after which a temporary file that nobody locks was left behind, whoever wrote it: locks of other machines may
/// not show.
const LEFT_BEHIND: Duration = Duration::from_secs(24 * 3600);

/// See [`unfinished`].
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes temporary files from a folder that nobody writes any more: those that nobody locks, at once where locks are certain
/// to show and else after a day.
pub fn sweep(folder: &Path) {
    let kernel = kernel();
    let own = format!("{TEMPORARY}{kernel}-");
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|n| n.starts_with(TEMPORARY)) else { continue };
        if !entry.file_type().is_ok_and(|kind| kind.is_file()) {
            continue;
        }
        let path = entry.path();
        // Held until the file is removed, so that its writer notices; see `Temporary::in_folder`.
        let file = OpenOptions::new().write(true).open(path.with_file_name(name_of_lock(name)));
        let locked = file.as_ref().map(File::try_lock);
        if matches!(locked, Ok(Err(TryLockError::WouldBlock))) {
            continue;
        }
        let is_free = match locked {
            Ok(locked) => locked.is_ok(),
            // Removed already, and content is never without while it is written.
            Err(error) => error.kind() == ErrorKind::NotFound,
        };
        let shows = !kernel.is_empty() && name.starts_with(&own) && is_free;
        let modified = entry.metadata().and_then(|m| m.modified());
        let is_old = modified.is_ok_and(|at| at.elapsed().is_ok_and(|age| age > LEFT_BEHIND));
        if shows || is_old {
            // Another process may have been faster.
            let _ = fs::remove_file(path);
        }
    }
}

/// Name of the file that is locked while that of this name is written.
fn name_of_lock(name: &str) -> &str {
    name.strip_suffix(CONTENT).unwrap_or(name)
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

/// A file that is being written: locked, or guarded by one that is, and deleted unless it is renamed.
pub struct Temporary {
    file: File,
    path: TempPath,
    /// Dropped after the file is gone, as the guard is.
    _listed: Listed,
    _guard: Option<Box<Temporary>>,
}

impl Temporary {
    /// A new one in a folder, to be written by its handle.
    ///
    /// # Errors
    /// As the system.
    pub fn in_folder(folder: &Path) -> io::Result<Self> {
        // A sweep may take a file between its making and its locking, over and over only where locks do not work.
        const ATTEMPTS: u32 = 16;
        let mut attempt = 1;
        loop {
            let temporary = Self::unlocked(folder)?;
            let is_swept = match temporary.file.try_lock() {
                Err(TryLockError::WouldBlock) => true,
                Ok(()) => !temporary.path.exists(),
                // Where files cannot be locked their age protects them.
                Err(TryLockError::Error(_)) => false,
            };
            if !is_swept || attempt == ATTEMPTS {
                return Ok(temporary);
            }
            attempt += 1;
        }
    }

    /// A new one in a folder, to be written by its path.
    ///
    /// # Errors
    /// As the system.
    pub fn for_another(folder: &Path) -> io::Result<Self> {
        let guard = Self::in_folder(folder)?;
        let mut path = guard.path().as_os_str().to_owned();
        path.push(CONTENT);
        let mut unfinished = unfinished();
        let file = File::create_new(&path)?;
        let path = TempPath::try_from_path(path)?;
        let listed = Listed::new(&mut unfinished, &path);
        Ok(Self { file, path, _listed: listed, _guard: Some(Box::new(guard)) })
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
        let (file, path) = builder.tempfile_in(folder)?.into_parts();
        let listed = Listed::new(&mut unfinished, &path);
        Ok(Self { file, path, _listed: listed, _guard: None })
    }

    /// Path of it for the time being.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// File that is written to.
    pub fn file(&mut self) -> &mut File {
        &mut self.file
    }

    /// Flushes the file to the disk and gives it its name, which a file that is there only loses where it is replaced.
    ///
    /// # Errors
    /// As the system; already exists for a file that is not replaced, even one that has come just now.
    pub fn rename(self, target: &Path, replaces: bool) -> io::Result<()> {
        if replaces {
            self.take_permissions(target);
        }
        // A name must not appear before what it names is on the disk.
        self.file.sync_all()?;
        let Self { file: _open, path, _listed, _guard } = self;
        let mut left = Some(path);
        let named = patiently(|| {
            let Some(path) = left.take() else { return Err(ErrorKind::NotFound.into()) };
            named(path, target, replaces).map_err(|(path, error)| {
                left = Some(path);
                error
            })
        });
        match named {
            Err(_) if !replaces && target.exists() => Err(ErrorKind::AlreadyExists.into()),
            named => named,
        }
    }

    /// Gives the file the permissions and the owner of the one that it will replace.
    #[cfg(unix)]
    fn take_permissions(&self, target: &Path) {
        use std::os::unix::fs::{MetadataExt, fchown};
        let Ok(old) = fs::metadata(target) else { return };
        // Not every disk knows permissions, and not everybody may give files away: the picture counts more.
        let _ = fchown(&self.file, Some(old.uid()), Some(old.gid()));
        let _ = self.file.set_permissions(old.permissions());
    }

    /// Folders decide who may use the files in them.
    #[cfg(not(unix))]
    fn take_permissions(&self, _target: &Path) {}
}

/// Gives a file its name; where it cannot have it the file stays.
fn named(path: TempPath, target: &Path, replaces: bool) -> Result<(), (TempPath, io::Error)> {
    let named = match replaces {
        true => path.persist(target),
        false => path.persist_noclobber(target).or_else(|refused| {
            // Some disks know no renaming that replaces nothing; there a look before it has to do.
            if target.exists() { Err(refused) } else { refused.path.persist(target) }
        }),
    };
    named.map_err(|refused| (refused.path, refused.error))
}

/// An entry of [`UNFINISHED`].
struct Listed(PathBuf);

impl Listed {
    fn new(unfinished: &mut Vec<PathBuf>, path: &Path) -> Self {
        unfinished.push(path.to_owned());
        Self(path.to_owned())
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        unfinished().retain(|path| *path != self.0);
    }
}

/// Temporary files of this process.
pub fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The kernel that runs, whose processes see each other's locks in whatever container they are; empty where it does
/// not tell. All machines with Windows see those of each other, on shared disks as well.
fn kernel() -> String {
    if cfg!(windows) {
        return "windows".into();
    }
    let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    id.chars().filter(char::is_ascii_hexdigit).take(32).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use std::time::SystemTime;

    use super::*;

    /// Names of what lies in a folder, in order.
    pub(crate) fn names(folder: &Path) -> Vec<String> {
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
        let locked = [format!("{TEMPORARY}-locked"), format!("{own}locked")].map(|name| make(&name, 2));
        locked.iter().for_each(|file| file.lock().unwrap());
        drop(make(&format!("{own}killed"), 0));
        drop(make(&format!("{own}killed{CONTENT}"), 0));
        drop(make(&format!("{own}locked{CONTENT}"), 2));
        drop(make("a.png", 9));
        sweep(folder.path());
        let mut left: Vec<String> = others.iter().map(|name| format!(".isophote{name}")).collect();
        let guarded = format!("{own}locked{CONTENT}");
        left.extend([format!("{TEMPORARY}-locked"), format!("{own}locked"), guarded, "a.png".into()]);
        if kernel().is_empty() {
            left.extend(["", CONTENT].map(|end| format!("{own}killed{end}")));
        }
        left.sort();
        assert_eq!(names(folder.path()), left);
        drop(locked);
        sweep(folder.path());
        assert!(!names(folder.path()).iter().any(|name| name.contains("locked")));
    }
}
