//! Reasons why a dialog of the system was not shown: the crate that shows them tells them in the log alone.

use std::cell::RefCell;
use std::sync::Once;

use isophote_files::error::{Error, Result};

/// Origin of that crate's messages.
const SHOWS: &str = "rfd";
/// Program that it tries last, after which there is no dialog.
const LAST: &str = "zenity";

thread_local! {
    /// Problem with the dialog of this thread.
    static PROBLEM: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps what goes wrong with dialogs; other messages are for nobody.
struct Listener;

impl log::Log for Listener {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        metadata.level() == log::Level::Error && metadata.target().starts_with(SHOWS)
    }

    fn log(&self, record: &log::Record<'_>) {
        let text = record.args().to_string();
        if self.enabled(record.metadata()) && text.contains(LAST) {
            PROBLEM.set(Some(text));
        }
    }

    fn flush(&self) {}
}

/// Response to a dialog, which is nothing when it was closed.
///
/// # Errors
/// [`Error::Failure`] when there was none to answer; `otherwise` says what to do then.
pub fn shown<T>(ask: impl FnOnce() -> Option<T>, otherwise: &str) -> Result<Option<T>> {
    static LISTENS: Once = Once::new();
    LISTENS.call_once(|| {
        // Where a program has a log of its own, it is told there.
        if log::set_logger(&Listener).is_ok() {
            log::set_max_level(log::LevelFilter::Error);
        }
    });
    PROBLEM.take();
    let answer = ask();
    match PROBLEM.take() {
        Some(problem) => {
            Err(Error::failure(format!("the system cannot show a dialog: {problem}"), otherwise))
        }
        None => Ok(answer),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_shown_is_no_answer() {
        let refused = || {
            log::error!(target: "rfd::backend", "no bus");
            log::error!(target: "rfd::backend", "no zenity");
            None::<u8>
        };
        let error = shown(refused, "drop the file").unwrap_err().to_string();
        assert!(error.contains("no zenity") && error.ends_with("; drop the file"), "{error}");
        let fallback = || {
            log::error!(target: "rfd::backend", "no bus");
            Some(1)
        };
        assert_eq!(shown(fallback, "").unwrap(), Some(1));
        assert_eq!(shown(|| None::<u8>, "").unwrap(), None, "it was closed");
    }
}
