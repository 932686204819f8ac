//! Outcomes of work beside the window, as the session takes them over, and requests for more of it.

use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Session;
use crate::state::notes::Subject;
use crate::state::outcome::{Dialog, IdleControls, Opened, Outcome};
use crate::state::progress::{Progress, State};
use crate::state::scenery::{Scenery, Staging};
use crate::state::work::Request;
use isophote_files::error::Error;
use isophote_loader::abi::IsophoteRequest;
use isophote_scene::{Scene, camera, floor};

impl Session {
    /// Takes over what came of work beside the window.
    pub fn take_over(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Opened(opened) => self.open(opened),
            Outcome::Chosen(dialog, path) => self.take_chosen(dialog, &path),
            Outcome::ExportBegun(begun) => {
                self.dialogs.plan = None;
                match begun {
                    Ok(()) => {
                        self.work.exported = Some(0.0);
                        self.notes.mended(Subject::Export);
                    }
                    Err(error) => self.notes.complain_of(Subject::Export, &error),
                }
            }
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
            Opened::Again(playback) => {
                if self.open.file() == Some(playback.path()) {
                    self.show_again(*playback);
                }
            }
            Opened::Scene(scene, file) => self.open_scene(*scene, file),
            Opened::Pictures(playback) => self.show_playback(*playback),
            Opened::Look(look) => self.take(Arc::from(look)),
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

    /// Takes over the file or folder that was chosen in a dialog. What is to be opened comes later.
    fn take_chosen(&mut self, dialog: Dialog, path: &Path) {
        match dialog {
            Dialog::File | Dialog::Surroundings => {}
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
            Dialog::Export => {
                if let Some(plan) = &mut self.dialogs.plan {
                    plan.path = path.display().to_string();
                }
            }
        }
    }

    /// The export has come so far, which is said when it has ended.
    fn follow_export(&mut self, Progress { done, total, state }: Progress) {
        self.work.exported = Some((done / total.max(1.0)) as f32);
        let is_done = state == State::Done;
        match state {
            State::Running => return,
            State::Done => self.notes.say("Exported"),
            State::Cancelled => self.notes.say("The export was cancelled"),
            State::Failed(problem) => {
                self.notes.complain_of(Subject::Export, &Error::failure(problem, "export again"));
            }
        }
        self.end_export(is_done);
    }
}
