//! Memory that this process holds, where the system tells.

use std::fs;

/// Memory from some moment on.
#[derive(Clone, Copy, Debug)]
pub struct Resident {
    before: Option<u64>,
}

impl Resident {
    /// From now on.
    pub fn new() -> Self {
        // Elsewhere the peak since the start counts, which is no less.
        let _ = fs::write("/proc/self/clear_refs", "5");
        Self { before: status("VmRSS:") }
    }

    /// The most bytes that the process has held since.
    pub fn peak(self) -> Option<u64> {
        status("VmHWM:")
    }

    /// The most bytes that it has held since beside those that it held before.
    pub fn grown(self) -> Option<u64> {
        Some(self.peak()?.saturating_sub(self.before?))
    }
}

/// Bytes of a line of the system's account of this process.
fn status(name: &str) -> Option<u64> {
    if !cfg!(target_os = "linux") {
        // Wine opens Linux's files for programs of Windows, and this one is the account of whoever opens it.
        return None;
    }
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}
