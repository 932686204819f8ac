//! Files that are read: opened once, then checked and read by their handle, so that nothing can take their place
//! between the two.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, ErrorKind, Read};
#[cfg(unix)]
use std::os::unix::fs::OpenOptionsExt;
#[cfg(windows)]
use std::os::windows::fs::OpenOptionsExt;
use std::path::Path;

use crate::patience::patiently;

/// Opens whatever has this path, be it a folder, and says what it is. Pipes are not waited for.
///
/// # Errors
/// As the system.
pub fn open(path: &Path) -> io::Result<(File, Metadata)> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits() as i32);
    // Without it Windows opens no folders, and says that access is denied.
    #[cfg(windows)]
    options.custom_flags(FILE_FLAG_BACKUP_SEMANTICS);
    let file = patiently(|| options.open(path))?;
    let found = file.metadata()?;
    Ok((file, found))
}

#[cfg(windows)]
const FILE_FLAG_BACKUP_SEMANTICS: u32 = 0x0200_0000;

/// The text of a file of at most `most` bytes.
///
/// # Errors
/// As the system; too large; invalid input for pipes and devices, which might not end; invalid data for what is
/// no UTF-8.
pub fn text(path: &Path, most: u64) -> io::Result<String> {
    let (file, found) = open(path)?;
    if found.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !found.is_file() {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is a pipe or a device"));
    }
    if found.len() > most {
        return Err(io::Error::new(ErrorKind::FileTooLarge, format!("it has more than {most} bytes")));
    }
    let mut text = String::new();
    file.take(most).read_to_string(&mut text)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn texts_are_read_within_their_limit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        fs::write(&path, "four").unwrap();
        assert_eq!(text(&path, 4).unwrap(), "four");
        assert_eq!(text(&path, 3).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(text(folder.path(), 4).unwrap_err().kind(), ErrorKind::IsADirectory);
        fs::write(&path, [0xff]).unwrap();
        assert_eq!(text(&path, 4).unwrap_err().kind(), ErrorKind::InvalidData);
    }

    #[cfg(unix)]
    #[test]
    fn what_might_not_end_is_not_read() {
        assert_eq!(text(Path::new("/dev/zero"), 4).unwrap_err().kind(), ErrorKind::InvalidInput);
    }

    // Windows does the same since version 10, and Wine does not.
    #[cfg(unix)]
    #[test]
    fn what_was_opened_is_what_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "first").unwrap();
        let (mut file, found) = open(&path).unwrap();
        fs::write(folder.path().join("b"), "another, longer one").unwrap();
        fs::rename(folder.path().join("b"), &path).unwrap();
        let mut read = String::new();
        file.read_to_string(&mut read).unwrap();
        assert_eq!((read.as_str(), found.len()), ("first", 5));
    }
}
