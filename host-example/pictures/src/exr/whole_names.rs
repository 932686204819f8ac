//! Whole names of the things that names with stars and question marks stand for in a Cryptomatte.

use std::path::Path;

use isophote_cryptomatte::MatteChoice;
use isophote_exr_edit::File;

use super::fault::Fault;
use super::file::{LIMITS, folder};
use super::mask::MaskSource;
use super::mattes::{mattes, pick};
use isophote_files::error::Result;

/// A file whose Cryptomattes list names of things.
#[derive(Debug)]
pub struct WholeNames<'p> {
    path: &'p Path,
    exr: File,
}

impl<'p> WholeNames<'p> {
    /// The file of these bytes.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) for damaged files.
    pub fn of(path: &'p Path, bytes: Vec<u8>) -> Result<Self> {
        let exr = File::parse(bytes, LIMITS).map_err(|error| Fault::from(error).of(path))?;
        Ok(Self { path, exr })
    }

    /// Words that name the things of `source` one by one, as hosts need them that have no list of names; the same `words` where those
    /// name no things, or whole names alone.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) for files without such a Cryptomatte, and for names that stand for none in its
    /// list.
    pub fn words(&self, source: &MaskSource, words: &str) -> Result<String> {
        match source {
            MaskSource::Mattes(choice) if choice.names.iter().any(|name| name.exact().is_none()) => {
                self.written_out(choice).map_err(|fault| fault.of(self.path))
            }
            _ => Ok(words.to_owned()),
        }
    }

    fn written_out(&self, choice: &MatteChoice) -> std::result::Result<String, Fault> {
        let mattes = mattes(&self.exr);
        let matte = pick(&mattes, choice.layer.as_deref())?;
        let manifest = matte.manifest(folder(self.path)).map_err(|problem| Fault::Choice {
            problem: format!("has a Cryptomatte '{}' whose manifest {problem}", matte.name),
            fix: "write whole names, or name a file whose manifest is whole".into(),
        })?;
        let mut names: Vec<String> = Vec::new();
        for name in &choice.names {
            let before = names.len();
            match name.exact() {
                Some(exact) => names.push(exact),
                None => names.extend(manifest.names(name).map(|(name, _)| name.to_owned())),
            }
            if names.len() == before {
                return Err(Fault::Choice {
                    problem: format!("has no '{}' in its Cryptomatte '{}'", name.text, matte.name),
                    fix: manifest.advice(&name.text),
                });
            }
        }
        Ok(choice.words(names.iter().map(String::as_str)))
    }
}
