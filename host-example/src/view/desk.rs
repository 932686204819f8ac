//! What the window does beside drawing: opening files, asking for names, saving. Nothing of it holds the window up.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::command;
use super::demo;
use super::document::kind::Kind;
use super::document::{Document, Options};
use super::export::{self, Export, Progress, State};
use super::idle::{self, Question};
use super::look::Look;
use super::reel::Reel;
use super::scenery::{Scenery, Staging};
use super::session::{Session, Wish};
use super::watch::Watch;
use super::worker::{Wake, Worker};
use crate::error::{Error, Result};
use crate::loader::Library;
use crate::render::background::Background;
use crate::scene::environment::Environment;
use crate::scene::{Scene, camera, floor};

/// What is to be opened.
enum Job {
    Demo,
    File(PathBuf),
    Look(Library, PathBuf),
    Surroundings(PathBuf),
}

/// What was opened.
enum Opened {
    Scene(Box<Scene>, Option<PathBuf>),
    Pictures(Box<Reel>),
    Look(Box<Look>),
    Surroundings(Background, PathBuf),
}

/// What a dialog is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dialog {
    File,
    Look,
    Save,
    Surroundings,
    Export,
}

/// The work beside the window.
pub struct Desk {
    opener: Worker<Job, Result<Opened>>,
    critic: Worker<Question, idle::Answer>,
    /// Reads looks again whose files have changed.
    reader: Worker<(Library, PathBuf), (PathBuf, Result<Look>)>,
    watch: Watch,
    /// What the critic was asked last.
    asked: Option<Look>,
    chosen: Receiver<(Dialog, Option<PathBuf>)>,
    choose: Sender<(Dialog, Option<PathBuf>)>,
    export: Option<Export>,
    /// Whether a dialog is open.
    choosing: bool,
    wake: Wake,
    over: bool,
}

