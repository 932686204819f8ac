//! Sequences of frames: file names such as `shot.####.exr`, `shot.@@@@.exr` and `shot.%04d.exr`, and lists of
//! frame numbers such as `1001-1100x2,1200`.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::error::{Error, Result};

/// Most frames of one run.
const MOST_FRAMES: usize = 1_000_000;
/// Most ranges in a message.
const MOST_SHOWN: usize = 12;

/// A file name with a place for the number of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    path: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Pattern {
    /// The pattern in a path's last part; nothing when there is none.
    ///
    /// # Errors
    /// [`Error::Input`] when there are several.
    pub fn new(path: &Path) -> Result<Option<Self>> {
        let Some(name) = path.file_name().and_then(|n| n.to_str()) else { return Ok(None) };
        let Some((start, length, digits)) = place(name) else { return Ok(None) };
        let (before, after) = (name[..start].to_owned(), name[start + length..].to_owned());
        if place(&after).is_some() {
            return Err(Error::file(path, "has several places for the frame number", "leave one"));
        }
        Ok(Some(Self { path: path.to_owned(), before, digits, after }))
    }

    /// The pattern in a path's last part; without one, `.####` before the extension.
    ///
    /// # Errors
    /// As [`Pattern::new`].
    pub fn or_added(path: &Path) -> Result<Self> {
        let part = |part: Option<&OsStr>| part.map(|p| p.to_string_lossy().into_owned()).unwrap_or_default();
        let added = || Self {
            path: path.to_owned(),
            before: format!("{}.", part(path.file_stem())),
            digits: 4,
            after: path.extension().map_or_else(String::new, |e| format!(".{}", e.to_string_lossy())),
        };
        Ok(Self::new(path)?.unwrap_or_else(added))
    }

    /// The file of a frame.
    pub fn file(&self, frame: i64) -> PathBuf {
        let sign = if frame < 0 { "-" } else { "" };
        let digits = self.digits;
        let number = format!("{sign}{:0digits$}", frame.unsigned_abs());
        self.path.with_file_name(format!("{}{number}{}", self.before, self.after))
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
            let number = name
                .to_str()
                .and_then(|n| n.strip_prefix(&self.before)?.strip_suffix(&self.after)?.parse::<i64>().ok());
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

/// Where the number goes: start, length and digits.
fn place(name: &str) -> Option<(usize, usize, usize)> {
    for (start, c) in name.char_indices() {
        let rest = &name[start..];
        if c == '#' || c == '@' {
            let length = rest.chars().take_while(|other| *other == c).count();
            return Some((start, length, length));
        }
        if c == '%' {
            let digits: String = rest[1..].chars().take_while(char::is_ascii_digit).collect();
            if rest[1 + digits.len()..].starts_with('d') && digits.len() <= 3 {
                // %4d would pad with blanks, which no sequence means.
                return Some((start, digits.len() + 2, digits.parse().unwrap_or(1)));
            }
        }
    }
    None
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
    /// What is wrong with the text.
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
    let number = |text: &str| text.trim().parse::<i64>().ok().filter(|n| n.abs() < 1 << 40);
    let (first, last) = match split {
        Some((at, _)) => (number(&range[..at])?, number(&range[at + 1..])?),
        None => (number(range)?, number(range)?),
    };
    (step > 0).then_some((first, last, step))
}

/// Frames that a sequence on disk seems to lack: holes in its smallest step.
pub fn holes(frames: &[i64]) -> Vec<i64> {
    let Some(step) = frames.windows(2).map(|pair| pair[1] - pair[0]).min() else { return Vec::new() };
    let holes = frames.windows(2).flat_map(|pair| (pair[0] + step..pair[1]).step_by(step as usize));
    holes.take(MOST_FRAMES).collect()
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
    let mut parts: Vec<(i64, i64, i64)> = Vec::new();
    for frame in sorted {
        match parts.last_mut() {
            Some((first, last, step)) if *first == *last => {
                *step = frame - *last;
                *last = frame;
            }
            Some((_, last, step)) if *last + *step == frame => *last = frame,
            _ => parts.push((frame, frame, 1)),
        }
    }
    let text = |(first, last, step): &(i64, i64, i64)| match (last - first, *step) {
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
        for bad in ["", "a", "1-", "1-5x0", "1-5x-1", "1--", "1-99999999999", "1..5"] {
            assert!(frames(bad).is_err(), "{bad}");
        }
        assert_eq!(holes(&[1, 3, 5, 9, 11]), [7]);
        assert_eq!(holes(&[4]), [] as [i64; 0]);
    }

    #[test]
    fn range_expressions_are_short() {
        assert_eq!(range_expression(&[1, 3, 5, 7, 20]), "1-7:2,20");
        assert_eq!(range_expression(&[3, 2, 1]), "1-3");
        assert_eq!(range_expression(&[1, 9]), "1,9");
        assert_eq!(range_expression(&[-2, -1, 5]), "-2--1,5");
        assert_eq!(range_expression(&[4]), "4");
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
        assert!(Pattern::new(Path::new("s.##.##.exr")).is_err());
        let added = |path: &str| Pattern::or_added(Path::new(path)).unwrap().file(7).display().to_string();
        assert_eq!(added("a/out.png"), "a/out.0007.png");
        assert_eq!(added("a/out.##.exr"), "a/out.07.exr");
        assert_eq!(added("out"), "out.0007");
    }
}
