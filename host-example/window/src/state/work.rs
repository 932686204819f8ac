//! Work beside the window as far as it is seen: what is asked for, and what is being done.

use std::path::PathBuf;

use super::outcome::Dialog;
use super::painted::channel::Kind;
use super::running::Running;
use isophote_pictures::exr::Layer;
use isophote_pictures::material::MaterialKind;

/// Request of the controls for work beside the window.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Open this file.
    Open(PathBuf),
    /// Open the scene that comes with the program.
    OpenDemo,
    /// Open a picture that comes with the program.
    OpenSample(usize),
    /// Show a dialog and take what is chosen.
    Choose(Dialog),
    /// Show this layer of the file, and a view of it.
    ChooseLayer(Layer, Option<String>),
    /// Lay the picture on this paper, or draw it with this hatching, by its name or file; on the look's own without.
    ChooseMaterial(MaterialKind, Option<PathBuf>),
    /// Read a painted map from this file.
    OpenMap(Kind, PathBuf),
    /// Write a painted map to this file, or those of all frames to files with their numbers.
    SaveMap(Kind, PathBuf),
    /// Carry what is painted along the motion of the sequence that is open.
    CarryMaps,
    /// Read which looks there are.
    ListLooks,
    /// Make what is planned.
    Export,
    /// Use the look on the pictures that are chosen.
    UseOnSeveral,
    /// Show where this file lies.
    Reveal(PathBuf),
    /// End the export.
    CancelExport,
}

/// Work that is asked for and done.
#[derive(Debug, Default)]
pub struct Work {
    /// Work that is being done, in words.
    pub busy: Option<&'static str>,
    /// The share of a look that is computed, while one is on the CPU.
    pub share: Option<f32>,
    /// The share of an export that is done, while there is one.
    pub exported: Option<f32>,
    /// The export, while there is one.
    pub running: Option<Running>,
    requests: Vec<Request>,
}

impl Work {
    /// Asks for something.
    pub fn ask(&mut self, request: Request) {
        self.requests.push(request);
    }

    /// Requests that nobody has taken yet.
    pub fn requests(&self) -> &[Request] {
        &self.requests
    }

    /// Requests since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }
}
