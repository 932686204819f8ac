//! State of the window: what it shows and what was done to it. All of it outlives a lost device.

mod beside;
mod browsing;
mod leaving;
mod looks;
mod outcomes;
mod painting;
mod steps;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::browser::Browser;
use super::dialogs::Dialogs;
use super::document::kind::Kind;
use super::file_steps::FileSteps;
use super::folder::Beside;
use super::histogram::Histograms;
use super::history::History;
use super::look::EditedLook;
use super::looks::Looks;
use super::notes::Notes;
use super::open::Open;
use super::painted::Painting;
use super::painted::key_frames::KeyFrames;
use super::plan::Plan;
use super::playback::Playback;
use super::preview::Previews;
use super::probed::Probed;
use super::record::Record;
use super::scenery::{Lighting, Scenery};
use super::settings::Settings;
use super::viewport::{Compare, Overlay, Viewport};
use super::work::Work;
use isophote_files::error::Result;
use isophote_finishing::apply::backend::Backend;
use isophote_finishing::stylize::precision::Precision;
use isophote_loader::{Library, printable};
use isophote_pictures::exr::Guide;

/// Name of the program for people.
const PRODUCT: &str = "Isophote";
/// Longest pause of the wheel within one step.
pub const TURNS: Duration = Duration::from_millis(600);

/// State that undo brings back.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    current: usize,
    looks: Vec<Arc<EditedLook>>,
    lighting: Option<Lighting>,
    /// What is painted over the pictures that are open.
    keys: Option<Arc<KeyFrames>>,
    /// Changes of files that were made.
    files: usize,
}

/// Origin of a picture, as the canvas has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The picture as it was.
    Original,
    /// The look.
    Look,
    /// Picture that the look is compared with.
    Compared,
    /// Picture that is shown instead of the look.
    Overlay,
}

/// All that the window knows.
pub struct Session {
    /// The dynamic library.
    pub library: Library,
    /// Precision in which looks are computed.
    pub precision: Precision,
    /// Backend that looks are computed on.
    pub backend: Backend,
    /// The scene or the pictures that are open.
    pub open: Open,
    /// Files of the folder of what is open.
    pub beside: Beside,
    /// Looks at hand, and the one that is shown.
    pub looks: Looks,
    /// Placement of pictures, and what is under the pointer.
    pub viewport: Viewport,
    /// The pixel under the pointer.
    pub probed: Option<Probed>,
    /// Time at which the wheel has changed a value last.
    pub wheeled: Option<Instant>,
    /// Histograms of what is shown.
    pub histograms: Option<Histograms>,
    /// The brush, and what it paints.
    pub painting: Painting,
    /// The browser of looks, and those that are compared.
    pub browser: Browser,
    /// Small pictures in the looks.
    pub previews: Previews,
    /// True where files can be dropped on the window.
    pub takes_drops: bool,
    /// Dialogs that are open.
    pub dialogs: Dialogs,
    /// Work beside the window.
    pub work: Work,
    /// Messages to be shown.
    pub notes: Notes,
    /// Frames and times.
    pub record: Record,
    /// Settings that are remembered from one time to the next.
    pub settings: Settings,
    edits: History<State>,
    files: FileSteps,
}

impl Session {
    /// A window of these looks, at least one, with nothing open.
    ///
    /// # Errors
    /// As [`EditedLook::parameters`].
    pub fn new(library: Library, looks: Vec<EditedLook>, settings: Settings) -> Result<Self> {
        Ok(Self {
            looks: Looks::new(&library, looks)?,
            library,
            precision: Precision::default(),
            backend: Backend::default(),
            open: Open::default(),
            beside: Beside::default(),
            histograms: None,
            viewport: Viewport::default(),
            probed: None,
            wheeled: None,
            painting: Painting::default(),
            browser: Browser::new(settings.favourites.clone()),
            previews: Previews::default(),
            takes_drops: true,
            dialogs: Dialogs::default(),
            work: Work::default(),
            notes: Notes::default(),
            record: Record::default(),
            settings,
            edits: History::default(),
            files: FileSteps::default(),
        })
    }

    /// The look that is shown and edited.
    pub fn look(&self) -> &EditedLook {
        self.looks.present()
    }

