//! Work of the window beside drawing: opening files, asking for names, saving. Nothing of it holds the window up.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use egui::ColorImage;

use super::dialogs;
use super::document::{Document, Options};
use super::export::{self, Export, Progress, State};
use super::idle::{self, IdleControls, IdleRequest};
use super::look_work::LookWork;
use super::reader::Reader;
use super::watch::Watch;
use super::worker::{Wake, Worker};
use crate::state::document::kind::Kind;
use crate::state::look::EditedLook;
use crate::state::plan::What;
use crate::state::playback::Playback;
use crate::state::samples::{self, SAMPLES, Sample};
use crate::state::saving::Saving;
use crate::state::scenery::{Scenery, Staging};
use crate::state::session::{Request, Session};
use crate::state::{command, demo};
use isophote_files::error::{Error, Result};
use isophote_finishing::stylize::preset;
use isophote_loader::Library;
use isophote_loader::abi::IsophoteRequest;
use isophote_pictures::exr::Selection;
use isophote_render::background::Background as Surround;
use isophote_scene::environment::Environment;
use isophote_scene::{Scene, camera, floor};

/// Something to be opened.
enum OpenJob {
    Demo,
    /// A picture that comes with the program, whose file is in a folder.
    Sample(&'static Sample, PathBuf),
    /// The first of them that can be opened.
    Files(Library, Vec<PathBuf>),
    /// The file that is open, read in another way.
    Again(PathBuf, Box<Selection>),
    Look(Library, PathBuf),
    Surroundings(PathBuf),
}

/// Something that was opened.
enum Opened {
    Scene(Box<Scene>, Option<PathBuf>),
    Pictures(Box<Playback>),
    Again(Box<Playback>),
    /// One of several, with what is wrong with others and how many were left.
    Among(Box<Opened>, Vec<Error>, usize),
    Look(Box<EditedLook>),
    Surroundings(Surround, PathBuf),
}

/// Purpose of a dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dialog {
    File,
    Look,
    LookFolder,
    Save,
    Surroundings,
    Export,
}

impl Dialog {
    /// Advice where the system has no dialogs.
    const fn otherwise(self) -> &'static str {
        match self {
            Self::File | Self::Look => "drop the file on the window, or install zenity or xdg-desktop-portal",
            Self::Export => "type where it is to go, or install zenity or xdg-desktop-portal",
            Self::LookFolder | Self::Save | Self::Surroundings => "install zenity or xdg-desktop-portal",
        }
    }
}

/// The work beside the window.
pub struct Background {
    opener: Worker<OpenJob, Result<(Opened, Option<Document>)>>,
    idle_search: Worker<IdleRequest, IdleControls>,
    /// Reads looks again whose files have changed.
    reader: Worker<(Library, PathBuf), (PathBuf, Result<EditedLook>)>,
    watch: Watch,
    looks: LookWork,
    /// Makes the pictures of the start small.
    reducer: Worker<(), Vec<Arc<ColorImage>>>,
    /// The last request to the search for idle controls.
    asked: Option<(EditedLook, Option<IsophoteRequest>)>,
    chosen: Receiver<(Dialog, Result<Option<PathBuf>>)>,
    choose: Sender<(Dialog, Result<Option<PathBuf>>)>,
    export: Option<Export>,
    /// True while a dialog is open.
    choosing: bool,
    frames: Reader,
    wake: Wake,
}

