//! An export at work: how much of it is done, how long the rest takes, and where it goes.

use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Time after which the rest can be told.
const FIRST: Duration = Duration::from_secs(2);
/// Most failures that are named; of the others there is the number.
const MOST: usize = 8;

/// An export at work.
#[derive(Clone, Debug)]
pub struct Running {
    /// File, pattern or folder that it goes to.
    pub place: PathBuf,
    /// Word for what is counted: frames or pictures.
    pub noun: &'static str,
    /// Number that is done; a picture by itself counts by its share.
    pub done: f64,
    /// Number of all, as far as is known; 0 at first.
    pub total: f64,
    started: Instant,
}

impl Running {
    /// One that has just begun.
    pub fn new(place: PathBuf, noun: &'static str) -> Self {
        let place = std::path::absolute(&place).unwrap_or(place);
        Self { place, noun, done: 0.0, total: 0.0, started: Instant::now() }
    }

    /// Share that is done.
    pub fn share(&self) -> f32 {
        (self.done / self.total.max(1.0)) as f32
    }

    /// Progress in words.
    pub fn words(&self) -> String {
        words((self.noun, self.done, self.total), self.started.elapsed())
    }

    /// Sentence on what there is now.
    pub fn sentence(&self) -> String {
        let folder = self.place.parent().unwrap_or(&self.place).display();
        let name = self.place.file_name().unwrap_or_default().to_string_lossy();
        match (self.noun, self.total as u64) {
            ("pictures", count) => format!("{count} pictures are in {}", self.place.display()),
            (_, ..=1) => format!("Exported {name} to {folder}"),
            (noun, count) => format!("Exported {count} {noun} as {name} to {folder}"),
        }
    }
}

/// Sentence on what could not be done of so many, by name.
pub fn failures(failures: &[String], all: u64) -> String {
    let mut text = format!("{} of {all} could not be done; the others are there.", failures.len());
    failures.iter().take(MOST).for_each(|failure| text += &format!("\n{failure}"));
    if failures.len() > MOST {
        text += &format!("\nand {} more", failures.len() - MOST);
    }
    text
}

fn words((noun, done, total): (&str, f64, f64), passed: Duration) -> String {
    if total < 1.0 {
        return "Exporting".to_owned();
    }
    let mut text = match total as u64 {
        1 => format!("{:.0} %", (done * 100.0).floor()),
        all => format!("{:.0} of {all} {noun}", done.floor()),
    };
    let share = done / total;
    if share > 0.01 && share < 1.0 && passed >= FIRST {
        let left = passed.as_secs_f64() * (1.0 - share) / share;
        text += &format!(", {} left", time(left));
    }
    text
}

fn time(seconds: f64) -> String {
    let whole = seconds.ceil() as u64;
    match whole {
        ..60 => format!("{whole} s"),
        60..3600 => format!("{} min", whole.div_ceil(60)),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_once_it_is_known() {
        let after = |seconds, of| words(of, Duration::from_secs(seconds));
        assert_eq!(after(9, ("frames", 0.0, 0.0)), "Exporting");
        assert_eq!(after(1, ("frames", 12.0, 96.0)), "12 of 96 frames");
        assert_eq!(after(12, ("frames", 12.0, 96.0)), "12 of 96 frames, 2 min left");
        assert_eq!(after(4, ("frames", 0.25, 1.0)), "25 %, 12 s left");
        assert_eq!(after(4, ("pictures", 12.0, 12.0)), "12 of 12 pictures");
        assert_eq!(time(7300.0), "2 h 1 min");
    }

    #[test]
    fn what_failed_is_named() {
        let many: Vec<String> = (0..10).map(|n| format!("{n}.png: is damaged")).collect();
        let text = failures(&many, 12);
        assert!(text.starts_with("10 of 12 could not be done") && text.ends_with("and 2 more"), "{text}");
        assert!(text.contains("7.png") && !text.contains("8.png"));
    }
}