    /// True where there is such a thing to show of the picture.
    pub fn has_overlay(&self, overlay: Overlay) -> bool {
        let guide = match overlay {
            Overlay::None | Overlay::Orientation | Overlay::Lines => return true,
            Overlay::Normal => Guide::Normal,
            Overlay::Depth => Guide::Depth,
            Overlay::ObjectId => Guide::ObjectId,
            Overlay::Motion => Guide::Motion,
        };
        self.open.has_guide(guide)
    }

    /// Shows all there is.
    pub fn frame_all(&mut self) {
        self.viewport.fit();
        let [_, half] = self.viewport.halves();
        if let Some(scenery) = self.open.scenery_mut() {
            scenery.frame_all(half.width / half.height);
        }
    }

    /// Lets time pass, and frames a scene that was just opened.
    pub fn advance(&mut self) {
        if self.open.wants_framing() {
            self.frame_all();
        }
        self.open.advance();
    }

    /// Puts away what is open.
    pub fn close(&mut self) {
        self.begin(Open::default());
    }

    /// Size of the picture as it is placed: what is rendered smaller for the moment is shown as large.
    pub fn nominal_size(&self) -> (u32, u32) {
        let [_, half] = self.viewport.halves();
        self.open.playback().map_or((half.width as u32, half.height as u32), Playback::size)
    }

    /// The pictures on the left and on the right of the split.
    pub fn shown(&self) -> [Which; 2] {
        let look = if self.viewport.overlay == Overlay::None { Which::Look } else { Which::Overlay };
        let other = if self.looks.compared.is_some() { Which::Compared } else { Which::Original };
        match self.viewport.compare {
            _ if self.viewport.peek || self.is_covered() => [Which::Original; 2],
            Compare::Off => [look; 2],
            Compare::Wipe | Compare::Side | Compare::Difference => [other, look],
        }
    }

    /// A scene is open from now on.
    pub fn show_scene(&mut self, scenery: Scenery, file: Option<PathBuf>, name: String) {
        self.begin(Open::scene(scenery, file, name));
    }

    /// A picture, sequence or video is open from now on.
    pub fn show_playback(&mut self, playback: Playback) {
        self.begin(Open::pictures(playback));
    }

    /// Shows the same file, read in another way.
    pub fn show_again(&mut self, playback: Playback) {
        self.open.read_again(playback);
        if !self.has_overlay(self.viewport.overlay) {
            self.viewport.overlay = Overlay::None;
        }
    }

    /// True where what is shown can be exported.
    pub fn can_export(&self) -> bool {
        self.open.file().is_some() && (!self.look().is_plain() || self.open.playback().is_none())
    }

    /// Asks what is to be exported, if anything can be.
    pub fn plan_export(&mut self) {
        let playback = self.open.playback();
        let Some(file) = self.open.file().filter(|_| self.can_export()) else { return };
        let length = self.open.scenery().map_or(0.0, |scenery| scenery.time().1);
        let frames = playback.and_then(Playback::frames).cloned();
        let animated = (length * 24.0).ceil() as u32;
        let mut plan = Plan::new(self.open.kind(), file, frames, self.nominal_size(), animated);
        plan.rate = playback.map_or(plan.rate, |playback| playback.rate);
        (self.dialogs.plan, self.dialogs.batch) = (Some(plan), None);
    }

    fn begin(&mut self, open: Open) {
        self.keep_maps();
        self.open = open;
        self.restore_maps();
        self.notes.leave_behind();
        self.beside.open(self.open.file(), self.open.kind() == Kind::Picture);
        self.histograms = None;
        if let Some(file) = self.open.file() {
            self.settings.remember(file);
        }
        (self.dialogs.plan, self.dialogs.batch) = (None, None);
        self.previews.clear();
        self.viewport.fit();
        self.viewport.overlay = Overlay::None;
        self.record.begin();
        self.forget_open();
        self.tell_of_rules();
    }

    /// Title of the window: what is open, and the look once it is seen on it; frames are counted there where a report is wanted.
    pub fn title(&self) -> String {
        if !self.open.has_picture() {
            return PRODUCT.into();
        }
        // Programs that list windows print their titles.
        let mut parts = vec![printable(self.open.name()).to_string()];
        if let Some(frames) = self.record.present() {
            parts.push(printable(&self.look().name).to_string());
            if self.record.is_wanted {
                parts.push(format!("frame {frames}"));
            }
        }
        if self.precision != Precision::Exact {
            parts.push(format!("{} precision", self.precision.name()));
        }
        parts.push(PRODUCT.into());
        parts.join(" – ")
    }
}
