//! Messages of the window: one line at a time, which goes away by itself unless something went wrong.

use std::time::{Duration, Instant};

use isophote_files::error::Error;
use isophote_files::output;

/// Time that good news stays.
const STAYS: Duration = Duration::from_secs(4);
/// Most notes at a time.
const MOST: usize = 3;

/// One line.
#[derive(Clone, Debug)]
pub struct Note {
    /// Text of the message.
    pub text: String,
    /// True where something went wrong.
    pub is_bad: bool,
    since: Instant,
}

/// All that is said at the moment.
#[derive(Debug, Default)]
pub struct Notes {
    notes: Vec<Note>,
}

impl Notes {
    /// Adds a note of something that was done.
    pub fn say(&mut self, text: impl Into<String>) {
        self.add(text.into(), false);
    }

    /// Adds a note of what went wrong, here and where the program was started.
    pub fn complain(&mut self, error: &Error) {
        let text = error.to_string();
        if self.notes.iter().any(|note| note.text == text) {
            return;
        }
        output::warn(&text);
        self.add(text, true);
    }

    fn add(&mut self, text: String, is_bad: bool) {
        self.notes.retain(|note| note.is_bad && note.text != text);
        self.notes.push(Note { text, is_bad, since: Instant::now() });
        if self.notes.len() > MOST {
            self.notes.remove(0);
        }
    }

    /// Takes what went wrong back: it has been mended.
    pub fn clear(&mut self) {
        self.notes.clear();
    }

    /// Notes in the order in which they came.
    pub fn present(&mut self) -> &[Note] {
        self.notes.retain(|note| note.is_bad || note.since.elapsed() < STAYS);
        &self.notes
    }

    /// Removes a note.
    pub fn dismiss(&mut self, index: usize) {
        if index < self.notes.len() {
            self.notes.remove(index);
        }
    }
}
