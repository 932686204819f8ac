//! What was shown so far: for the window's title and for the report at the end.

use std::time::Duration;

use crate::error::Result;
use crate::output;

/// Frames of one look and size.
#[derive(Clone, Debug)]
struct Stretch {
    look: String,
    size: (u32, u32),
    times: Vec<Duration>,
}

/// Frames and their times.
#[derive(Debug, Default)]
pub struct Record {
    /// Closes the window after so many frames.
    pub limit: Option<u32>,
    /// Name of the adapter.
    pub adapter: String,
    stretches: Vec<Stretch>,
    begins: bool,
}

/// Most frames of a stretch whose times are kept; a window may be open for days.
const MOST: usize = 100_000;
/// Most stretches.
const MOST_STRETCHES: usize = 1000;

impl Record {
    /// A frame was shown.
    pub fn count(&mut self, look: &str, size: (u32, u32), time: Duration) {
        let begins = std::mem::take(&mut self.begins);
        match self.stretches.last_mut() {
            Some(last) if !begins && last.look == look && last.size == size => {
                if last.times.len() < MOST {
                    last.times.push(time);
                }
            }
            _ => {
                if self.stretches.len() >= MOST_STRETCHES {
                    self.stretches.remove(0);
                }
                self.stretches.push(Stretch { look: look.to_owned(), size, times: vec![time] });
            }
        }
    }

    /// The next frame is the first of another look.
    pub fn begin(&mut self) {
        self.begins = true;
    }

    /// Frames of the present look and the time of the last.
    pub fn present(&self) -> Option<(usize, Duration)> {
        let last = self.stretches.last().filter(|_| !self.begins)?;
        Some((last.times.len(), *last.times.last()?))
    }

    /// Whether all frames that were asked for have been shown.
    pub fn is_finished(&self) -> bool {
        let shown: usize = self.stretches.iter().map(|s| s.times.len()).sum();
        self.limit.is_some_and(|limit| shown >= limit as usize)
    }

    /// Prints the adapter, and the frames and milliseconds of each look.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn report(&self) -> Result<()> {
        let mut text = format!("{}\n", self.adapter);
        for Stretch { look, size: (width, height), times } in &self.stretches {
            let mut times = times.clone();
            times.sort_unstable();
            let median = times.get(times.len() / 2).map_or(0.0, |t| t.as_secs_f64() * 1e3);
            text += &format!("{look} {width}x{height}: {} frames, {median:.1} ms each\n", times.len());
        }
        output::print(&text)
    }
}
