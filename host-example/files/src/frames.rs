//! Sequences of frames: file names such as `shot.####.exr`, `shot.@@@@.exr`, `shot.%04d.exr` and `shot.$F4.exr`, and
//! lists of frame numbers such as `1001-1100x2,1200`.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::place::{Place, places};

pub use crate::list::{FrameList, holes, range_expression, summary};

/// Most digits of a place for the number: names of files are no longer.
const MOST_DIGITS: usize = 255;
/// Numbers of UDIM tiles.
const TILES: RangeInclusive<i64> = 1001..=9999;
/// Extensions of pictures.
const KINDS: [&str; 8] = ["exr", "png", "jpg", "jpeg", "tif", "tiff", "webp", "hdr"];

/// A file name with a place for the number of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    path: PathBuf,
    before: OsString,
    digits: usize,
    /// True where a minus is one of the digits.
    counts_sign: bool,
    after: OsString,
    /// True where any number of digits may be meant, since one sign was written.
    is_open: bool,
    is_of_tiles: bool,
}

/// A number in the name of a file.
struct Numbered {
    number: i64,
    /// Its digits, without a minus.
    digits: usize,
    is_padded: bool,
    name: OsString,
}

impl Pattern {
    /// The pattern in the last part of a path that is read; nothing when there is none, and where a file has just this
    /// name. One sign alone stands for as many digits as the files have.
    ///
    /// # Errors
    /// [`Error::Input`] when there are several, or it has more digits than a name can have.
    pub fn new(path: &Path) -> Result<Option<Self>> {
        if path.exists() {
            return Ok(None);
        }
        match Self::in_name(path) {
            Ok(pattern) => Ok(pattern.map(Self::fitted)),
            // The files tell which of several places is meant.
            Err(error) => {
                let mut found =
                    Self::all(path)?.into_iter().map(Self::fitted).filter(|p| p.on_disk().is_ok());
                match (found.next(), found.next()) {
                    (Some(only), None) => Ok(Some(only)),
                    _ => Err(error),
                }
            }
        }
    }

    /// The pattern in a path's last part, whatever files there are; nothing when there is none.
    ///
    /// # Errors
    /// As [`Pattern::new`].
    pub fn in_name(path: &Path) -> Result<Option<Self>> {
        let name = path.file_name().map(OsStr::as_encoded_bytes).unwrap_or_default();
        let all = places(name);
        let most = all.iter().map(|place| place.rank(name)).max();
        let mut best = all.iter().filter(|place| Some(place.rank(name)) == most);
        match (best.next(), best.next()) {
            (None, _) => Ok(None),
            (Some(place), None) => Self::at(path, name, place).map(Some),
            _ => Err(Error::file(path, "has several places for the frame number", "leave one")),
        }
    }

    /// The patterns of all places in a path's last part.
    fn all(path: &Path) -> Result<Vec<Self>> {
        let name = path.file_name().map(OsStr::as_encoded_bytes).unwrap_or_default();
        places(name).iter().map(|place| Self::at(path, name, place)).collect()
    }

    fn at(path: &Path, name: &[u8], place: &Place) -> Result<Self> {
        let Place { start, length, digits, counts_sign, is_tile } = *place;
        if digits > MOST_DIGITS {
            return Err(Error::file(
                path,
                format!("has {digits} digits for the frame number"),
                "leave a few",
            ));
        }
        Ok(Self {
            path: path.to_owned(),
            before: piece(&name[..start]),
            digits,
            counts_sign,
            after: piece(&name[start + length..]),
            is_open: digits == 1,
            is_of_tiles: is_tile,
        })
    }

    /// The pattern in the last part of a path that is written; without one, `.####` before the extension.
    ///
    /// # Errors
    /// As [`Pattern::new`].
    pub fn or_added(path: &Path) -> Result<Self> {
        let added = || {
            let mut before = path.file_stem().unwrap_or_default().to_owned();
            before.push(".");
            let mut after = OsString::new();
            if let Some(extension) = path.extension() {
                after.push(".");
                after.push(extension);
            }
            let path = path.to_owned();
            Self { path, before, digits: 4, counts_sign: false, after, is_open: false, is_of_tiles: false }
        };
        Ok(Self::in_name(path)?.unwrap_or_else(added))
    }

