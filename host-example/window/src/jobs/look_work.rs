//! Work beside the window for the browser of looks: reading what there is, watching the files, and making previews.

use std::sync::Arc;

use super::listing::{self, ListingRequest};
use super::preview::queue::Queue;
use super::watch::Watch;
use super::worker::{Wake, Worker};
use crate::state::browser::listing::Listing;
use crate::state::session::Session;
use isophote_files::error::Result;

/// The threads.
pub struct LookWork {
    lister: Worker<ListingRequest, Listing>,
    watch: Watch,
    previews: Option<Queue>,
    wake: Wake,
}

impl LookWork {
    /// Starts the threads.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        Ok(Self {
            lister: Worker::new("looks", Arc::clone(wake), listing::read)?,
            watch: Watch::new(wake)?,
            previews: None,
            wake: Arc::clone(wake),
        })
    }

    /// Takes over what was read and made since the last call.
    pub fn collect(&mut self, session: &mut Session) {
        if let Some(listing) = self.lister.answer() {
            session.list(listing);
        }
        for done in self.previews.iter().flat_map(Queue::collect) {
            session.previews.take(done);
        }
        session.follow_picture();
    }

    /// Does what is asked for.
    ///
    /// # Errors
    /// As [`Queue::new`].
    pub fn carry_out(&mut self, session: &mut Session) -> Result<()> {
        let is_open = session.browser.is_open;
        self.watch.follow(if is_open { session.browser.watched.clone() } else { Vec::new() });
        if is_open && (std::mem::take(&mut session.browser.is_outdated) | self.watch.has_changed()) {
            let folders = session.settings.look_folders.clone();
            self.lister.ask(ListingRequest { library: session.library.clone(), folders });
        }
        let tasks = session.previews.tasks();
        if self.previews.is_none() && !tasks.is_empty() {
            self.previews = Some(Queue::new(session.library.clone(), Arc::clone(&self.wake))?);
        }
        if let Some(previews) = &self.previews {
            previews.follow(tasks);
        }
        Ok(())
    }
}
