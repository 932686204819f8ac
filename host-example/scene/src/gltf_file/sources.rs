//! Sources of the bytes of a glTF: the binary chunk, data URIs, and files beside it. A file may only name
//! others in its own folder or below, so that opening a scene from anywhere cannot read anything else.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::budget::{Budget, TOO_LARGE};
use isophote_files::error::{Error, Result};

/// Decodes `%41` and its like.
fn percent_decode(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len());
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        if byte == b'%' {
            let high = char::from(bytes.next()?).to_digit(16)?;
            let low = char::from(bytes.next()?).to_digit(16)?;
            out.push((high * 16 + low) as u8);
        } else {
            out.push(byte);
        }
    }
    Some(out)
}

/// Decodes base64 with or without padding.
fn base64_decode(text: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    let digits = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    for &c in digits {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    Some(out)
}

/// True where a reference begins with a URL scheme such as `http:`.
fn has_scheme(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

/// Opens a file that `owner` refers to, which must lie in the folder of `owner` or below; yields its path too.
///
/// # Errors
/// A clause saying why the reference is refused.
pub fn open(owner: &Path, reference: &str) -> std::result::Result<(File, PathBuf), String> {
    let path = resolve(owner, reference)?;
    let opened = || {
        let file = File::open(&path)?;
        let place = place_of(&file, &path)?;
        Ok::<_, io::Error>((place.starts_with(fs::canonicalize(folder_of(owner))?), file))
    };
    // A link may have come in the way since the path was checked, so the file itself is checked again.
    match opened() {
        Ok((true, file)) => Ok((file, path)),
        Ok((false, _)) => Err(format!("refers to '{reference}', which leads outside its folder")),
        Err(e) => Err(format!("refers to '{reference}', which cannot be read: {e}")),
    }
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

/// The path of a file that `owner` refers to, which must lie in the folder of `owner` or below.
fn resolve(owner: &Path, reference: &str) -> std::result::Result<PathBuf, String> {
    let refuse = |why: &str| Err(format!("refers to '{reference}', which {why}"));
    if has_scheme(reference) {
        return refuse("is a URL and not a file beside it");
    }
    let Some(name) = percent_decode(reference).and_then(|bytes| String::from_utf8(bytes).ok()) else {
        return refuse("is not a valid file reference");
    };
    // Backslashes and drive letters mean nothing here but would on another system.
    if name.is_empty() || name.contains(['\\', '\0']) {
        return refuse("is not a valid file reference");
    }
    if name.starts_with('/') || has_scheme(&name) || name.split('/').any(|part| part == "..") {
        return refuse("lies outside its folder");
    }
    let folder = folder_of(owner);
    let path = folder.join(&name);
    match (fs::canonicalize(folder), fs::canonicalize(&path)) {
        (Ok(folder), Ok(real)) if real.starts_with(&folder) && real.is_file() => Ok(path),
        (Ok(folder), Ok(real)) if real.starts_with(&folder) => refuse("is not a file"),
        (Ok(_), Ok(_)) => refuse("leads outside its folder"),
        _ => refuse("does not exist"),
    }
}

/// The bytes behind a URI of the glTF file `owner`.
///
/// # Errors
/// [`Error::Input`] when the URI is refused, or its file missing, unreadable or too large.
pub fn read_uri(owner: &Path, uri: &str, budget: &Budget) -> Result<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        budget
            .take(data.len(), 1)
            .map_err(|problem| Error::file(owner, format!("holds a data URI that {problem}"), TOO_LARGE))?;
        let decoded = match data.split_once(',') {
            Some((head, body)) if head.ends_with(";base64") => base64_decode(body.as_bytes()),
            Some((_, body)) => percent_decode(body),
            None => None,
        };
        return decoded.ok_or_else(|| {
            Error::file(owner, "holds a data URI that cannot be decoded", "export the scene again")
        });
    }
    let (file, path) = open(owner, uri)
        .map_err(|problem| Error::file(owner, problem, "keep its files in the same folder, or below"))?;
    budget.read(file).map_err(|e| Error::file(&path, e, budget.fix("make the file readable")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_remainder() {
        assert_eq!(base64_decode(b"").unwrap(), b"");
        assert_eq!(base64_decode(b"TQ==").unwrap(), b"M");
        assert_eq!(base64_decode(b"TWE=").unwrap(), b"Ma");
        assert_eq!(base64_decode(b"TWFu").unwrap(), b"Man");
        assert_eq!(base64_decode(b"+/8").unwrap(), [0xfb, 0xff]);
        assert!(base64_decode(b"TW!u").is_none());
    }

    #[test]
    fn references_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(folder.path().join("secret.bin"), b"x").unwrap();
        fs::write(inner.join("a b.bin"), b"x").unwrap();
        let owner = inner.join("scene.gltf");
        assert_eq!(resolve(&owner, "a%20b.bin").unwrap(), inner.join("a b.bin"));
        let absolute = folder.path().join("secret.bin").display().to_string();
        for bad in [
            "../secret.bin",
            "%2e%2e/secret.bin",
            "x/../../secret.bin",
            "..\\secret.bin",
            "file:///etc/passwd",
            "http://localhost/a.bin",
            "C:/a.bin",
            "%2Fetc/passwd",
            "%zz",
            "",
            ".",
            "missing.bin",
            &absolute,
        ] {
            assert!(resolve(&owner, bad).is_err(), "{bad} was accepted");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_out_of_the_folder_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(folder.path().join("secret.bin"), b"x").unwrap();
        std::os::unix::fs::symlink("../secret.bin", inner.join("link.bin")).unwrap();
        assert!(resolve(&inner.join("scene.gltf"), "link.bin").unwrap_err().contains("outside"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn links_that_appear_between_check_and_reading_lead_nowhere() {
        use std::sync::atomic::{AtomicBool, Ordering};
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(folder.path().join("secret.bin"), b"secret").unwrap();
        let done = AtomicBool::new(false);
        let owner = inner.join("scene.gltf");
        let read = std::thread::scope(|scope| {
            scope.spawn(|| {
                let spare = inner.join("spare");
                while !done.load(Ordering::Relaxed) {
                    fs::write(&spare, b"public").unwrap();
                    fs::rename(&spare, inner.join("a.bin")).unwrap();
                    std::os::unix::fs::symlink("../secret.bin", &spare).unwrap();
                    fs::rename(&spare, inner.join("a.bin")).unwrap();
                }
            });
            let tries = (0..20_000).filter_map(|_| read_uri(&owner, "a.bin", &Budget::default()).ok());
            let read: Vec<Vec<u8>> = tries.collect();
            done.store(true, Ordering::Relaxed);
            read
        });
        assert!(!read.is_empty(), "the file was never read at all");
        assert!(read.iter().all(|bytes| bytes == b"public"));
    }
}
