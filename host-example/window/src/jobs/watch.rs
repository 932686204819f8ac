//! Files that other programs change while the window shows what is in them.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};
use std::{fs, mem};

use super::worker::Wake;
use isophote_files::error::{Error, Result};

/// Time between two looks at the files.
const PAUSE: Duration = Duration::from_millis(500);

/// Time at which a file was written, and its length; none where there is none.
type Stamp = Option<(SystemTime, u64)>;

/// A thread that looks at files twice a second and wakes the window when one has changed.
#[derive(Debug)]
pub struct Watch {
    shared: Arc<Shared>,
    files: Vec<PathBuf>,
    changes: Receiver<()>,
    thread: Option<JoinHandle<()>>,
}

/// State that the thread looks at.
#[derive(Debug, Default)]
struct Shared {
    tray: Mutex<Tray>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Tray {
    files: Vec<(PathBuf, Stamp)>,
    closed: bool,
}

impl Watch {
    /// Starts the thread, with nothing to look at.
    ///
    /// # Errors
    /// [`Error::Failure`] when the system has no thread to give.
    pub fn new(wake: &Wake) -> Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, changes) = channel();
        let (own, wake) = (Arc::clone(&shared), Arc::clone(wake));
        let thread = std::thread::Builder::new()
            .name("watch".into())
            .spawn(move || serve(&own, &sender, &wake))
            .map_err(|e| Error::failure(format!("no thread can be started: {e}"), "close other programs"))?;
        Ok(Self { shared, files: Vec::new(), changes, thread: Some(thread) })
    }

    /// Looks at these files from now on, as they are now, unless it does already.
    pub fn follow(&mut self, files: Vec<PathBuf>) {
        if self.files == files {
            return;
        }
        let stamped = files.iter().map(|file| (file.clone(), stamp(file))).collect();
        self.shared.tray.lock().unwrap_or_else(PoisonError::into_inner).files = stamped;
        self.files = files;
        self.shared.changed.notify_one();
    }

    /// True where one of them has changed since the last call.
    pub fn has_changed(&self) -> bool {
        self.changes.try_iter().count() > 0
    }
}

fn serve(shared: &Shared, changes: &Sender<()>, wake: &Wake) {
    let mut tray = shared.tray.lock().unwrap_or_else(PoisonError::into_inner);
    while !tray.closed {
        // Where there is no file, there is nothing to wake up for.
        tray = if tray.files.is_empty() {
            shared.changed.wait(tray).unwrap_or_else(PoisonError::into_inner)
        } else {
            shared.changed.wait_timeout(tray, PAUSE).unwrap_or_else(PoisonError::into_inner).0
        };
        let mut is_new = false;
        for (file, known) in &mut tray.files {
            let now = stamp(file);
            // A file that is gone for the moment is about to be replaced.
            is_new |= now.is_some() && mem::replace(known, now) != now;
        }
        if is_new {
            // Nobody is to be told once the window is closed.
            let _ = changes.send(());
            wake();
        }
    }
}

fn stamp(file: &PathBuf) -> Stamp {
    let data = fs::metadata(file).ok()?;
    Some((data.modified().ok()?, data.len()))
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.shared.tray.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has been printed.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    fn waits_for_change(watch: &Watch) -> bool {
        let started = Instant::now();
        while started.elapsed() < Duration::from_secs(20) {
            if watch.has_changed() {
                return true;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        false
    }

    #[test]
    fn changes_are_told_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("look.json");
        fs::write(&file, "1").unwrap();
        let mut watch = Watch::new(&(Arc::new(|| ()) as Wake)).unwrap();
        watch.follow(vec![file.clone()]);
        fs::write(&file, "22").unwrap();
        assert!(waits_for_change(&watch));
        fs::remove_file(&file).unwrap();
        std::thread::sleep(PAUSE * 3);
        assert!(!watch.has_changed(), "it is gone, which is no news");
        fs::write(&file, "333").unwrap();
        assert!(waits_for_change(&watch));
    }

    #[test]
    fn a_folder_changes_with_the_files_in_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("look.json");
        fs::write(&file, "1").unwrap();
        let mut watch = Watch::new(&(Arc::new(|| ()) as Wake)).unwrap();
        watch.follow(vec![folder.path().to_owned()]);
        std::thread::sleep(Duration::from_millis(50));
        fs::remove_file(&file).unwrap();
        assert!(waits_for_change(&watch));
        std::thread::sleep(Duration::from_millis(50));
        fs::write(folder.path().join("other.json"), "1").unwrap();
        assert!(waits_for_change(&watch));
    }
}
