//! Images of frames that later frames need again, within a bound of memory.

use std::collections::HashMap;

/// Name that an image is known by: the passes that made it ([`Plan::keys`](crate::Plan::keys)) and the number of its
/// frame.
pub type Name = (u128, i64);

/// Images by name, of whatever kind an executor has. Those that were used least recently give way first.
#[derive(Debug)]
pub struct FrameStore<T> {
    images: HashMap<Name, Stored<T>>,
    bytes: u64,
    most: u64,
    clock: u64,
}

#[derive(Debug)]
struct Stored<T> {
    image: T,
    bytes: u64,
    used: u64,
}

impl<T> FrameStore<T> {
    /// An empty store that holds at most `most` bytes.
    pub fn new(most: u64) -> Self {
        Self { images: HashMap::new(), bytes: 0, most, clock: 0 }
    }

    /// True where there is an image of this name.
    pub fn has(&self, name: Name) -> bool {
        self.images.contains_key(&name)
    }

    /// The image of this name, which counts as used now.
    pub fn get(&mut self, name: Name) -> Option<&T> {
        self.touch(name);
        self.images.get(&name).map(|stored| &stored.image)
    }

    /// Lets the image of this name count as used now.
    pub fn touch(&mut self, name: Name) {
        self.clock += 1;
        if let Some(stored) = self.images.get_mut(&name) {
            stored.used = self.clock;
        }
    }

    /// The image of this name.
    pub fn peek(&self, name: Name) -> Option<&T> {
        self.images.get(&name).map(|stored| &stored.image)
    }

    /// Takes an image of `bytes` bytes in, and returns those that gave way for it: itself where it is larger than all may
    /// be together.
    pub fn put(&mut self, name: Name, image: T, bytes: u64) -> Vec<T> {
        let mut gone: Vec<T> = self.remove(name).into_iter().collect();
        if bytes > self.most {
            gone.push(image);
            return gone;
        }
        while self.bytes + bytes > self.most {
            let oldest = self.images.iter().min_by_key(|(_, stored)| stored.used).map(|(name, _)| *name);
            let Some(oldest) = oldest else { break };
            gone.extend(self.remove(oldest));
        }
        self.clock += 1;
        self.bytes += bytes;
        self.images.insert(name, Stored { image, bytes, used: self.clock });
        gone
    }

    fn remove(&mut self, name: Name) -> Option<T> {
        let stored = self.images.remove(&name)?;
        self.bytes -= stored.bytes;
        Some(stored.image)
    }

    /// True where there is any image of a frame.
    pub fn knows(&self, frame: i64) -> bool {
        self.images.keys().any(|(_, of)| *of == frame)
    }

    /// Most bytes of all images.
    pub fn most(&self) -> u64 {
        self.most
    }

    /// Bytes of all images.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Forgets all images.
    pub fn clear(&mut self) {
        self.images.clear();
        self.bytes = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_recently_used_gives_way() {
        let mut store = FrameStore::new(10);
        assert!(store.put((1, 1), "a", 4).is_empty() && store.put((1, 2), "b", 4).is_empty());
        assert_eq!(store.get((1, 1)), Some(&"a"));
        assert_eq!(store.put((1, 3), "c", 4), ["b"]);
        assert!(store.has((1, 1)) && !store.has((1, 2)) && store.bytes() == 8);
        assert_eq!(store.put((1, 1), "d", 2), ["a"]);
        assert_eq!((store.bytes(), store.peek((1, 1))), (6, Some(&"d")));
        assert_eq!(store.put((2, 1), "large", 11), ["large"]);
        assert_eq!(store.bytes(), 6);
        store.clear();
        assert!(store.bytes() == 0 && !store.has((1, 1)));
    }
}
