//! Archives: the same files make the same bytes, whoever packs them and whenever.

use crate::error::{Error, Result};
use crate::tree::{Entry, Tree};
use flate2::{Compression, GzBuilder};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use tar::{Builder, EntryType, Header};

/// Packs a tree below a folder named `name` into `file`, and returns the archive's SHA-256 as it is written in lists of
/// checksums.
///
/// # Errors
/// [`Error::File`] for what cannot be read or written.
pub fn pack(tree: &Tree, name: &str, file: &Path, fast: bool) -> Result<String> {
    let level = if fast { Compression::fast() } else { Compression::best() };
    let out = BufWriter::new(File::create(file).map_err(Error::at(file))?);
    // The system and the time in the header of gzip would differ from run to run.
    let gzip = GzBuilder::new().mtime(0).operating_system(255).write(out, level);
    let mut archive = Builder::new(gzip);
    for (place, entry) in &tree.entries {
        append(&mut archive, &format!("{name}/{place}"), entry, file)?;
    }
    let finished = archive.into_inner().and_then(flate2::write::GzEncoder::finish);
    let written = finished.and_then(|out| Ok(out.into_inner()?));
    // Some disks tell only then that they are full.
    written.and_then(|file| file.sync_all()).map_err(Error::at(file))?;
    checksum(file)
}

/// Writes a text under another name in its folder, and renames it when it is whole.
///
/// # Errors
/// [`Error::File`] when it cannot be written.
pub fn write_text(file: &Path, text: &str) -> Result<()> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let beside = file.with_file_name(format!(".{name}.part"));
    let written = std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, file));
    if written.is_err() {
        // What failed is told; that this may fail as well adds nothing.
        let _ = std::fs::remove_file(&beside);
    }
    written.map_err(Error::at(file))
}

fn append(archive: &mut Builder<impl Write>, place: &str, entry: &Entry, file: &Path) -> Result<()> {
    let (bytes, mode) = match entry {
        Entry::Link(target) => {
            let mut header = header(0, 0o777);
            header.set_entry_type(EntryType::Symlink);
            return archive.append_link(&mut header, place, target).map_err(Error::at(file));
        }
        Entry::Copy(from) => (std::fs::read(from).map_err(Error::at(from))?, 0o644),
        Entry::Program(from) => (std::fs::read(from).map_err(Error::at(from))?, 0o755),
        Entry::Text(text) => (text.clone().into_bytes(), 0o644),
        Entry::Script(text) => (text.clone().into_bytes(), 0o755),
    };
    let mut header = header(bytes.len() as u64, mode);
    archive.append_data(&mut header, place, bytes.as_slice()).map_err(Error::at(file))
}

/// Of nobody in particular, at no time.
fn header(size: u64, mode: u32) -> Header {
    let mut header = Header::new_gnu();
    header.set_size(size);
    header.set_mode(mode);
    header.set_mtime(0);
    header.set_uid(0);
    header.set_gid(0);
    header
}

/// The SHA-256 of a file as it is written in lists of checksums.
///
/// # Errors
/// [`Error::File`] when it cannot be read.
pub fn checksum(file: &Path) -> Result<String> {
    let bytes = std::fs::read(file).map_err(Error::at(file))?;
    Ok(Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_tree_makes_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let mut tree = Tree::default();
        tree.text("b/long.txt", "text ".repeat(1000));
        tree.add("a", Entry::Link("b".into()));
        let files = ["one", "two"].map(|name| folder.path().join(name));
        let sums = files.each_ref().map(|file| pack(&tree, "top", file, true).unwrap());
        assert_eq!(sums[0], sums[1]);
        assert_eq!(std::fs::read(&files[0]).unwrap(), std::fs::read(&files[1]).unwrap());
        tree.text("b/long.txt", "other");
        assert_ne!(pack(&tree, "top", &files[0], true).unwrap(), sums[0]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn an_archive_that_does_not_fit_on_the_disk_is_an_error() {
        let mut tree = Tree::default();
        tree.text("a.txt", "text");
        assert!(pack(&tree, "top", Path::new("/dev/full"), true).is_err());
    }

    #[test]
    fn texts_appear_when_they_are_whole() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.txt");
        write_text(&file, "first").unwrap();
        write_text(&file, "second").unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "second");
        std::fs::create_dir(folder.path().join("folder")).unwrap();
        assert!(write_text(&folder.path().join("folder"), "text").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "nothing half-written is left");
    }

    #[test]
    fn checksums_are_those_of_sha_256() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("abc");
        std::fs::write(&file, "abc").unwrap();
        // The example of FIPS 180-4.
        let sum = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(checksum(&file).unwrap(), sum);
    }
}
