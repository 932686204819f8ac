//! Ending a long run early, with whole files only.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use crate::error::Error;
use crate::output;
use crate::temporary;

/// Time between two looks at whether the process is to end.
const TICK: Duration = Duration::from_millis(40);

/// Exit code of a process that Ctrl-C ends at once.
const BY_KEYBOARD: i32 = 130;

/// Time that what is nearly done may take then.
const GRACE: Duration = Duration::from_millis(300);

/// Request that a run ends after what is being done now.
#[derive(Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Requested by the first Ctrl-C or termination; the second ends the process at once.
    pub fn on_signals() -> Self {
        let stop = Self::default();
        stop.listen();
        stop
    }

    #[cfg(not(windows))]
    fn listen(&self) {
        use signal_hook::consts::{SIGINT, SIGTERM};
        for (signal, code) in [(SIGINT, BY_KEYBOARD), (SIGTERM, 143)] {
            // Where signals cannot be caught they end the process, which leaves whole files too.
            let _ = signal_hook::flag::register_conditional_shutdown(signal, code, Arc::clone(&self.0));
            let _ = signal_hook::flag::register(signal, Arc::clone(&self.0));
        }
    }

    /// Windows tells it to a thread of its own. Its signals are those of the C library, of which not every one knows how to say
    /// what was asked for before: Wine's would call that as a function.
    #[cfg(windows)]
    fn listen(&self) {
        let requested = Arc::clone(&self.0);
        let end = move || {
            if requested.swap(true, Ordering::Relaxed) {
                signal_hook::low_level::exit(BY_KEYBOARD);
            }
        };
        // As above.
        let _ = ctrlc::set_handler(end);
    }

    /// True where it was requested.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// For a run that makes one thing only: when the end is requested, the process ends soon, whatever it does, and
    /// leaves nothing that is not whole.
    pub fn ends_the_process(&self, thing: &str) {
        let requested = Arc::clone(&self.0);
        let error = Error::failure(format!("stopped before {thing} was written"), "start again");
        let watch = move || {
            while !requested.load(Ordering::Relaxed) {
                thread::sleep(TICK);
            }
            thread::sleep(GRACE);
            output::complain(&error);
            temporary::abandon(error.exit_code())
        };
        // Without a thread to spare the run ends after what is being done.
        let _ = thread::Builder::new().name("end".into()).spawn(watch);
    }
}
