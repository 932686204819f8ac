//! `isophote apply --to`: several pictures, or those of folders, each to a file of its own name in one folder.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::{ApplyArgs, Files};
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_files::frames::{self, Pattern};
use isophote_finishing::apply::tasks::Task;
use isophote_finishing::video::is_video;
use isophote_pictures::write::Format;

/// Arguments without an option, by their meaning.
pub struct Named<'a> {
    /// The style: a file or the name of a node or look.
    pub style: &'a Path,
    /// Pictures, sequences, folders and videos that are read; at least one.
    pub inputs: Vec<&'a Path>,
    /// The result; nothing where it goes to a folder.
    pub output: Option<&'a Path>,
}

impl ApplyArgs {
    /// Meaning of the arguments without an option: with a preset the style is left out, and with a folder the result.
    ///
    /// # Errors
    /// [`Error::Input`] for a style beside a preset, for a folder without pictures for it, and for more pictures without one.
    pub fn named(&self) -> Result<Named<'_>> {
        if let (Some(first), None) = (self.more.first(), &self.to) {
            let fix = "name the folder of the results of several by --to, or leave it out";
            return Err(Error::file(first, "is one more than a style, a picture and a result", fix));
        }
        let all = [Some(&self.style), self.input.as_ref(), self.output.as_ref()];
        let all: Vec<&Path> = all.into_iter().flatten().chain(&self.more).map(PathBuf::as_path).collect();
        match (self.preset.as_deref().or(self.layered.as_deref()), all.as_slice()) {
            (Some(style), inputs) if self.to.is_some() => {
                Ok(Named { style, inputs: inputs.to_vec(), output: None })
            }
            (None, [style, inputs @ ..]) if self.to.is_some() && !inputs.is_empty() => {
                Ok(Named { style, inputs: inputs.to_vec(), output: None })
            }
            (None, [style, input, output]) if self.to.is_none() => {
                Ok(Named { style, inputs: vec![input], output: Some(output) })
            }
            (Some(style), [input, output]) => Ok(Named { style, inputs: vec![input], output: Some(output) }),
            (None, _) => {
                Err(Error::input("--to", "is given no picture", "name a style, and pictures or a folder"))
            }
            (Some(_), _) => {
                let (option, problem) = match self.preset {
                    Some(_) => ("--preset", "the preset names the style"),
                    None => ("--layered", "its looks name the styles"),
                };
                let fix = format!("give the picture and the result alone, or leave {option} out");
                Err(Error::input(option, problem, fix))
            }
        }
    }

    /// The files that the command line names; of several the first.
    ///
    /// # Errors
    /// As [`ApplyArgs::named`].
    pub fn files(&self) -> Result<Files<'_>> {
        let Named { style, inputs, output } = self.named()?;
        let input = inputs[0];
        let output = match (output, &self.to) {
            (None, Some(folder)) => Cow::Owned(result(folder, input)),
            (output, _) => Cow::Borrowed(output.unwrap_or(input)),
        };
        Ok(Files { style, input, output })
    }

    /// The pictures of a run that has several of them or a folder, each with its result; nothing for other runs.
    ///
    /// # Errors
    /// [`Error::Input`] for folders without pictures, two results of one name, and options of sequences.
    pub fn pictures(&self) -> Result<Option<Vec<Task>>> {
        let inputs = self.named()?.inputs;
        let Some(to) = self.to.as_deref() else { return Ok(None) };
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
                let output = result(to, &input);
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
        let Some(folder) = self.to.as_deref().filter(|folder| !folder.is_dir()) else { return Ok(()) };
        fs::create_dir_all(folder).map_err(|e| files::unwritable(folder, Some(e.kind()), e))
    }
}

/// The files that a path names: the pictures of a folder, the frames of a sequence, or itself.
fn each(path: &Path) -> Result<Vec<PathBuf>> {
    if path.is_dir() {
        let unreadable =
            |e: std::io::Error| Error::file(path, format!("cannot be read: {e}"), "name another folder");
        let mut found = Vec::new();
        for entry in fs::read_dir(path).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            // Some systems keep notes on files in hidden ones of the same endings.
            let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            let file = entry.path();
            if !is_hidden && frames::is_picture(&file) && file.is_file() {
                found.push(file);
            }
        }
        if found.is_empty() {
            return Err(Error::file(path, "is a folder without pictures", "name a folder that has some"));
        }
        found.sort_unstable();
        return Ok(found);
    }
    match Pattern::new(path)? {
        Some(pattern) => Ok(pattern.on_disk()?.into_iter().map(|frame| pattern.file(frame)).collect()),
        None => Ok(vec![path.to_owned()]),
    }
}

/// The result of a file in a folder: of the same name, with another ending where that kind is not written, and that of an
/// animated PNG file tells it from a still one.
fn result(folder: &Path, input: &Path) -> PathBuf {
    let name = Path::new(input.file_name().unwrap_or(input.as_os_str()));
    let name = match Format::of(name) {
        Ok(_) if is_video(input) => name.with_extension("apng"),
        Ok(_) => name.to_owned(),
        Err(_) if is_video(input) => name.to_owned(),
        Err(_) if name.extension().is_some_and(|e| e.eq_ignore_ascii_case("hdr")) => {
            name.with_extension("exr")
        }
        Err(_) => name.with_extension("png"),
    };
    folder.join(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_their_names() {
        for (input, output) in [
            ("a/b.jpg", "out/b.jpg"),
            ("photo #1.PNG", "out/photo #1.PNG"),
            ("a.webp", "out/a.png"),
            ("a.hdr", "out/a.exr"),
            ("a.mp4", "out/a.mp4"),
            ("shot.####.exr", "out/shot.####.exr"),
        ] {
            assert_eq!(result(Path::new("out"), Path::new(input)), Path::new(output));
        }
    }
}
