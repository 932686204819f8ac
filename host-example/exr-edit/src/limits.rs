//! Memory that a file may take.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result};

/// Limits on what reading and writing a file may take of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of memory that all allocations may take together whose size the file decides: its lists of channels and
    /// chunks, decompressed chunks, planes, and what codecs need meanwhile. The bytes that are given to
    /// [`File::parse`](crate::File::parse) are the caller's and do not count.
    pub memory: u64,
    /// Most pixels of a part at full resolution.
    pub pixels: u64,
}

impl Default for Limits {
    /// 8 GiB, 2^28 pixels.
    fn default() -> Self {
        Self { memory: 8 << 30, pixels: 1 << 28 }
    }
}

/// The part of the limit that is in use.
#[derive(Debug)]
pub struct Budget {
    limit: u64,
    used: AtomicU64,
}

/// Bytes of a budget, given back when dropped.
#[derive(Debug)]
pub struct Reserved {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Budget {
    /// Nothing is in use yet.
    pub fn new(limits: Limits) -> Arc<Self> {
        Arc::new(Self { limit: limits.memory, used: AtomicU64::new(0) })
    }

    /// Takes bytes out of the budget, before they are allocated.
    ///
    /// # Errors
    /// [`Error::Memory`] when fewer are left.
    pub fn reserve(self: &Arc<Self>, bytes: u64) -> Result<Reserved> {
        let more = |used: u64| used.checked_add(bytes).filter(|sum| *sum <= self.limit);
        match self.used.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more) {
            Ok(_) => Ok(Reserved { budget: Arc::clone(self), bytes }),
            Err(used) => Err(Error::Memory { needed: bytes, left: self.limit - used, limit: self.limit }),
        }
    }

    /// As [`reserve`](Self::reserve), for `count` things of the type `T`.
    ///
    /// # Errors
    /// [`Error::Memory`] when fewer bytes are left.
    pub fn reserve_many<T>(self: &Arc<Self>, count: usize) -> Result<Reserved> {
        self.reserve((count as u64).saturating_mul(size_of::<T>() as u64))
    }
}

impl Reserved {
    /// Adds another share, so that both are given back together.
    pub fn join(&mut self, mut other: Self) {
        self.bytes += std::mem::take(&mut other.bytes);
    }
}

impl Drop for Reserved {
    fn drop(&mut self) {
        self.budget.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_dropped_is_given_back() {
        let budget = Budget::new(Limits { memory: 100, ..Limits::default() });
        let mut reservation = budget.reserve(60).unwrap();
        assert!(matches!(budget.reserve(41), Err(Error::Memory { needed: 41, left: 40, limit: 100 })));
        reservation.join(budget.reserve(40).unwrap());
        assert!(budget.reserve(1).is_err());
        drop(reservation);
        assert!(budget.reserve(u64::MAX).is_err());
        assert!(budget.reserve_many::<u32>(25).is_ok());
    }
}
