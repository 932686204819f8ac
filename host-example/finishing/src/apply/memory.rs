//! Memory that frames may take together.

use std::path::Path;
use std::str::FromStr;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::machine;
use isophote_files::error::Error;

/// A number of bytes as people write it: `4GiB`, `500MB`, `2G`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

/// Fewest bytes that a number without a unit stands for: nobody who writes less means bytes.
const FEWEST_BYTES: f64 = (1 << 20) as f64;

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "write a size such as 4GiB or 500MB".to_owned();
        let split = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
        let number: f64 = text[..split].parse().map_err(|_| wrong())?;
        let is_bare = text[split..].trim().is_empty();
        if is_bare && (1.0..FEWEST_BYTES).contains(&number) {
            return Err(format!("that is {number} bytes; write {number}GiB, or another size such as 500MB"));
        }
        let unit = match text[split..].trim().to_ascii_lowercase().as_str() {
            "" | "b" => 1.0,
            "k" | "kib" => 1024.0,
            "m" | "mib" => 1024.0 * 1024.0,
            "g" | "gib" => 1024.0 * 1024.0 * 1024.0,
            "kb" => 1e3,
            "mb" => 1e6,
            "gb" => 1e9,
            _ => return Err(wrong()),
        };
        let bytes = number * unit;
        if (1.0..1e18).contains(&bytes) { Ok(Self(bytes as u64)) } else { Err(wrong()) }
    }
}

impl std::fmt::Display for Bytes {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const MIB: u64 = 1 << 20;
        if self.0 < 10 * MIB {
            write!(f, "{}KiB", self.0.div_ceil(1 << 10))
        } else if self.0 >= 10 << 30 {
            write!(f, "{}GiB", self.0.div_ceil(1 << 30))
        } else {
            write!(f, "{}MiB", self.0.div_ceil(MIB))
        }
    }
}

/// Memory that a frame needs, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// From being read to being written.
    pub frame: u64,
    /// While it is filtered, beside that.
    pub filter: u64,
}

/// Memory that frames in flight share.
#[derive(Debug)]
pub struct Budget {
    most: u64,
    filtered_at_once: usize,
    reserved: Mutex<Vec<(u64, Needs)>>,
    freed: Condvar,
}

/// A frame's share of a budget, given back when dropped.
#[derive(Debug)]
pub struct Share<'a> {
    budget: &'a Budget,
    number: u64,
}

impl Needs {
    /// Both together.
    pub fn total(self) -> u64 {
        self.frame.saturating_add(self.filter)
    }

    /// Needs of so many frames of which one is filtered.
    pub fn of(self, frames: u64) -> Self {
        Self { frame: self.frame.saturating_mul(frames), filter: self.filter }
    }
}

impl Budget {
    /// So many bytes for all frames together, of which so many are filtered at once.
    pub fn new(most: u64, filtered_at_once: usize) -> Self {
        Self { most, filtered_at_once, reserved: Mutex::new(Vec::new()), freed: Condvar::new() }
    }

    /// Room for a frame of which nothing is known yet. One thread takes frames.
    pub fn share(&self) -> Share<'_> {
        let mut reserved = self.reserved();
        let number = reserved.last().map_or(0, |(last, _)| last + 1);
        reserved.push((number, Needs::default()));
        Share { budget: self, number }
    }

    fn reserved(&self) -> MutexGuard<'_, Vec<(u64, Needs)>> {
        self.reserved.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Share<'_> {
    /// Waits until there is room for what the frame is now known to need; so many bytes will be held together before any
    /// is given back.
    ///
    /// # Errors
    /// The whole budget, when that is less than those.
    pub fn grow(&self, needs: Needs, together: u64) -> Result<(), Bytes> {
        let most = self.budget.most;
        if together > most {
            return Err(Bytes(most));
        }
        let mut reserved = self.budget.reserved();
        loop {
            let others =
                || reserved.iter().filter(|(number, _)| *number != self.number).map(|(_, needs)| needs);
            let frames = others().map(|needs| needs.frame).fold(needs.frame, u64::saturating_add);
            let mut filters: Vec<u64> = others().map(|needs| needs.filter).chain([needs.filter]).collect();
            filters.sort_unstable();
            let most_at_once = filters.iter().rev().take(self.budget.filtered_at_once);
            let filter = most_at_once.copied().fold(0, u64::saturating_add);
            if frames.saturating_add(filter) <= most {
                break;
            }
            reserved = self.budget.freed.wait(reserved).unwrap_or_else(PoisonError::into_inner);
        }
        if let Some((_, own)) = reserved.iter_mut().find(|(number, _)| *number == self.number) {
            *own = needs;
        }
        Ok(())
    }
}

impl Drop for Share<'_> {
    fn drop(&mut self) {
        self.budget.reserved().retain(|(number, _)| *number != self.number);
        self.budget.freed.notify_all();
    }
}

/// The error of frames that need more memory than all may take together, `count` of which are held at the same time.
pub fn too_large(path: &Path, count: u64, needs: Needs, most: Bytes) -> Error {
    let needed = Bytes(needs.total());
    let (who, fix) = match count {
        0 | 1 => ("a frame needs".to_owned(), "give more by --memory"),
        _ => (
            format!("{count} frames that depend on each other need"),
            "give more by --memory, or a smaller window",
        ),
    };
    Error::file(path, format!("{who} about {needed} of memory, and {most} may be used"), fix)
}

/// Memory of a machine that does not tell.
const UNKNOWN: u64 = 4 << 30;

/// Memory of a run that is given no bound: half of what nobody uses.
pub fn usual() -> Bytes {
    Bytes(machine::free().map_or(UNKNOWN, |bytes| bytes / 2))
}

/// Memory of one picture in a program that somebody works with: half of what the machine has, or 4 GiB of it.
pub fn half() -> Bytes {
    Bytes(machine::memory().map_or(UNKNOWN, |bytes| (bytes / 2).max(bytes.min(UNKNOWN))))
}

/// Memory of frames that such a program keeps although it could read them again.
pub fn kept() -> Bytes {
    Bytes(machine::memory().map_or(UNKNOWN, |bytes| bytes.min(UNKNOWN)) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        for (text, bytes) in
            [("4GiB", 4 << 30), ("1.5k", 1536), ("500MB", 500_000_000), ("7b", 7), ("4194304", 4 << 20)]
        {
            assert_eq!(text.parse(), Ok(Bytes(bytes)));
        }
        assert_eq!(
            "4".parse::<Bytes>(),
            Err("that is 4 bytes; write 4GiB, or another size such as 500MB".to_owned())
        );
        for bad in ["", "x", "7", "-1G", "0", "4 parsecs", "1e99"] {
            assert!(bad.parse::<Bytes>().is_err(), "{bad}");
        }
    }

    #[test]
    fn frames_wait_for_room_and_one_is_filtered_at_a_time() {
        let budget = Budget::new(20, 1);
        let needs = |frame, filter| Needs { frame, filter };
        let large = budget.share();
        assert_eq!(large.grow(needs(15, 6), 21), Err(Bytes(20)));
        drop(large);
        let (a, b) = (budget.share(), budget.share());
        // What both need of the filter counts once.
        a.grow(needs(5, 10), 15).unwrap();
        b.grow(needs(5, 8), 13).unwrap();
        std::thread::scope(|scope| {
            let third = scope.spawn(|| {
                let share = budget.share();
                share.grow(needs(1, 0), 1).unwrap();
                share.grow(needs(5, 0), 5).unwrap();
            });
            drop(a);
            third.join().unwrap();
        });
        drop(b);
        assert!(budget.reserved().is_empty());
    }
}