impl Background {
    /// Starts the threads.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        let (choose, chosen) = channel();
        Ok(Self {
            opener: Worker::new("open", Arc::clone(wake), open)?,
            idle_search: Worker::new("controls", Arc::clone(wake), idle::idle_controls)?,
            reader: Worker::new("look again", Arc::clone(wake), |(library, path): (Library, PathBuf)| {
                let read = EditedLook::open(&library, &path);
                (path, read)
            })?,
            watch: Watch::new(wake)?,
            looks: LookWork::new(wake)?,
            reducer: Worker::new("samples", Arc::clone(wake), |()| samples::small())?,
            asked: None,
            chosen,
            choose,
            export: None,
            choosing: false,
            frames: Reader::default(),
            wake: Arc::clone(wake),
        })
    }

    /// Ends what is being exported; says whether it has ended, so that nothing of it is left.
    pub fn end_export(&mut self) -> bool {
        let Some(export) = &mut self.export else { return true };
        export.cancel();
        export.poll().state != State::Running
    }

    /// The work that is being done, in words.
    pub fn busy(&self) -> Option<&'static str> {
        self.opener.is_busy().then_some("Opening").or(self.export.as_ref().map(|_| "Exporting"))
    }

    /// Reads frames of a document from when it is shown on.
    pub fn read_frames(&mut self, document: Document) {
        self.frames.add(document);
    }

    /// Takes over the frame that is wanted.
    pub fn follow_frames(&mut self, session: &mut Session) {
        let Some((frames, frame)) = self.frames.follow(session.playback.as_ref()) else { return };
        let Some(playback) = &mut session.playback else { return };
        if let Err(error) = playback.take(frames, frame) {
            session.notes.complain(&error);
        }
    }

    /// Takes over the file or folder that was chosen in a dialog.
    fn take_chosen(&mut self, session: &mut Session, dialog: Dialog, path: PathBuf) {
        match dialog {
            Dialog::File => self.opener.ask(OpenJob::Files(session.library.clone(), vec![path])),
            Dialog::Look => {
                session.settings.look_folder = path.parent().map(Path::to_owned);
                self.opener.ask(OpenJob::Look(session.library.clone(), path));
            }
            Dialog::Surroundings => self.opener.ask(OpenJob::Surroundings(path)),
            Dialog::LookFolder => {
                session.settings.add_look_folder(&path);
                session.browser.is_outdated = true;
            }
            Dialog::Save => {
                if let Some(saving) = &mut session.saving {
                    saving.place(Some(&path));
                }
            }
            Dialog::Export => {
                if let Some(plan) = &mut session.plan {
                    plan.path = path.display().to_string();
                }
            }
        }
    }

    /// Takes over what was done since the last call.
    pub fn collect(&mut self, session: &mut Session) {
        while let Ok((dialog, path)) = self.chosen.try_recv() {
            self.choosing = false;
            let path = match path {
                Ok(Some(path)) => path,
                Ok(None) => continue,
                Err(error) => {
                    session.notes.complain(&error);
                    continue;
                }
            };
            self.take_chosen(session, dialog, path);
        }
        self.follow_export(session);
        self.looks.collect(session);
        if let Some(small) = self.reducer.answer() {
            session.thumbnails.take(small);
        }
        if let Some(opened) = self.opener.answer() {
            match opened {
                Ok((opened, document)) => {
                    document.into_iter().for_each(|document| self.read_frames(document));
                    take(session, opened);
                }
                Err(error) => session.notes.complain(&error),
            }
        }
        self.watch.follow(session.look().files());
        if self.watch.has_changed() {
            self.reader.ask((session.library.clone(), session.look().source.clone()));
        }
        if let Some((source, read)) = self.reader.answer() {
            session.reload(&source, read);
        }
        if let Some(found) = self.idle_search.answer()
            && found.look == *session.look()
            && found.asked == asked(session)
        {
            session.idle = found.idle;
        }
        let asked = asked(session);
        let is_known = self.asked.as_ref().is_some_and(|(look, of)| look == session.look() && *of == asked);
        if !is_known && session.has_picture() {
            self.asked = Some((session.look().clone(), asked));
            let (library, look) = (session.library.clone(), session.look().clone());
            self.idle_search.ask(IdleRequest { library, look, asked });
        }
    }

    /// Does what the controls have asked for, and returns what is to be put on the clipboard.
    pub fn carry_out(&mut self, session: &mut Session) -> Option<String> {
        let mut copied = None;
        let mut files = Vec::new();
        for request in std::mem::take(&mut session.requests) {
            match request {
                Request::Open(path) => files.push(path),
                Request::ChooseLayer(layer, view) => {
                    if let Some(file) = &session.file {
                        let name = Some(layer.name).filter(|name| !name.is_empty());
                        let selection = Selection {
                            force: layer.is_data && name.is_some(),
                            layer: name,
                            view,
                            ..Selection::default()
                        };
                        self.opener.ask(OpenJob::Again(file.clone(), Box::new(selection)));
                    }
                }
                Request::ChooseOutput => self.choose(Dialog::Export, session),
                Request::OpenDemo => self.opener.ask(OpenJob::Demo),
                Request::OpenSample(index) => {
                    if let Some(sample) = SAMPLES.get(index) {
                        self.opener.ask(OpenJob::Sample(sample, session.settings.place_for_samples()));
                    }
                }
                Request::ChooseFile => self.choose(Dialog::File, session),
                Request::ChooseLook => self.choose(Dialog::Look, session),
                Request::ChooseSurroundings => self.choose(Dialog::Surroundings, session),
                Request::ChooseFolder => self.choose(Dialog::LookFolder, session),
                Request::ChooseLookFile => self.choose(Dialog::Save, session),
                Request::Export => self.export(session),
                Request::CancelExport => {
                    if let Some(export) = &mut self.export {
                        export.cancel();
                    }
                }
                Request::CopyCommand => {
                    copied = Some(command::line(session));
                    session.notes.say("Copied the command line of this picture");
                }
            }
        }
        if !files.is_empty() {
            self.opener.ask(OpenJob::Files(session.library.clone(), files));
        }
        if !session.has_picture() && !std::mem::replace(&mut session.thumbnails.are_asked, true) {
            self.reducer.ask(());
        }
        if let Err(error) = self.looks.carry_out(session) {
            session.notes.complain(&error);
        }
        copied
    }

    /// Writes what is shown, by another process.
    fn export(&mut self, session: &mut Session) {
        let Some(plan) = session.plan.take() else { return };
        let Some(file) = &session.file else { return };
        let look = session.look();
        let preset = if look.is_plain() {
            Ok(None)
        } else {
            look.whole().and_then(|preset| preset::text(&preset).map(Some))
        };
        let started = preset.and_then(|preset| {
            let mut job = export::ExportJob::new(plan.kind, file, Path::new(&plan.path), preset);
            (job.frames, job.turntable) = (plan.frames(), plan.what == What::Turntable);
            let mut words: Vec<String> = match &session.playback {
                Some(playback) => {
                    job.rate = playback.rate;
                    command::selection(playback)
                }
                None => {
                    let [width, height] = plan.size;
                    let size = ["--size".to_owned(), format!("{width}x{height}")];
                    let is_turntable = plan.what == What::Turntable;
                    size.into_iter().chain(command::staging(session, is_turntable)).collect()
                }
            };
            match plan.what {
                What::Animation => words.extend(command::animation(session)),
                What::Picture if session.playback.is_none() => words.extend(command::moment(session)),
                What::Picture | What::Turntable | What::Frames => {}
            }
            words.extend(command::precision(session));
            job.arguments = words.into_iter().map(Into::into).collect();
            Export::start(job)
        });
        match started {
            Ok(export) => (self.export, session.exported) = (Some(export), Some(0.0)),
            Err(error) => session.notes.complain(&error),
        }
    }

    /// Says how far the export is, and what became of it.
    fn follow_export(&mut self, session: &mut Session) {
        let Some(export) = &self.export else { return };
        let Progress { done, total, state } = export.poll();
        session.exported = Some((done / total.max(1.0)) as f32);
        let is_done = state == State::Done;
        match state {
            State::Running => return,
            State::Done => session.notes.say("Exported"),
            State::Cancelled => session.notes.say("The export was cancelled"),
            State::Failed(problem) => {
                session.notes.complain(&Error::failure(problem, "export again"));
            }
        }
        self.export = None;
        session.end_export(is_done);
    }

    /// Asks for a file on a thread of its own: dialogs of the system may stay open for long.
    fn choose(&mut self, dialog: Dialog, session: &mut Session) {
        if self.choosing {
            return;
        }
        let saved = session.saving.as_ref().map(Saving::file);
        let folder = match dialog {
            Dialog::Save => saved.as_deref().and_then(Path::parent).map(Path::to_owned),
            Dialog::Look | Dialog::LookFolder => session.settings.look_folder.clone(),
            Dialog::File | Dialog::Surroundings | Dialog::Export => session.settings.folder.clone(),
        };
        let name = match (dialog, &session.plan) {
            (Dialog::Export, Some(plan)) => {
                Path::new(&plan.path).file_name().unwrap_or_default().to_string_lossy().into_owned()
            }
            _ => saved.unwrap_or_default().file_name().unwrap_or_default().to_string_lossy().into_owned(),
        };
        let (choose, wake) = (self.choose.clone(), Arc::clone(&self.wake));
        let asked = std::thread::Builder::new().name("dialog".into()).spawn(move || {
            let path = dialogs::shown(|| ask(dialog, folder, &name), dialog.otherwise());
            // The window may be closed by now.
            let _ = choose.send((dialog, path));
            wake();
        });
        match asked {
            Ok(_) => self.choosing = true,
            Err(e) => session.notes.complain(&Error::failure(
                format!("no dialog can be opened: {e}"),
                "drop the file on the window",
            )),
        }
    }
}

