//! Sequences of frames: file names such as `shot.####.exr`, `shot.@@@@.exr` and `shot.%04d.exr`, and lists of
//! frame numbers such as `1001-1100x2,1200`.

use std::collections::HashSet;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::iter::successors;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::error::{Error, Result};

/// Most frames of one run.
const MOST_FRAMES: usize = 1_000_000;
/// Most digits of a place for the number: names of files are no longer.
const MOST_DIGITS: usize = 255;
/// Extensions of pictures.
const KINDS: [&str; 8] = ["exr", "png", "jpg", "jpeg", "tif", "tiff", "webp", "hdr"];
/// Most ranges in a message.
const MOST_SHOWN: usize = 12;

/// A file name with a place for the number of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    path: PathBuf,
    before: OsString,
    digits: usize,
    after: OsString,
}

impl Pattern {
    /// The pattern in a path's last part; nothing when there is none.
    ///
    /// # Errors
    /// [`Error::Input`] when there are several, or it has more digits than a name can have.
    pub fn new(path: &Path) -> Result<Option<Self>> {
        let Some(name) = path.file_name().map(OsStr::as_encoded_bytes) else { return Ok(None) };
        let Some((start, length, digits)) = place(name) else { return Ok(None) };
        let (before, after) = (&name[..start], &name[start + length..]);
        if place(after).is_some() {
            return Err(Error::file(path, "has several places for the frame number", "leave one"));
        }
        if digits > MOST_DIGITS {
            return Err(Error::file(
                path,
                format!("has {digits} digits for the frame number"),
                "leave a few",
            ));
        }
        Ok(Some(Self { path: path.to_owned(), before: piece(before), digits, after: piece(after) }))
    }

    /// The pattern in a path's last part; without one, `.####` before the extension.
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
            Self { path: path.to_owned(), before, digits: 4, after }
        };
        Ok(Self::new(path)?.unwrap_or_else(added))
    }

    /// The file of a frame.
    pub fn file(&self, frame: i64) -> PathBuf {
        let sign = if frame < 0 { "-" } else { "" };
        let digits = self.digits;
        let mut name = self.before.clone();
        name.push(format!("{sign}{:0digits$}", frame.unsigned_abs()));
        name.push(&self.after);
        self.path.with_file_name(name)
    }

    /// The number in the name of a file of the sequence.
    fn number(&self, name: &OsStr) -> Option<i64> {
        let rest = name.as_encoded_bytes().strip_prefix(self.before.as_encoded_bytes())?;
        let number = rest.strip_suffix(self.after.as_encoded_bytes())?;
        std::str::from_utf8(number).ok()?.parse().ok()
    }

    /// Frames that have a file, in order.
    ///
    /// # Errors
    /// [`Error::Input`] when the folder cannot be read or there are none.
    pub fn on_disk(&self) -> Result<Vec<i64>> {
        let folder = match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let unreadable =
            |e: std::io::Error| Error::file(folder, format!("cannot be read: {e}"), "name another folder");
        let mut frames = Vec::new();
        for entry in fs::read_dir(folder).map_err(unreadable)? {
            let name = entry.map_err(unreadable)?.file_name();
            let number = self.number(&name);
            // Only the name that the frame would have: 1 is no frame of ####.
            frames.extend(number.filter(|n| self.file(*n).file_name() == Some(name.as_os_str())));
        }
        if frames.is_empty() {
            return Err(Error::file(&self.path, "matches no file", "name files that exist"));
        }
        frames.sort_unstable();
        Ok(frames)
    }
}