    /// The same with as many digits as `other` has, where both were written with one sign.
    #[must_use]
    pub fn like(mut self, other: &Self) -> Self {
        if self.is_open && other.is_open {
            self.digits = other.digits;
        }
        self
    }

    /// True for UDIM tiles, whose numbers are places and no times.
    pub fn is_of_tiles(&self) -> bool {
        self.is_of_tiles
    }

    /// The file of a frame.
    pub fn file(&self, frame: i64) -> PathBuf {
        self.path.with_file_name(self.name(frame, self.counts_sign))
    }

    /// The same pattern with a word before the number: `shot.cartoon.####.exr`.
    pub fn with_word(&self, word: &str) -> PathBuf {
        let all = self.path.file_name().unwrap_or_default().as_encoded_bytes();
        let [before, number] = all.split_at_checked(self.before.len()).map_or([all, b""], |(a, b)| [a, b]);
        let separator = match before.last() {
            Some(separator @ (b'.' | b'_' | b'-')) => char::from(*separator),
            _ => '.',
        };
        let mut name = piece(before);
        if before.last().is_some_and(|last| char::from(*last) != separator) {
            name.push(separator.to_string());
        }
        name.push(format!("{word}{separator}"));
        name.push(piece(number));
        self.path.with_file_name(name)
    }

    fn name(&self, frame: i64, counts_sign: bool) -> OsString {
        let (sign, digits) = match (frame < 0, counts_sign) {
            (false, _) => ("", self.digits),
            (true, false) => ("-", self.digits),
            (true, true) => ("-", self.digits.saturating_sub(1)),
        };
        let mut name = self.before.clone();
        name.push(format!("{sign}{:0digits$}", frame.unsigned_abs()));
        name.push(&self.after);
        name
    }

    /// The same with the digits of the files that there are, where it leaves them open, and with their way to write
    /// numbers below zero.
    fn fitted(mut self) -> Self {
        let Ok(found) = self.numbered() else { return self };
        if self.is_open
            && let Some(digits) = padding(&found)
        {
            self.digits = digits;
        }
        let has =
            |counts_sign| found.iter().any(|n| n.number < 0 && self.name(n.number, counts_sign) == n.name);
        if !has(self.counts_sign) && has(!self.counts_sign) {
            self.counts_sign = !self.counts_sign;
        }
        self
    }

    fn folder(&self) -> &Path {
        match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        }
    }

    /// Files with any number in the place.
    fn numbered(&self) -> std::io::Result<Vec<Numbered>> {
        let mut found = Vec::new();
        for entry in fs::read_dir(self.folder())? {
            let name = entry?.file_name();
            let text = between(name.as_encoded_bytes(), [&self.before, &self.after]);
            let text = text.and_then(|text| std::str::from_utf8(text).ok());
            let Some((text, number)) = text.and_then(|text| Some((text, text.parse().ok()?))) else {
                continue;
            };
            let digits = text.bytes().filter(u8::is_ascii_digit).count();
            let is_padded = digits > 1 && text.trim_start_matches('-').starts_with('0');
            // As the pattern has it, whatever the case of its letters on the disk.
            let mut name = self.before.clone();
            name.push(text);
            name.push(&self.after);
            found.push(Numbered { number, digits, is_padded, name });
        }
        Ok(found)
    }

    /// Frames that have a file, in order.
    ///
    /// # Errors
    /// [`Error::Input`] when the folder cannot be read or there are none.
    pub fn on_disk(&self) -> Result<Vec<i64>> {
        let unreadable = |e: std::io::Error| {
            Error::file(self.folder(), format!("cannot be read: {e}"), "name another folder")
        };
        let found = self.numbered().map_err(unreadable)?;
        // Only the name that the frame would have: 1 is no frame of ####.
        let is_frame = |n: &&Numbered| {
            self.name(n.number, self.counts_sign) == n.name
                && (!self.is_of_tiles || TILES.contains(&n.number))
        };
        let mut frames: Vec<i64> = found.iter().filter(is_frame).map(|n| n.number).collect();
        if frames.is_empty() {
            return Err(self.none(&found));
        }
        frames.sort_unstable();
        Ok(frames)
    }

    /// The error of a pattern that no file has; `found` are files with other numbers of digits.
    fn none(&self, found: &[Numbered]) -> Error {
        let fix = match found.iter().find(|n| n.is_padded).or(found.first()) {
            Some(first) => {
                let same = found.iter().all(|n| n.digits == first.digits);
                let signs = if first.is_padded || same { first.digits } else { 1 };
                let mut name = self.before.clone();
                name.push("#".repeat(signs));
                name.push(&self.after);
                format!("write {}", self.path.with_file_name(name).display())
            }
            None => "name files that exist".into(),
        };
        Error::file(&self.path, "matches no file", fix)
    }
}

