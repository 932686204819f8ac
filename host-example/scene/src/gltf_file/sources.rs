//! Sources of the bytes of a glTF: data URIs, and files near it.

use crate::budget::{Budget, TOO_LARGE};
use crate::references::Folders;

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

/// Error of a URI behind which there are no bytes: the reason, and advice.
pub type UriError = (String, &'static str);

/// The bytes behind a URI, which may name a file in these folders.
///
/// # Errors
/// [`UriError`] when the URI is refused, or its file missing, unreadable or too large.
pub fn read_uri(folders: &Folders, uri: &str, budget: &Budget) -> Result<Vec<u8>, UriError> {
    if let Some(data) = uri.strip_prefix("data:") {
        budget
            .take(data.len(), 1)
            .map_err(|problem| (format!("holds a data URI that {problem}"), TOO_LARGE))?;
        let decoded = match data.split_once(',') {
            Some((head, body)) if head.ends_with(";base64") => base64_decode(body.as_bytes()),
            Some((_, body)) => percent_decode(body),
            None => None,
        };
        return decoded
            .ok_or_else(|| ("holds a data URI that cannot be decoded".into(), "export the scene again"));
    }
    // Escapes are what the format asks for; a name without any may hold their sign as it is.
    let decoded = percent_decode(uri).and_then(|bytes| String::from_utf8(bytes).ok());
    let opened = match decoded.filter(|name| name != uri) {
        Some(name) => folders.open(&name).or_else(|problem| folders.open(uri).map_err(|_| problem)),
        None => folders.open(uri),
    };
    let (file, _) = opened.map_err(|problem| (problem, "keep its files in the same folder, or below"))?;
    budget.read(file).map_err(|problem| {
        (format!("refers to '{uri}', which {problem}"), budget.fix("make the file readable"))
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

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
    fn names_may_have_escapes_or_not() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a b.bin", "50%.bin", "50%25.bin"] {
            fs::write(folder.path().join(name), name).unwrap();
        }
        let owner = folder.path().join("scene.gltf");
        let read = |uri: &str| {
            read_uri(&Folders::around(&owner), uri, &Budget::default()).map(|b| String::from_utf8(b).unwrap())
        };
        for (uri, name) in [
            ("a%20b.bin", "a b.bin"),
            ("a b.bin", "a b.bin"),
            ("50%.bin", "50%.bin"),
            ("50%25.bin", "50%.bin"),
        ] {
            assert_eq!(read(uri).unwrap(), name);
        }
        for bad in ["%2e%2e/gone.bin", "%2Fetc/passwd", "%zz", "%00"] {
            assert!(read(bad).is_err(), "{bad} was accepted");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn links_that_appear_between_check_and_reading_lead_nowhere() {
        use std::sync::atomic::{AtomicBool, Ordering};
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(folder.path().join("secret.bin"), b"secret").unwrap();
        fs::write(inner.join("a.bin"), b"public").unwrap();
        let done = AtomicBool::new(false);
        let owner = inner.join("scene.gltf");
        let read = std::thread::scope(|scope| {
            scope.spawn(|| {
                let spare = inner.join("spare");
                for _ in 0..2_000 {
                    std::os::unix::fs::symlink("../secret.bin", &spare).unwrap();
                    fs::rename(&spare, inner.join("a.bin")).unwrap();
                    fs::write(&spare, b"public").unwrap();
                    fs::rename(&spare, inner.join("a.bin")).unwrap();
                }
                done.store(true, Ordering::Relaxed);
            });
            // The first reading is before the links, or the last one is after them.
            let mut read: Vec<Vec<u8>> = Vec::new();
            let mut last = false;
            while !last {
                last = done.load(Ordering::Relaxed);
                read.extend(read_uri(&Folders::of(&owner), "a.bin", &Budget::default()));
            }
            read
        });
        assert!(!read.is_empty(), "the file was never read at all");
        assert!(read.iter().all(|bytes| bytes == b"public"));
    }
}
