//! Files that results may replace: those that are there already where that was asked for, and never one that is read.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::files::{self, Existing};
use crate::frames::Pattern;
use crate::identity::{Identity, is_same};

/// Consent of the caller to what is replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Consent {
    /// Any file that has the name of a result gives way.
    pub force: bool,
    /// The file that a result is made from gives way.
    pub in_place: bool,
    /// Results that are whole stay, and others are made again.
    pub skip_existing: bool,
}

/// A result with the file that it is made from, if that is a file.
#[derive(Clone, Copy, Debug)]
pub struct Made<'a> {
    /// File that it is made from.
    pub from: Option<&'a Path>,
    /// Path that it goes to.
    pub to: &'a Path,
}

/// Files that are read, by which they are and as they were named.
#[derive(Debug, Default)]
pub struct Inputs(HashMap<Identity, PathBuf>);

impl Inputs {
    /// These files.
    pub fn of(paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Self {
        let mut inputs = Self::default();
        paths.into_iter().for_each(|path| inputs.add(path.as_ref()));
        inputs
    }

    /// Adds a file, where there is one.
    pub fn add(&mut self, path: &Path) {
        if let Some(identity) = Identity::of(path) {
            self.0.entry(identity).or_insert_with(|| path.to_owned());
        }
    }

    /// Adds a file, or the files of a pattern for these frames, or for all that are on disk.
    ///
    /// # Errors
    /// As [`Pattern::new`].
    pub fn add_frames(&mut self, path: &Path, frames: Option<&BTreeSet<i64>>) -> Result<()> {
        match (Pattern::new(path)?, frames) {
            (None, _) => self.add(path),
            (Some(pattern), Some(frames)) => frames.iter().for_each(|frame| self.add(&pattern.file(*frame))),
            // Without any there is nothing to lose.
            (Some(pattern), None) => {
                pattern
                    .on_disk()
                    .unwrap_or_default()
                    .iter()
                    .for_each(|frame| self.add(&pattern.file(*frame)));
            }
        }
        Ok(())
    }
}

impl Consent {
    /// To the replacement of any file, or of none.
    pub fn forced(force: bool) -> Self {
        Self { force, ..Self::default() }
    }

    /// Refuses results that would replace what is read, and such as are there already; asked before anything is made. What
    /// else is read than the results are made from is found only where a result is there already. Of frames of a sequence
    /// the rest may be made.
    ///
    /// # Errors
    /// [`Error::Input`] naming the file that would be replaced, or the first of them; as `read`.
    pub fn check(
        self,
        results: &[Made<'_>],
        is_sequence: bool,
        read: impl FnOnce() -> Result<Inputs>,
    ) -> Result<()> {
        let found = results.iter().map(|made| (made, Identity::of(made.to)));
        let there: Vec<_> = found.filter_map(|(made, identity)| Some((made, identity?))).collect();
        if there.is_empty() {
            return Ok(());
        }
        let mut inputs = read()?;
        results.iter().filter_map(|made| made.from).for_each(|from| inputs.add(from));
        let mut replaced = Vec::new();
        for (made, identity) in &there {
            match inputs.0.get(identity) {
                None => replaced.push(made.to),
                Some(input) if Some(input.as_path()) != made.from => return Err(is_read(made.to, input)),
                Some(_) if self.in_place => {}
                Some(input) => return Err(is_the_input(made.to, input)),
            }
        }
        match replaced.first() {
            Some(first) if !(self.force || self.skip_existing) => Err(if is_sequence {
                begun(first, replaced.len(), results.len())
            } else {
                files::exists(first)
            }),
            _ => Ok(()),
        }
    }

    /// Lets `write` write a result, and says whether it did: where existing results are skipped, one that somebody else has
    /// finished meanwhile stays. `is_done` tells those from others.
    ///
    /// # Errors
    /// The errors of `write`.
    pub fn write(
        self,
        made: Made<'_>,
        is_done: impl Fn(&Path) -> bool,
        write: impl FnOnce(Existing) -> Result<()>,
    ) -> Result<bool> {
        let is_in_place = self.in_place && made.from.is_some_and(|from| is_same(from, made.to));
        let existing = if self.force || is_in_place {
            Existing::Replace
        } else if self.skip_existing && made.to.exists() {
            if is_done(made.to) {
                return Ok(false);
            }
            Existing::Replace
        } else {
            Existing::Keep
        };
        match write(existing) {
            Err(_) if self.skip_existing && existing == Existing::Keep && is_done(made.to) => Ok(false),
            result => result.map(|()| true),
        }
    }

    /// Way to go on with a run that was not done to its end.
    pub fn resuming(self) -> &'static str {
        if self.in_place || self.force {
            "start again with --frames for those that are left"
        } else {
            "start again with --skip-existing"
        }
    }
}

/// The error of a result that is the file it is made from.
fn is_the_input(result: &Path, input: &Path) -> Error {
    let problem = if result == input {
        "is the input as well".into()
    } else {
        format!("is the same file as the input {}", input.display())
    };
    Error::file(result, problem, "name another file, or add --in-place to replace the input")
}

/// The error of a result that is another file which is read.
fn is_read(result: &Path, input: &Path) -> Error {
    let problem = if result == input {
        "is read, and would be replaced".into()
    } else {
        format!("is the same file as {}, which is read", input.display())
    };
    Error::file(result, problem, "name another file")
}

/// The error of a sequence of which some results are there.
fn begun(first: &Path, count: usize, all: usize) -> Error {
    let problem = match count {
        1 => format!("is there already, the only one of {all} results"),
        _ => format!("is there already, the first of {count} among {all} results"),
    };
    Error::file(first, problem, "add --skip-existing to make the others, or --force to make all again")
}
