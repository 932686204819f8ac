//! Summary of the comparisons of twins.

use isophote_engine::Tolerance;
use isophote_engine::cpu::Control;
use isophote_engine::gpu::Executor;
use isophote_tests::compare::Difference;
use isophote_tests::sweep::Step;
use isophote_tests::trials::Report;

/// Summary of all comparisons of a kernel.
#[derive(Default)]
pub struct Tally {
    pub runs: usize,
    values: usize,
    outliers: usize,
    worst: f32,
    ratio: f32,
    pub failures: Vec<String>,
}

impl Tally {
    /// Runs the shader of a step and compares; the failure is that of the first run that does not come out.
    pub fn compare(&mut self, step: &Step, devices: &mut [Executor]) -> Result<(), String> {
        self.runs += 1;
        let plan = step.plan_with(step.kernel);
        for gpu in devices {
            let results = gpu
                .run_images(&plan, &step.named_inputs(), step.region(), Control::default())
                .map_err(|e| format!("{}: {e}", step.label))?;
            for (index, (ours, theirs)) in step.outputs.iter().zip(&results).enumerate() {
                self.add(
                    &format!("{} output {index}", step.label),
                    &step.kernel.tolerance,
                    &Difference::between(ours, theirs, &step.kernel.tolerance),
                );
            }
        }
        Ok(())
    }

    pub fn add(&mut self, what: &str, tolerance: &Tolerance, difference: &Difference) {
        let Difference { values, outliers, worst, ratio, place, broken } = difference;
        self.values += values;
        self.outliers += outliers;
        self.worst = self.worst.max(*worst);
        self.ratio = self.ratio.max(*ratio);
        if !difference.is_within(tolerance) {
            self.failures.push(format!(
                "{what}: {outliers} of {values} values differ, {broken} not finite, worst at {place}"
            ));
        }
    }

    /// One line for the reader, and what is wrong.
    pub fn report(&self, kind: &str, kernel: &str, tolerance: &Tolerance) -> Report {
        let share = self.outliers as f64 / self.values.max(1) as f64;
        let allowed = tolerance.outliers;
        println!(
            "{kind}::{kernel:30} {:5} runs, {:8} values, {share:.5} outliers of {allowed:.5} allowed, worst {:.1e}, \
             {:.2} of the tolerance",
            self.runs, self.values, self.worst, self.ratio
        );
        let mut wrong = Vec::new();
        if self.runs == 0 && kind == "twins" {
            wrong.push("no node reaches it".to_owned());
        }
        if share > f64::from(allowed) {
            wrong.push(format!("{share:.5} of all values differ"));
        }
        if !self.failures.is_empty() {
            wrong.push(format!("{} comparisons fail", self.failures.len()));
            wrong.extend(self.failures.iter().take(4).map(|f| format!("    {f}")));
        }
        wrong.into()
    }
}