impl Desk {
    /// Starts the threads.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(wake: &Wake) -> Result<Self> {
        let (choose, chosen) = channel();
        Ok(Self {
            opener: Worker::new("open", Arc::clone(wake), open)?,
            critic: Worker::new("controls", Arc::clone(wake), idle::answer)?,
            reader: Worker::new("look again", Arc::clone(wake), |(library, path): (Library, PathBuf)| {
                let read = Look::open(&library, &path);
                (path, read)
            })?,
            watch: Watch::new(wake)?,
            asked: None,
            chosen,
            choose,
            export: None,
            choosing: false,
            wake: Arc::clone(wake),
            over: false,
        })
    }

    /// Whether the window is to be closed.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// What is being done.
    pub fn busy(&self) -> Option<&'static str> {
        self.opener.is_busy().then_some("Opening").or(self.export.as_ref().map(|_| "Exporting"))
    }

    /// Takes over what was done since the last call.
    pub fn collect(&mut self, session: &mut Session) {
        while let Ok((dialog, path)) = self.chosen.try_recv() {
            self.choosing = false;
            let Some(path) = path else { continue };
            match dialog {
                Dialog::File => self.opener.ask(Job::File(path)),
                Dialog::Look => {
                    session.settings.look_folder = path.parent().map(Path::to_owned);
                    self.opener.ask(Job::Look(session.library.clone(), path));
                }
                Dialog::Surroundings => self.opener.ask(Job::Surroundings(path)),
                Dialog::Save => save(session, &path),
                Dialog::Export => self.export(session, &path),
            }
        }
        self.follow_export(session);
        if let Some(opened) = self.opener.answer() {
            match opened {
                Ok(opened) => take(session, opened),
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
        if let Some(answer) = self.critic.answer()
            && answer.look == *session.look()
        {
            session.idle = answer.idle;
        }
        if self.asked.as_ref() != Some(session.look()) && session.has_picture() {
            self.asked = Some(session.look().clone());
            self.critic.ask(Question { library: session.library.clone(), look: session.look().clone() });
        }
    }

    /// Does what the controls have asked for, and returns what is to be put on the clipboard.
    pub fn grant(&mut self, session: &mut Session) -> Option<String> {
        let mut copied = None;
        for wish in std::mem::take(&mut session.wishes) {
            match wish {
                Wish::Open(path) if is_look(&path) => {
                    self.opener.ask(Job::Look(session.library.clone(), path));
                }
                Wish::Open(path) => self.opener.ask(Job::File(path)),
                Wish::OpenDemo => self.opener.ask(Job::Demo),
                Wish::ChooseFile => self.choose(Dialog::File, session),
                Wish::ChooseLook => self.choose(Dialog::Look, session),
                Wish::ChooseSurroundings => self.choose(Dialog::Surroundings, session),
                Wish::SaveLook(elsewhere) => {
                    let own = session.look().source.clone();
                    if elsewhere || !is_look(&own) {
                        self.choose(Dialog::Save, session)
                    } else {
                        save(session, &own)
                    }
                }
                Wish::TakeLook(path) => self.opener.ask(Job::Look(session.library.clone(), path)),
                Wish::Export => self.choose(Dialog::Export, session),
                Wish::CancelExport => {
                    if let Some(export) = &mut self.export {
                        export.cancel();
                    }
                }
                Wish::CopyCommand => {
                    copied = Some(command::line(session));
                    session.notes.say("Copied the command line of this picture");
                }
                Wish::Quit => self.over = true,
            }
        }
        copied
    }

    /// Writes what is shown, by another process.
    fn export(&mut self, session: &mut Session, path: &Path) {
        let Some(file) = &session.file else { return };
        let look = session.look();
        let preset =
            if look.is_plain() { Ok(None) } else { look.whole().map(|preset| Some(preset.to_json())) };
        let kind = session.reel.as_ref().map_or(Kind::Scene, |reel| reel.document.kind());
        let started = preset.and_then(|preset| {
            let mut job = export::Job::new(kind, file, path, preset);
            if let Some(reel) = &session.reel {
                job.rate = reel.rate;
            } else {
                job.arguments = command::staging(session).into_iter().map(Into::into).collect();
            }
            Export::start(job)
        });
        match started {
            Ok(export) => self.export = Some(export),
            Err(error) => session.notes.complain(&error),
        }
    }

    /// Says how far the export is, and what became of it.
    fn follow_export(&mut self, session: &mut Session) {
        let Some(export) = &self.export else { return };
        let Progress { done, total, state } = export.poll();
        session.exported = Some((done / total.max(1.0)) as f32);
        match state {
            State::Running => return,
            State::Done => session.notes.say("Exported"),
            State::Cancelled => session.notes.say("The export was cancelled"),
            State::Failed(problem) => {
                session.notes.complain(&Error::failure(problem, "export again"));
            }
        }
        (self.export, session.exported) = (None, None);
    }

    /// Asks for a file on a thread of its own: dialogs of the system may stay open for long.
    fn choose(&mut self, dialog: Dialog, session: &mut Session) {
        if self.choosing || session.look().is_plain() && dialog == Dialog::Save {
            return;
        }
        let folder = match dialog {
            Dialog::Look | Dialog::Save => session.settings.look_folder.clone(),
            Dialog::File | Dialog::Surroundings | Dialog::Export => session.settings.folder.clone(),
        };
        let name = match (dialog, &session.reel) {
            (Dialog::Export, Some(reel)) => {
                command::output(reel).file_name().unwrap_or_default().to_string_lossy().into_owned()
            }
            (Dialog::Export, None) => "picture.png".to_owned(),
            _ => format!("{}.json", session.look().name.to_lowercase().replace(' ', "-")),
        };
        let (choose, wake) = (self.choose.clone(), Arc::clone(&self.wake));
        let asked = std::thread::Builder::new().name("dialog".into()).spawn(move || {
            let path = ask(dialog, folder, &name);
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

fn open(job: Job) -> Result<Opened> {
    Ok(match job {
        Job::Demo => Opened::Scene(Box::new(demo::scene()?), None),
        Job::File(path) => {
            let document = Document::open(&path, &Options::default())?;
            match document.kind() {
                Kind::Scene => Opened::Scene(Box::new(Scene::load(&path, None)?), Some(path)),
                _ => Opened::Pictures(Box::new(Reel::new(document)?)),
            }
        }
        Job::Look(library, path) => Opened::Look(Box::new(Look::open(&library, &path)?)),
        Job::Surroundings(path) => {
            let environment = Arc::new(Environment::read(&path)?);
            Opened::Surroundings(Background::Environment(environment), path)
        }
    })
}

fn take(session: &mut Session, opened: Opened) {
    match opened {
        Opened::Scene(scene, file) => {
            let area = session.easel.area;
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
        Opened::Pictures(reel) => session.show_reel(*reel),
        Opened::Look(look) => session.take(*look),
        Opened::Surroundings(background, path) => {
            session.relight("surroundings", |lighting| {
                (lighting.background, lighting.surroundings) = (background, Some(path));
            });
            session.let_go();
        }
    }
}

fn save(session: &mut Session, path: &Path) {
    let mut look = session.look().clone();
    match look.save(path) {
        Ok(()) => {
            session.settings.look_folder = path.parent().map(Path::to_owned);
            session.notes.say(format!("Saved {}", path.display()));
            session.saved(look);
        }
        Err(error) => session.notes.complain(&error),
    }
}
