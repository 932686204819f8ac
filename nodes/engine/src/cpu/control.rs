//! Messages between a caller and a run: what it hears of it and says to it.

use crate::error::{Error, Result};
use std::time::Duration;

/// Means by which the caller watches and stops a run.
#[derive(Clone, Copy, Default)]
pub struct Control<'a> {
    /// Asked often, from any thread; true stops the run.
    pub cancelled: Option<&'a (dyn Fn() -> bool + Sync)>,
    /// Called with the share of the work done, 0..=1, from the calling thread.
    pub progress: Option<&'a dyn Fn(f32)>,
}

impl Control<'_> {
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancelled.is_some_and(|c| c())
    }

    /// Fails when the caller asks to stop.
    pub(crate) fn check(&self) -> Result<()> {
        if self.is_cancelled() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// Time that one pass took.
#[derive(Clone, Debug)]
pub struct PassTime {
    /// The kernel's name.
    pub kernel: String,
    /// Wall-clock time.
    pub time: Duration,
    /// Output pixels computed.
    pub pixels: u64,
}
