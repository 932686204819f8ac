//! A run of a plan for a host: its threads, its callbacks, the CPU or a device.

use super::failure::{Failure, Outcome};
use super::guard::lock;
use super::handles::Object;
use super::objects::DeviceObject;
use super::threads::{CallThreads, User};
use isophote::engine::cpu::{Control, CpuExecutor, PassTime, Rows};
use isophote::engine::gpu::Executor;
use isophote::engine::program::Precision;
use isophote::engine::{Image, ImageId, Plan, Rect, memory};
use isophote_abi::*;
use std::ffi::{CString, c_void};
use std::sync::Arc;

/// Run of a plan, and its options.
pub struct Run<'a> {
    /// The passes.
    pub plan: &'a Plan,
    /// Precision in which devices compute.
    pub precision: Precision,
    /// The part of the picture.
    pub region: Rect,
    /// Threads on which the CPU computes.
    pub threads: &'a CallThreads,
    /// The host's callbacks.
    pub control: &'a IsophoteControl,
}

impl Run<'_> {
    /// Computes the region of all outputs, on a device or on the CPU.
    ///
    /// # Errors
    /// As the executors.
    pub fn execute(
        &self,
        cpu: &mut Option<CpuExecutor>,
        gpu: &mut Option<Executor>,
        device: Option<&DeviceObject>,
        images: &[(&str, &Image)],
    ) -> Outcome<Vec<Image>> {
        self.controlled(|control| match device {
            None => self.on_cpu(cpu, images, control),
            Some(device) => self.on_device(gpu, device, images, control),
        })
    }

    /// Computes the region of all outputs on the CPU, from and to images by rows that take at most `most` bytes.
    ///
    /// # Errors
    /// As the executor.
    pub fn by_rows(&self, cpu: &mut Option<CpuExecutor>, rows: &mut dyn Rows, most: u64) -> Outcome<()> {
        self.controlled(|control| {
            let cpu = cpu.get_or_insert_default();
            cpu.record_times(self.control.measured.is_some());
            cpu.run_rows(self.plan, rows, (self.region, most), self.threads.threads(), control)?;
            self.report(cpu);
            Ok(())
        })
    }

    /// Does `work` with the host's callbacks.
    fn controlled<T>(&self, work: impl FnOnce(Control<'_>) -> T) -> T {
        let user = User(self.control.user);
        let cancelled = self.control.cancelled.map(|ask| {
            move || {
                let user = user;
                // SAFETY: the host promised a function of this type that any thread may call.
                unsafe { ask(user.0) != 0 }
            }
        });
        let progress = self.control.progress.map(|report| {
            move |done: f32| {
                let user = user;
                // SAFETY: the host promised a function of this type.
                unsafe { report(user.0, done) }
            }
        });
        let control = Control {
            cancelled: cancelled.as_ref().map(|c| c as &(dyn Fn() -> bool + Sync)),
            progress: progress.as_ref().map(|p| p as &dyn Fn(f32)),
        };
        work(control)
    }

    fn on_cpu(
        &self,
        cpu: &mut Option<CpuExecutor>,
        images: &[(&str, &Image)],
        control: Control<'_>,
    ) -> Outcome<Vec<Image>> {
        let cpu = cpu.get_or_insert_default();
        cpu.record_times(self.control.measured.is_some());
        let results = cpu.run(self.plan, images, self.region, self.threads.threads(), control)?;
        self.report(cpu);
        Ok(results)
    }

    /// Reports what the passes took, where the host wants to know.
    fn report(&self, cpu: &CpuExecutor) {
        if let Some(measured) = self.control.measured {
            self.report_times(cpu.times(), measured);
        }
    }

    fn on_device(
        &self,
        gpu: &mut Option<Executor>,
        object: &DeviceObject,
        images: &[(&str, &Image)],
        control: Control<'_>,
    ) -> Outcome<Vec<Image>> {
        let executor = match gpu.take() {
            Some(executor) if Arc::ptr_eq(executor.device(), &object.device) => executor,
            _ => Executor::new(Arc::clone(&object.device)),
        };
        let executor = gpu.insert(executor);
        executor.set_precision(self.precision);
        let results = executor.run_images(self.plan, images, self.region, control);
        if let Err(e) = &results {
            // A lost device takes all that was made on it with it.
            *gpu = None;
            e.to_string().clone_into(&mut lock(object.message()));
        }
        Ok(results?)
    }

    /// Reports to the host what each pass of the last run on the CPU took.
    fn report_times(
        &self,
        times: &[PassTime],
        measured: unsafe extern "C" fn(*mut c_void, *const IsophotePassTime),
    ) {
        let plan = self.plan;
        let windows = plan.windows(self.region);
        let bytes = |id: &ImageId| windows[id.index()].area() * u64::from(plan.desc(*id).channels) * 4;
        // Passes that the region does not need were not run.
        let passes = plan.passes().iter().filter(|pass| !windows[pass.outputs[0].index()].is_empty());
        for (pass, time) in passes.zip(times) {
            let kernel = CString::new(pass.kernel.name).unwrap_or_default();
            let entry = IsophotePassTime {
                kernel: kernel.as_ptr(),
                seconds: time.time.as_secs_f64(),
                operations: (pass.kernel.cost)(&pass.params) * time.pixels as f64,
                bytes: pass.inputs.iter().chain(&pass.outputs).map(bytes).sum(),
                pixels: time.pixels,
            };
            // SAFETY: the host promised a function of this type; what it is given lives during the call.
            unsafe { measured(self.control.user, &raw const entry) };
        }
    }
}

/// Fails when the images of a run would not fit into memory, before any of them is computed.
///
/// # Errors
/// Out of memory, with what would be needed.
pub fn must_fit(plan: &Plan, windows: &[Rect], on_device: bool) -> Outcome<()> {
    let most = if on_device {
        let bytes = |id: ImageId| windows[id.index()].area() * u64::from(plan.desc(id).channels) * 4;
        plan.inputs().iter().chain(plan.outputs()).map(|port| bytes(port.image)).sum()
    } else {
        plan.peak_bytes(windows)
    };
    must_have(most)
}

/// Fails when the system has not so many bytes for images.
///
/// # Errors
/// Out of memory, with what would be needed.
pub fn must_have(most: u64) -> Outcome<()> {
    memory::must_have(most).map_err(|_| {
        Failure::new(
            ISOPHOTE_ERROR_OUT_OF_MEMORY,
            format!("{} MiB are needed at once, more than there is; compute smaller regions", most >> 20),
        )
    })
}
