//! Work beside the window for looks: reading which there are, reading the present one again when its files have changed, and
//! making previews.

use std::path::PathBuf;
use std::sync::Arc;

use super::listing::{self, ListingRequest};
use super::preview::queue::Queue;
use super::watch::Watch;
use super::worker::{Wake, Worker};
use crate::state::browser::listing::Listing;
use crate::state::look::EditedLook;
use crate::state::outcome::Outcome;
use crate::state::preview::order::Task;
use crate::state::session::Session;
use isophote_files::error::Result;
use isophote_loader::Library;

/// The threads.
pub struct LookWork {
    library: Library,
    lister: Worker<ListingRequest, Listing>,
    /// Watches the files of all looks while they are shown.
    listed: Watch,
    /// Reads the present look again.
    reader: Worker<PathBuf, (PathBuf, Result<EditedLook>)>,
    /// Watches the files of the present look.
    present: Watch,
    previews: Option<Queue>,
    wake: Wake,
}

impl LookWork {
    /// Starts the threads.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(library: &Library, wake: &Wake) -> Result<Self> {
        let own = library.clone();
        Ok(Self {
            library: library.clone(),
            lister: Worker::new("looks", Arc::clone(wake), listing::read)?,
            listed: Watch::new(wake)?,
            reader: Worker::new("look again", Arc::clone(wake), move |path: PathBuf| {
                let read = EditedLook::open(&own, &path);
                (path, read)
            })?,
            present: Watch::new(wake)?,
            previews: None,
            wake: Arc::clone(wake),
        })
    }

    /// Outcomes since the last call.
    pub fn collect(&mut self) -> Vec<Outcome> {
        let listed = self.lister.answer().map(Outcome::Listed);
        let previews = self.previews.iter().flat_map(Queue::collect).map(Outcome::Preview);
        let read = self.reader.answer().map(|(source, read)| Outcome::Reread(source, read));
        listed.into_iter().chain(previews).chain(read).collect()
    }

    /// Watches the files of the present look, and those of all looks while they are shown, and reads what has changed.
    pub fn follow(&mut self, session: &Session) {
        self.present.follow(session.look().files());
        if self.present.has_changed() {
            self.reader.ask(session.look().source.clone());
        }
        let is_open = session.browser.is_open;
        self.listed.follow(if is_open { session.browser.watched.clone() } else { Vec::new() });
        if is_open && self.listed.has_changed() {
            self.list(session);
        }
    }

    /// Reads which looks there are.
    pub fn list(&mut self, session: &Session) {
        let folders = session.settings.look_folders.clone();
        self.lister.ask(ListingRequest { library: self.library.clone(), folders });
    }

    /// Makes these previews, and no others that are not begun.
    ///
    /// # Errors
    /// As [`Queue::new`].
    pub fn preview(&mut self, tasks: Vec<Task>) -> Result<()> {
        if self.previews.is_none() && !tasks.is_empty() {
            self.previews = Some(Queue::new(self.library.clone(), Arc::clone(&self.wake))?);
        }
        if let Some(previews) = &self.previews {
            previews.follow(tasks);
        }
        Ok(())
    }
}
