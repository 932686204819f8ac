//! Kind of document that a path holds.

use std::io::Read;
use std::path::{Path, PathBuf};

use isophote_files::error::{Error, Result};
use isophote_files::frames::{self, Pattern};
use isophote_files::input;
use isophote_finishing::video;

/// Kinds of documents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A scene: glTF, GLB or OBJ.
    Scene,
    /// A picture by itself.
    Picture,
    /// Pictures with numbers.
    Sequence,
    /// A video.
    Video,
}

/// Extensions of scenes.
const SCENES: [&str; 3] = ["gltf", "glb", "obj"];
/// First bytes of a binary glTF file.
const GLB: &[u8] = b"glTF";
/// List of the kinds that can be opened, for messages.
const KNOWN: &str = "open a picture (PNG, JPEG, TIFF, WebP, HDR, EXR), a sequence of them, a video, or a scene (glTF, GLB, OBJ)";

/// True where a path ends as those of documents do.
pub fn is_known(path: &Path) -> bool {
    let is_scene = path.extension().is_some_and(|e| SCENES.iter().any(|known| e.eq_ignore_ascii_case(known)));
    is_scene || frames::is_picture(path) || video::becomes_video(path)
}

impl Kind {
    /// The kind of a path with the path that is meant: the pattern of a sequence where a folder of frames is named, or one of
    /// its frames and `as_sequence`.
    ///
    /// # Errors
    /// [`Error::Input`] for what is missing or nothing of these.
    pub fn of(path: &Path, as_sequence: bool) -> Result<(Self, PathBuf)> {
        if Pattern::new(path)?.is_some() {
            return Ok((Self::Sequence, path.to_owned()));
        }
        let (mut file, found) =
            input::open(path).map_err(|e| Error::file(path, format!("cannot be opened: {e}"), KNOWN))?;
        if found.is_dir() {
            let none = || Error::file(path, "is a folder without numbered pictures", KNOWN);
            return frames::meant(path).map(|pattern| (Self::Sequence, pattern)).ok_or_else(none);
        }
        if !found.is_file() {
            return Err(Error::file(path, "is a pipe or a device", KNOWN));
        }
        let mut start = [0; GLB.len()];
        // What is shorter is no scene.
        let is_scene = (file.read_exact(&mut start).is_ok() && start == *GLB)
            || path.extension().is_some_and(|e| SCENES.iter().any(|known| e.eq_ignore_ascii_case(known)));
        if is_scene {
            return Ok((Self::Scene, path.to_owned()));
        }
        if video::is_video(path) {
            return Ok((Self::Video, path.to_owned()));
        }
        match frames::sequence_of(path).filter(|_| as_sequence) {
            Some(pattern) => Ok((Self::Sequence, pattern)),
            None => Ok((Self::Picture, path.to_owned())),
        }
    }
}