/// Place of the number: start, length and digits.
fn place(name: &[u8]) -> Option<(usize, usize, usize)> {
    for (start, c) in name.iter().enumerate() {
        let rest = &name[start..];
        if matches!(c, b'#' | b'@') {
            let length = rest.iter().take_while(|other| *other == c).count();
            return Some((start, length, length));
        }
        if *c == b'%' {
            let length = rest[1..].iter().take_while(|c| c.is_ascii_digit()).count();
            if rest.get(1 + length) == Some(&b'd') && length <= 3 {
                // %4d would pad with blanks, which no sequence means.
                let digits = rest[1..=length].iter().fold(0, |sum, c| sum * 10 + usize::from(c - b'0'));
                return Some((start, length + 2, digits.max(1)));
            }
        }
    }
    None
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
fn numbered(name: &OsStr) -> Option<String> {
    let (stem, extension) = name.to_str()?.rsplit_once('.')?;
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let digits = stem[..end].bytes().rev().take_while(u8::is_ascii_digit).count();
    is_picture(Path::new(name))
        .then(|| format!("{}{}{}.{extension}", &stem[..end - digits], "#".repeat(digits), &stem[end..]))
}

/// Frames as they are written on the command line: numbers and ranges with steps after an x, or after a colon as
/// Open Job Description has it; each frame once and in the order given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList(Vec<i64>);

impl FrameList {
    /// The frames, at least one.
    pub fn frames(&self) -> &[i64] {
        &self.0
    }

    /// Reads a list, or a number alone as that many frames from 1.
    ///
    /// # Errors
    /// The problem with the text.
    pub fn or_count(text: &str) -> std::result::Result<Self, String> {
        match text.trim().parse::<usize>() {
            Ok(0) => {
                Err("no frames are too few; write a number such as 48, or a list such as 1001-1100".into())
            }
            Ok(count) if count > MOST_FRAMES => Err(format!("more than {MOST_FRAMES} frames are too many")),
            Ok(count) => Ok(Self((1..=count as i64).collect())),
            Err(_) => text.parse(),
        }
    }
}

impl FromStr for FrameList {
    type Err = String;

    fn from_str(list: &str) -> std::result::Result<Self, String> {
        let mut all = Vec::new();
        let mut seen = HashSet::new();
        for item in list.split(',') {
            let (first, last, step) = range(item.trim()).ok_or_else(|| {
                format!("'{}' is no range of frames; write a list such as 1001-1100x2,1200", item.trim())
            })?;
            let count = (last - first).abs() / step;
            if all.len() as i64 + count >= MOST_FRAMES as i64 {
                return Err(format!("more than {MOST_FRAMES} frames are too many"));
            }
            let signed = if last < first { -step } else { step };
            all.extend((0..=count).map(|i| first + i * signed).filter(|frame| seen.insert(*frame)));
        }
        Ok(Self(all))
    }
}

/// First frame, last frame and step of `1001-1100x2`, of `1001-1100` or of a single frame.
fn range(item: &str) -> Option<(i64, i64, i64)> {
    let (range, step) = match item.split_once(['x', ':']) {
        Some((range, step)) => (range, step.trim().parse().ok()?),
        None => (item, 1i64),
    };
    // A minus at the front is the number's own.
    let split = range
        .char_indices()
        .skip(1)
        .find(|(at, c)| *c == '-' && range[..*at].trim_end().ends_with(|c: char| c.is_ascii_digit()));
    let number = |text: &str| text.trim().parse::<i64>().ok().filter(|n| n.unsigned_abs() < 1 << 40);
    let (first, last) = match split {
        Some((at, _)) => (number(&range[..at])?, number(&range[at + 1..])?),
        None => (number(range)?, number(range)?),
    };
    (step > 0).then_some((first, last, step))
}

/// Frames that a sequence on disk seems to lack: holes in its smallest step.
pub fn holes(frames: &[i64]) -> Vec<i64> {
    let pairs = || frames.windows(2).filter(|pair| pair[0] < pair[1]);
    let Some(step) = pairs().map(|pair| pair[1].abs_diff(pair[0])).min() else { return Vec::new() };
    let next = move |frame: &i64| frame.checked_add_unsigned(step);
    let between = |pair: &[i64]| {
        successors(next(&pair[0]), next).take_while({
            let end = pair[1];
            move |f| *f < end
        })
    };
    pairs().flat_map(between).take(MOST_FRAMES).collect()
}

/// Frames as a range expression of Open Job Description, in ascending order: `1001-1099:2,1200`.
pub fn range_expression(frames: &[i64]) -> String {
    ranges(frames).join(",")
}

/// As [`range_expression`], cut short where it is long, for messages.
pub fn summary(frames: &[i64]) -> String {
    let mut ranges = ranges(frames);
    if ranges.len() > MOST_SHOWN {
        ranges.truncate(MOST_SHOWN);
        ranges.push("...".into());
    }
    ranges.join(",")
}

fn ranges(frames: &[i64]) -> Vec<String> {
    let mut sorted = frames.to_vec();
    sorted.sort_unstable();
    let mut parts: Vec<(i64, i64, u64)> = Vec::new();
    for frame in sorted {
        match parts.last_mut() {
            Some((first, last, step)) if *first == *last => {
                *step = frame.abs_diff(*last);
                *last = frame;
            }
            Some((_, last, step)) if last.abs_diff(frame) == *step => *last = frame,
            _ => parts.push((frame, frame, 1)),
        }
    }
    let text = |(first, last, step): &(i64, i64, u64)| match (last.abs_diff(*first), *step) {
        (0, _) => first.to_string(),
        (_, 1) => format!("{first}-{last}"),
        (length, step) if length == step => format!("{first},{last}"),
        (_, step) => format!("{first}-{last}:{step}"),
    };
    parts.iter().map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_frames_are_read() {
        let frames = |list: &str| list.parse::<FrameList>().map(|list| list.0);
        assert_eq!(frames("1001-1007x2,1200").unwrap(), [1001, 1003, 1005, 1007, 1200]);
        assert_eq!(frames("3-1, 2,-2--1").unwrap(), [3, 2, 1, -2, -1]);
        assert_eq!(frames("1-5:2").unwrap(), [1, 3, 5]);
        for bad in ["-9223372036854775808", "", "a", "1-", "1-5x0", "1-5x-1", "1--", "1-99999999999", "1..5"]
        {
            assert!(frames(bad).is_err(), "{bad}");
        }
        assert_eq!(holes(&[1, 3, 5, 9, 11]), [7]);
        assert_eq!(holes(&[4]), [] as [i64; 0]);
        assert_eq!(holes(&[i64::MIN, i64::MAX]), [] as [i64; 0]);
        assert_eq!(holes(&[i64::MIN, i64::MAX - 2, i64::MAX]).first(), Some(&(i64::MIN + 2)));
    }

    #[test]
    fn range_expressions_are_short() {
        assert_eq!(range_expression(&[1, 3, 5, 7, 20]), "1-7:2,20");
        assert_eq!(range_expression(&[3, 2, 1]), "1-3");
        assert_eq!(range_expression(&[1, 9]), "1,9");
        assert_eq!(range_expression(&[-2, -1, 5]), "-2--1,5");
        assert_eq!(range_expression(&[4]), "4");
        let ends = [i64::MIN, i64::MAX];
        assert_eq!(range_expression(&ends), "-9223372036854775808,9223372036854775807");
        assert_eq!(summary(&[1, 2, 3, 7, 9, 10]), "1-3,7,9,10");
        let growing: Vec<i64> = (0..100).map(|n| n * n).collect();
        assert!(summary(&growing).ends_with(",...") && summary(&growing).len() < 100);
    }

    #[test]
    fn patterns_name_files() {
        let file = |pattern: &str, frame| {
            Pattern::new(Path::new(pattern)).unwrap().map(|p| p.file(frame).display().to_string())
        };
        assert_eq!(file("a/s.####.exr", 7).as_deref(), Some("a/s.0007.exr"));
        assert_eq!(file("a/s.@@@.exr", -7).as_deref(), Some("a/s.-007.exr"));
        assert_eq!(file("s.%05d.exr", 12345678).as_deref(), Some("s.12345678.exr"));
        assert_eq!(file("s%d.exr", 3).as_deref(), Some("s3.exr"));
        assert_eq!(file("plain.exr", 3), None);
        assert_eq!(file("100%.exr", 3), None);
        assert_eq!(file("s.##.exr", i64::MIN).as_deref(), Some("s.-9223372036854775808.exr"));
        assert!(Pattern::new(Path::new(&"#".repeat(70_000))).is_err());
        assert!(Pattern::new(Path::new("s.##.##.exr")).is_err());
        let added = |path: &str| Pattern::or_added(Path::new(path)).unwrap().file(7).display().to_string();
        assert_eq!(added("a/out.png"), "a/out.0007.png");
        assert_eq!(added("a/out.##.exr"), "a/out.07.exr");
        assert_eq!(added("out"), "out.0007");
    }
}
