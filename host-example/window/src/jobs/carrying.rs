//! Painted maps of key frames, carried along the motion of the sequence that is open, on a thread of its own.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::worker::{Wake, Worker};
use crate::state::document::Info;
use crate::state::outcome::Outcome;
use crate::state::painted::channel::{Channel, Kind};
use crate::state::painted::key_frames::{CarriedMaps, KeyFrames};
use crate::state::painted::maps::Maps;
use crate::state::playback::{PaintedOver, Playback};
use isophote_files::error::{Error, Result};
use isophote_files::frames::Pattern;
use isophote_finishing::carry::{Carried, Key, Shot, Taker, Vectors};
use isophote_loader::Library;
use isophote_pictures::exr::Guide;
use isophote_pictures::pixels::{Pixels, Samples};

/// Most bytes that the maps of all frames take.
const MOST_BYTES: usize = 1 << 30;
/// Number of a job that nobody asks for.
const NONE: u64 = u64::MAX;

/// Maps to be carried to all frames of a sequence.
pub struct CarryJob {
    library: Library,
    info: Arc<Info>,
    over: PaintedOver,
    /// Pixels of the maps.
    size: (u32, u32),
}

/// Maps of all frames with the key frames that they were made of.
type Made = (Arc<KeyFrames>, Arc<CarriedMaps>);

/// The thread that carries, and the number of the job that is wanted: one that is not ends with the frame at hand.
pub struct Carrying {
    wanted: Arc<AtomicU64>,
    worker: Worker<(u64, CarryJob), Option<Result<Made>>>,
    /// The sequence that the last job is of.
    asked: Option<Arc<Info>>,
}

impl Carrying {
    /// Starts the thread.
    ///
    /// # Errors
    /// [`Error::Failure`] when the system gives no thread.
    pub fn new(wake: &Wake) -> Result<Self> {
        let wanted = Arc::new(AtomicU64::new(0));
        let own = Arc::clone(&wanted);
        let work = move |(number, job): (u64, CarryJob)| {
            let is_wanted = || own.load(Ordering::Relaxed) == number;
            let made = job.carry(&is_wanted);
            is_wanted().then_some(made)
        };
        Ok(Self { wanted, worker: Worker::new("carry", Arc::clone(wake), work)?, asked: None })
    }

    /// Asks for the maps of all frames, instead of what was asked for before.
    pub fn ask(&mut self, job: CarryJob) {
        let number = self.wanted.fetch_add(1, Ordering::Relaxed) + 1;
        self.asked = Some(Arc::clone(&job.info));
        self.worker.ask((number, job));
    }

