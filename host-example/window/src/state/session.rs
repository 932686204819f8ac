//! State of the window: what it shows and what was done to it. All of it outlives a lost device.

mod browsing;
mod leaving;
mod looks;
mod outcomes;
mod steps;

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

use super::browser::Browser;
use super::chain::{self, Chain, Watched};
use super::comparison::Comparison;
use super::document::kind::Kind;
use super::file_steps::FileSteps;
use super::history::History;
use super::leaving::Leaving;
use super::look::{EditedLook, Parameter};
use super::notes::Notes;
use super::outcome::Dialog;
use super::plan::Plan;
use super::playback::Playback;
use super::preview::Previews;
use super::record::Record;
use super::samples::Thumbnails;
use super::saving::Saving;
use super::scenery::{Lighting, Scenery};
use super::settings::Settings;
use super::viewport::{Compare, Overlay, Viewport};
use isophote_files::error::Result;
use isophote_finishing::stylize::precision::Precision;
use isophote_finishing::stylize::preset::Preset;
use isophote_loader::Library;
use isophote_loader::catalogue::Node;
use isophote_loader::printable;
use isophote_pictures::exr::{Guide, Layer};

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
    /// Read which looks there are.
    ListLooks,
    /// Make what is planned.
    Export,
    /// End the export.
    CancelExport,
}

/// State that undo brings back.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    current: usize,
    looks: Vec<Arc<EditedLook>>,
    lighting: Option<Lighting>,
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
    /// Looks in the order of the keys 1, 2, ...
    pub looks: Vec<Arc<EditedLook>>,
    /// Parameters of the present look.
    pub parameters: Vec<Parameter>,
    /// The list of nodes that the present look is, if it is one.
    pub chain: Option<Chain>,
    /// The part of it that is looked at, if not the whole.
    pub watched: Option<Watched>,
    /// The node whose parameters are shown, if not those of all.
    pub selected: Option<String>,
    /// Nodes that can be put into a list.
    pub fitting: Vec<Node>,
    /// Names of those that have no effect at the moment.
    pub idle: HashSet<String>,
    /// Look that the present one is compared with, if that is not the original.
    pub compared: Option<EditedLook>,
    /// The scene that is open.
    pub scenery: Option<Scenery>,
    /// The picture, sequence or video that is open, where no scene is.
    pub playback: Option<Playback>,
    /// The file that is open.
    pub file: Option<PathBuf>,
    /// Name of what is open, for the title.
    pub name: String,
    /// Placement of pictures.
    pub viewport: Viewport,
    /// The browser of looks.
    pub browser: Browser,
    /// The looks that are seen beside each other, if any.
    pub comparison: Option<Comparison>,
    /// A look that is about to be saved.
    pub saving: Option<Saving>,
    /// Pictures that come with the program, small.
    pub thumbnails: Thumbnails,
    /// Small pictures in the looks.
    pub previews: Previews,
    /// Messages to be shown.
    pub notes: Notes,
    /// Frames and times.
    pub record: Record,
    /// Settings that are remembered from one time to the next.
    pub settings: Settings,
    /// Requests of the controls to the window.
    pub requests: Vec<Request>,
    /// True where the help is open.
    pub shows_help: bool,
    /// Work that is being done beside the window, in words.
    pub busy: Option<&'static str>,
    /// Plan of the export, while that is asked.
    pub plan: Option<Plan>,
    /// State of closing the window.
    pub leaving: Leaving,
    /// The share of an export that is done, while there is one.
    pub exported: Option<f32>,
    /// Position of the pointer on the picture, in pixels of the window.
    pub pointer: Option<[f32; 2]>,
    /// Colours under the pointer, before and after.
    pub probed: Option<[[f32; 4]; 2]>,
    /// True where the scene was opened before its place in the window was known.
    is_unframed: bool,
    current: usize,
    /// Looks as their files have them, or as the command line has made them: that much is not lost with the window.
    /// Others are as they were opened.
    kept: HashMap<PathBuf, Preset>,
    edits: History<State>,
    files: FileSteps,
}

impl Session {
    /// A window of these looks, at least one, with nothing open.
    ///
    /// # Errors
    /// As [`EditedLook::parameters`].
    pub fn new(library: Library, looks: Vec<EditedLook>, settings: Settings) -> Result<Self> {
        let parameters = looks.first().map_or_else(|| Ok(Vec::new()), |look| look.parameters(&library))?;
        let chain = looks.first().map_or(Ok(None), |look| look.chain(&library))?;
        Ok(Self {
            fitting: chain::fitting(&library),
            library,
            precision: Precision::default(),
            looks: looks.into_iter().map(Arc::new).collect(),
            parameters,
            chain,
            watched: None,
            selected: None,
            idle: HashSet::new(),
            compared: None,
            scenery: None,
            playback: None,
            file: None,
            name: String::new(),
            viewport: Viewport::default(),
            browser: Browser::default(),
            comparison: None,
            saving: None,
            thumbnails: Thumbnails::default(),
            previews: Previews::default(),
            notes: Notes::default(),
            record: Record::default(),
            settings,
            requests: Vec::new(),
            shows_help: false,
            busy: None,
            plan: None,
            leaving: Leaving::default(),
            exported: None,
            pointer: None,
            probed: None,
            is_unframed: false,
            current: 0,
            kept: HashMap::new(),
            edits: History::default(),
            files: FileSteps::default(),
        })
    }

    /// The look that is shown and edited.
    pub fn look(&self) -> &EditedLook {
        &self.looks[self.current]
    }

