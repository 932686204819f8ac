//! Ending a long run early, with whole files only.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};

/// Whether a run is to end after what is being done now.
#[derive(Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Requested by the first Ctrl-C or termination; the second ends the process at once.
    pub fn on_signals() -> Self {
        let stop = Self::default();
        for (signal, code) in [(SIGINT, 130), (SIGTERM, 143)] {
            // Where signals cannot be caught they end the process, which leaves whole files too.
            let _ = signal_hook::flag::register_conditional_shutdown(signal, code, Arc::clone(&stop.0));
            let _ = signal_hook::flag::register(signal, Arc::clone(&stop.0));
        }
        stop
    }

    /// Whether it was requested.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
