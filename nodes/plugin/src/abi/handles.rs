//! Handles: numbers that name an object, so that a stale, foreign or invented one is noticed.
//!
//! A handle is the kind of the object (8 bits), the generation of its slot (32 bits) and the slot (24
//! bits). A slot's generation grows with every object that leaves it, so that no handle is ever
//! given out twice.

use super::failure::{Failure, Outcome};
use isophote_abi::{
    ISOPHOTE_ERROR_INVALID_HANDLE, ISOPHOTE_ERROR_OUT_OF_MEMORY, IsophoteDevice, IsophoteGraph, IsophotePlan,
    IsophoteSequence, IsophoteStyle, IsophoteVulkan, IsophoteVulkanEffect,
};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// A handle as hosts hold it, of a type of its own.
pub trait Handle: Copy {
    /// Of a number.
    fn new(id: u64) -> Self;
    /// The number.
    fn id(self) -> u64;
}

macro_rules! handles {
    ($($handle:ident),*) => {
        $(impl Handle for $handle {
            fn new(id: u64) -> Self {
                Self { id }
            }

            fn id(self) -> u64 {
                self.id
            }
        })*
    };
}

handles!(
    IsophoteGraph,
    IsophotePlan,
    IsophoteDevice,
    IsophoteSequence,
    IsophoteStyle,
    IsophoteVulkan,
    IsophoteVulkanEffect
);

/// Object that hosts hold handles of.
pub trait Object: Send + Sync + Sized + 'static {
    /// Its handles.
    type Handle: Handle;
    /// All objects of the kind.
    fn slots() -> &'static Slots<Self>;
    /// Message of the last failure.
    fn message(&self) -> &Mutex<String>;
}

/// Makes a type with a field `message` an [`Object`]: its handles, the number of its kind and its name for messages.
macro_rules! object {
    ($object:ident, $handle:ident, $kind:literal, $name:literal) => {
        impl $crate::abi::handles::Object for $object {
            type Handle = $handle;

            fn slots() -> &'static $crate::abi::handles::Slots<Self> {
                static SLOTS: $crate::abi::handles::Slots<$object> =
                    $crate::abi::handles::Slots::new($kind, $name);
                &SLOTS
            }

            fn message(&self) -> &std::sync::Mutex<String> {
                &self.message
            }
        }
    };
}

pub(super) use object;

/// All objects of one kind.
#[derive(Debug)]
pub struct Slots<T> {
    kind: u8,
    name: &'static str,
    entries: RwLock<Entries<T>>,
}

#[derive(Debug)]
struct Entries<T> {
    slots: Vec<Slot<T>>,
    free: Vec<u32>,
}

#[derive(Debug)]
struct Slot<T> {
    generation: u32,
    object: Option<Arc<T>>,
}

const INDEX_BITS: u32 = 24;
const MOST: usize = 1 << INDEX_BITS;

impl<T> Slots<T> {
    /// No objects yet; `kind` is above 0 and unique, `name` is for messages.
    pub const fn new(kind: u8, name: &'static str) -> Self {
        Self { kind, name, entries: RwLock::new(Entries { slots: Vec::new(), free: Vec::new() }) }
    }

    /// Takes an object in and gives it a handle.
    ///
    /// # Errors
    /// Out of memory at the 16,777,216th object.
    pub fn insert(&self, object: T) -> Outcome<u64> {
        let object = Some(Arc::new(object));
        let mut guard = self.entries.write().unwrap_or_else(PoisonError::into_inner);
        let entries = &mut *guard;
        let index = match entries.free.pop() {
            Some(index) => index as usize,
            None if entries.slots.len() == MOST => {
                return Err(Failure::new(
                    ISOPHOTE_ERROR_OUT_OF_MEMORY,
                    format!("there are {MOST} {}s already; destroy some", self.name),
                ));
            }
            None => {
                entries.slots.push(Slot { generation: 1, object: None });
                entries.slots.len() - 1
            }
        };
        let slot = &mut entries.slots[index];
        slot.object = object;
        Ok(u64::from(self.kind) << 56 | u64::from(slot.generation) << INDEX_BITS | index as u64)
    }

    /// The object of a handle.
    ///
    /// # Errors
    /// Invalid handle.
    pub fn get(&self, handle: u64) -> Outcome<Arc<T>> {
        let (index, generation) = self.parts(handle)?;
        let entries = self.entries.read().unwrap_or_else(PoisonError::into_inner);
        entries
            .slots
            .get(index)
            .filter(|slot| slot.generation == generation)
            .and_then(|slot| slot.object.clone())
            .ok_or_else(|| self.stale(handle))
    }

    /// Takes the object of a handle out.
    ///
    /// # Errors
    /// Invalid handle.
    pub fn remove(&self, handle: u64) -> Outcome<Arc<T>> {
        let (index, generation) = self.parts(handle)?;
        let mut guard = self.entries.write().unwrap_or_else(PoisonError::into_inner);
        let entries = &mut *guard;
        let Some(slot) = entries.slots.get_mut(index).filter(|slot| slot.generation == generation) else {
            return Err(self.stale(handle));
        };
        let object = slot.object.take().ok_or_else(|| self.stale(handle))?;
        // A slot whose generations are used up is not used again.
        if let Some(next) = slot.generation.checked_add(1) {
            slot.generation = next;
            entries.free.push(index as u32);
        }
        Ok(object)
    }

    /// All objects.
    pub fn all(&self) -> Vec<Arc<T>> {
        let entries = self.entries.read().unwrap_or_else(PoisonError::into_inner);
        entries.slots.iter().filter_map(|slot| slot.object.clone()).collect()
    }

    fn parts(&self, handle: u64) -> Outcome<(usize, u32)> {
        if handle == 0 {
            return Err(Failure::new(ISOPHOTE_ERROR_INVALID_HANDLE, format!("the {} is 0", self.name)));
        }
        if (handle >> 56) as u8 != self.kind {
            let message = format!("{handle:#x} is no handle of a {}", self.name);
            return Err(Failure::new(ISOPHOTE_ERROR_INVALID_HANDLE, message));
        }
        Ok((handle as usize & (MOST - 1), (handle >> INDEX_BITS) as u32))
    }

    fn stale(&self, handle: u64) -> Failure {
        Failure::new(
            ISOPHOTE_ERROR_INVALID_HANDLE,
            format!("there is no {0} {handle:#x}; was it destroyed?", self.name),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_living_handles_of_the_kind_are_taken() {
        let words = Slots::new(7, "word");
        let numbers = Slots::new(8, "number");
        let a = words.insert("a").unwrap();
        let b = numbers.insert(1).unwrap();
        assert_ne!(a, b);
        assert_eq!(*words.get(a).unwrap(), "a");
        for wrong in [0, 1, b, a + 1, a + (1 << INDEX_BITS), u64::MAX] {
            assert_eq!(words.get(wrong).unwrap_err().status, ISOPHOTE_ERROR_INVALID_HANDLE, "{wrong:#x}");
            assert!(words.remove(wrong).is_err());
        }
        words.remove(a).unwrap();
        assert!(words.get(a).unwrap_err().message.contains("was it destroyed?"));
        // The slot is used again, the handle is not.
        let c = words.insert("c").unwrap();
        assert_ne!(a, c);
        assert_eq!(a as u32 & 0xff_ffff, c as u32 & 0xff_ffff);
        assert!(words.get(a).is_err());
        assert_eq!(words.all().len(), 1);
    }
}
