//! Names of results that nobody names: in a folder, or beside what they are made of; and the pictures of a folder.

use std::fs;
use std::path::{Path, PathBuf};

use crate::stylize::preset;
use crate::video;
use crate::writing::FileKind;
use isophote_files::error::{Error, Result};
use isophote_files::frames::{self, Pattern};
use isophote_pictures::write::Format;

/// Word of results whose style has no name: a graph that is written out.
const NAMELESS: &str = "styled";

/// The result of a file in a folder: of the same name, with another ending where that kind is not written or another is asked
/// for.
pub fn in_folder(folder: &Path, input: &Path, kind: Option<FileKind>) -> PathBuf {
    let name = of_its_kind(input);
    folder.join(kind.map_or_else(|| name.clone(), |kind| name.with_extension(kind.extension())))
}

/// The pictures of a folder by their names, without those that are hidden.
///
/// # Errors
/// [`Error::Input`] for a folder that cannot be read or has none.
pub fn pictures_of(folder: &Path) -> Result<Vec<PathBuf>> {
    let unreadable =
        |e: std::io::Error| Error::file(folder, format!("cannot be read: {e}"), "name another folder");
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        // Some systems keep notes on files in hidden ones of the same endings.
        let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
        let file = entry.path();
        if !is_hidden && frames::is_picture(&file) && file.is_file() {
            found.push(file);
        }
    }
    if found.is_empty() {
        return Err(Error::file(folder, "is a folder without pictures", "name a folder that has some"));
    }
    found.sort_unstable();
    Ok(found)
}

/// The result of a file beside it, with the name of the style in its own: `photo.cartoon.png`.
///
/// # Errors
/// [`Error::Input`] for what has no name of its own: standard input, and folders.
pub fn beside(style: &Path, input: &Path) -> Result<PathBuf> {
    if input == Path::new("-") {
        let fix = "name the result: a video, or - for standard output";
        return Err(Error::input("-", "standard input has no name that the result could have", fix));
    }
    if input.is_dir() {
        let fix = "name a folder for the results as well, such as out/";
        return Err(Error::file(input, "is a folder", fix));
    }
    let word = word(style);
    let name = of_its_kind(input);
    if Pattern::new(input)?.is_some()
        && let Some(pattern) = Pattern::in_name(&name)?
    {
        return Ok(input.with_file_name(pattern.with_word(&word)));
    }
    let mut stem = name.file_stem().unwrap_or_default().to_owned();
    stem.push(format!(".{word}"));
    if let Some(extension) = name.extension() {
        stem.push(".");
        stem.push(extension);
    }
    Ok(input.with_file_name(stem))
}

/// True where two paths lie in one folder.
pub fn are_neighbours(a: &Path, b: &Path) -> bool {
    let folder = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        folder.canonicalize().ok()
    };
    folder(a).is_some_and(|of_a| folder(b) == Some(of_a))
}

/// The word for a style in the names of files.
fn word(style: &Path) -> String {
    if style.to_str().is_some_and(preset::is_written_out) {
        return NAMELESS.to_owned();
    }
    let id = preset::id_of_look(style).map(str::to_owned);
    id.unwrap_or_else(|| style.file_stem().unwrap_or_default().to_string_lossy().into_owned())
}

/// The name of a file, with another ending where that kind is not written; that of an animated PNG file tells it from a still
/// one.
fn of_its_kind(file: &Path) -> PathBuf {
    let name = Path::new(file.file_name().unwrap_or(file.as_os_str()));
    match Format::of(name) {
        Ok(_) if video::is_video(file) => name.with_extension("apng"),
        Ok(_) => name.to_owned(),
        Err(_) if video::is_video(file) => name.to_owned(),
        Err(_) if name.extension().is_some_and(|e| e.eq_ignore_ascii_case("hdr")) => {
            name.with_extension("exr")
        }
        Err(_) => name.with_extension("png"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_in_folders_keep_their_names() {
        for (input, output) in [
            ("a/b.jpg", "out/b.jpg"),
            ("photo #1.PNG", "out/photo #1.PNG"),
            ("a.webp", "out/a.png"),
            ("a.hdr", "out/a.exr"),
            ("a.mp4", "out/a.mp4"),
            ("shot.####.exr", "out/shot.####.exr"),
        ] {
            assert_eq!(in_folder(Path::new("out"), Path::new(input), None), Path::new(output));
        }
        assert_eq!(
            in_folder(Path::new("o"), Path::new("a/b.tiff"), Some(FileKind::Jpeg)),
            Path::new("o/b.jpg")
        );
    }

    #[test]
    fn results_beside_pictures_have_the_name_of_the_style() {
        for (style, input, output) in [
            ("cartoon", "a/b.jpg", "a/b.cartoon.jpg"),
            ("look:noir_panel", "a.png", "a.noir_panel.png"),
            ("presets/my.json", "a.tar.webp", "a.tar.my.png"),
            (r#"{"nodes": []}"#, "a.hdr", "a.styled.exr"),
            ("ink", "a.mov", "a.ink.mov"),
            ("ink", "s/shot.####.exr", "s/shot.ink.####.exr"),
            ("ink", "shot_%04d.webp", "shot_ink_%04d.png"),
            ("ink", "shot####.png", "shot.ink.####.png"),
            ("ink", "####.png", "ink.####.png"),
        ] {
            assert_eq!(beside(Path::new(style), Path::new(input)).unwrap(), Path::new(output), "{input}");
        }
        assert!(beside(Path::new("ink"), Path::new("-")).is_err());
        assert!(beside(Path::new("ink"), Path::new(".")).is_err());
    }
}