    /// The look as far as it is looked at.
    pub fn seen(&self) -> Cow<'_, EditedLook> {
        let (Some(chain), Some(watched)) = (&self.chain, &self.watched) else {
            return Cow::Borrowed(self.look());
        };
        let part = self.look().watched(&self.library, chain, watched);
        part.map_or_else(|_| Cow::Borrowed(self.look()), Cow::Owned)
    }

    /// Its place among the looks.
    pub fn current(&self) -> usize {
        self.current
    }

    /// True where there is anything to look at.
    pub fn has_picture(&self) -> bool {
        self.scenery.is_some() || self.playback.is_some()
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
        let frame = self.playback.as_ref().and_then(|playback| playback.frame(false));
        self.scenery.is_some() || frame.is_some_and(|(frame, _)| frame.guide(guide).is_some())
    }

    /// True while time passes.
    pub fn is_playing(&self) -> bool {
        self.scenery.as_ref().is_some_and(|scenery| scenery.playing)
            || self.playback.as_ref().is_some_and(|playback| playback.playing)
    }

    /// Starts or stops time.
    pub fn toggle_playing(&mut self) {
        if let Some(scenery) = &mut self.scenery {
            scenery.toggle_playing();
        } else if let Some(playback) = &mut self.playback {
            playback.toggle_playing();
        }
    }

    /// Shows all there is.
    pub fn frame_all(&mut self) {
        self.viewport.fit();
        let [_, half] = self.viewport.halves();
        if let Some(scenery) = &mut self.scenery {
            scenery.frame_all(half.width / half.height);
        }
    }

    /// Frames a scene that was just opened, by the place that it has in the window.
    fn frame_first(&mut self) {
        if std::mem::take(&mut self.is_unframed) {
            self.frame_all();
        }
    }

    /// Lets time pass, and frames a scene that was just opened.
    pub fn advance(&mut self) {
        self.frame_first();
        if let Some(scenery) = &mut self.scenery {
            scenery.advance();
        }
        if let Some(playback) = &mut self.playback {
            playback.advance();
        }
    }

    /// Puts away what is open.
    pub fn close(&mut self) {
        (self.scenery, self.playback) = (None, None);
        self.begin(None, String::new());
    }

    /// Size of the picture as it is placed: what is rendered smaller for the moment is shown as large.
    pub fn nominal_size(&self) -> (u32, u32) {
        let [_, half] = self.viewport.halves();
        self.playback.as_ref().map_or((half.width as u32, half.height as u32), Playback::size)
    }

    /// The pictures on the left and on the right of the split.
    pub fn shown(&self) -> [Which; 2] {
        let look = if self.viewport.overlay == Overlay::None { Which::Look } else { Which::Overlay };
        let other = if self.compared.is_some() { Which::Compared } else { Which::Original };
        match self.viewport.compare {
            _ if self.viewport.peek || self.is_covered() => [Which::Original; 2],
            Compare::Off => [look; 2],
            Compare::Wipe | Compare::Side => [other, look],
        }
    }

    /// A scene is open from now on.
    pub fn show_scene(&mut self, scenery: Scenery, file: Option<PathBuf>, name: String) {
        self.is_unframed = scenery.camera().is_none();
        (self.scenery, self.playback) = (Some(scenery), None);
        self.begin(file, name);
    }

    /// A picture, sequence or video is open from now on.
    pub fn show_playback(&mut self, playback: Playback) {
        let file = playback.path().to_owned();
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        (self.scenery, self.playback) = (None, Some(playback));
        self.begin(Some(file), name);
    }

    /// Shows the same file, read in another way.
    pub fn show_again(&mut self, mut playback: Playback) {
        if let Some(old) = &self.playback {
            playback.rate = old.rate;
            playback.seek(old.number());
        }
        self.playback = Some(playback);
        if !self.has_overlay(self.viewport.overlay) {
            self.viewport.overlay = Overlay::None;
        }
    }

    /// Asks what is to be exported, if anything can be.
    pub fn plan_export(&mut self) {
        let Some(file) = self.file.as_deref().filter(|_| !self.look().is_plain() || self.playback.is_none())
        else {
            return;
        };
        let kind = self.playback.as_ref().map_or(Kind::Scene, |playback| playback.info().kind);
        let length = self.scenery.as_ref().map_or(0.0, |scenery| scenery.time().1);
        let frames = self.playback.as_ref().and_then(Playback::frames).cloned();
        let animated = (length * 24.0).ceil() as u32;
        self.plan = Some(Plan::new(kind, file, frames, self.nominal_size(), animated));
    }

    fn begin(&mut self, file: Option<PathBuf>, name: String) {
        if let Some(file) = &file {
            self.settings.remember(file);
        }
        (self.file, self.name) = (file, name);
        self.plan = None;
        self.previews.clear();
        self.viewport.fit();
        self.viewport.overlay = Overlay::None;
        self.record.begin();
        self.forget_lighting();
    }

    /// Title of the window: what is open, the look, frames shown since the last switch, time of the last one.
    pub fn title(&self) -> String {
        // Programs that list windows print their titles.
        let style = self.look().source.file_stem().unwrap_or_default().to_string_lossy();
        let style = printable(&style);
        if !self.has_picture() {
            return "Isophote".into();
        }
        let precision = match self.precision {
            Precision::Exact => String::new(),
            precision => format!(" - {} precision", precision.name()),
        };
        let name = printable(&self.name);
        match self.record.present() {
            Some((frames, time)) => {
                let time = time.as_secs_f64() * 1e3;
                format!("{name} - {style} - frame {frames} - {time:.1} ms{precision}")
            }
            None => format!("{name} - {style}{precision}"),
        }
    }
}
