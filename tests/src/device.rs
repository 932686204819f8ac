//! The graphics device of the tests.

use isophote_engine::gpu::{Device, Executor, Options};
use std::sync::{Arc, OnceLock};

/// The device that all tests of a process share, or `None`, loudly, where there is none.
///
/// # Panics
/// Panics where a device is required (`CI=true` or `ISOPHOTE_REQUIRE_GPU=1`) and none can be opened.
pub fn device(test: &str) -> Option<Arc<Device>> {
    static DEVICE: Opened = OnceLock::new();
    match open(&DEVICE, None) {
        Ok(device) => Some(device),
        Err(reason) => {
            assert!(!is_required(), "{test} needs a graphics device: {reason}");
            eprintln!("\n*** SKIPPED: {test} had no graphics device: {reason} ***\n");
            None
        }
    }
}

type Opened = OnceLock<Result<Arc<Device>, String>>;

fn open(cell: &Opened, shared_windows: Option<bool>) -> Result<Arc<Device>, String> {
    let options = Options { timestamps: true, shared_windows, ..Options::default() };
    cell.get_or_init(|| Device::open(&options).map_err(|e| e.to_string())).clone()
}

/// An executor on [`device`] that keeps little memory, since the tests' shapes rarely repeat.
///
/// # Panics
/// As [`device`].
pub fn executor(test: &str) -> Option<Executor> {
    device(test).map(frugal)
}

/// An executor that reads windows of neighbours from workgroup memory, or tap by tap, whatever is faster on
/// the device. All that read them in the way that [`device`] does not share a second one.
///
/// # Panics
/// As [`device`], and where the device cannot be opened twice.
pub fn executor_with_windows(test: &str, shared: bool) -> Option<Executor> {
    static OTHER: Opened = OnceLock::new();
    let usual = device(test)?;
    if usual.shares_windows() == shared {
        return Some(frugal(usual));
    }
    match open(&OTHER, Some(shared)) {
        Ok(device) => Some(frugal(device)),
        Err(e) => panic!("{test} needs a second graphics device: {e}"),
    }
}

fn frugal(device: Arc<Device>) -> Executor {
    let mut executor = Executor::new(Arc::clone(&device));
    executor.set_limits(device.max_side(), 48 << 20);
    executor
}

fn is_required() -> bool {
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|v| v == value);
    is("CI", "true") || is("ISOPHOTE_REQUIRE_GPU", "1")
}
