//! Facts about files, for people and for programs.

mod facts;
mod meaning;
mod picture;
mod scene;
mod style;
mod video;

use std::path::Path;

use isophote_files::error::{Error, Result};
use isophote_files::output;
use isophote_finishing::video::is_video;

use self::facts::Facts;

/// Extensions of scenes.
const SCENES: [&str; 3] = ["gltf", "glb", "obj"];

/// Everything that is understood of a file.
///
/// # Errors
/// [`Error::Input`] for files that are missing, damaged or of no kind that is known; [`Error::Failure`] without a library
/// or the programs that a video needs.
pub fn of(path: &Path) -> Result<Facts> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if path.as_os_str() == "-" {
        return Err(Error::file(path, "stands for a stream, which is read once", "name a file"));
    }
    let mut facts = Facts::default();
    let file = path.display().to_string();
    facts.add("file", file.clone());
    let (result, warnings) = output::with_warnings(|| match extension.as_str() {
        scene if SCENES.contains(&scene) => scene::add(&mut facts, path),
        "json" => style::add(&mut facts, path),
        _ if is_video(path) => video::add(&mut facts, path),
        _ => picture::add(&mut facts, path),
    });
    if result.is_err() {
        warnings.iter().for_each(output::warn);
    }
    result?;
    facts.warn(&file, warnings);
    Ok(facts)
}
