//! Way of what is open to the device: large pictures and scenes are uploaded beside the window.

use std::sync::Arc;

use super::origin::Origin;
use super::pictures::PictureSource;
use super::source::{LookInput, SceneSource, SceneState};
use crate::jobs::worker::{Wake, Worker};
use crate::state::document::frame::Frame;
use crate::state::session::Session;
use isophote_files::error::{AtPlace, Result};
use isophote_loader::abi::IsophoteRequest;
use isophote_render::gpu::Gpu;
use isophote_scene::Scene;

/// An upload to be made.
enum UploadJob {
    Scene { state: Box<SceneState>, size: (u32, u32), usual: IsophoteRequest },
    Picture { frame: Arc<Frame>, scale: f32, usual: IsophoteRequest },
}

/// Name of what is uploaded.
#[derive(Clone)]
enum Thing {
    Scene(Arc<Scene>),
    Picture(Arc<Frame>),
}

/// Pixels of a picture that is put on the device at once, so that the window shows nothing else meanwhile.
const AT_ONCE: u64 = 2_100_000;

/// Result of an upload: the source, or why it could not be uploaded.
type Uploaded = (Thing, Result<LookInput>);

/// Inputs of looks, as far as they are on the device.
pub struct Sources {
    gpu: Gpu,
    worker: Worker<UploadJob, Uploaded>,
    present: Option<LookInput>,
    /// The picture at its other size: whole, or its small copy.
    spare: Option<LookInput>,
    /// Thing that is being uploaded, or cannot be.
    requested: Option<Thing>,
    number: u64,
    /// Origin of the present input.
    origin: Option<Origin>,
    /// True while a small copy stands for the whole picture, which is on its way.
    is_whole_awaited: bool,
}

