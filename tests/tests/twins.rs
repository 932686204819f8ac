//! Both twins of every kernel on equal input: the difference stays below the tolerance that the
//! kernel declares. Shaders that can hold windows in workgroup memory are tried with and without.
//!
//! And that comparison is worth something: a shader with one number changed is noticed.

mod fast;
mod spoiled;
mod tally;

use isophote::kernels::KERNELS;
use isophote_engine::Kernel;
use isophote_tests::device;
use isophote_tests::sweep::{self, Step};
use isophote_tests::trials::{Report, Trials};
use std::sync::{Arc, OnceLock};
use tally::Tally;

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    // Both tests look at the same steps, which are computed by whoever comes first.
    let kernels: Vec<_> = KERNELS.iter().map(|kernel| (*kernel, Arc::new(OnceLock::new()))).collect();
    for (kernel, steps) in kernels.clone() {
        trials
            .add("twins", kernel.name, move || agreement(kernel, steps.get_or_init(|| sweep::steps(kernel))));
    }
    for (kernel, steps) in kernels.clone() {
        trials.add("fast", kernel.name, move || {
            fast::agreement(kernel, steps.get_or_init(|| sweep::steps(kernel)))
        });
    }
    for (kernel, steps) in kernels {
        trials.add("spoiled", kernel.name, move || {
            spoiled::notice(kernel, steps.get_or_init(|| sweep::steps(kernel)))
        });
    }
}

fn agreement(kernel: &'static Kernel, steps: &[Step]) -> Option<Report> {
    let mut devices = vec![device::executor(kernel.name)?];
    if kernel.shader.contains("override shared_windows") {
        let other = !devices[0].device().shares_windows();
        devices.push(device::executor_with_windows(kernel.name, other)?);
    }
    let mut tally = Tally::default();
    for step in steps {
        if let Err(failure) = tally.compare(step, &mut devices) {
            tally.failures.push(failure);
        }
    }
    Some(tally.report("twins", kernel.name, &kernel.tolerance))
}