/// The part of a name between a beginning and an end, whose letters may be of another case on Windows, as names are there.
fn between<'n>(name: &'n [u8], [before, after]: [&OsStr; 2]) -> Option<&'n [u8]> {
    let is_same = |part: &[u8], wanted: &[u8]| match cfg!(windows) {
        true => part.eq_ignore_ascii_case(wanted),
        false => part == wanted,
    };
    let [before, after] = [before, after].map(OsStr::as_encoded_bytes);
    let (start, rest) = name.split_at_checked(before.len())?;
    let (middle, end) = rest.split_at_checked(rest.len().checked_sub(after.len())?)?;
    (is_same(start, before) && is_same(end, after)).then_some(middle)
}

/// Digits of numbers that zeros pad to one length; nothing where they are as long as they are.
fn padding(found: &[Numbered]) -> Option<usize> {
    // A minus may be one of the digits.
    let is_below = found.iter().all(|n| n.number < 0);
    let found = || found.iter().filter(|n| is_below || n.number >= 0);
    let least = found().map(|n| n.digits).min()?;
    let mut padded = found().filter(|n| n.is_padded).peekable();
    padded.peek()?;
    padded.all(|n| n.digits == least).then_some(least)
}

/// A part of a name that ends where ASCII begins or the other way round, whatever its letters are.
#[cfg(unix)]
fn piece(name: &[u8]) -> OsString {
    <OsStr as std::os::unix::ffi::OsStrExt>::from_bytes(name).to_owned()
}

#[cfg(not(unix))]
fn piece(name: &[u8]) -> OsString {
    String::from_utf8_lossy(name).into_owned().into()
}

/// The pattern of a sequence that somebody may mean who names a folder, or a pattern as shells know them such as
/// `shot.*.exr` or `shot.[0-9].exr`, and that has frames on disk.
pub fn meant(path: &Path) -> Option<PathBuf> {
    if path.is_dir() {
        let mut names: Vec<OsString> = fs::read_dir(path).ok()?.flatten().map(|e| e.file_name()).collect();
        names.sort_unstable();
        return names.iter().find_map(|name| numbered(name)).map(|pattern| path.join(pattern));
    }
    let name = path.file_name()?.to_str()?;
    let start = name.find(['*', '?', '[', '{', '$', '<'])?;
    // What programs write with a dollar ends with the letters and digits behind it.
    let word = name[start + 1..].chars().take_while(char::is_ascii_alphanumeric).count();
    let word = if name[start..].starts_with('$') { word } else { 0 };
    let end = 1 + name.rfind(['*', '?', ']', '}', '>']).unwrap_or(start).max(start + word);
    let (before, after) = (&name[..start], &name[end..]);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut names: Vec<OsString> =
        fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?.flatten().map(|e| e.file_name()).collect();
    names.sort_unstable();
    let fits = |name: &&OsString| {
        name.to_str().is_some_and(|name| name.starts_with(before) && name.ends_with(after))
    };
    names.iter().filter(fits).find_map(|name| numbered(name)).map(|pattern| path.with_file_name(pattern))
}

