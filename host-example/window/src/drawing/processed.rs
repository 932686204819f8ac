//! Looks that are computed on the CPU and put on the device, where the device's driver would compute there itself, or where rules
//! for things are followed: first at the screen's size, then in full.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use super::origin::Origin;
use super::pictures;
use super::shown::Output;
use crate::jobs::stylizing::{Stylist, Task};
use crate::jobs::worker::{Wake, Worker};
use crate::state::document::frame::Frame;
use crate::state::look::EditedLook;
use crate::state::things::Things;
use isophote_example::kernels::checked;
use isophote_files::error::Result;
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::catalogue::Kind;
use isophote_loader::{Control, Library};
use isophote_render::gpu::Gpu;

/// Share of the pixels across that a picture for the screen may lack: when a window grows a little, the whole picture is
/// nearer than another one for the screen.
const ENOUGH: f32 = 0.7;

/// A picture in a look, as it is wanted.
#[derive(Clone)]
struct Wanted {
    slot: usize,
    task: Task,
    origin: Origin,
    /// True where it may become whole although another one is wanted: while a slider moves, none would.
    may_finish: bool,
    since: Instant,
}

/// A picture to be made, and its number.
type Job = (u64, Wanted);
/// Result of it: nothing where it was cancelled.
type Answer = (Wanted, Result<Option<Finished>>);

/// A picture in a look on the device.
struct Finished {
    output: Output,
    spent: Duration,
}

/// The looks of the window on the CPU.
pub struct Processed {
    worker: Worker<Job, Answer>,
    /// Sentences about rules of looks.
    news: Receiver<String>,
    /// Number of the picture that is to go on; others are given up.
    allowed: Arc<AtomicU64>,
    /// Share of it that is done, as bits.
    done: Arc<AtomicU32>,
    asked: u64,
    running: Option<Wanted>,
    /// Pictures that could not be made, which are not asked for again.
    refused: Vec<Wanted>,
    shown: [Option<(Wanted, Finished)>; 3],
    /// True where everything that is wanted is shown, at whichever size.
    is_complete: bool,
    revision: u64,
    shot: u64,
    origin: Option<Origin>,
}

/// The picture that looks are wanted of.
pub struct Subject<'s> {
    /// The picture.
    pub frame: &'s Arc<Frame>,
    /// Things in it, where rules may be for them.
    pub things: Option<Things>,
    /// Its size over that of the file's.
    pub share: f32,
    /// Origin of it.
    pub origin: Origin,
    /// Sizes at which it is wanted, one after the other.
    pub sizes: Vec<(u32, u32)>,
    /// True while something moves.
    pub moves: bool,
    /// Time from which on it counts how long it takes.
    pub since: Instant,
}

impl Wanted {
    /// True where both are the same picture, size apart.
    fn is_same(&self, other: &Self) -> bool {
        self.slot == other.slot
            && Arc::ptr_eq(&self.task.frame, &other.task.frame)
            && self.task.look == other.task.look
    }

    fn is(&self, other: &Self) -> bool {
        self.is_same(other) && self.task.size == other.task.size
    }

    /// True where it is as good as another one.
    fn satisfies(&self, other: &Self) -> bool {
        let (own, wanted) = (self.task.size.0, other.task.size.0);
        let is_whole = wanted == other.task.frame.width;
        let enough = if is_whole { 1.0 } else { ENOUGH };
        self.is_same(other) && own as f32 >= wanted as f32 * enough
    }
}

