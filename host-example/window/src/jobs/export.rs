//! Export of what the window shows into files: a picture, a sequence, a turntable or a video; and of its look on other pictures.
//!
//! The work is done by another process of this program, by its verbs `apply` and `render` with a preset file. So the window
//! stays alive whatever becomes of it, and the result is the one that the command line gives.

use std::ffi::OsString;
use std::fs;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, Builder};
use std::time::Duration;

use serde_json::Value;

use super::maps;
use crate::state::document::kind::Kind as DocumentKind;
use crate::state::painted::channel::Kind;
use crate::state::playback::PaintedOver;
use crate::state::progress::{Progress, State};
use isophote_files::error::{Error, Result};
use isophote_files::files;
use isophote_finishing::video;

/// Time between two looks at whether a process has ended that says no more.
const TICK: Duration = Duration::from_millis(5);
/// Time that a process has to end and to remove what it has begun.
const GRACE: Duration = Duration::from_secs(2);

/// An export to be made.
#[derive(Clone, Debug)]
pub struct ExportJob {
    /// Kind of the input: scenes are rendered, the others filtered.
    pub kind: DocumentKind,
    /// The document's path.
    pub input: PathBuf,
    /// More pictures, each by itself, whose results go to a folder as that of the input does.
    pub more: Vec<PathBuf>,
    /// The picture, the pattern of the pictures or the video; the folder where there are more.
    pub output: PathBuf,
    /// The look as the text of a preset file, in which paths are absolute; only scenes are something without.
    pub preset: Option<String>,
    /// Frames, as `--frames` takes them.
    pub frames: Option<String>,
    /// True where the camera turns once around the scene over all frames.
    pub turntable: bool,
    /// Frames per second of scenes and of sequences that become videos.
    pub rate: f64,
    /// Maps that are painted over the document.
    pub maps: Option<PaintedOver>,
    /// More options of the verb.
    pub arguments: Vec<OsString>,
    /// The program instead of this one.
    pub program: Option<PathBuf>,
}

impl ExportJob {
    /// The whole of a document into a file, at full resolution and 24 frames a second.
    pub fn new(kind: DocumentKind, input: &Path, output: &Path, preset: Option<String>) -> Self {
        Self {
            kind,
            input: input.to_owned(),
            more: Vec::new(),
            output: output.to_owned(),
            preset,
            frames: None,
            turntable: false,
            rate: 24.0,
            maps: None,
            arguments: Vec::new(),
            program: None,
        }
    }

    /// True where several pictures, each by itself, go to a folder.
    fn is_of_several(&self) -> bool {
        !self.more.is_empty()
    }

    /// Removes what a process had begun when it was ended; nobody writes it any more.
    fn sweep(&self) {
        let beside = if self.is_of_several() { &self.output.join("picture") } else { &self.output };
        files::sweep(beside);
    }

    /// The process that does it, with its preset and other files in `folder`.
    fn command(&self, folder: &Path) -> Result<Command> {
        let preset = folder.join("look.json");
        if let Some(text) = &self.preset {
            fs::write(&preset, text).map_err(|e| {
                Error::file(&preset, format!("cannot be written: {e}"), "make room on the disk")
            })?;
        }
        let program = match &self.program {
            Some(program) => program.clone(),
            None => std::env::current_exe().map_err(|e| {
                Error::failure(format!("the program does not find itself: {e}"), "start it again")
            })?,
        };
        let mut command = Command::new(program);
        match self.kind {
            DocumentKind::Scene => {
                command.arg("render").arg("--fps").arg(self.rate.to_string());
                if self.preset.is_some() {
                    command.arg("--style").arg(&preset);
                }
                if self.turntable {
                    command.arg("--turntable");
                }
            }
            _ => {
                command.arg("apply").arg("--preset").arg(&preset);
                // Whoever chose the document itself was asked; of a video the sound is read to the end.
                if self.kind != DocumentKind::Video {
                    command.arg("--in-place");
                }
                if self.kind == DocumentKind::Sequence && video::becomes_video(&self.output) {
                    command.arg("--fps").arg(self.rate.to_string());
                }
            }
        }
        if let Some(over) = &self.maps {
            for kind in Kind::ALL.into_iter().filter(|kind| over.keys.has(*kind)) {
                let number = if over.keys.is_one() { "" } else { ".####" };
                let file = folder.join(format!("{}{number}.png", kind.option()));
                maps::write_all(kind, over, &file, files::Existing::Replace)?;
                command.arg(format!("--{}", kind.option())).arg(file);
            }
        }
        if let Some(frames) = &self.frames {
            command.arg("--frames").arg(frames);
        }
        if self.is_of_several() {
            command.arg("--to").arg(&self.output);
        }
        // What is there may go: the dialog has asked.
        command.args(&self.arguments).args(["--force", "--json", "--"]).arg(&self.input).args(&self.more);
        if !self.is_of_several() {
            command.arg(&self.output);
        }
        Ok(command)
    }
}

/// An export at work. Dropped, it is cancelled.
#[derive(Debug)]
pub struct Export {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    progress: Mutex<Progress>,
    child: Mutex<Option<Child>>,
    is_cancelled: AtomicBool,
}

