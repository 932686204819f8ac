//! Every kernel's CPU twin with every instruction set that this build knows and this machine has: within the
//! tolerance that the kernel declares, and the same bits wherever multiplication and addition are fused.
//! Builds without debug assertions know one set more (`cargo test --release --workspace --test trials -- --file levels`).

use isophote::kernels::KERNELS;
use isophote_engine::dispatch::levels;
use isophote_engine::{Image, Kernel};
use isophote_tests::compare::Difference;
use isophote_tests::sweep::{self, Step};
use isophote_tests::trials::Trials;

/// Adds the trials of this file.
pub fn add(trials: &mut Trials) {
    for kernel in KERNELS {
        trials.add("levels", kernel.name, || departures_of(kernel));
    }
}

/// Departures of the results of a kernel with the other instruction sets from those with the widest, which are
/// those of its steps.
fn departures_of(kernel: &'static Kernel) -> Vec<String> {
    let steps = sweep::steps(kernel);
    let mut wrong = Vec::new();
    if steps.is_empty() {
        wrong.push("no node reaches it".to_owned());
    }
    for (name, level) in levels() {
        for step in &steps {
            let found = departures(step, &step.on_cpu(level), name != "SSE2");
            wrong.extend(found.into_iter().map(|departure| format!("{name}: {departure}")));
        }
    }
    wrong.truncate(8);
    wrong
}

fn departures(step: &Step, results: &[Image], fused: bool) -> Vec<String> {
    let mut found = Vec::new();
    for (index, (widest, other)) in step.outputs.iter().zip(results).enumerate() {
        let difference = Difference::between(widest, other, &step.kernel.tolerance);
        let Difference { outliers, values, place, .. } = &difference;
        if fused && !bits(widest).eq(bits(other)) {
            found.push(format!("{} output {index}: other bits, worst at {place}", step.label));
        } else if !difference.is_within(&step.kernel.tolerance) {
            found.push(format!(
                "{} output {index}: {outliers} of {values} differ, worst at {place}",
                step.label
            ));
        }
    }
    found
}

fn bits(image: &Image) -> impl Iterator<Item = u32> {
    image.data().iter().map(|value| value.to_bits())
}