/// True where a path ends as those of pictures do.
pub fn is_picture(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    KINDS.iter().any(|kind| extension.eq_ignore_ascii_case(kind))
}

/// The pattern of the sequence of which a file is one frame among others on disk.
pub fn sequence_of(path: &Path) -> Option<PathBuf> {
    let pattern = path.with_file_name(numbered(path.file_name()?)?);
    let frames = Pattern::new(&pattern).ok()??.on_disk().ok()?;
    (frames.len() > 1).then_some(pattern)
}

/// The name of a picture with a place instead of the last number before its extension.
pub fn numbered(name: &OsStr) -> Option<String> {
    let (stem, extension) = name.to_str()?.rsplit_once('.')?;
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let digits = stem[..end].bytes().rev().take_while(u8::is_ascii_digit).count();
    is_picture(Path::new(name))
        .then(|| format!("{}{}{}.{extension}", &stem[..end - digits], "#".repeat(digits), &stem[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::MAIN_SEPARATOR;

    #[test]
    fn patterns_name_files() {
        // Joined by what the system joins paths with.
        let shown = |path: PathBuf| path.display().to_string().replace(MAIN_SEPARATOR, "/");
        let file =
            |pattern: &str, frame| Pattern::new(Path::new(pattern)).unwrap().map(|p| shown(p.file(frame)));
        assert_eq!(file("a/s.####.exr", 7).as_deref(), Some("a/s.0007.exr"));
        assert_eq!(file("a/s.@@@.exr", -7).as_deref(), Some("a/s.-007.exr"));
        assert_eq!(file("s.%05d.exr", 12345678).as_deref(), Some("s.12345678.exr"));
        assert_eq!(file("s%d.exr", 3).as_deref(), Some("s3.exr"));
        assert_eq!(file("plain.exr", 3), None);
        assert_eq!(file("100%.exr", 3), None);
        assert_eq!(file("s.##.exr", i64::MIN).as_deref(), Some("s.-9223372036854775808.exr"));
        assert!(Pattern::new(Path::new(&"#".repeat(70_000))).is_err());
        assert!(Pattern::new(Path::new("s.##.##.exr")).is_err());
        let added = |path: &str| shown(Pattern::or_added(Path::new(path)).unwrap().file(7));
        assert_eq!(added("a/out.png"), "a/out.0007.png");
        assert_eq!(added("a/out.##.exr"), "a/out.07.exr");
        assert_eq!(added("out"), "out.0007");
    }
    /// A folder with files of these names.
    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        names.iter().for_each(|name| fs::write(folder.path().join(name), "").unwrap());
        folder
    }

    #[test]
    fn a_file_that_exists_is_that_file() {
        let names = ["photo #1.png", "a@b.png", "50%d.png", "a.####.png", "a.0001.png", "b#1@2.0007.png"];
        let folder = folder(&names);
        let pattern = |name: &str| Pattern::new(&folder.path().join(name));
        for name in &names[..4] {
            assert_eq!(pattern(name).unwrap(), None, "{name}");
        }
        // What is written is a pattern, whatever there is.
        assert!(Pattern::in_name(&folder.path().join("a.####.png")).unwrap().is_some());
        assert_eq!(pattern("b#1@2.%04d.png").unwrap().unwrap().on_disk().unwrap(), [7]);
        assert_eq!(pattern("b#1@2.#.png").unwrap().unwrap().on_disk().unwrap(), [7]);
        assert!(pattern("#.#.png").is_err());
    }

    #[test]
    fn letters_have_two_cases_but_on_windows() {
        let folder = folder(&["Shot.0001.EXR", "Shot.0002.EXR"]);
        let pattern = Pattern::new(&folder.path().join("shot.####.exr")).unwrap().unwrap();
        assert_eq!(pattern.on_disk().ok(), cfg!(windows).then(|| vec![1, 2]));
        assert_eq!(pattern.file(1).is_file(), cfg!(windows));
    }

    #[test]
    fn one_sign_stands_for_the_digits_that_files_have() {
        let padded = folder(&["s.0001.exr", "s.0002.exr", "s.0010.exr"]);
        for name in ["s.#.exr", "s.@.exr", "s.%d.exr", "s.$F.exr", "s.$F4.exr", "s.%04d.exr", "s.<F4>.exr"] {
            let pattern = Pattern::new(&padded.path().join(name)).unwrap().unwrap();
            assert_eq!(pattern.on_disk().unwrap(), [1, 2, 10], "{name}");
            assert_eq!(pattern.file(7).file_name(), Some(OsStr::new("s.0007.exr")), "{name}");
        }
        for name in ["s.##.exr", "s.#####.exr", "s.%03d.exr"] {
            let pattern = Pattern::new(&padded.path().join(name)).unwrap().unwrap();
            let error = pattern.on_disk().unwrap_err().to_string();
            assert!(error.contains("matches no file") && error.contains("s.####.exr"), "{error}");
        }
        let plain = folder(&["s.8.exr", "s.9.exr", "s.10.exr"]);
        let pattern = |name: &str| Pattern::new(&plain.path().join(name)).unwrap().unwrap();
        assert_eq!(pattern("s.#.exr").on_disk().unwrap(), [8, 9, 10]);
        let error = pattern("s.####.exr").on_disk().unwrap_err().to_string();
        assert!(error.contains("write ") && error.contains("s.#.exr"), "{error}");
        // More digits than the padding are no other padding.
        let grown = folder(&["s.098.exr", "s.999.exr", "s.1000.exr"]);
        let pattern = Pattern::new(&grown.path().join("s.#.exr")).unwrap().unwrap();
        assert_eq!(pattern.on_disk().unwrap(), [98, 999, 1000]);
        // A result is written as its frames are read.
        let result = Pattern::in_name(Path::new("out.#.exr")).unwrap().unwrap();
        assert_eq!(result.clone().file(7), Path::new("out.7.exr"));
        assert_eq!(result.like(&pattern).file(7), Path::new("out.007.exr"));
    }

    #[test]
    fn numbers_below_zero_are_found_as_they_are_written() {
        let file = |pattern: &str| Pattern::in_name(Path::new(pattern)).unwrap().unwrap().file(-7);
        assert_eq!(file("s.%03d.exr"), Path::new("s.-07.exr"));
        assert_eq!(file("s.%d.exr"), Path::new("s.-7.exr"));
        assert_eq!(file("s.###.exr"), Path::new("s.-007.exr"));
        for (names, pattern) in [
            (["s.-007.exr", "s.000.exr"], "s.%03d.exr"),
            (["s.-07.exr", "s.000.exr"], "s.###.exr"),
            (["s.-07.exr", "s.000.exr"], "s.%03d.exr"),
            (["s.-007.exr", "s.000.exr"], "s.#.exr"),
        ] {
            let folder = folder(&names);
            let pattern = Pattern::new(&folder.path().join(pattern)).unwrap().unwrap();
            assert_eq!(pattern.on_disk().unwrap(), [-7, 0], "{names:?}");
            assert_eq!(pattern.file(-7).file_name(), Some(OsStr::new(names[0])));
        }
    }

    #[test]
    fn tiles_are_found_by_their_words() {
        let folder = folder(&["t.1001.exr", "t.1011.exr", "t.0007.exr"]);
        for name in ["t.<UDIM>.exr", "t.<udim>.exr", "t.%(UDIM)d.exr"] {
            let pattern = Pattern::new(&folder.path().join(name)).unwrap().unwrap();
            assert!(pattern.is_of_tiles());
            assert_eq!(pattern.on_disk().unwrap(), [1001, 1011], "{name}");
        }
    }
}
