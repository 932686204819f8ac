//! Images that frames have in common, kept by the contents that they were made from, within a bound of memory. Whoever
//! wants one that another thread is computing waits for it.

use super::stop::Stop;
use crate::pool;
use isophote::engine::Image;
use std::collections::HashMap;
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Most bytes that are kept.
const MOST: u64 = 4 << 30;
/// One part in so many of the machine's memory is kept at most.
const SHARE: u64 = 8;
/// What was not used for so long is given back when the next image comes.
const IDLE: Duration = Duration::from_secs(120);
/// Time between two questions whether to stop, while another thread computes.
const TURN: Duration = Duration::from_millis(10);
/// After so long a thread computes by itself what another was to compute, which may wait for this one.
pub const PATIENCE: Duration = Duration::from_secs(5);

/// A place of the store.
enum Place {
    /// A thread is computing the image.
    Claimed,
    Kept {
        image: Arc<Image>,
        used: Instant,
    },
}

/// Images by the numbers of what they were made from.
#[derive(Default)]
struct Store(HashMap<u128, Place>);

static STORE: LazyLock<Mutex<Store>> = LazyLock::new(Mutex::default);
/// Told when a claim has ended.
static ENDED: Condvar = Condvar::new();

fn lock() -> MutexGuard<'static, Store> {
    STORE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Most bytes that are kept.
pub fn most() -> u64 {
    MOST.min(pool::share_of_machine(SHARE))
}

impl Store {
    fn bytes(&self) -> u64 {
        let bytes = |place: &Place| match place {
            Place::Claimed => 0,
            Place::Kept { image, .. } => image.memory(),
        };
        self.0.values().map(bytes).sum()
    }

    /// Takes out what is there of images that are still missing, and claims those that nobody computes.
    fn find(&mut self, names: &[u128], found: &mut [Option<Arc<Image>>]) -> Vec<usize> {
        let mut claimed = Vec::new();
        for (index, (name, found)) in names.iter().zip(found).enumerate().filter(|(_, (_, f))| f.is_none()) {
            match self.0.get_mut(name) {
                Some(Place::Kept { image, used }) => {
                    *used = Instant::now();
                    *found = Some(Arc::clone(image));
                }
                Some(Place::Claimed) => {}
                None => {
                    self.0.insert(*name, Place::Claimed);
                    claimed.push(index);
                }
            }
        }
        claimed
    }

    /// Takes out what must not be kept any longer, those first that were used least recently.
    fn excess(&mut self, most: u64, now: Instant) -> Vec<Arc<Image>> {
        let mut ages: Vec<(Instant, u128)> = self
            .0
            .iter()
            .filter_map(|(name, place)| match place {
                Place::Claimed => None,
                Place::Kept { used, .. } => Some((*used, *name)),
            })
            .collect();
        ages.sort_unstable();
        let (mut bytes, mut gone) = (self.bytes(), Vec::new());
        for (used, name) in ages {
            if bytes <= most && now.saturating_duration_since(used) <= IDLE {
                break;
            }
            if let Some(Place::Kept { image, .. }) = self.0.remove(&name) {
                bytes -= image.memory();
                gone.push(image);
            }
        }
        gone
    }
}

/// Images that a thread has promised to the others. Those that it does not deliver are free for them again.
struct Claim<'n>(Vec<&'n u128>);

impl Claim<'_> {
    fn deliver(self, images: &[Arc<Image>]) {
        let now = Instant::now();
        let mut store = lock();
        for (name, image) in self.0.iter().zip(images) {
            store.0.insert(**name, Place::Kept { image: Arc::clone(image), used: now });
        }
        let gone = store.excess(most(), now);
        drop(store);
        for image in gone {
            Arc::try_unwrap(image).into_iter().for_each(pool::keep_image);
        }
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        let mut store = lock();
        for name in &self.0 {
            if matches!(store.0.get(*name), Some(Place::Claimed)) {
                store.0.remove(*name);
            }
        }
        drop(store);
        ENDED.notify_all();
    }
}

