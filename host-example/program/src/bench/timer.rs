//! Timestamps around every pass of a plan.

use isophote_example::plan_runner::PlanRunner;
use isophote_files::error::Result;
use isophote_render::gpu::Gpu;
use isophote_render::timestamps::Timestamps;

/// Measures plans of so many passes.
#[derive(Debug)]
pub struct Timer {
    timestamps: Timestamps,
    passes: usize,
}

impl Timer {
    /// Room for so many passes; nothing where the adapter has no timestamps or not so many.
    pub fn new(gpu: &Gpu, passes: usize) -> Option<Self> {
        Some(Self { timestamps: Timestamps::new(gpu, passes)?, passes })
    }

    /// Runs the plan with each of its passes as a compute pass of its own, so that the whole takes a little longer, and
    /// returns what each took, in seconds.
    ///
    /// # Errors
    /// [`isophote_files::error::Error::Failure`] when the device fails.
    pub fn run(&self, gpu: &Gpu, runner: &PlanRunner) -> Result<Vec<f64>> {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for index in 0..self.passes {
            let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("timed"),
                timestamp_writes: Some(self.timestamps.compute(index)),
            });
            runner.encode_pass(&mut compute, index)?;
        }
        self.timestamps.encode(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        self.timestamps.ask();
        gpu.wait()?;
        self.timestamps.read()
    }
}
