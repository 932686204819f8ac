//! Twins where the shader reads and writes 16-bit floats, and interpolates by samplers if it can: the difference stays below
//! the kernel's second tolerance.

use super::spoiled;
use super::tally::Tally;
use isophote_engine::Kernel;
use isophote_engine::cpu::Control;
use isophote_engine::program::{Format, Precision, Program};
use isophote_tests::compare::Difference;
use isophote_tests::device;
use isophote_tests::sweep::Step;
use isophote_tests::trials::Report;

/// Comparisons a kernel.
const STEPS: usize = 24;

/// True where any image of the kernel's passes is kept in 16-bit floats.
pub fn concerns(steps: &[Step]) -> bool {
    steps.first().is_some_and(|step| {
        let plan = step.plan_with(step.kernel);
        let program = Program::lower_as(&plan, step.region(), Precision::Fast);
        program.is_ok_and(|program| program.textures.iter().any(|t| t.format == Format::Rgba16))
    })
}

/// Compares both twins on some of the steps; kernels that keep nothing in 16-bit floats have nothing to compare.
pub fn agreement(kernel: &'static Kernel, steps: &[Step]) -> Option<Report> {
    let mut devices = vec![device::executor(kernel.name)?];
    if kernel.pieces.windowed.is_some() && !devices[0].device().shares_windows() {
        devices.push(device::executor_with_windows(kernel.name, true)?);
    }
    devices.iter_mut().for_each(|gpu| gpu.set_precision(Precision::Fast));
    let mut tally = Tally::default();
    for step in spoiled::sample(steps, STEPS).into_iter().filter(|_| concerns(steps)) {
        let plan = step.plan_with(kernel);
        let (inputs, expected) = step.in_half();
        let named: Vec<_> = plan.inputs().iter().map(|port| port.name.as_str()).zip(&inputs).collect();
        for gpu in &mut devices {
            tally.runs += 1;
            let label = format!("{}, windows {}", step.label, gpu.device().shares_windows());
            match gpu.run_images(&plan, &named, step.region(), Control::default()) {
                Ok(results) => {
                    for (index, (ours, theirs)) in expected.iter().zip(&results).enumerate() {
                        let difference = Difference::between(ours, theirs, &kernel.fast);
                        tally.add(&format!("{label}, output {index}"), &kernel.fast, &difference);
                    }
                }
                Err(e) => tally.failures.push(format!("{label}: {e}")),
            }
        }
    }
    Some(tally.report("fast", kernel.name, &kernel.fast))
}