/// The images of these numbers: those that are kept, and the others from `compute`, which is given their positions. What
/// others compute is waited for as long as `patience` lasts.
///
/// # Errors
/// Aborted, where `stops` says so while another thread computes; those of `compute`.
pub fn obtain(
    names: &[u128],
    patience: Duration,
    stops: &dyn Fn() -> bool,
    mut compute: impl FnMut(&[usize]) -> Result<Vec<Image>, Stop>,
) -> Result<Vec<Arc<Image>>, Stop> {
    let mut found: Vec<Option<Arc<Image>>> = vec![None; names.len()];
    let started = Instant::now();
    loop {
        let mut store = lock();
        let claimed = store.find(names, &mut found);
        let missing: Vec<usize> = (0..names.len()).filter(|index| found[*index].is_none()).collect();
        if missing.is_empty() {
            return Ok(found.into_iter().flatten().collect());
        }
        if claimed.is_empty() && started.elapsed() < patience {
            // Nothing is claimed by this thread here, so that no two wait for each other.
            store = ENDED.wait_timeout(store, TURN).unwrap_or_else(PoisonError::into_inner).0;
            drop(store);
            if stops() {
                return Err(Stop::Aborted);
            }
            continue;
        }
        drop(store);
        let own = if claimed.is_empty() { &missing } else { &claimed };
        let claim = Claim(claimed.iter().map(|index| &names[*index]).collect());
        let images: Vec<Arc<Image>> = compute(own)?.into_iter().map(Arc::new).collect();
        claim.deliver(&images);
        own.iter().zip(images).for_each(|(index, image)| found[*index] = Some(image));
    }
}

/// The image of this number, if it is kept.
pub fn find(name: u128) -> Option<Arc<Image>> {
    match lock().0.get_mut(&name)? {
        Place::Kept { image, used } => {
            *used = Instant::now();
            Some(Arc::clone(image))
        }
        Place::Claimed => None,
    }
}

/// Gives back all that is kept.
pub fn forget() {
    let mut store = lock();
    let (kept, claimed) =
        std::mem::take(&mut store.0).into_iter().partition(|(_, place)| matches!(place, Place::Kept { .. }));
    store.0 = claimed;
    drop(store);
    let gone: HashMap<u128, Place> = kept;
    drop(gone);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn image(value: f32) -> Image {
        Image::from_vec(1, 1, 1, vec![value]).unwrap()
    }

    fn never() -> bool {
        false
    }

    #[test]
    fn an_image_is_computed_once_however_many_want_it() {
        let computed = AtomicUsize::new(0);
        let want = || {
            let images = obtain(&[1 << 100, 2 << 100], PATIENCE, &never, |own| {
                computed.fetch_add(own.len(), Ordering::SeqCst);
                std::thread::sleep(Duration::from_millis(30));
                Ok(own.iter().map(|index| image(*index as f32)).collect())
            });
            let images = images.ok().unwrap();
            assert_eq!([images[0].data(), images[1].data()], [[0.0], [1.0]]);
        };
        std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(want))));
        assert_eq!(computed.load(Ordering::SeqCst), 2);
    }

    #[test]
    fn who_fails_or_panics_leaves_it_to_others_and_who_waits_can_stop() {
        let name = [3 << 100];
        assert!(obtain(&name, PATIENCE, &never, |_| Err(Stop::Aborted)).is_err());
        assert!(
            catch_unwind(AssertUnwindSafe(|| obtain(&name, PATIENCE, &never, |_| panic!("broken")))).is_err()
        );
        let images = obtain(&name, PATIENCE, &never, |_| {
            std::thread::scope(|scope| {
                let stopped =
                    scope.spawn(|| obtain(&name, PATIENCE, &|| true, |_| Ok(vec![image(0.0)])).is_err());
                assert!(stopped.join().unwrap());
            });
            Ok(vec![image(5.0)])
        });
        assert_eq!(images.ok().unwrap()[0].data(), [5.0]);
    }

    #[test]
    fn the_least_recently_used_gives_way() {
        let (mut store, now) = (Store::default(), Instant::now());
        for n in 0..4_u8 {
            let used = now + Duration::from_secs(n.into());
            store.0.insert(n.into(), Place::Kept { image: Arc::new(image(f32::from(n))), used });
        }
        store.0.insert(9, Place::Claimed);
        let each = store.bytes() / 4;
        let gone = store.excess(2 * each, now);
        assert_eq!(gone.iter().map(|image| image.data()[0]).collect::<Vec<_>>(), [0.0, 1.0]);
        assert_eq!(store.excess(2 * each, now + 2 * IDLE).len(), 2);
        assert!(store.bytes() == 0 && store.0.len() == 1);
    }
}
