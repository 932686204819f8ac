//! The work beside the window as a whole: what it is asked for, and what comes of it. Nothing of it holds the window up.

use std::path::PathBuf;
use std::sync::Arc;

use egui::ColorImage;

use super::carrying::{CarryJob, Carrying};
use super::dialogs::SystemDialogs;
use super::document::Document;
use super::exporting::Exporting;
use super::folder::FolderReader;
use super::idle::IdleSearch;
use super::look_work::LookWork;
use super::opening::{self, OpenJob, WithFrames};
use super::reader::Reader;
use super::reveal::Reveal;
use super::worker::{Wake, Worker};
use crate::state::outcome::{Dialog, Opened, Outcome};
use crate::state::playback::Playback;
use crate::state::preview::order::Task;
use crate::state::samples::{self, SAMPLES};
use crate::state::session::Session;
use crate::state::work::Request;
use isophote_files::error::Result;
use isophote_files::files::Existing;
use isophote_loader::Library;
use isophote_pictures::exr::{Layer, Selection};
use isophote_pictures::material::MaterialKind;

/// The work beside the window.
pub struct Background {
    library: Library,
    opener: Worker<OpenJob, Result<WithFrames>>,
    frames: Reader,
    folder: FolderReader,
    idle: IdleSearch,
    looks: LookWork,
    /// Makes the pictures of the start small.
    reducer: Worker<(), Vec<Arc<ColorImage>>>,
    /// True where these have been asked for.
    is_start_made: bool,
    dialogs: SystemDialogs,
    export: Exporting,
    carrying: Carrying,
    reveal: Reveal,
}

