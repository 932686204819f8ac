//! Reading of the folder of the file that is open.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::worker::{Wake, Worker};
use crate::state::folder;
use crate::state::outcome::Outcome;
use crate::state::session::Session;
use isophote_files::error::Result;

/// A file, and patterns of numbered pictures that count one by one.
type FolderJob = (PathBuf, Vec<PathBuf>);

/// Reads folders on a thread of its own.
pub struct FolderReader {
    worker: Worker<FolderJob, (PathBuf, Vec<PathBuf>)>,
    /// The file whose folder was read last.
    requested: Option<PathBuf>,
}

impl FolderReader {
    /// Starts the thread.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        let worker = Worker::new("folder", Arc::clone(wake), |(file, apart): FolderJob| {
            let files = read(&file, &apart);
            (file, files)
        })?;
        Ok(Self { worker, requested: None })
    }

    /// Files that were found since the last call.
    pub fn answer(&mut self) -> Option<Outcome> {
        self.worker.answer().map(|(of, files)| Outcome::Beside(of, files))
    }

    /// Reads the folder of the file that is open, each time that another one is.
    pub fn follow(&mut self, session: &Session) {
        let file = session.open.file();
        if file == self.requested.as_deref() {
            return;
        }
        self.requested = file.map(Path::to_owned);
        if let Some(file) = file {
            self.worker.ask((file.to_owned(), session.beside.apart().to_vec()));
        }
    }
}

/// Files beside one; none where the folder cannot be read.
fn read(file: &Path, apart: &[PathBuf]) -> Vec<PathBuf> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let is_file = |entry: &fs::DirEntry| entry.path().is_file();
    let names = entries.flatten().filter(is_file).map(|entry| entry.file_name()).collect();
    folder::files(file, names, apart)
}
