//! A shader with one number changed is noticed by the comparison of twins.

use isophote_engine::Kernel;
use isophote_engine::cpu::Control;
use isophote_engine::gpu::Executor;
use isophote_tests::compare::Difference;
use isophote_tests::device;
use isophote_tests::shaders::{Spoiled, spoil};
use isophote_tests::sweep::Step;

/// Comparisons that nearly all kernels show enough by; more only cost time.
const STEPS: usize = 48;

/// Changes tried per kernel.
const CHANGES: usize = 6;

/// Changes numbers of the shader, one at a time. Returns what is wrong.
pub fn notice(kernel: &'static Kernel, steps: &[Step]) -> Option<Vec<String>> {
    // Shaders do more where windows are in workgroup memory.
    let mut gpu = device::executor_with_windows(kernel.name, true)?;
    let changes = spoil(kernel);
    let changes = &changes[..changes.len().min(CHANGES)];
    let mut noticed = 0;
    // What a kernel does in few of its passes may be in none of a sample.
    for steps in [sample(steps, STEPS), steps.iter().collect()] {
        noticed = changes.iter().filter(|change| is_noticed(&mut gpu, kernel, change, &steps)).count();
        // Some numbers only guard what rarely happens; most must matter.
        if noticed > 0 && 3 * noticed >= changes.len() {
            return Some(Vec::new());
        }
    }
    Some(vec![format!("only {noticed} of {} changes were noticed", changes.len())])
}

/// True where a change breaks the tolerance; prints where.
fn is_noticed(gpu: &mut Executor, kernel: &'static Kernel, change: &Spoiled, steps: &[&Step]) -> bool {
    let outcome = difference(gpu, kernel, change, steps);
    let said = outcome.as_deref().unwrap_or("NOT NOTICED");
    println!("spoiled::{:28} {}: {said}", kernel.name, change.change);
    outcome.is_some()
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
