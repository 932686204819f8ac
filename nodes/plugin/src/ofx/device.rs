//! The graphics device that all instances share, opened by the first frame that wants it and freed when the host purges
//! or unloads.
//!
//! A frame borrows an executor, which has buffers and textures of its own, so that several frames are on their way at
//! once: while the device computes one, others are uploaded or read back. The lock is held to take an executor and to
//! give it back, not while anything is computed.
//!
//! The process in which a device was wanted first is the only one that has any: drivers do not survive a fork, and a lock
//! of another thread's may be held for ever in the child.

use super::card::Card;
use super::faults;
use crate::abi::guard::lock;
use isophote::engine::cpu::Control;
use isophote::engine::gpu::{Device, Executor, Options};
use isophote::engine::{Error, Image, Plan, Rect};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Frames that are on their way at once: one goes there, one is computed, one comes back.
const FRAMES: usize = 3;

/// Bytes on the device that a frame may take before it is cut into tiles.
const BUDGET: u64 = 1 << 30;

/// Devices that fail one after the other before the CPU computes until the host purges.
const MOST_FAILURES: u32 = 3;

/// Time after which one who waits for an executor asks whether the frame is still wanted.
const PATIENCE: Duration = Duration::from_millis(10);

/// The process that has the devices; 0 before any was wanted.
static OWNER: AtomicU32 = AtomicU32::new(0);

/// The devices, by the numbers of their cards.
static SHARED: Mutex<Vec<(usize, Result<Shared, String>)>> = Mutex::new(Vec::new());

/// An executor came back.
static FREED: Condvar = Condvar::new();

/// Devices that failed since one computed, or since the host purged.
static FAILURES: AtomicU32 = AtomicU32::new(0);

/// A device and the executors on it.
struct Shared {
    device: Arc<Device>,
    idle: Vec<Executor>,
    busy: usize,
}

impl Shared {
    fn open(card: Card) -> Result<Self, String> {
        let options = Options { adapter: card.adapter(), ..Options::default() };
        let device = Device::open(&options).map_err(|e| e.to_string())?;
        Ok(Self { device, idle: Vec::new(), busy: 0 })
    }

    /// An executor, unless as many frames are on their way as may be.
    fn take(&mut self) -> Option<Executor> {
        if self.busy == FRAMES {
            return None;
        }
        self.busy += 1;
        Some(self.idle.pop().unwrap_or_else(|| {
            let mut new = Executor::new(Arc::clone(&self.device));
            new.set_limits(self.device.max_side(), BUDGET);
            new
        }))
    }
}

/// Looks at the device of a card, which is opened when it is not yet.
fn with<T>(card: Card, look: impl FnOnce(&mut Shared) -> T) -> Result<T, Error> {
    let me = std::process::id();
    let owner = OWNER.compare_exchange(0, me, Ordering::AcqRel, Ordering::Acquire).unwrap_or_else(|o| o);
    if owner != 0 && owner != me {
        return Err(Error::NoDevice(
            "this process is a copy of the one that has the graphics device".to_owned(),
        ));
    }
    let mut shared = lock(&SHARED);
    let index = shared.iter().position(|(number, _)| *number == card.number).unwrap_or_else(|| {
        shared.push((card.number, Shared::open(card)));
        shared.len() - 1
    });
    match &mut shared[index].1 {
        Ok(found) => Ok(look(found)),
        Err(reason) => Err(Error::NoDevice(reason.clone())),
    }
}

/// Opens the device of a card, unless it is open.
///
/// # Errors
/// No device, with the reason.
pub fn ready(card: Card) -> Result<(), Error> {
    with(card, |_| ())
}

/// Computes `region` of a plan on a card. One that waits for others hears when the frame is no longer wanted.
///
/// # Errors
/// As the engine's executor; no device.
pub fn run(
    card: Card,
    plan: &Plan,
    images: &[(&str, &Image)],
    region: Rect,
    control: Control<'_>,
) -> Result<Vec<Image>, Error> {
    let mut borrowed = Borrowed::wait(card, control)?;
    let mut results = borrowed.run(card, plan, images, region, control);
    if matches!(results, Err(Error::Memory(_))) {
        // What others left for later may be what is missing.
        let idle = with(card, |shared| std::mem::take(&mut shared.idle))?;
        drop(idle);
        results = borrowed.run(card, plan, images, region, control);
    }
    match &results {
        Ok(_) => FAILURES.store(0, Ordering::Relaxed),
        Err(Error::Device(reason)) => borrowed.condemn(reason),
        Err(_) => {}
    }
    results
}

/// An executor on loan.
struct Borrowed(Option<Executor>);

impl Borrowed {
    fn wait(card: Card, control: Control<'_>) -> Result<Self, Error> {
        loop {
            if let Some(executor) = with(card, Shared::take)? {
                return Ok(Self(Some(executor)));
            }
            let shared = lock(&SHARED);
            drop(FREED.wait_timeout(shared, PATIENCE).unwrap_or_else(PoisonError::into_inner));
            if control.cancelled.is_some_and(|cancelled| cancelled()) {
                return Err(Error::Cancelled);
            }
        }
    }

    fn run(
        &mut self,
        card: Card,
        plan: &Plan,
        images: &[(&str, &Image)],
        region: Rect,
        control: Control<'_>,
    ) -> Result<Vec<Image>, Error> {
        let Some(executor) = &mut self.0 else { return Err(Error::NoDevice(String::new())) };
        if let Some(error) = faults::of_device(executor.device()) {
            return Err(error);
        }
        executor.set_precision(card.precision);
        executor.run_images(plan, images, region, control)
    }

    /// Lets no other frame begin on the device, which failed. The next one opens it anew, but not for ever.
    fn condemn(&mut self, reason: &str) {
        let Some(executor) = self.0.take() else { return };
        let mut shared = lock(&SHARED);
        let is_it = |found: &Shared| Arc::ptr_eq(&found.device, executor.device());
        let index = shared.iter().position(|(_, found)| found.as_ref().is_ok_and(is_it));
        // Another frame may have been first.
        let condemned = index.map(|index| shared.remove(index));
        if let Some((number, _)) = &condemned
            && FAILURES.fetch_add(1, Ordering::Relaxed) + 1 >= MOST_FAILURES
        {
            shared.push((*number, Err(reason.to_owned())));
        }
        drop(shared);
        FREED.notify_all();
        // Waits for the device, and is therefore done without the lock.
        drop((condemned, executor));
    }
}

impl Drop for Borrowed {
    fn drop(&mut self) {
        let Some(executor) = self.0.take() else { return };
        let mut shared = lock(&SHARED);
        let is_it = |found: &&mut Shared| Arc::ptr_eq(&found.device, executor.device());
        let owner = shared.iter_mut().filter_map(|(_, found)| found.as_mut().ok()).find(is_it);
        let left = match owner {
            Some(owner) => {
                owner.busy -= 1;
                owner.idle.push(executor);
                None
            }
            // The host has purged meanwhile.
            None => Some(executor),
        };
        drop(shared);
        FREED.notify_one();
        drop(left);
    }
}

/// Frees the devices, and those of frames that are on their way when they are done. Another process leaves them alone.
pub fn forget() {
    if OWNER.load(Ordering::Acquire) == std::process::id() {
        let shared = std::mem::take(&mut *lock(&SHARED));
        FAILURES.store(0, Ordering::Relaxed);
        FREED.notify_all();
        drop(shared);
    }
}
