//! Whole names of the things that names with stars and question marks stand for in a Cryptomatte.

use std::path::Path;

use isophote_exr_edit::File;

use super::fault::Fault;
use super::file::{LIMITS, folder};
use super::mask::MaskSource;
use super::mattes::{mattes, pick};
use isophote_files::error::Result;

impl MaskSource {
    /// Words that name its things one by one, by the Cryptomatte of a file, as hosts need them that have no list of names; the same
    /// words where it names no things, or whole names alone.
    ///
    /// # Errors
    /// [`Error::Input`](isophote_files::error::Error::Input) for damaged files, those without such a Cryptomatte, and names that stand for
    /// none in its list.
    pub fn by_whole_names(&self, words: &str, path: &Path, bytes: Vec<u8>) -> Result<String> {
        let Self::Mattes(choice) = self else { return Ok(words.to_owned()) };
        if choice.names.iter().all(|name| name.exact().is_some()) {
            return Ok(words.to_owned());
        }
        let read = || -> std::result::Result<_, Fault> {
            let exr = File::parse(bytes, LIMITS)?;
            let mattes = mattes(&exr);
            let matte = pick(&mattes, choice.layer.as_deref())?;
            let in_file = |problem: String| Fault::Choice {
                problem: format!("has a Cryptomatte '{}' whose manifest {problem}", matte.name),
                fix: "write whole names, or name a file whose manifest is whole".into(),
            };
            let manifest = matte.manifest(folder(path)).map_err(in_file)?;
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
        };
        read().map_err(|fault| fault.of(path))
    }
}
