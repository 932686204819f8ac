//! Keys of stages that different frames have in common: a stage on the inputs of one frame is the same image in every
//! plan that describes it, whichever frame that plan is for.

use super::parts::{Kept, Plan};
use std::hash::{Hash, Hasher};
use twox_hash::XxHash3_128;

impl Plan {
    /// A number for each of [`Plan::kept`], in its order: of the passes that make it, down to their uniform bytes, and
    /// of the inputs that these read, by name and by how far their frames are from its own. Together with the frame
    /// it names the image, in this process.
    pub fn keys(&self) -> Vec<u128> {
        let mut homes: Vec<i32> = self.kept.iter().map(|kept| kept.frame).collect();
        homes.sort_unstable();
        homes.dedup();
        let mut keys = vec![0; self.kept.len()];
        for home in homes {
            let images = self.seen_from(home);
            let own = |kept: &&Kept| kept.frame == home;
            for (key, kept) in keys.iter_mut().zip(&self.kept).filter(|(_, kept)| own(kept)) {
                *key = images[kept.image.index()];
            }
        }
        keys
    }

    /// A number for each image, with frames counted from `home`.
    fn seen_from(&self, home: i32) -> Vec<u128> {
        self.names(|port| hash(&(port.base(), port.frame - home)))
    }
}

/// 128 bits of XXH3, so that no two images of a run meet.
pub(super) fn hash(value: &impl Hash) -> u128 {
    let mut bytes = Bytes(Vec::new());
    value.hash(&mut bytes);
    XxHash3_128::oneshot(&bytes.0)
}

/// All that is hashed of a value, one behind the other.
struct Bytes(Vec<u8>);

impl Hasher for Bytes {
    fn write(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn finish(&self) -> u64 {
        // Half of the number; the whole is taken from the bytes.
        XxHash3_128::oneshot(&self.0) as u64
    }
}
