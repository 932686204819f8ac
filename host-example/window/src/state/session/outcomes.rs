//! Outcomes of work beside the window, as the session takes them over, and requests for more of it.

use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Session;
use crate::state::batch::Batch;
use crate::state::notes::Subject;
use crate::state::outcome::{Dialog, IdleControls, Opened, Outcome};
use crate::state::progress::{Progress, State};
use crate::state::running::{Running, failures};
use crate::state::scenery::{Scenery, Staging};
use crate::state::work::Request;
use isophote_files::error::{Error, Result};
use isophote_loader::abi::IsophoteRequest;
use isophote_scene::{Scene, camera, floor};

impl Session {
    /// Takes over what came of work beside the window.
    pub fn take_over(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Opened(opened) => self.open(opened),
            Outcome::Chosen(dialog, paths) => self.take_chosen(dialog, paths),
            Outcome::ExportBegun(begun) => self.begin_export(begun),
            Outcome::Export(progress) => self.follow_export(progress),
            Outcome::Beside(of, files) => {
                if self.open.file() == Some(&of)
                    && let Some(file) = self.beside.take(of, files)
                {
                    self.work.ask(Request::Open(file));
                }
            }
            Outcome::Listed(listing) => self.list(listing),
            Outcome::Preview(done) => self.previews.take(done),
            Outcome::Samples(small) => self.previews.samples.take(small),
            Outcome::Reread(source, read) => self.reload(&source, read),
            Outcome::Idle(IdleControls { look, request, idle }) => {
                if look == *self.look() && request == self.request() {
                    self.looks.set_idle(idle);
                }
            }
            Outcome::Frames(frames, wanted) => {
                let is_read = wanted.as_ref().is_some_and(Result::is_ok);
                let taken = self.open.playback_mut().map_or(Ok(()), |playback| playback.take(frames, wanted));
                match taken {
                    Err(error) => self.notes.complain_of(Subject::Frame, &error),
                    Ok(()) if is_read => self.notes.mended(Subject::Frame),
                    Ok(()) => {}
                }
            }
            Outcome::Carried(keys, carried) => self.take_carried(&keys, carried),
            Outcome::Failed(error) => self.notes.complain(&error),
        }
    }

    /// Requests since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        let mut requests = self.work.take_requests();
        if self.browser.is_open && mem::take(&mut self.browser.is_outdated) {
            requests.push(Request::ListLooks);
        }
        requests
    }

    /// Request of looks on the picture that is open.
    pub fn request(&self) -> Option<IsophoteRequest> {
        let (frame, _) = self.open.playback()?.frame(false)?;
        self.library.request((1, 1)).ok().map(|usual| frame.request_of_all(1.0, usual))
    }

    fn open(&mut self, opened: Opened) {
        match opened {
            Opened::Among(opened, problems, left) => {
                problems.iter().for_each(|problem| self.notes.complain(problem));
                self.open(*opened);
                if left > 0 {
                    let files = if left == 1 { "One file more was" } else { "More files were" };
                    let name = self.open.name();
                    self.notes.say(format!("{files} dropped; the first that opens is shown, {name}"));
                }
            }
            Opened::OfSeveral(opened, pictures, sequence) => {
                self.open(*opened);
                self.dialogs.plan = None;
                self.dialogs.batch = Some(Batch::new(pictures, sequence));
            }
            Opened::Again(playback) => {
                if self.open.file() == Some(playback.path()) {
                    self.show_again(*playback);
                }
            }
            Opened::Scene(scene, file) => self.open_scene(*scene, file),
            Opened::Pictures(playback) => self.show_playback(*playback),
            Opened::Look(look) => self.take(Arc::from(look)),
            Opened::Palette(palette) => self.colour_by(&palette),
            Opened::Map(kind, path, maps) => self.take_map(kind, path, &maps),
            Opened::SavedMap(kind, path, keys) => {
                self.notes.say(format!("Saved the {} in {}", kind.name(), path.display()));
                self.map_saved(kind, path, keys);
            }
            Opened::Material(kind, material) => {
                if let Some(scenery) = self.open.scenery_mut() {
                    scenery.lie_on(kind, material);
                }
            }
            Opened::Surroundings(background, path) => {
                self.relight("surroundings", |lighting| {
                    (lighting.background, lighting.surroundings) = (background, Some(path));
                });
                self.let_go();
            }
        }
    }

    fn open_scene(&mut self, scene: Scene, file: Option<PathBuf>) {
        let area = self.viewport.area;
        let name = file.as_ref().and_then(|file| file.file_name());
        let name = name.map_or_else(|| "Demo".into(), |name| name.to_string_lossy().into_owned());
        if let Some(warning) = scene.warnings.first() {
            self.notes.say(format!("{name}: {warning}"));
        }
        let staging = Staging {
            camera: camera::file_camera(&scene),
            ground: floor::lacks_floor(&scene),
            ..Staging::default()
        };
        let aspect = area.width.max(1.0) / area.height.max(1.0);
        self.show_scene(Scenery::new(scene, staging, aspect), file, name);
    }

    /// Takes over the files or the folder that were chosen in a dialog. What is to be opened comes later.
    fn take_chosen(&mut self, dialog: Dialog, paths: Vec<PathBuf>) {
        let Some(path) = paths.first().cloned() else { return };
        let path = path.as_path();
        match dialog {
            Dialog::File | Dialog::Surroundings | Dialog::Palette => {}
            Dialog::Material(kind) => {
                self.work.ask(Request::ChooseMaterial(kind, Some(path.to_owned())));
            }
            Dialog::OpenMap(kind) => self.work.ask(Request::OpenMap(kind, path.to_owned())),
            Dialog::SaveMap(kind) => self.work.ask(Request::SaveMap(kind, path.to_owned())),
            Dialog::Look => self.settings.look_folder = path.parent().map(Path::to_owned),
            Dialog::LookFolder => {
                self.settings.add_look_folder(path);
                self.browser.is_outdated = true;
            }
            Dialog::Save => {
                if let Some(saving) = &mut self.dialogs.saving {
                    saving.place(Some(path));
                }
            }
            Dialog::Export => self.dialogs.plan.iter_mut().for_each(|plan| plan.place(path)),
            Dialog::Several => {
                self.dialogs.plan = None;
                self.dialogs.batch = Some(Batch::new(paths, None));
            }
            Dialog::SeveralTo => {
                if let Some(batch) = &mut self.dialogs.batch {
                    (batch.folder, batch.asks) = (path.display().to_string(), None);
                }
            }
        }
    }

    /// The export that was asked for has begun, or cannot.
    fn begin_export(&mut self, begun: Result<()>) {
        let (plan, batch) = (self.dialogs.plan.take(), self.dialogs.batch.take());
        let running = match batch {
            Some(batch) => Running::new(PathBuf::from(batch.folder.trim()), "pictures"),
            None => Running::new(plan.map(|plan| PathBuf::from(plan.path)).unwrap_or_default(), "frames"),
        };
        match begun {
            Ok(()) => {
                (self.work.exported, self.work.running) = (Some(0.0), Some(running));
                self.notes.mended(Subject::Export);
            }
            Err(error) => self.notes.complain_of(Subject::Export, &error),
        }
    }

    /// The export has come so far, which is said when it has ended.
    fn follow_export(&mut self, Progress { done, total, state }: Progress) {
        let mut running = self.work.running.take().unwrap_or_else(|| Running::new(PathBuf::new(), "frames"));
        (running.done, running.total) = (done, total);
        self.work.exported = Some(running.share());
        let is_done = state == State::Done;
        match state {
            State::Running => {
                self.work.running = Some(running);
                return;
            }
            State::Done => self.notes.tell_of(running.place.clone(), running.sentence(), false),
            State::Partly(failed) => {
                self.notes.tell_of(running.place.clone(), failures(&failed, total as u64), true);
            }
            State::Cancelled => self.notes.say("The export was cancelled"),
            State::Failed(problem) => {
                self.notes.complain_of(Subject::Export, &Error::failure(problem, "export again"));
            }
        }
        self.end_export(is_done);
    }
}
