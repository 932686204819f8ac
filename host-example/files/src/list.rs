//! Lists of frame numbers such as `1001-1100x2,1200`.

use std::collections::HashSet;
use std::iter::successors;
use std::str::FromStr;

/// Most frames of one run.
const MOST_FRAMES: usize = 1_000_000;
/// Most ranges in a message.
const MOST_SHOWN: usize = 12;

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
    pub fn or_count(text: &str) -> Result<Self, String> {
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

    fn from_str(list: &str) -> Result<Self, String> {
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
}
