//! Record of what was shown so far: for the window's title and for the report at the end.

use std::time::Duration;

use isophote_files::error::Result;
use isophote_files::output;
use isophote_finishing::stylize::precision::Precision;

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
    /// True where a report is wanted at the end.
    pub is_wanted: bool,
    stretches: Vec<Stretch>,
    begins: bool,
    /// Time of the controls on the device's clock, frame by frame.
    panel: Vec<Duration>,
    longest: Option<Hold>,
}

/// Time that the thread of the window was held up by one frame, during which it answers nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hold {
    /// Laying out the controls.
    pub controls: Duration,
    /// Taking over the picture, the looks and what was done beside the window.
    pub looks: Duration,
    /// Recording what the device is to do, and waiting for a place on the screen.
    pub drawing: Duration,
}

impl Hold {
    fn whole(self) -> Duration {
        self.controls + self.looks + self.drawing
    }
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

    /// The window was held up by a frame. What it does before its first picture does not count: there is nothing to answer yet.
    pub fn hold(&mut self, hold: Hold) {
        let is_longest = self.longest.is_none_or(|longest| hold.whole() > longest.whole());
        if is_longest && !self.stretches.is_empty() {
            self.longest = Some(hold);
        }
    }

    /// The controls took so long on the device.
    pub fn count_panel(&mut self, time: Duration) {
        if self.panel.len() < MOST {
            self.panel.push(time);
        }
    }

    /// The next frame is the first of another look.
    pub fn begin(&mut self) {
        self.begins = true;
    }

    /// Frames of the present look, once there is one.
    pub fn present(&self) -> Option<usize> {
        self.stretches.last().filter(|_| !self.begins).map(|last| last.times.len())
    }

    /// True where all frames that were asked for have been shown.
    pub fn is_finished(&self) -> bool {
        self.limit.is_some_and(|limit| self.shown() >= limit as usize)
    }

    /// Frames that have been shown, as far as they are kept.
    pub fn shown(&self) -> usize {
        self.stretches.iter().map(|stretch| stretch.times.len()).sum()
    }

    /// Prints the adapter and the precision, the frames and milliseconds of each look, the longest time that the window answered nobody, and what
    /// its controls took on the device.
    ///
    /// # Errors
    /// As [`output::print`].
    pub fn report(&self, precision: Precision) -> Result<()> {
        let mut text = format!("{}, {} precision\n", self.adapter, precision.name());
        for Stretch { look, size: (width, height), times } in &self.stretches {
            let median = median(times);
            text += &format!("{look} {width}x{height}: {} frames, {median:.1} ms each\n", times.len());
        }
        if let Some(hold) = self.longest {
            let [whole, controls, looks, drawing] =
                [hold.whole(), hold.controls, hold.looks, hold.drawing].map(milliseconds);
            text += &format!(
                "longest hold of the window: {whole:.1} ms (controls {controls:.1}, looks {looks:.1}, drawing {drawing:.1})\n"
            );
        }
        if !self.panel.is_empty() {
            let (frames, median) = (self.panel.len(), median(&self.panel));
            text += &format!("controls on the device: {frames} frames, {median:.2} ms each\n");
        }
        output::print(&text)
    }
}

fn median(times: &[Duration]) -> f64 {
    let mut times = times.to_vec();
    times.sort_unstable();
    times.get(times.len() / 2).copied().map_or(0.0, milliseconds)
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
