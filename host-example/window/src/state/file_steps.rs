//! Changes of the files of looks as steps that are taken back and taken again: what was in a file before each and after it is
//! kept until the window is closed.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};

/// Most bytes of a file that is kept; looks have some kilobytes.
const MOST_BYTES: u64 = 16 << 20;

/// Content of a file; nothing where there is none.
type Content = Option<Vec<u8>>;

/// A change of a file.
#[derive(Debug)]
struct Change {
    file: PathBuf,
    before: Content,
    after: Content,
}

/// All changes that were made, of which some may have been taken back.
#[derive(Debug, Default)]
pub struct FileSteps {
    changes: Vec<Change>,
    done: usize,
}

impl FileSteps {
    /// Number of steps that have been made and not been taken back.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Changes a file by `change`. What was taken back before can be made again no more.
    ///
    /// # Errors
    /// [`Error::Input`] for files that are too large to be kept or cannot be read, and what `change` says.
    pub fn change(&mut self, file: &Path, change: impl FnOnce() -> Result<()>) -> Result<()> {
        let before = read(file)?;
        change()?;
        let after = read(file)?;
        if before == after {
            return Ok(());
        }
        self.changes.truncate(self.done);
        self.changes.push(Change { file: file.to_owned(), before, after });
        self.done += 1;
        Ok(())
    }

    /// Takes changes back, or makes them again, until so many are made. Returns the files that were restored, and those that
    /// could not be: one that is not as it was left has been changed by somebody else, and stays as it is.
    pub fn go_to(&mut self, done: usize) -> Vec<Result<PathBuf>> {
        let mut said = Vec::new();
        while self.done > done {
            self.done -= 1;
            said.extend(
                self.changes.get(self.done).map(|Change { file, before, after }| {
                    restore(file, after, before).map(|()| file.clone())
                }),
            );
        }
        while self.done < done.min(self.changes.len()) {
            let Change { file, before, after } = &self.changes[self.done];
            said.push(restore(file, before, after).map(|()| file.clone()));
            self.done += 1;
        }
        said
    }
}

fn read(file: &Path) -> Result<Content> {
    let unreadable = |e: std::io::Error| Error::file(file, format!("cannot be read: {e}"), "mend it first");
    match fs::metadata(file) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        Ok(data) if data.len() > MOST_BYTES => {
            let problem = "is too large to be kept, so that it could not be brought back";
            return Err(Error::file(file, problem, "use a file manager"));
        }
        Ok(_) | Err(_) => {}
    }
    fs::read(file).map(Some).map_err(unreadable)
}

/// Gives a file the content `wanted` if it has the one that is `expected`.
fn restore(file: &Path, expected: &Content, wanted: &Content) -> Result<()> {
    if read(file)? != *expected {
        let problem = "has been changed by somebody else meanwhile, and stays as it is";
        return Err(Error::file(file, problem, "change it by hand"));
    }
    match wanted {
        Some(bytes) => files::write_bytes(file, Existing::Replace, bytes),
        None => fs::remove_file(file)
            .map_err(|e| Error::file(file, format!("cannot be deleted: {e}"), "delete it in a file manager")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_taken_back_and_made_again_but_never_those_of_others() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("look.json");
        let put = |text: &str| fs::write(&file, text).map_err(|e| Error::failure(e.to_string(), ""));
        let text = || fs::read_to_string(&file).ok();
        put("one").unwrap();
        let mut steps = FileSteps::default();
        steps.change(&file, || put("two")).unwrap();
        steps
            .change(&file, || fs::remove_file(&file).map_err(|e| Error::failure(e.to_string(), "")))
            .unwrap();
        assert_eq!((steps.done(), text()), (2, None));
        assert!(steps.go_to(1).iter().all(Result::is_ok));
        assert_eq!(text().as_deref(), Some("two"));
        assert!(steps.go_to(0).iter().all(Result::is_ok));
        assert_eq!(text().as_deref(), Some("one"));
        assert_eq!(steps.go_to(9).into_iter().map(Result::unwrap).collect::<Vec<_>>(), [&*file, &*file]);
        assert_eq!((steps.done(), text()), (2, None));
        put("of somebody else").unwrap();
        let refused = steps.go_to(1).remove(0).unwrap_err().to_string();
        assert!(refused.contains("somebody else") && refused.contains("look.json"), "{refused}");
        assert_eq!((steps.done(), text().as_deref()), (1, Some("of somebody else")));
        steps.change(&file, || put("three")).unwrap();
        assert_eq!(steps.go_to(5).len(), 0, "what was taken back is forgotten");
    }

    #[test]
    fn what_fails_is_no_step() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("look.json");
        let mut steps = FileSteps::default();
        assert!(steps.change(&file, || Err(Error::failure("no", ""))).is_err());
        let large = fs::File::create(&file).unwrap();
        large.set_len(MOST_BYTES + 1).unwrap();
        assert!(steps.change(&file, || unreachable!("it is not begun")).is_err());
        assert_eq!(steps.done(), 0);
    }
}
