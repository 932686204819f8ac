//! A shader with one number changed is noticed by the comparison of twins.

use isophote_engine::Kernel;
use isophote_engine::cpu::Control;
use isophote_engine::gpu::Executor;
use isophote_tests::compare::Difference;
use isophote_tests::device;
use isophote_tests::shaders::{Spoiled, spoil};
use isophote_tests::sweep::Step;

/// Comparisons kept per kernel; more only cost time.
const STEPS: usize = 48;

/// Changes tried per kernel.
const CHANGES: usize = 6;

/// Changes numbers of the shader, one at a time. Returns what is wrong.
pub fn notice(kernel: &'static Kernel, steps: &[Step]) -> Option<Vec<String>> {
    // Shaders do more where windows are in workgroup memory.
    let mut gpu = device::executor_with_windows(kernel.name, true)?;
    let steps = sample(steps, STEPS);
    let changes = spoil(kernel);
    let (mut tried, mut noticed) = (0, 0);
    for change in changes.iter().take(CHANGES) {
        let outcome = difference(&mut gpu, kernel, change, &steps);
        tried += 1;
        noticed += usize::from(outcome.is_some());
        let outcome = outcome.as_deref().unwrap_or("NOT NOTICED");
        println!("spoiled::{:28} {}: {outcome}", kernel.name, change.change);
    }
    // Some numbers only guard what rarely happens; most must matter.
    let enough = noticed > 0 && 3 * noticed >= tried;
    Some(if enough { Vec::new() } else { vec![format!("only {noticed} of {tried} changes were noticed")] })
}

/// At most so many of the steps, evenly from the smallest pictures to the largest.
pub fn sample(steps: &[Step], most: usize) -> Vec<&Step> {
    let stride = steps.len().div_ceil(most).max(1);
    // The last one, of a large picture, is always there.
    let mut kept: Vec<&Step> = steps.iter().rev().step_by(stride).collect();
    kept.reverse();
    kept
}

/// Place where the changed shader breaks the tolerance, if anywhere. A shader that no longer compiles counts
/// for nothing: it must run and differ.
fn difference(
    gpu: &mut Executor,
    kernel: &'static Kernel,
    change: &Spoiled,
    steps: &[&Step],
) -> Option<String> {
    let spoiled: &'static Kernel =
        Box::leak(Box::new(Kernel { shader: change.source.clone().leak(), ..copy(kernel) }));
    // Large pictures first: they show more.
    for step in steps.iter().rev() {
        let plan = step.plan_with(spoiled);
        let results = gpu.run_images(&plan, &step.named_inputs(), step.region(), Control::default()).ok()?;
        for (ours, theirs) in step.outputs.iter().zip(&results) {
            let difference = Difference::between(ours, theirs, &kernel.tolerance);
            if !difference.is_within(&kernel.tolerance) {
                return Some(format!("differs by {:.2e} at {}", difference.worst, difference.place));
            }
        }
    }
    None
}

fn copy(kernel: &Kernel) -> Kernel {
    let Kernel { name, shader, inputs, outputs, params_size, pieces, fusible, cpu, cost, tolerance, fast } =
        *kernel;
    Kernel { name, shader, inputs, outputs, params_size, pieces, fusible, cpu, cost, tolerance, fast }
}
