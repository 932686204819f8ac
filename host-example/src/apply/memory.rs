//! How much memory frames may take together.

use std::str::FromStr;
use std::sync::{Condvar, Mutex, PoisonError};

/// A number of bytes as people write it: `4GiB`, `500MB`, `2G`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bytes(pub u64);

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "write a size such as 4GiB or 500MB".to_owned();
        let split = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
        let number: f64 = text[..split].parse().map_err(|_| wrong())?;
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
        if self.0 >= 10 << 30 {
            write!(f, "{}GiB", self.0.div_ceil(1 << 30))
        } else {
            write!(f, "{}MiB", self.0.div_ceil(MIB))
        }
    }
}

/// Memory that frames in flight share.
#[derive(Debug)]
pub struct Budget {
    most: u64,
    used: Mutex<u64>,
    freed: Condvar,
}

/// A frame's share of a budget, given back when dropped.
#[derive(Debug)]
pub struct Share<'a> {
    budget: &'a Budget,
    bytes: u64,
}

impl Budget {
    /// So many bytes for all frames together.
    pub fn new(most: u64) -> Self {
        Self { most, used: Mutex::new(0), freed: Condvar::new() }
    }

    /// Waits until there is room. One frame always has room.
    pub fn share(&self, bytes: u64) -> Share<'_> {
        let mut used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        while *used > 0 && *used + bytes > self.most {
            used = self.freed.wait(used).unwrap_or_else(PoisonError::into_inner);
        }
        *used += bytes;
        Share { budget: self, bytes }
    }
}

impl Drop for Share<'_> {
    fn drop(&mut self) {
        *self.budget.used.lock().unwrap_or_else(PoisonError::into_inner) -= self.bytes;
        self.budget.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        for (text, bytes) in [("4GiB", 4 << 30), ("1.5k", 1536), ("500MB", 500_000_000), ("7", 7)] {
            assert_eq!(text.parse(), Ok(Bytes(bytes)));
        }
        for bad in ["", "x", "-1G", "0", "4 parsecs", "1e99"] {
            assert!(bad.parse::<Bytes>().is_err(), "{bad}");
        }
    }

    #[test]
    fn one_frame_always_has_room() {
        let budget = Budget::new(10);
        let large = budget.share(1000);
        drop(large);
        let (a, b) = (budget.share(5), budget.share(5));
        std::thread::scope(|scope| {
            let third = scope.spawn(|| drop(budget.share(5)));
            drop(a);
            third.join().unwrap();
        });
        drop(b);
        assert_eq!(*budget.used.lock().unwrap(), 0);
    }
}
