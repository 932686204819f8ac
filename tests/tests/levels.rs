//! Every kernel's CPU twin with every instruction set that this build knows and this machine has: within the
//! tolerance that the kernel declares, and the same bits wherever multiplication and addition are fused.
//! Builds without debug assertions know one set more (`cargo test --release --workspace --test levels`).

use isophote_engine::Image;
use isophote_engine::cpu::{CallingThread, Control, CpuExecutor};
use isophote_engine::dispatch::levels;
use isophote_tests::compare::Difference;
use isophote_tests::sweep::{Step, sweep};

fn bits(image: &Image) -> impl Iterator<Item = u32> {
    image.data().iter().map(|value| value.to_bits())
}

/// How the results of a step with one instruction set depart from those with the widest.
fn departures(step: &Step, results: &[Image], fused: bool) -> Vec<String> {
    let mut found = Vec::new();
    for (index, (widest, other)) in step.outputs.iter().zip(results).enumerate() {
        let difference = Difference::between(widest, other, &step.kernel.tolerance);
        if fused && !bits(widest).eq(bits(other)) {
            found.push(format!("{} output {index}: other bits, worst at {}", step.label, difference.place));
        } else if !difference.is_within(&step.kernel.tolerance) {
            let Difference { outliers, values, place, .. } = difference;
            found.push(format!(
                "{} output {index}: {outliers} of {values} differ, worst at {place}",
                step.label
            ));
        }
    }
    found
}

#[test]
fn every_twin_agrees_with_itself_on_all_instruction_sets() {
    let levels = levels();
    let names: Vec<&str> = levels.iter().map(|(name, _)| *name).collect();
    println!("instruction sets: {}", names.join(", "));
    let mut executors: Vec<CpuExecutor> = levels.iter().map(|(_, l)| CpuExecutor::with_level(*l)).collect();
    let (mut wrong, mut compared) = (Vec::new(), 0);
    // What a step gave before was computed with the widest, the last.
    let others = levels.len() - 1;
    sweep(|step| {
        let plan = step.plan_with(step.kernel);
        for (executor, name) in executors[..others].iter_mut().zip(&names) {
            let results =
                executor.run(&plan, &step.named_inputs(), step.region(), &CallingThread, Control::default());
            let found = departures(step, &results.unwrap(), *name != "SSE2");
            wrong.extend(found.into_iter().map(|departure| format!("{name}: {departure}")));
            compared += 1;
        }
    });
    println!("{compared} comparisons, {} fail", wrong.len());
    assert!(compared > 0 || others == 0, "nothing was compared");
    wrong.truncate(40);
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
