//! Opening of files, scenes, looks, surroundings and palettes, one after the other on a thread of its own.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::{Document, Options};
use super::maps;
use crate::state::demo;
use crate::state::document::kind::Kind as DocumentKind;
use crate::state::look::EditedLook;
use crate::state::outcome::Opened;
use crate::state::painted::channel::Kind;
use crate::state::playback::PaintedOver;
use crate::state::samples::Sample;
use crate::state::scenery::OnScene;
use isophote_files::error::Result;
use isophote_files::files::Existing;
use isophote_files::frames;
use isophote_finishing::stylize::palette;
use isophote_finishing::{naming, video};
use isophote_loader::Library;
use isophote_pictures::exr::Selection;
use isophote_pictures::material::MaterialKind;
use isophote_render::background::Background as Surround;
use isophote_scene::Scene;
use isophote_scene::environment::Environment;

/// Something to be opened.
pub enum OpenJob {
    /// The scene that comes with the program.
    Demo,
    /// A picture that comes with the program, whose file is in a folder.
    Sample(&'static Sample, PathBuf),
    /// The first of them that can be opened.
    Files(Library, Vec<PathBuf>),
    /// The file that is open, read in another way.
    Again(PathBuf, Box<Selection>, Vec<(MaterialKind, PathBuf)>),
    /// A look.
    Look(Library, PathBuf),
    /// Surroundings of a scene.
    Surroundings(PathBuf),
    /// A material for a scene: a file, or the name of one that ships.
    Material(MaterialKind, PathBuf),
    /// Colours for the look.
    Palette(Library, PathBuf),
    /// A painted map for pictures of a size in their file, and another as they are shown.
    Map(Kind, PathBuf, [(u32, u32); 2]),
    /// A painted map, to be saved.
    SaveMap(Kind, PathBuf, PaintedOver, Existing),
}

/// Something that was opened, with the document whose frames are to be read while it is shown.
pub type WithFrames = (Opened, Option<Document>);

fn is_look(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

/// Opens something.
///
/// # Errors
/// The reason why it cannot be opened.
pub fn open(job: OpenJob) -> Result<WithFrames> {
    let opened = match job {
        OpenJob::Demo => Opened::Scene(Box::new(demo::scene()?), None),
        OpenJob::Sample(sample, folder) => {
            return pictures(Document::open(&sample.file_in(&folder)?, &Options::default())?);
        }
        OpenJob::Files(library, files) => return files_or_folder(&library, files),
        OpenJob::Again(path, selection, materials) => {
            let options = Options { selection: *selection, materials, ..Options::default() };
            let document = Document::open(&path, &options)?;
            return Ok((Opened::Again(Box::new(document.playback()?)), Some(document)));
        }
        OpenJob::Look(library, path) => Opened::Look(Box::new(EditedLook::open(&library, &path)?)),
        OpenJob::Surroundings(path) => {
            let environment = Arc::new(Environment::read(&path)?);
            Opened::Surroundings(Surround::Environment(environment), path)
        }
        OpenJob::Material(kind, name) => {
            let material = Arc::new(kind.open(&name)?);
            Opened::Material(kind, Some(OnScene { name, material }))
        }
        OpenJob::Palette(library, path) => Opened::Palette(palette::read(&library, &path, None)?),
        OpenJob::Map(kind, path, sizes) => {
            let maps = maps::read(kind, &path, sizes)?;
            Opened::Map(kind, path, maps)
        }
        OpenJob::SaveMap(kind, path, over, existing) => {
            maps::write_all(kind, &over, &path, existing)?;
            Opened::SavedMap(kind, path, over.keys)
        }
    };
    Ok((opened, None))
}

fn pictures(document: Document) -> Result<WithFrames> {
    Ok((Opened::Pictures(Box::new(document.playback()?)), Some(document)))
}

/// Opens the first file that can be opened. Where there are several pictures, or a folder of them, the look can be used on all.
fn files_or_folder(library: &Library, files: Vec<PathBuf>) -> Result<WithFrames> {
    let folder = files.first().filter(|first| files.len() == 1 && first.is_dir());
    let (pictures, sequence) = match folder {
        Some(folder) => (naming::pictures_of(folder).unwrap_or_default(), frames::meant(folder)),
        None => {
            let pictures: Vec<PathBuf> = files.iter().filter(|file| is_picture(file)).cloned().collect();
            let pattern = pictures.first().and_then(|first| frames::sequence_of(first));
            let is_one = pictures.iter().all(|file| frames::sequence_of(file) == pattern);
            (pictures, pattern.filter(|_| is_one))
        }
    };
    // A folder that is no sequence is opened at its first picture.
    let first = match (folder, &sequence, pictures.first()) {
        (Some(_), None, Some(first)) => vec![first.clone()],
        _ => files,
    };
    let (opened, document) = first_of(library, first)?;
    let opened = match pictures.len() {
        ..=1 => opened,
        _ => Opened::OfSeveral(Box::new(opened), pictures, sequence),
    };
    Ok((opened, document))
}

fn is_picture(file: &Path) -> bool {
    frames::is_picture(file) && file.is_file() && !video::is_video(file)
}

/// Opens the first file that can be opened.
fn first_of(library: &Library, files: Vec<PathBuf>) -> Result<WithFrames> {
    let mut problems = Vec::new();
    let mut files = files.into_iter();
    while let Some(path) = files.next() {
        match file(library, path) {
            Ok(opened) if problems.is_empty() && files.len() == 0 => return Ok(opened),
            Ok((opened, document)) => {
                return Ok((Opened::Among(Box::new(opened), problems, files.len()), document));
            }
            Err(problem) => problems.push(problem),
        }
    }
    Err(problems.swap_remove(0))
}

/// Opens a scene, a picture, a sequence, a video or a look.
fn file(library: &Library, path: PathBuf) -> Result<WithFrames> {
    if is_look(&path) {
        return Ok((Opened::Look(Box::new(EditedLook::open(library, &path)?)), None));
    }
    let document = Document::open(&path, &Options::default())?;
    match document.kind() {
        DocumentKind::Scene => Ok((Opened::Scene(Box::new(Scene::load(&path, None)?), Some(path)), None)),
        _ => pictures(document),
    }
}