impl Processed {
    /// No looks yet.
    ///
    /// # Errors
    /// As [`Worker::new`].
    pub fn new(gpu: &Gpu, library: &Library, wake: &Wake) -> Result<Self> {
        let (allowed, done) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU32::new(0)));
        let (sender, news) = channel();
        let own = (gpu.clone(), Arc::clone(&allowed), Arc::clone(&done));
        let mut stylist = Stylist::new(library.clone());
        let worker = Worker::new("stylizing", Arc::clone(wake), move |(number, wanted): Job| {
            let (gpu, allowed, done) = &own;
            let made = make(gpu, &mut stylist, &wanted, &|| allowed.load(Ordering::Relaxed) != number, done);
            tell(&sender, &mut stylist);
            (wanted, made)
        })?;
        Ok(Self {
            worker,
            news,
            allowed,
            done,
            asked: 0,
            running: None,
            refused: Vec::new(),
            shown: [const { None }; 3],
            is_complete: false,
            revision: 0,
            shot: 0,
            origin: None,
        })
    }

    /// Follows looks on a picture, of which these are shown; plain ones are none. Those that are not shown for the moment are
    /// kept as they are.
    ///
    /// # Errors
    /// Errors of the library about a look; what is shown stays.
    pub fn follow(
        &mut self,
        looks: [Option<&EditedLook>; 3],
        is_shown: [bool; 3],
        subject: &Subject<'_>,
    ) -> Result<()> {
        let taken = self.take();
        if self.origin.as_ref().is_none_or(|origin| !origin.is_of_same(&subject.origin)) {
            self.shot += 1;
            (self.shown, self.refused) = ([const { None }; 3], Vec::new());
        }
        self.origin = Some(subject.origin.clone());
        for (shown, _) in self.shown.iter_mut().zip(&looks).filter(|(_, look)| look.is_none()) {
            *shown = None;
        }
        let wanted = |size: (u32, u32)| {
            let looks = looks.iter().enumerate().filter(|(slot, _)| is_shown[*slot]);
            let looks = looks.filter_map(|(slot, look)| Some((slot, (*look)?)));
            looks.map(move |(slot, look)| (slot, look, size))
        };
        let mut first = None;
        self.is_complete = true;
        for (slot, look, size) in subject.sizes.iter().copied().flat_map(wanted) {
            let task = Task {
                look: look.clone(),
                frame: Arc::clone(subject.frame),
                things: subject.things.clone(),
                share: subject.share,
                size,
                shot: self.shot,
            };
            let Subject { moves: may_finish, since, .. } = *subject;
            let wanted = Wanted { slot, task, origin: subject.origin.clone(), may_finish, since };
            let shown = self.shown[slot].as_ref();
            self.is_complete &= shown.is_some_and(|(shown, _)| shown.is_same(&wanted));
            let is_refused = self.refused.iter().any(|refused| refused.is(&wanted));
            if first.is_none() && !is_refused && !shown.is_some_and(|(shown, _)| shown.satisfies(&wanted)) {
                first = Some(wanted);
            }
        }
        if is_shown.contains(&true) {
            self.go_on(first);
        }
        taken
    }

    /// Makes this picture next, or none.
    fn go_on(&mut self, first: Option<Wanted>) {
        let Some(wanted) = first else { return self.rest() };
        if let Some(running) = &self.running {
            let is_useful = running.may_finish && running.origin.is_of_same(&wanted.origin);
            if running.is(&wanted) || is_useful {
                return;
            }
        }
        self.asked += 1;
        self.allowed.store(self.asked, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
        self.running = Some(wanted.clone());
        self.worker.ask((self.asked, wanted));
    }

    /// Gives up what is being made, as long as nothing can be wanted.
    pub fn wait(&mut self) {
        self.is_complete = false;
        self.rest();
    }

    /// Gives up all pictures, while looks are made elsewhere.
    pub fn put_away(&mut self) {
        self.rest();
        // What was all but made is not wanted, either.
        drop(self.worker.answer());
        (self.shown, self.refused) = ([const { None }; 3], Vec::new());
    }

    /// Sentences about rules of looks that are for nothing in what is open, since the last call.
    pub fn news(&self) -> Vec<String> {
        self.news.try_iter().collect()
    }

    /// Gives up what is being made.
    fn rest(&mut self) {
        if self.running.take().is_some() {
            self.allowed.store(0, Ordering::Relaxed);
        }
    }

    /// Takes over what was made.
    fn take(&mut self) -> Result<()> {
        let Some((wanted, made)) = self.worker.answer() else { return Ok(()) };
        let is_last = !self.worker.is_busy();
        let was_running = is_last && self.running.take().is_some();
        match made {
            Ok(Some(made)) => {
                let slot = wanted.slot;
                self.shown[slot] = Some((wanted, made));
                self.revision += 1;
                Ok(())
            }
            Ok(None) => {
                // What was not given up cannot be.
                if was_running {
                    self.refuse(wanted);
                }
                Ok(())
            }
            Err(error) => {
                self.refuse(wanted);
                Err(error)
            }
        }
    }

    /// Does not make this again until its look or its frame is another.
    fn refuse(&mut self, wanted: Wanted) {
        self.refused.retain(|refused| {
            let is_same_frame = Arc::ptr_eq(&refused.task.frame, &wanted.task.frame);
            is_same_frame && (refused.slot != wanted.slot || refused.is_same(&wanted))
        });
        self.refused.push(wanted);
    }

    /// A picture that may stand for what is open `now`, its kind, and what its colours are.
    pub fn output(&self, slot: usize, now: &Origin) -> Option<Output> {
        let (wanted, made) = self.shown[slot].as_ref()?;
        wanted.origin.stands_for(now).then(|| made.output.clone())
    }

    /// True where everything that is wanted is shown, at whichever size.
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// True where the picture that is being made is to become whole before there is another.
    pub fn finishes(&self) -> bool {
        self.running.as_ref().is_some_and(|running| running.may_finish)
    }

    /// A number that grows with every picture.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Time that the pictures took that are shown.
    pub fn spent(&self) -> Duration {
        self.shown.iter().flatten().map(|(_, made)| made.spent).sum()
    }

    /// The share of the picture that is being made, while there is one.
    pub fn progress(&self) -> Option<f32> {
        self.running.as_ref().map(|_| f32::from_bits(self.done.load(Ordering::Relaxed)))
    }
}

impl Drop for Processed {
    fn drop(&mut self) {
        // The thread is waited for.
        self.allowed.store(0, Ordering::Relaxed);
    }
}

/// Hands on what the computation of a look has told.
fn tell(to: &Sender<String>, stylist: &mut Stylist) {
    for sentence in stylist.take_news() {
        // Nobody hears it once the window is closed.
        let _ = to.send(sentence);
    }
}

/// Makes a picture and puts it on the device.
fn make(
    gpu: &Gpu,
    stylist: &mut Stylist,
    wanted: &Wanted,
    cancelled: &(dyn Fn() -> bool + Sync),
    done: &AtomicU32,
) -> Result<Option<Finished>> {
    let mut progress = |share: f32| done.store(share.to_bits(), Ordering::Relaxed);
    let mut control =
        Control { cancelled: Some(cancelled), progress: Some(&mut progress), ..Control::default() };
    if cancelled() {
        return Ok(None);
    }
    let Some(pixels) = stylist.stylize(&wanted.task, &mut control)? else { return Ok(None) };
    let size = (pixels.width(), pixels.height());
    let channels = pixels.channels();
    let view = checked(&gpu.device, || Ok(pictures::texture(gpu, "look", size, channels)))?;
    pictures::write(gpu, &view, bytemuck::cast_slice(pixels.bytes()));
    let kind = if channels == 1 { Kind::Scalar } else { Kind::Color };
    let request = wanted.task.frame.request_of_all(1.0, IsophoteRequest::default());
    Ok(Some(Finished { output: (view, kind, request.space), spent: wanted.since.elapsed() }))
}