/// Shows a dialog of the system and waits for its answer.
fn ask(dialog: Dialog, folder: Option<PathBuf>, name: &str) -> Option<PathBuf> {
    let mut shown = rfd::FileDialog::new();
    if let Some(folder) = folder {
        shown = shown.set_directory(folder);
    }
    match dialog {
        Dialog::File => shown.set_title("Open").pick_file(),
        Dialog::Look => shown.set_title("Open a look").add_filter("Looks", &["json"]).pick_file(),
        Dialog::LookFolder => shown.set_title("Add a folder of looks").pick_folder(),
        Dialog::Save => {
            let shown = shown.set_title("Save the look").set_file_name(name).add_filter("Looks", &["json"]);
            let path = shown.save_file()?;
            Some(if path.extension().is_some() { path } else { path.with_extension("json") })
        }
        Dialog::Export => shown.set_title("Export").set_file_name(name).save_file(),
        Dialog::Surroundings => shown
            .set_title("Surroundings")
            .add_filter("Pictures of the surroundings", &["hdr", "exr"])
            .pick_file(),
    }
}

fn is_look(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

fn open(job: OpenJob) -> Result<(Opened, Option<Document>)> {
    let opened = match job {
        OpenJob::Demo => Opened::Scene(Box::new(demo::scene()?), None),
        OpenJob::Sample(sample, folder) => {
            return pictures(Document::open(&sample.file_in(&folder)?, &Options::default())?);
        }
        OpenJob::Files(library, files) => return first_of(&library, files),
        OpenJob::Again(path, selection) => {
            let options = Options { selection: *selection, ..Options::default() };
            let document = Document::open(&path, &options)?;
            return Ok((Opened::Again(Box::new(document.playback()?)), Some(document)));
        }
        OpenJob::Look(library, path) => Opened::Look(Box::new(EditedLook::open(&library, &path)?)),
        OpenJob::Surroundings(path) => {
            let environment = Arc::new(Environment::read(&path)?);
            Opened::Surroundings(Surround::Environment(environment), path)
        }
    };
    Ok((opened, None))
}

fn pictures(document: Document) -> Result<(Opened, Option<Document>)> {
    Ok((Opened::Pictures(Box::new(document.playback()?)), Some(document)))
}

/// Opens the first file that can be opened.
fn first_of(library: &Library, files: Vec<PathBuf>) -> Result<(Opened, Option<Document>)> {
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
fn file(library: &Library, path: PathBuf) -> Result<(Opened, Option<Document>)> {
    if is_look(&path) {
        return Ok((Opened::Look(Box::new(EditedLook::open(library, &path)?)), None));
    }
    let document = Document::open(&path, &Options::default())?;
    match document.kind() {
        Kind::Scene => Ok((Opened::Scene(Box::new(Scene::load(&path, None)?), Some(path)), None)),
        _ => pictures(document),
    }
}

/// Request of looks on the picture that is open.
fn asked(session: &Session) -> Option<IsophoteRequest> {
    let (frame, _) = session.playback.as_ref()?.frame(false)?;
    session.library.request((1, 1)).ok().map(|usual| frame.request_of_all(1.0, usual))
}

fn take(session: &mut Session, opened: Opened) {
    match opened {
        Opened::Among(opened, problems, left) => {
            problems.iter().for_each(|problem| session.notes.complain(problem));
            take(session, *opened);
            if left > 0 {
                let files = if left == 1 { "One file more was" } else { "More files were" };
                session
                    .notes
                    .say(format!("{files} dropped; the first that opens is shown, {}", session.name));
            }
        }
        Opened::Again(playback) => {
            if session.file.as_deref() == Some(playback.path()) {
                session.show_again(*playback);
            }
        }
        Opened::Scene(scene, file) => {
            let area = session.viewport.area;
            let name = file.as_ref().and_then(|file| file.file_name());
            let name = name.map_or_else(|| "Demo".into(), |name| name.to_string_lossy().into_owned());
            if let Some(warning) = scene.warnings.first() {
                session.notes.say(format!("{name}: {warning}"));
            }
            let staging = Staging {
                camera: camera::file_camera(&scene),
                ground: floor::lacks_floor(&scene),
                ..Staging::default()
            };
            let aspect = area.width.max(1.0) / area.height.max(1.0);
            session.show_scene(Scenery::new(*scene, staging, aspect), file, name);
        }
        Opened::Pictures(playback) => session.show_playback(*playback),
        Opened::Look(look) => session.take(Arc::from(look)),
        Opened::Surroundings(background, path) => {
            session.relight("surroundings", |lighting| {
                (lighting.background, lighting.surroundings) = (background, Some(path));
            });
            session.let_go();
        }
    }
}
