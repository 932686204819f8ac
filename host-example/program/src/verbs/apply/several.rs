//! `isophote apply` into a folder: several pictures, or those of folders, each to a file of its own name in one folder.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::{ApplyArgs, Files};
use crate::verbs::shared::is_folder;
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_files::frames::Pattern;
use isophote_finishing::apply::tasks::Task;
use isophote_finishing::naming;

/// Arguments without an option, by their meaning.
pub struct Named<'a> {
    /// The style: a file or the name of a node or look.
    pub style: &'a Path,
    /// Pictures, sequences, folders and videos that are read; at least one.
    pub inputs: Vec<&'a Path>,
    /// The result; nothing where it goes to a folder or was left out.
    pub output: Option<&'a Path>,
    /// The folder of the results.
    pub folder: Option<&'a Path>,
}

impl ApplyArgs {
    /// Meaning of the arguments without an option: with a preset the style is left out, and the last may be a folder for the
    /// results or be left out.
    ///
    /// # Errors
    /// [`Error::Input`] for a style beside a preset, for a folder without pictures for it, and for more pictures without one.
    pub fn named(&self) -> Result<Named<'_>> {
        let all = [Some(&self.style), self.input.as_ref(), self.output.as_ref()];
        let all: Vec<&Path> = all.into_iter().flatten().chain(&self.more).map(PathBuf::as_path).collect();
        let set = self.preset.as_deref().or(self.layered.as_deref());
        let Some((style, rest)) = set.map(|style| (style, &all[..])).or_else(|| {
            let (style, rest) = all.split_first()?;
            Some((*style, rest))
        }) else {
            return Err(no_picture());
        };
        let (inputs, output, folder) = match (self.to.as_deref(), rest) {
            (_, []) => return Err(no_picture()),
            (Some(to), inputs) => (inputs, None, Some(to)),
            (None, [inputs @ .., folder]) if takes_all(inputs, folder) => (inputs, None, Some(*folder)),
            (None, [_]) => (rest, None, None),
            (None, [inputs @ .., output]) if inputs.len() == 1 => (inputs, Some(*output), None),
            (None, _) => return Err(self.too_many()),
        };
        Ok(Named { style, inputs: inputs.to_vec(), output, folder })
    }

    /// The error of more names than have a meaning.
    fn too_many(&self) -> Error {
        if let Some(first) = self.more.first() {
            let fix = "name a folder for the results of several as the last, or by --to";
            return Error::file(first, "is one more than a style, a picture and a result", fix);
        }
        let (option, problem) = match self.preset {
            Some(_) => ("--preset", "the preset names the style"),
            None => ("--layered", "its looks name the styles"),
        };
        let fix = format!("give the picture and the result alone, or leave {option} out");
        Error::input(option, problem, fix)
    }

    /// The files that the command line names; of several the first.
    ///
    /// # Errors
    /// As [`ApplyArgs::named`], and as [`naming::beside`].
    pub fn files(&self) -> Result<Files<'_>> {
        let Named { style, inputs, output, folder } = self.named()?;
        let input = inputs[0];
        let output = match (output, folder) {
            (Some(output), _) => Cow::Borrowed(output),
            (None, Some(folder)) => Cow::Owned(self.result(style, folder, input)?),
            (None, None) if self.in_place => Cow::Borrowed(input),
            (None, None) => Cow::Owned(naming::beside(style, input)?),
        };
        Ok(Files { style, input, output })
    }

    /// The result of a file in a folder. In the file's own, where it would take its place, it has the style in its name.
    fn result(&self, style: &Path, folder: &Path, input: &Path) -> Result<PathBuf> {
        let result = naming::in_folder(folder, input, self.result.format);
        if self.to.is_none() && !self.in_place && naming::are_neighbours(&result, input) {
            let beside = naming::beside(style, input)?;
            return Ok(folder.join(beside.file_name().unwrap_or_default()));
        }
        Ok(result)
    }

    /// The pictures of a run that has several of them or a folder, each with its result; nothing for other runs.
    ///
    /// # Errors
    /// [`Error::Input`] for folders without pictures, two results of one name, and options of sequences.
    pub fn pictures(&self) -> Result<Option<Vec<Task>>> {
        let Named { style, inputs, folder, .. } = self.named()?;
        let Some(folder) = folder else {
            return match self.result.format {
                Some(_) => Err(Error::input(
                    "--format",
                    "is for a folder of results",
                    "name the result, or a folder by --to",
                )),
                None => Ok(None),
            };
        };
        if matches!(inputs.as_slice(), [one] if !one.is_dir()) {
            return Ok(None);
        }
        if self.frames.is_some() {
            return Err(Error::input(
                "--frames",
                "is for one sequence",
                "name a sequence such as shot.####.exr alone",
            ));
        }
        let mut tasks: Vec<Task> = Vec::new();
        let mut made: HashMap<PathBuf, PathBuf> = HashMap::new();
        for input in inputs {
            for input in each(input)? {
                let output = self.result(style, folder, &input)?;
                if let Some(other) = made.insert(output.clone(), input.clone()) {
                    let problem =
                        format!("would be the result of {} and of {}", other.display(), input.display());
                    return Err(Error::file(
                        &output,
                        problem,
                        "give them other names, or write to two folders",
                    ));
                }
                tasks.push(Task { frame: None, input, output });
            }
        }
        Ok(Some(tasks))
    }

    /// Makes the folder of the results where it is not there.
    ///
    /// # Errors
    /// [`Error::Input`] where it cannot be made.
    pub fn make_folder(&self) -> Result<()> {
        let Some(folder) = self.named()?.folder.filter(|folder| !folder.is_dir()) else { return Ok(()) };
        fs::create_dir_all(folder).map_err(|e| files::unwritable(folder, Some(e.kind()), e))
    }
}

fn no_picture() -> Error {
    Error::input("--to", "is given no picture", "name a style, and pictures or a folder")
}

/// The files that a path names: the pictures of a folder, the frames of a sequence, or itself.
fn each(path: &Path) -> Result<Vec<PathBuf>> {
    if path.is_dir() {
        return naming::pictures_of(path);
    }
    match Pattern::new(path)? {
        Some(pattern) => Ok(pattern.on_disk()?.into_iter().map(|frame| pattern.file(frame)).collect()),
        None => Ok(vec![path.to_owned()]),
    }
}

/// True where the last name is a folder that gets the results: it is one, or it follows a folder and has no extension, since
/// no result of a folder is a file.
fn takes_all(inputs: &[&Path], last: &Path) -> bool {
    let follows_folder = inputs.iter().any(|input| input.is_dir()) && last.extension().is_none();
    !inputs.is_empty() && (is_folder(last) || follows_folder)
}
