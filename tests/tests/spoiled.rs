//! The comparison of twins is worth something: a shader with one number changed is noticed.

use isophote::kernels::KERNELS;
use isophote_engine::Kernel;
use isophote_engine::cpu::Control;
use isophote_engine::gpu::Executor;
use isophote_tests::compare::Difference;
use isophote_tests::shaders::{Spoiled, spoil};
use isophote_tests::sweep::{Step, sweep};
use isophote_tests::{cases, device};
use std::collections::BTreeMap;

/// Comparisons kept per kernel; more only cost time.
const STEPS: usize = 48;

/// Changes tried per kernel.
const CHANGES: usize = 6;

#[test]
fn a_changed_number_in_a_shader_is_noticed() {
    // Shaders do more where windows are in workgroup memory.
    let Some(mut gpu) = device::executor_with_windows("a_changed_number_in_a_shader_is_noticed", true) else {
        return;
    };
    let mut steps: BTreeMap<&str, Vec<Step>> = BTreeMap::new();
    sweep(|step| {
        let kept = steps.entry(step.kernel.name).or_default();
        // The first ones are of the smallest pictures; later ones take their places in turn.
        let place = (step.label.len() + kept.len() * 7) % STEPS;
        if kept.len() < STEPS {
            kept.push(step.clone());
        } else {
            kept[place] = step.clone();
        }
    });
    let mut unnoticed = Vec::new();
    for kernel in KERNELS {
        if cases::only_some() && !steps.contains_key(kernel.name) {
            continue;
        }
        let steps = steps.get(kernel.name).map_or(&[][..], Vec::as_slice);
        let changes = spoil(kernel);
        let tried: Vec<(&Spoiled, Option<String>)> =
            changes.iter().take(CHANGES).map(|c| (c, notice(&mut gpu, kernel, c, steps))).collect();
        for (change, noticed) in &tried {
            let outcome = noticed.as_deref().unwrap_or("NOT NOTICED");
            println!("{:28} {}: {outcome}", kernel.name, change.change);
        }
        // Some numbers only guard what rarely happens; most must matter.
        let noticed = tried.iter().filter(|(_, noticed)| noticed.is_some()).count();
        if noticed == 0 || 3 * noticed < tried.len() {
            unnoticed.push(format!(
                "{}: only {noticed} of {} changes were noticed",
                kernel.name,
                tried.len()
            ));
        }
    }
    assert!(unnoticed.is_empty(), "\n{}", unnoticed.join("\n"));
}

/// Where the changed shader breaks the tolerance, if anywhere. A shader that no longer compiles counts
/// for nothing: it must run and differ.
fn notice(gpu: &mut Executor, kernel: &'static Kernel, change: &Spoiled, steps: &[Step]) -> Option<String> {
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
    let Kernel { name, shader, inputs, outputs, params_size, cpu, cost, tolerance } = *kernel;
    Kernel { name, shader, inputs, outputs, params_size, cpu, cost, tolerance }
}
