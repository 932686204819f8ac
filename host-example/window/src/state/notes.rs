//! Messages of the window: one line at a time, which goes away by itself unless something went wrong.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use isophote_files::error::Error;
use isophote_files::output;

/// Time that good news stays.
const STAYS: Duration = Duration::from_secs(4);
/// Time that good news stays where something can be done about it.
const STAYS_LONG: Duration = Duration::from_secs(60);
/// Most notes at a time.
const MOST: usize = 3;

/// One line.
#[derive(Clone, Debug)]
pub struct Note {
    /// Text of the message.
    pub text: String,
    /// True where something went wrong.
    pub is_bad: bool,
    /// File that it tells of, which can be shown in its folder.
    pub place: Option<PathBuf>,
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

    /// Adds a note of a file that was made, or of files of which some could not be.
    pub fn tell_of(&mut self, place: PathBuf, text: String, is_bad: bool) {
        if is_bad {
            output::warn(&text);
        }
        self.notes.retain(|note| note.place.is_none());
        self.add(text, is_bad);
        if let Some(note) = self.notes.last_mut() {
            note.place = Some(place);
        }
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
        self.notes.retain(|note| (note.is_bad || note.place.is_some()) && note.text != text);
        self.notes.push(Note { text, is_bad, place: None, since: Instant::now() });
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
        let stays = |note: &Note| if note.place.is_some() { STAYS_LONG } else { STAYS };
        self.notes.retain(|note| note.is_bad || note.since.elapsed() < stays(note));
        &self.notes
    }

    /// Removes a note.
    pub fn dismiss(&mut self, index: usize) {
        if index < self.notes.len() {
            self.notes.remove(index);
        }
    }
}
