//! The graphics device of the tests.

use isophote_engine::gpu::{Device, Executor, Options};
use std::sync::{Arc, OnceLock};

/// The device that all tests of a binary share, or `None`, loudly, where there is none.
///
/// # Panics
/// Where a device is required (`CI=true` or `ISOPHOTE_REQUIRE_GPU=1`) and none can be opened.
pub fn device(test: &str) -> Option<Arc<Device>> {
    static DEVICE: OnceLock<Result<Arc<Device>, String>> = OnceLock::new();
    let opened = DEVICE.get_or_init(|| {
        let options = Options { timestamps: true, ..Options::default() };
        Device::open(&options).map_err(|e| e.to_string())
    });
    match opened {
        Ok(device) => Some(Arc::clone(device)),
        Err(reason) => {
            assert!(!is_required(), "{test} needs a graphics device: {reason}");
            eprintln!("\n*** SKIPPED: {test} had no graphics device: {reason} ***\n");
            None
        }
    }
}

/// An executor on [`device`] that keeps little memory, since the tests' shapes rarely repeat.
///
/// # Panics
/// As [`device`].
pub fn executor(test: &str) -> Option<Executor> {
    let device = device(test)?;
    let mut executor = Executor::new(Arc::clone(&device));
    executor.set_limits(device.max_side(), 48 << 20);
    Some(executor)
}

/// An executor on a device of its own that reads windows of neighbours from workgroup memory, or tap by tap,
/// whatever is faster there.
///
/// # Panics
/// As [`device`], and where the device cannot be opened twice.
pub fn executor_with_windows(test: &str, shared: bool) -> Option<Executor> {
    device(test)?;
    match Device::open(&Options { shared_windows: Some(shared), ..Options::default() }) {
        Ok(device) => {
            let mut executor = Executor::new(Arc::clone(&device));
            executor.set_limits(device.max_side(), 48 << 20);
            Some(executor)
        }
        Err(e) => panic!("{test} needs a second graphics device: {e}"),
    }
}

fn is_required() -> bool {
    let is = |name: &str, value: &str| std::env::var(name).is_ok_and(|v| v == value);
    is("CI", "true") || is("ISOPHOTE_REQUIRE_GPU", "1")
}
