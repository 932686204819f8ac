//! Dialogs of the system, each on a thread of its own: they may stay open for long. The crate that shows them tells in the log
//! alone why one was not shown.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Once};

use super::worker::Wake;
use crate::state::command;
use crate::state::outcome::Dialog;
use crate::state::saving::Saving;
use crate::state::session::Session;
use isophote_files::error::{Error, Result};
use isophote_pictures::material::MaterialKind;

/// Result of a dialog: its purpose, and what was chosen; nothing where it was closed.
type DialogResult = (Dialog, Result<Vec<PathBuf>>);

/// Dialogs, of which one is open at a time.
pub struct SystemDialogs {
    chosen: Receiver<DialogResult>,
    choose: Sender<DialogResult>,
    /// True while one is open.
    is_open: bool,
    wake: Wake,
}

impl SystemDialogs {
    /// Dialogs of which none is open yet.
    pub fn new(wake: &Wake) -> Self {
        let (choose, chosen) = channel();
        Self { chosen, choose, is_open: false, wake: Arc::clone(wake) }
    }

    /// Result since the last call.
    pub fn answer(&mut self) -> Option<DialogResult> {
        let answer = self.chosen.try_recv().ok()?;
        self.is_open = false;
        Some(answer)
    }

    /// Shows a dialog, unless one is open.
    ///
    /// # Errors
    /// [`Error::Failure`] when the system has no thread to give.
    pub fn show(&mut self, dialog: Dialog, session: &Session) -> Result<()> {
        if self.is_open {
            return Ok(());
        }
        let (folder, name) = proposed(dialog, session);
        let kind = session.dialogs.plan.as_ref().map(|plan| (plan.format.name, plan.format.extension));
        let (choose, wake) = (self.choose.clone(), Arc::clone(&self.wake));
        let otherwise = otherwise(dialog, session.takes_drops);
        let spawned = std::thread::Builder::new().name("dialog".into()).spawn(move || {
            let asked = Asked { dialog, folder, name, kind };
            let paths = shown(|| asked.answer(), otherwise).map(Option::unwrap_or_default);
            // The window may be closed by now.
            let _ = choose.send((dialog, paths));
            wake();
        });
        spawned.map_err(|e| Error::failure(format!("no dialog can be opened: {e}"), otherwise))?;
        self.is_open = true;
        Ok(())
    }
}

/// Folder and name of a file that a dialog begins with.
fn proposed(dialog: Dialog, session: &Session) -> (Option<PathBuf>, String) {
    let saved = session.dialogs.saving.as_ref().map(Saving::file);
    let planned = session.dialogs.plan.as_ref().map(|plan| PathBuf::from(&plan.path));
    let folder = match dialog {
        Dialog::Save => saved.as_deref().and_then(Path::parent).map(Path::to_owned),
        Dialog::Look | Dialog::LookFolder => session.settings.look_folder.clone(),
        Dialog::Export => planned.as_deref().and_then(Path::parent).map(Path::to_owned),
        Dialog::SeveralTo => {
            let results = session.dialogs.batch.as_ref().map(|batch| PathBuf::from(batch.folder.trim()));
            results.as_deref().and_then(Path::parent).map(Path::to_owned)
        }
        Dialog::File
        | Dialog::Surroundings
        | Dialog::Palette
        | Dialog::Material(_)
        | Dialog::OpenMap(_)
        | Dialog::Several => session.settings.folder.clone(),
        Dialog::SaveMap(kind) => command::map_file(session, kind).parent().map(Path::to_owned),
    };
    let file = match (dialog, planned) {
        (Dialog::Export, Some(planned)) => planned,
        (Dialog::SaveMap(kind), _) => command::map_file(session, kind),
        _ => saved.unwrap_or_default(),
    };
    (folder, file.file_name().unwrap_or_default().to_string_lossy().into_owned())
}

/// Advice where the system has no dialogs.
const fn otherwise(dialog: Dialog, takes_drops: bool) -> &'static str {
    match dialog {
        Dialog::File | Dialog::Look if takes_drops => {
            "drop the file on the window, or install zenity or xdg-desktop-portal"
        }
        Dialog::Several if takes_drops => {
            "drop the files on the window, or install zenity or xdg-desktop-portal"
        }
        Dialog::Export | Dialog::SeveralTo => {
            "type where it is to go, or install zenity or xdg-desktop-portal"
        }
        _ => "install zenity or xdg-desktop-portal",
    }
}

/// A dialog as it is shown.
struct Asked {
    dialog: Dialog,
    folder: Option<PathBuf>,
    name: String,
    /// Name and extension of the kind of file that is exported.
    kind: Option<(&'static str, &'static str)>,
}

impl Asked {
    /// Shows it and waits for its answer.
    fn answer(&self) -> Option<Vec<PathBuf>> {
        let mut shown = rfd::FileDialog::new();
        if let Some(folder) = &self.folder {
            shown = shown.set_directory(folder);
        }
        match self.dialog {
            Dialog::File => return shown.set_title("Open").pick_files(),
            Dialog::Several => return shown.set_title("Use the look on these pictures").pick_files(),
            Dialog::Look => shown.set_title("Open a look").add_filter("Looks", &["json"]).pick_file(),
            Dialog::LookFolder => shown.set_title("Add a folder of looks").pick_folder(),
            Dialog::SeveralTo => shown.set_title("Folder of the results").pick_folder(),
            Dialog::Save => {
                let shown = shown.set_title("Save the look").set_file_name(&self.name);
                let path = shown.add_filter("Looks", &["json"]).save_file()?;
                Some(if path.extension().is_some() { path } else { path.with_extension("json") })
            }
            Dialog::Export => {
                let shown = shown.set_title("Export").set_file_name(&self.name);
                let shown = match self.kind {
                    Some((name, extension)) => shown.add_filter(name, &[extension]),
                    None => shown,
                };
                shown.save_file()
            }
            // Pictures are palettes as well, of many endings.
            Dialog::Palette => shown.set_title("Colours of a palette or a picture").pick_file(),
            Dialog::Material(MaterialKind::Paper) => shown.set_title("A picture of paper").pick_file(),
            Dialog::Material(MaterialKind::Hatching) => shown.set_title("A picture of hatching").pick_file(),
            Dialog::OpenMap(kind) => shown.set_title(format!("Open a {}", kind.name())).pick_file(),
            Dialog::SaveMap(kind) => {
                let shown = shown.set_title(format!("Save the {}", kind.name())).set_file_name(&self.name);
                let path = shown.add_filter("PNG", &["png"]).save_file()?;
                Some(if path.extension().is_some() { path } else { path.with_extension("png") })
            }
            Dialog::Surroundings => shown
                .set_title("Surroundings")
                .add_filter("Pictures of the surroundings", &["hdr", "exr"])
                .pick_file(),
        }
        .map(|path| vec![path])
    }
}

/// Origin of the messages of the crate that shows dialogs.
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
fn shown<T>(ask: impl FnOnce() -> Option<T>, otherwise: &str) -> Result<Option<T>> {
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