impl Background {
    /// Starts the threads.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(library: &Library, wake: &Wake) -> Result<Self> {
        Ok(Self {
            library: library.clone(),
            opener: Worker::new("open", Arc::clone(wake), opening::open)?,
            frames: Reader::default(),
            folder: FolderReader::new(wake)?,
            idle: IdleSearch::new(wake)?,
            looks: LookWork::new(library, wake)?,
            reducer: Worker::new("samples", Arc::clone(wake), |()| samples::small())?,
            is_start_made: false,
            dialogs: SystemDialogs::new(wake),
            export: Exporting::default(),
            carrying: Carrying::new(wake)?,
            reveal: Reveal::new(wake),
        })
    }

    /// Ends what is being exported; says whether it has ended, so that nothing of it is left.
    pub fn end_export(&mut self) -> bool {
        self.export.has_ended()
    }

    /// The work that is being done, in words.
    pub fn busy(&self) -> Option<&'static str> {
        let opening = self.opener.is_busy().then_some("Opening");
        let carrying = self.carrying.is_busy().then_some("Carrying");
        opening.or(self.export.is_running().then_some("Exporting")).or(carrying)
    }

    /// Reads frames of a document from when it is shown on.
    pub fn read_frames(&mut self, document: Document) {
        self.frames.extend(Some(document));
    }

    /// Frames of what is shown.
    pub fn frames(&mut self, session: &Session) -> Option<Outcome> {
        let (frames, wanted) = self.frames.follow(session.open.playback())?;
        Some(Outcome::Frames(frames, wanted))
    }

    /// Outcomes since the last call.
    pub fn collect(&mut self) -> Vec<Outcome> {
        let mut outcomes = Vec::new();
        while let Some((dialog, chosen)) = self.dialogs.answer() {
            match chosen {
                Ok(paths) if paths.is_empty() => {}
                Ok(paths) => {
                    self.open_chosen(dialog, &paths);
                    outcomes.push(Outcome::Chosen(dialog, paths));
                }
                Err(error) => outcomes.push(Outcome::Failed(error)),
            }
        }
        outcomes.extend(self.export.progress());
        outcomes.extend(self.carrying.answer());
        outcomes.extend(self.reveal.problem().map(Outcome::Failed));
        outcomes.extend(self.looks.collect());
        outcomes.extend(self.reducer.answer().map(Outcome::Samples));
        outcomes.extend(self.opener.answer().map(|opened| match opened {
            Ok((opened, document)) => {
                self.frames.extend(document);
                Outcome::Opened(opened)
            }
            Err(error) => Outcome::Failed(error),
        }));
        outcomes.extend(self.folder.answer());
        outcomes.extend(self.idle.answer());
        outcomes
    }

    /// Opens the files that were chosen in a dialog, where they are to be opened.
    fn open_chosen(&mut self, dialog: Dialog, paths: &[PathBuf]) {
        let Some(path) = paths.first().cloned() else { return };
        let library = self.library.clone();
        match dialog {
            Dialog::File => self.opener.ask(OpenJob::Files(library, paths.to_vec())),
            Dialog::Look => self.opener.ask(OpenJob::Look(library, path)),
            Dialog::Surroundings => self.opener.ask(OpenJob::Surroundings(path)),
            Dialog::Palette => self.opener.ask(OpenJob::Palette(library, path)),
            // The session asks for them.
            Dialog::Material(_) | Dialog::OpenMap(_) | Dialog::SaveMap(_) => {}
            Dialog::LookFolder | Dialog::Save | Dialog::Export | Dialog::Several | Dialog::SeveralTo => {}
        }
    }

    /// Follows the look that is shown, and asks for what is to be known of it and of the start.
    pub fn follow(&mut self, session: &Session) {
        self.looks.follow(session);
        self.carrying.follow(session.open.playback());
        self.folder.follow(session);
        self.idle.follow(session);
    }

    /// Does what the controls have asked for: requests, and `previews` to be made.
    pub fn carry_out(
        &mut self,
        session: &Session,
        requests: Vec<Request>,
        previews: Vec<Task>,
    ) -> Vec<Outcome> {
        let mut outcomes = Vec::new();
        let mut files = Vec::new();
        for request in requests {
            match request {
                Request::Open(path) => files.push(path),
                Request::ChooseLayer(layer, view) => self.open_layer(session, layer, view),
                Request::ChooseMaterial(kind, name) => outcomes.extend(self.open_on(session, kind, name)),
                Request::OpenMap(kind, path) => {
                    let sizes = session.open.playback().map(|shown| [shown.file_size(), shown.size()]);
                    let job = sizes.map(|sizes| OpenJob::Map(kind, path, sizes));
                    job.into_iter().for_each(|job| self.opener.ask(job));
                }
                Request::SaveMap(kind, path) => {
                    // The dialog has asked for one file; of several only those that were saved from here may be replaced.
                    let over = session.open.playback().and_then(Playback::painted);
                    let is_own = session.painting.saved.iter().any(|(_, known, _)| *known == path);
                    let existing = if is_own { Existing::Replace } else { Existing::Keep };
                    let job = over.map(|over| OpenJob::SaveMap(kind, path, over, existing));
                    job.into_iter().for_each(|job| self.opener.ask(job));
                }
                Request::CarryMaps => {
                    let playback = session.open.playback();
                    let job = playback.and_then(|playback| CarryJob::of(playback, &self.library));
                    job.into_iter().for_each(|job| self.carrying.ask(job));
                }
                Request::OpenDemo => self.opener.ask(OpenJob::Demo),
                Request::OpenSample(index) => {
                    if let Some(sample) = SAMPLES.get(index) {
                        self.opener.ask(OpenJob::Sample(sample, session.settings.place_for_samples()));
                    }
                }
                Request::Choose(dialog) => {
                    outcomes.extend(self.dialogs.show(dialog, session).err().map(Outcome::Failed));
                }
                Request::ListLooks => self.looks.list(session),
                Request::Export => outcomes.extend(self.export.begin(session)),
                Request::UseOnSeveral => outcomes.extend(self.export.begin_several(session)),
                Request::Reveal(file) => self.reveal.show(&file),
                Request::CancelExport => self.export.cancel(),
            }
        }
        if !files.is_empty() {
            self.opener.ask(OpenJob::Files(self.library.clone(), files));
        }
        if !session.open.has_picture() && !std::mem::replace(&mut self.is_start_made, true) {
            self.reducer.ask(());
        }
        outcomes.extend(self.looks.preview(previews).err().map(Outcome::Failed));
        outcomes
    }

    /// Opens the file that is open once more, to show a layer and a view of it.
    fn open_layer(&mut self, session: &Session, layer: Layer, view: Option<String>) {
        let Some(file) = session.open.file() else { return };
        let name = Some(layer.name).filter(|name| !name.is_empty());
        let force = layer.is_data && name.is_some();
        let selection = Selection { force, layer: name, view, ..Selection::default() };
        let materials = session.open.playback().map(|playback| playback.info().materials.clone());
        self.opener.ask(OpenJob::Again(file.to_owned(), Box::new(selection), materials.unwrap_or_default()));
    }

    /// Opens the file that is open once more, on another paper or with other hatching, or on the look's own; or such for a scene.
    fn open_on(&mut self, session: &Session, kind: MaterialKind, name: Option<PathBuf>) -> Option<Outcome> {
        let Some(playback) = session.open.playback() else {
            let Some(name) = name else { return Some(Outcome::Opened(Opened::Material(kind, None))) };
            self.opener.ask(OpenJob::Material(kind, name));
            return None;
        };
        let info = playback.info();
        let others = info.materials.iter().filter(|(known, _)| *known != kind).cloned();
        let materials = others.chain(name.map(|name| (kind, name))).collect();
        let selection = Box::new(info.selection.clone());
        self.opener.ask(OpenJob::Again(info.path.clone(), selection, materials));
        None
    }
}
