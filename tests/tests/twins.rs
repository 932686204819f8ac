//! Both twins of every kernel on equal input: the difference stays below the tolerance that the
//! kernel declares. Shaders that can hold windows in workgroup memory are tried with and without.

use isophote::kernels::KERNELS;
use isophote_engine::cpu::Control;
use isophote_engine::gpu::Executor;
use isophote_tests::compare::Difference;
use isophote_tests::sweep::sweep;
use isophote_tests::{cases, device};
use std::collections::BTreeMap;

#[derive(Default)]
struct Tally {
    runs: usize,
    values: usize,
    outliers: usize,
    worst: f32,
    ratio: f32,
    failures: Vec<String>,
}

#[test]
fn every_shader_agrees_with_its_cpu_twin() {
    let Some(mut gpu) = device::executor("every_shader_agrees_with_its_cpu_twin") else { return };
    let shared = !gpu.device().shares_windows();
    let Some(mut other) = device::executor_with_windows("every_shader_agrees_with_its_cpu_twin", shared)
    else {
        return;
    };
    println!("device: {}", gpu.device().name());
    let mut tallies: BTreeMap<&str, Tally> = KERNELS.iter().map(|k| (k.name, Tally::default())).collect();
    sweep(|step| {
        let tally = tallies.entry(step.kernel.name).or_default();
        tally.runs += 1;
        let plan = step.plan_with(step.kernel);
        let run = |gpu: &mut Executor| {
            gpu.run_images(&plan, &step.named_inputs(), step.region(), Control::default())
        };
        let mut runs = vec![run(&mut gpu)];
        if step.kernel.shader.contains("override shared_windows") {
            runs.push(run(&mut other));
        }
        for results in runs {
            let results = match results {
                Ok(results) => results,
                Err(e) => {
                    tally.failures.push(format!("{}: {e}", step.label));
                    return;
                }
            };
            for (index, (ours, theirs)) in step.outputs.iter().zip(&results).enumerate() {
                let difference = Difference::between(ours, theirs, &step.kernel.tolerance);
                tally.values += difference.values;
                tally.outliers += difference.outliers;
                tally.worst = tally.worst.max(difference.worst);
                tally.ratio = tally.ratio.max(difference.ratio);
                if !difference.is_within(&step.kernel.tolerance) {
                    tally.failures.push(format!(
                        "{} output {index}: {} of {} values differ, {} not finite, worst at {}",
                        step.label,
                        difference.outliers,
                        difference.values,
                        difference.broken,
                        difference.place
                    ));
                }
            }
        }
    });
    println!("kernel                          runs   values  outliers  allowed    worst  of tolerance");
    let mut wrong = Vec::new();
    for kernel in KERNELS {
        let tally = &tallies[kernel.name];
        let share = tally.outliers as f64 / tally.values.max(1) as f64;
        println!(
            "{:30} {:5} {:8} {:9.5} {:8.5} {:8.1e} {:8.2}",
            kernel.name, tally.runs, tally.values, share, kernel.tolerance.outliers, tally.worst, tally.ratio
        );
        if tally.runs == 0 && cases::only_some() {
            continue;
        }
        if tally.runs == 0 {
            wrong.push(format!("{}: no node reaches it", kernel.name));
        }
        if share > f64::from(kernel.tolerance.outliers) {
            wrong.push(format!("{}: {share:.5} of all values differ", kernel.name));
        }
        if let Some(first) = tally.failures.first() {
            wrong.push(format!("{}: {} comparisons fail", kernel.name, tally.failures.len()));
            wrong.extend(tally.failures.iter().skip(1).take(3).chain([first]).map(|f| format!("    {f}")));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
