//! Outcomes of work beside the window: what was opened, chosen, read, found or made, for the session to take over.

use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use egui::ColorImage;

use super::browser::listing::Listing;
use super::document::Frames;
use super::document::frame::Frame;
use super::look::EditedLook;
use super::painted::channel::Kind;
use super::painted::key_frames::{CarriedMaps, KeyFrames};
use super::painted::maps::Maps;
use super::playback::Playback;
use super::preview::order::Done;
use super::progress::Progress;
use super::scenery::OnScene;
use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::palette::Colours;
use isophote_loader::abi::IsophoteRequest;
use isophote_pictures::material::MaterialKind;
use isophote_render::background::Background;
use isophote_scene::Scene;

/// Outcome of one piece of work.
pub enum Outcome {
    /// Something was opened.
    Opened(Opened),
    /// These files were chosen in a dialog of the system, at least one.
    Chosen(Dialog, Vec<PathBuf>),
    /// The export that was planned has begun, or cannot.
    ExportBegun(Result<()>),
    /// An export has come so far.
    Export(Progress),
    /// Files beside one that can be opened.
    Beside(PathBuf, Vec<PathBuf>),
    /// These looks were found.
    Listed(Listing),
    /// A preview was made, or could not be.
    Preview(Done),
    /// Pictures that come with the program were made small.
    Samples(Vec<Arc<ColorImage>>),
    /// The files of a look were read again.
    Reread(PathBuf, Result<EditedLook>),
    /// Controls without effect were found.
    Idle(IdleControls),
    /// Frames that the document has, and the one that is wanted where it has been read.
    Frames(Frames, Option<Result<Arc<Frame>>>),
    /// Maps of these key frames were carried along the motion to all frames.
    Carried(Arc<KeyFrames>, Arc<CarriedMaps>),
    /// Something could not be begun, or has failed.
    Failed(Error),
}

/// Something that was opened.
pub enum Opened {
    /// A scene with its file; the one that comes with the program has none.
    Scene(Box<Scene>, Option<PathBuf>),
    /// Paper or hatching for the scene that is open; its own where there is none.
    Material(MaterialKind, Option<OnScene>),
    /// A picture, sequence or video.
    Pictures(Box<Playback>),
    /// The document that was open, read in another way.
    Again(Box<Playback>),
    /// The first of several pictures, which the look can be used on; all of them may be one sequence.
    OfSeveral(Box<Opened>, Vec<PathBuf>, Option<PathBuf>),
    /// One of several, with what is wrong with others and how many were left.
    Among(Box<Opened>, Vec<Error>, usize),
    /// A look.
    Look(Box<EditedLook>),
    /// Surroundings of a scene with their file.
    Surroundings(Background, PathBuf),
    /// Colours for the look.
    Palette(Colours),
    /// A painted map of a file.
    Map(Kind, PathBuf, Arc<Maps>),
    /// A painted map was saved in a file, or in one for each frame.
    SavedMap(Kind, PathBuf, Arc<KeyFrames>),
}

/// Purpose of a dialog of the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialog {
    /// Open a file.
    File,
    /// Open a look.
    Look,
    /// Add a folder of looks.
    LookFolder,
    /// Save the look.
    Save,
    /// Open surroundings of the scene.
    Surroundings,
    /// Take the colours of a file.
    Palette,
    /// Take paper or hatching of a file.
    Material(MaterialKind),
    /// Open a painted map.
    OpenMap(Kind),
    /// Save one.
    SaveMap(Kind),
    /// Name the output of an export.
    Export,
    /// Choose pictures to use the look on.
    Several,
    /// Name the folder of their results.
    SeveralTo,
}

/// Controls of a look that have no effect.
pub struct IdleControls {
    /// The look.
    pub look: EditedLook,
    /// Request that it was found for.
    pub request: Option<IsophoteRequest>,
    /// Names of the parameters without effect.
    pub idle: HashSet<String>,
}
