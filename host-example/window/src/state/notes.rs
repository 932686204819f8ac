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

/// Subject of what went wrong, by which it is known to be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Anything that nothing is heard of again, such as a file that cannot be opened.
    Other,
    /// The look that is shown, and its files.
    Look,
    /// The list of looks.
    List,
    /// A frame of what is open.
    Frame,
    /// An export.
    Export,
}

/// One line.
#[derive(Clone, Debug)]
pub struct Note {
    /// Text of the message.
    pub text: String,
    /// True where something went wrong.
    pub is_bad: bool,
    subject: Subject,
    /// True once it was shown.
    is_seen: bool,
    /// File that it tells of, which can be shown in its folder.
    pub place: Option<PathBuf>,
    since: Instant,
}

/// All that is said at the moment.
#[derive(Debug, Default)]
pub struct Notes {
    notes: Vec<Note>,
}

impl Note {
    /// Time until it goes away by itself; `None` where it stays until it is mended or dismissed.
    fn left(&self) -> Option<Duration> {
        let stays = if self.place.is_some() { STAYS_LONG } else { STAYS };
        (!self.is_bad).then(|| stays.saturating_sub(self.since.elapsed()))
    }
}

impl Notes {
    /// Adds a note of something that was done.
    pub fn say(&mut self, text: impl Into<String>) {
        self.add(text.into(), false, Subject::Other);
    }

    /// Adds a note of a file that was made, or of files of which some could not be.
    pub fn tell_of(&mut self, place: PathBuf, text: String, is_bad: bool) {
        if is_bad {
            output::warn(&text);
        }
        self.notes.retain(|note| note.place.is_none());
        self.add(text, is_bad, Subject::Export);
        if let Some(note) = self.notes.last_mut() {
            note.place = Some(place);
        }
    }

    /// Adds a note of what went wrong, here and where the program was started.
    pub fn complain(&mut self, error: &Error) {
        self.complain_of(Subject::Other, error);
    }

    /// As [`Notes::complain`], until the subject is mended.
    pub fn complain_of(&mut self, subject: Subject, error: &Error) {
        let text = error.to_string();
        if self.notes.iter().any(|note| note.text == text) {
            return;
        }
        output::warn(&text);
        self.add(text, true, subject);
    }

    fn add(&mut self, text: String, is_bad: bool, subject: Subject) {
        self.notes.retain(|note| (note.is_bad || note.place.is_some()) && note.text != text);
        let since = Instant::now();
        self.notes.push(Note { text, is_bad, subject, is_seen: false, place: None, since });
        if self.notes.len() > MOST {
            self.notes.remove(0);
        }
    }

    /// Takes back what went wrong with a subject: it has been mended.
    pub fn mended(&mut self, subject: Subject) {
        self.mended_but(subject, &[]);
    }

    /// As [`Notes::mended`], but for problems that are still there.
    pub fn mended_but(&mut self, subject: Subject, left: &[Error]) {
        let is_left = |note: &Note| left.iter().any(|error| error.to_string() == note.text);
        self.notes.retain(|note| !note.is_bad || note.subject != subject || is_left(note));
    }

    /// Takes back what went wrong and was seen: something else is open now.
    pub fn leave_behind(&mut self) {
        self.notes.retain(|note| !note.is_bad || !note.is_seen);
    }

    /// Notes in the order in which they came, which are shown now.
    pub fn present(&mut self) -> &[Note] {
        // Its time begins when it is seen, which may be late where a processor draws.
        for note in self.notes.iter_mut().filter(|note| !note.is_seen) {
            (note.is_seen, note.since) = (true, Instant::now());
        }
        self.notes.retain(|note| note.left().is_none_or(|left| !left.is_zero()));
        &self.notes
    }

    /// Time until the next note goes away by itself.
    pub fn next_end(&self) -> Option<Duration> {
        self.notes.iter().filter_map(Note::left).min()
    }

    /// Removes a note.
    pub fn dismiss(&mut self, index: usize) {
        if index < self.notes.len() {
            self.notes.remove(index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stays_has_no_end_to_wait_for() {
        let mut notes = Notes::default();
        notes.complain(&Error::failure("it is damaged", "use an intact file"));
        assert_eq!(notes.next_end(), None);
        notes.say("It is saved");
        assert!(notes.next_end().is_some_and(|left| left <= STAYS));
        assert_eq!(notes.present().len(), 2);
    }
}