impl Sources {
    /// Nothing yet.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(gpu: &Gpu, wake: &Wake) -> Result<Self> {
        let own = gpu.clone();
        let worker = Worker::new("upload", Arc::clone(wake), move |job| upload(&own, job))?;
        Ok(Self {
            gpu: gpu.clone(),
            worker,
            present: None,
            spare: None,
            requested: None,
            number: 0,
            origin: None,
            is_whole_awaited: false,
        })
    }

    /// The present input of looks.
    pub fn present(&self) -> Option<&LookInput> {
        self.present.as_ref()
    }

    /// The present input of looks, to be rendered.
    pub fn present_mut(&mut self) -> Option<&mut LookInput> {
        self.present.as_mut()
    }

    /// A number that grows when what looks read is another one.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Origin of the present input.
    pub fn origin(&self) -> Option<&Origin> {
        self.origin.as_ref()
    }

    /// True while a small copy stands for the whole picture, which is on its way.
    pub fn is_whole_awaited(&self) -> bool {
        self.is_whole_awaited
    }

    /// True while something is being uploaded.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }

    /// Takes over the scene or picture that is open, its frame and its size, and says whether looks must be bound to it anew.
    ///
    /// # Errors
    /// The reason why it cannot be shown. It is not tried again.
    pub fn follow(&mut self, session: &Session, scale: f32) -> Result<bool> {
        let usual = session.library.request((1, 1)).map_err(|e| e.at("the library", "install it again"))?;
        let is_new = self.take(session)?;
        let is_other = match (session.open.scenery(), session.open.playback()) {
            (Some(scenery), _) => {
                let [_, half] = session.viewport.halves();
                let pixels = |length: f32| ((length * scale).round() as u32).max(1);
                let size = (pixels(half.width), pixels(half.height));
                match &mut self.present {
                    Some(LookInput::Scene(source)) if source.is_of(scenery) => {
                        source.follow(scenery, size, scale)?
                    }
                    _ => {
                        let usual = IsophoteRequest { scale, ..usual };
                        self.replace(Thing::Scene(Arc::clone(&scenery.scene)), || UploadJob::Scene {
                            state: Box::new(SceneState::of(scenery)),
                            size,
                            usual,
                        });
                        false
                    }
                }
            }
            (None, Some(playback)) => {
                let Some(wanted) = playback.frame(scale < 1.0) else { return Ok(is_new) };
                self.follow_picture(wanted, playback.frame(scale >= 1.0), usual)
            }
            (None, None) => {
                (self.present, self.spare) = (None, None);
                false
            }
        };
        self.number += u64::from(is_other);
        self.origin = self.present.as_ref().and_then(|_| Origin::of(session));
        Ok(is_new || is_other)
    }

    /// Shows a frame, whose size is so much of the file's; `other` is the same picture at another size. Says whether it is
    /// on the device in the place of something else.
    fn follow_picture(
        &mut self,
        (frame, scale): (&Arc<Frame>, f32),
        other: Option<(&Arc<Frame>, f32)>,
        usual: IsophoteRequest,
    ) -> bool {
        self.is_whole_awaited = false;
        if shows(self.present.as_ref(), frame) {
            return false;
        }
        if shows(self.spare.as_ref(), frame) {
            std::mem::swap(&mut self.present, &mut self.spare);
            self.number += 1;
            return false;
        }
        // What was painted anew is the same picture.
        if let Some(LookInput::Picture(source)) = &self.present
            && let Some(Ok(source)) = source.repainted(&self.gpu, frame, scale)
        {
            (self.present, self.spare) = (Some(LookInput::Picture(source)), None);
            return true;
        }
        // Frames that follow one another take each other's place.
        if frame.number.is_some()
            && let Some(LookInput::Picture(source)) = &mut self.present
            && source.follow(&self.gpu, frame, scale)
        {
            self.number += 1;
            return false;
        }
        let job = || UploadJob::Picture { frame: Arc::clone(frame), scale, usual };
        if other.is_some_and(|(other, _)| shows(self.present.as_ref(), other)) {
            self.is_whole_awaited = true;
            self.ask(Thing::Picture(Arc::clone(frame)), job);
            return false;
        }
        // The window shows it at once, small if need be, and nothing of before under its name.
        let smallest = other.into_iter().chain([(frame, scale)]).min_by_key(|(frame, _)| frame.width);
        let is_small = |frame: &Frame| u64::from(frame.width) * u64::from(frame.height) <= AT_ONCE;
        let at_once = smallest.filter(|(frame, _)| is_small(frame)).and_then(|(frame, scale)| {
            // What is refused is refused once more, and said then.
            PictureSource::new(&self.gpu, frame, scale, usual).ok()
        });
        let is_there = at_once.as_ref().is_some_and(|source| source.shows(frame));
        (self.present, self.spare) = (at_once.map(LookInput::Picture), None);
        if is_there {
            self.requested = None;
        } else {
            self.is_whole_awaited = self.present.is_some();
            self.ask(Thing::Picture(Arc::clone(frame)), job);
        }
        self.present.is_some()
    }

    /// Takes what has been uploaded, and says whether there is anything.
    fn take(&mut self, session: &Session) -> Result<bool> {
        let Some((thing, uploaded)) = self.worker.answer() else { return Ok(false) };
        if self.requested.as_ref().is_none_or(|requested| !requested.is(&thing)) {
            return Ok(false);
        }
        let source = uploaded?;
        self.requested = None;
        let old = self.present.replace(source);
        let is_of_same = |frame: &Arc<Frame>| shows(old.as_ref(), frame);
        let playback = session.open.playback();
        let frames = playback.iter().flat_map(|playback| [playback.frame(false), playback.frame(true)]);
        let is_same = frames.flatten().any(|(frame, _)| is_of_same(frame));
        self.spare = old.filter(|_| is_same);
        self.number += 1;
        Ok(true)
    }

    /// Shows nothing until something is uploaded.
    fn replace(&mut self, thing: Thing, job: impl FnOnce() -> UploadJob) {
        (self.present, self.spare) = (None, None);
        self.ask(thing, job);
    }

    fn ask(&mut self, thing: Thing, job: impl FnOnce() -> UploadJob) {
        if self.requested.as_ref().is_some_and(|requested| requested.is(&thing)) {
            return;
        }
        self.requested = Some(thing);
        self.worker.ask(job());
    }
}

impl Thing {
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Scene(a), Self::Scene(b)) => Arc::ptr_eq(a, b),
            (Self::Picture(a), Self::Picture(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

fn shows(source: Option<&LookInput>, frame: &Arc<Frame>) -> bool {
    matches!(source, Some(LookInput::Picture(source)) if source.shows(frame))
}

fn upload(gpu: &Gpu, job: UploadJob) -> Uploaded {
    match job {
        UploadJob::Scene { state, size, usual } => {
            let source = SceneSource::new(gpu, &state, size, usual);
            (Thing::Scene(state.scene), source.map(|source| LookInput::Scene(Box::new(source))))
        }
        UploadJob::Picture { frame, scale, usual } => {
            let source = PictureSource::new(gpu, &frame, scale, usual);
            (Thing::Picture(frame), source.map(LookInput::Picture))
        }
    }
}