impl Export {
    /// Starts it.
    ///
    /// # Errors
    /// [`Error::Input`] for jobs without a look that need one, [`Error::Failure`] when the system gives no thread; what else
    /// is wrong is told by [`Export::poll`].
    pub fn start(job: ExportJob) -> Result<Self> {
        if job.preset.is_none() && job.kind != DocumentKind::Scene {
            return Err(Error::input("the export", "has no look", "choose a style first"));
        }
        let shared = Arc::new(Shared::default());
        let own = Arc::clone(&shared);
        let work = move || {
            let result = own.run(&job);
            let is_cancelled = own.is_cancelled();
            if is_cancelled || result.is_err() {
                job.sweep();
            }
            own.progress().state = match result {
                // What was done before it could be ended is done.
                Ok(()) => State::Done,
                Err(_) if is_cancelled => State::Cancelled,
                Err(Failure { pictures, all, .. })
                    if job.is_of_several() && (1..all).contains(&pictures.len()) =>
                {
                    State::Partly(pictures)
                }
                Err(failure) => State::Failed(failure.text()),
            };
        };
        Builder::new()
            .name("export".into())
            .spawn(work)
            .map_err(|e| Error::failure(format!("a thread cannot be started: {e}"), "try again"))?;
        Ok(Self { shared })
    }

    /// Progress of it.
    pub fn poll(&self) -> Progress {
        self.shared.progress().clone()
    }

    /// Ends it, and removes what is not whole; [`Export::poll`] tells when that is done.
    pub fn cancel(&mut self) {
        if self.shared.is_cancelled.swap(true, Ordering::SeqCst) {
            return;
        }
        if !self.shared.child().as_mut().is_some_and(ask_to_end) {
            return;
        }
        let shared = Arc::clone(&self.shared);
        let end = move || {
            thread::sleep(GRACE);
            if let Some(child) = shared.child().as_mut() {
                // One that has ended needs no end.
                let _ = child.kill();
            }
        };
        // Without a thread it has all the time that it needs.
        let _ = Builder::new().name("end of export".into()).spawn(end);
    }
}

/// Asks a process to end, and says whether it has not ended yet.
#[cfg(unix)]
fn ask_to_end(child: &mut Child) -> bool {
    use rustix::process::{Pid, Signal, kill_process};
    let is_running = matches!(child.try_wait(), Ok(None));
    let id = i32::try_from(child.id()).ok().and_then(Pid::from_raw);
    // As long as nobody has waited for it, no other process has its number.
    is_running && id.is_some_and(|id| kill_process(id, Signal::TERM).is_ok())
}

/// Ends a process: there is no way to ask.
#[cfg(not(unix))]
fn ask_to_end(child: &mut Child) -> bool {
    child.kill().is_ok()
}

/// Failure of a process.
struct Failure {
    /// Last complaint of the process.
    last: String,
    /// Complaints about single pictures.
    pictures: Vec<String>,
    /// Number of pictures that were tried.
    all: usize,
}

impl Failure {
    fn of(last: String) -> Self {
        Self { last, pictures: Vec::new(), all: 0 }
    }

    fn text(self) -> String {
        let Self { last, pictures, .. } = self;
        pictures.first().map_or_else(|| last.clone(), |first| format!("{first} ({last})"))
    }
}

impl Drop for Export {
    fn drop(&mut self) {
        self.cancel();
    }
}

impl Shared {
    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn child(&self) -> MutexGuard<'_, Option<Child>> {
        self.child.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::SeqCst)
    }

    /// Does a job, or says why it cannot be done.
    fn run(&self, job: &ExportJob) -> std::result::Result<(), Failure> {
        let folder =
            tempfile::tempdir().map_err(|e| Failure::of(format!("no folder for the time being: {e}")))?;
        self.process(job.command(folder.path()).map_err(|e| Failure::of(e.to_string()))?)
    }

    /// Runs a process to its end.
    fn process(&self, mut command: Command) -> std::result::Result<(), Failure> {
        let failed = |e: std::io::Error| Failure::of(format!("the export cannot be started: {e}"));
        let mut complaints = tempfile::tempfile().map_err(failed)?;
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(complaints.try_clone().map_err(failed)?);
        let out = {
            // Held so that whoever cancels finds the process, or it is not started.
            let mut child = self.child();
            if self.is_cancelled() {
                return Err(Failure::of(String::new()));
            }
            child.insert(command.spawn().map_err(failed)?).stdout.take()
        };
        let (mut frames, mut pictures) = (0, Vec::new());
        for line in out.into_iter().flat_map(|out| BufReader::new(out).split(b'\n')).map_while(|l| l.ok()) {
            if let Ok(event) = serde_json::from_slice::<Value>(&line) {
                frames += u32::from(event["event"] == "frame");
                self.note(&event, frames.into());
                pictures.extend(event["error"].as_str().map(str::to_owned));
            }
        }
        let status = loop {
            let mut child = self.child();
            if let Some(status) = child.as_mut().map_or(Ok(None), Child::try_wait).map_err(failed)? {
                *child = None;
                break status;
            }
            drop(child);
            thread::sleep(TICK);
        };
        if status.success() {
            return Ok(());
        }
        let mut text = String::new();
        // What cannot be read is not told.
        let _ = complaints.rewind().and_then(|()| complaints.read_to_string(&mut text));
        let last = text.lines().rev().find_map(|line| line.strip_prefix("error: "));
        let last = last.map_or_else(|| format!("the export ended early: {status}"), str::to_owned);
        Err(Failure { last, pictures, all: frames as usize })
    }

    /// Takes over what a process tells when so many frames are over.
    fn note(&self, event: &Value, frames: f64) {
        let mut progress = self.progress();
        match event["event"].as_str() {
            Some("start") => progress.total = event["frames"].as_f64().unwrap_or(0.0),
            Some("progress") => progress.done = event["done"].as_f64().unwrap_or(0.0),
            Some("frame") => {
                progress.done = frames;
                // Of a video the number may be a guess.
                progress.total = progress.total.max(frames);
            }
            _ => {}
        }
    }
}