    /// Ends a job of a sequence that is open no more with the frame at hand; what is open is `playback`.
    pub fn follow(&mut self, playback: Option<&Playback>) {
        let is_open = |asked: &Arc<Info>| playback.is_some_and(|open| Arc::ptr_eq(open.info(), asked));
        if self.asked.as_ref().is_some_and(|asked| !is_open(asked)) {
            self.asked = None;
            self.wanted.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Maps since the last call, or why there are none.
    pub fn answer(&mut self) -> Option<Outcome> {
        Some(match self.worker.answer()?? {
            Ok((keys, carried)) => Outcome::Carried(keys, carried),
            Err(error) => Outcome::Failed(error),
        })
    }

    /// True while maps are carried.
    pub fn is_busy(&self) -> bool {
        self.worker.is_busy()
    }
}

impl Drop for Carrying {
    fn drop(&mut self) {
        self.wanted.store(NONE, Ordering::Relaxed);
    }
}

impl CarryJob {
    /// What is painted on the key frames of the sequence that is open; nothing where there are none.
    pub fn of(playback: &Playback, library: &Library) -> Option<Self> {
        let over = playback.painted().filter(|_| playback.has_key_frames())?;
        let size = over.keys.iter().next()?.1.size();
        Some(Self { library: library.clone(), info: Arc::clone(playback.info()), over, size })
    }

    /// Carries them; ends early where that is not wanted any more.
    ///
    /// # Errors
    /// As [`Shot::carry`]; [`Error::Input`] where the maps take too much memory.
    pub fn carry(&self, is_wanted: &dyn Fn() -> bool) -> Result<Made> {
        let keys: Vec<Key> =
            self.over.keys.iter().map(|(frame, maps)| self.key(frame, maps)).collect::<Result<_>>()?;
        let mut maps = CarriedFrames { job: self, carried: CarriedMaps::default(), is_wanted };
        Shot { frames: &self.over.numbers, keys: &keys }.carry(&mut self.vectors()?, &mut maps)?;
        Ok((Arc::clone(&self.over.keys), Arc::new(maps.carried)))
    }

    /// Vectors of the files where they lead both ways, or from the first frame on where that alone is painted on; else estimated
    /// ones.
    fn vectors(&self) -> Result<Vectors> {
        let none = || Error::file(&self.info.path, "has no place for a frame number", "write shot.####.exr");
        let shot = Pattern::new(&self.info.path)?.ok_or_else(none)?;
        let has = |guide: Guide| self.info.offers.guides.iter().any(|(known, _)| *known == guide);
        let is_forth = self.over.keys.iter().all(|(frame, _)| self.over.numbers.first() == Some(&frame));
        if has(Guide::Motion) && (is_forth || has(Guide::MotionForward)) {
            return Ok(Vectors::of_files(shot, None, self.info.selection.clone()));
        }
        Vectors::estimated(shot, &self.library)
    }

    /// All channels of a key frame's maps, in the size of its file.
    fn key(&self, frame: i64, maps: &Maps) -> Result<Key> {
        let size = self.over.size;
        let [control, mask] = [Kind::Control, Kind::Mask].map(|kind| maps.bytes(kind, size));
        let all = control.as_chunks::<4>().0.iter().zip(&mask);
        let bytes: Vec<u8> = all.flat_map(|(control, mask)| [&control[..], &[*mask]].concat()).collect();
        let pixels = Pixels::new(size.0, size.1, Channel::ALL.len() as u32, Samples::U8(bytes));
        let pixels =
            pixels.ok_or_else(|| Error::failure("a map is not as large as it should be", "paint again"))?;
        let nothing = Channel::ALL.iter().map(|channel| f32::from(channel.plain()) / 255.0).collect();
        Ok(Key::new(frame, pixels, nothing))
    }
}

/// Maps of the frames that were carried to.
struct CarriedFrames<'j> {
    job: &'j CarryJob,
    carried: CarriedMaps,
    is_wanted: &'j dyn Fn() -> bool,
}

impl Taker for CarriedFrames<'_> {
    fn goes_on(&self) -> Result<()> {
        let ended = || Error::failure("the maps are not wanted any more", "carry them again");
        if (self.is_wanted)() { Ok(()) } else { Err(ended()) }
    }

    fn take(&mut self, carried: Carried, map: Pixels) -> Result<()> {
        let (all, size) = (map.to_f32(), self.job.over.size);
        let mut maps = Maps::new(self.job.size);
        let channels = all.as_chunks::<{ Channel::ALL.len() }>().0;
        let control: Vec<f32> = channels.iter().flat_map(|pixel| pixel[..4].iter().copied()).collect();
        maps.take(Kind::Control, &control, size);
        let mask: Vec<f32> = channels.iter().map(|pixel| pixel[4]).collect();
        maps.take(Kind::Mask, &mask, size);
        self.carried.insert(carried.frame, maps, carried.unknown);
        if self.carried.bytes() > MOST_BYTES {
            return Err(Error::input(
                "what is painted",
                "takes over a gigabyte of memory on all frames",
                "save the maps of the key frames, and carry them by `isophote carry`",
            ));
        }
        Ok(())
    }
}
