//! Computing images in memory, on the CPU or on a device of the library's own.

use super::args;
use super::contract::*;
use super::failure::{Failure, Outcome};
use super::graph;
use super::guard::{self, lock};
use super::handles::Object;
use super::images::{Checked, shown};
use super::objects::{DeviceObject, GraphObject};
use super::request::{region, request};
use super::threads::{CallThreads, User};
use super::warm::Warm;
use isophote::Request;
use isophote::engine::cpu::{Control, PassTime};
use isophote::engine::{Image, ImageId, Plan, Rect, Support, gpu, memory};
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote::request::Guides;
use std::ffi::{CString, c_char, c_void};
use std::ptr::null_mut;
use std::sync::Arc;
use std::time::Instant;

pub(super) unsafe extern "C" fn support(
    graph: IsophoteGraph,
    host_request: *const IsophoteRequest,
    host_region: *const IsophoteRect,
    input: *const c_char,
    support: *mut IsophoteSupport,
) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| {
        // SAFETY: the host promised structs behind the pointers, and text with a closing zero.
        let (request, region, input) = unsafe {
            let request = request(&args::get(host_request, "the request")?)?;
            let input = if input.is_null() { None } else { Some(graph::input(input)?) };
            (request, region(host_region, &request)?, input)
        };
        let warm = object.warm(&request)?;
        let plan = warm.plan()?;
        let windows = plan.windows(region);
        let window = plan
            .inputs()
            .iter()
            .filter(|port| input.is_none_or(|i| i.id() == port.name))
            .fold(Rect::default(), |all, port| all.union(&windows[port.image.index()]));
        let (halo, global) = match plan.support() {
            Support::Pixels(n) => (n, 0),
            Support::Global => (0, 1),
        };
        let window = IsophoteRect { x0: window.x0, y0: window.y0, x1: window.x1, y1: window.y1 };
        object.keep(warm);
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(support, IsophoteSupport { window, halo, global }, "the place for the support") }
    })
}

pub(super) unsafe extern "C" fn process(
    graph: IsophoteGraph,
    device: IsophoteDevice,
    host_request: *const IsophoteRequest,
    inputs: *const IsophoteInput,
    input_count: u32,
    host_region: *const IsophoteRect,
    target: *const IsophoteTarget,
    control: *const IsophoteControl,
    report: *mut IsophoteReport,
) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| {
        let started = Instant::now();
        // SAFETY: the host promised structs behind the pointers, and `input_count` of the inputs.
        let (mut request, inputs, target, control) = unsafe {
            let request = request(&args::get(host_request, "the request")?)?;
            let target = Checked::new(&args::get(target, "the target image")?, "the target image")?;
            let control = if control.is_null() { NO_CONTROL } else { args::get(control, "the control")? };
            (request, sources(inputs, input_count)?, target, control)
        };
        let given = |input| inputs.iter().any(|(i, _)| *i == input);
        request.guides = Guides {
            normal: given(GraphInput::Normal),
            depth: given(GraphInput::Depth),
            object_id: given(GraphInput::ObjectId),
            mask: given(GraphInput::Mask),
            flow: given(GraphInput::Flow),
        };
        // SAFETY: the host promised a rectangle behind the pointer, or null.
        let region = unsafe { region(host_region, &request)? };
        target.must_hold(&region, "the target image")?;
        let device = match device.id {
            0 => None,
            id => Some(DeviceObject::slots().get(id)?),
        };
        let threads = CallThreads::new(&control)?;
        let mut warm = object.warm(&request)?;
        let job = Job { object, request, region, inputs: &inputs, threads: &threads, control: &control };
        // SAFETY: the host promised that the images' memory may be read.
        let computed = unsafe { job.run(&mut warm, device.as_deref()) };
        let computed = computed.and_then(|(result, replaced)| {
            // SAFETY: the host promised that the target's memory may be written; all inputs were copied,
            // so that it does not matter whether it is theirs.
            unsafe { target.write(&result)? };
            if device.is_none() {
                warm.recycle(result);
            }
            Ok(replaced)
        });
        object.keep(warm);
        let replaced = computed?;
        let done = IsophoteReport { replaced, seconds: started.elapsed().as_secs_f64() };
        // SAFETY: the host promised that the report may be written, or is null.
        unsafe { args::put_if_wanted(report, done) };
        Ok(())
    })
}

const NO_CONTROL: IsophoteControl = IsophoteControl {
    user: null_mut(),
    run: None,
    progress: None,
    cancelled: None,
    measured: None,
    threads: 0,
};

/// The host's inputs, checked and named.
///
/// # Safety
/// `inputs` is null or points to `count` inputs, whose names are text with a closing zero.
unsafe fn sources(inputs: *const IsophoteInput, count: u32) -> Outcome<Vec<(GraphInput, Checked)>> {
    let mut sources: Vec<(GraphInput, Checked)> = Vec::new();
    for index in 0..count as usize {
        // More than there are names are refused below, long before the pointer could run off.
        // SAFETY: as the caller promised.
        let host = unsafe { args::get(inputs.wrapping_add(index), "the list of inputs")? };
        // SAFETY: as the caller promised.
        let input = unsafe { graph::input(host.name)? };
        if sources.iter().any(|(i, _)| *i == input) {
            return Err(Failure::argument(format!("input image '{}' is given twice", input.id())));
        }
        sources.push((input, Checked::source(&host.image, &format!("input image '{}'", input.id()))?));
    }
    Ok(sources)
}

/// One computation.
struct Job<'a> {
    object: &'a GraphObject,
    request: Request,
    region: Rect,
    inputs: &'a [(GraphInput, Checked)],
    threads: &'a CallThreads,
    control: &'a IsophoteControl,
}

impl Job<'_> {
    /// Reads the inputs and computes the result.
    ///
    /// # Safety
    /// The memory of the inputs must be readable.
    unsafe fn run(&self, warm: &mut Warm, device: Option<&DeviceObject>) -> Outcome<(Image, u64)> {
        let plan = warm.plan()?;
        let windows = plan.windows(self.region);
        let mut needed = Vec::new();
        for port in plan.inputs() {
            let window = windows[port.image.index()];
            if window.is_empty() {
                continue;
            }
            let Some((input, image)) = self.inputs.iter().find(|(i, _)| i.id() == port.name) else {
                return Err(Failure::new(
                    ISOPHOTE_ERROR_INPUT,
                    format!("input image '{}' is missing; {} of it is needed", port.name, shown(&window)),
                ));
            };
            image.must_hold(&window, &format!("input image '{}'", port.name))?;
            needed.push((*input, *image, window));
        }
        self.make_room(warm, device.is_some())?;
        let mut images = Vec::new();
        let mut replaced = 0;
        for (input, image, window) in needed {
            // SAFETY: as the caller promised.
            let (image, bad) = unsafe { image.read(window, input)? };
            replaced += bad;
            images.push((input.id(), image));
        }
        if self.has_light(&images) {
            let request = Request { emission: true, ..self.request };
            warm.plan_for(&self.object.snapshot(), &request)?;
            self.make_room(warm, device.is_some())?;
        }
        let images: Vec<(&str, &Image)> = images.iter().map(|(name, image)| (*name, image)).collect();
        let result = self.execute(warm, device, &images)?;
        if result.window() != self.region {
            return Err(Failure::new(
                ISOPHOTE_ERROR_UNSUPPORTED,
                "the graph's output is of another size than the picture",
            ));
        }
        Ok((result, replaced))
    }

    /// Fails when there is no memory for the run, also not when what earlier runs left is given back.
    fn make_room(&self, warm: &mut Warm, on_device: bool) -> Outcome<()> {
        let fits = |warm: &Warm| {
            let plan = warm.plan()?;
            must_fit(plan, &plan.windows(self.region), on_device)
        };
        fits(warm).or_else(|_| {
            warm.purge();
            fits(warm)
        })
    }

    /// Whether colour has light where coverage is 0 or little, which the plan does not know of.
    fn has_light(&self, images: &[(&str, Image)]) -> bool {
        self.request.premultiplied
            && !self.request.emission
            && images.iter().any(|(name, image)| *name == GraphInput::Color.id() && has_light(image.data()))
    }

    fn execute(
        &self,
        warm: &mut Warm,
        device: Option<&DeviceObject>,
        images: &[(&str, &Image)],
    ) -> Outcome<Image> {
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
        let results = match device {
            None => self.on_cpu(warm, images, control)?,
            Some(device) => self.on_device(warm, device, images, control)?,
        };
        results
            .into_iter()
            .next()
            .ok_or_else(|| Failure::new(ISOPHOTE_ERROR_INTERNAL, "the plan gave no image"))
    }

    fn on_cpu(
        &self,
        warm: &mut Warm,
        images: &[(&str, &Image)],
        control: Control<'_>,
    ) -> Outcome<Vec<Image>> {
        let (plan, cpu, _) = warm.parts()?;
        let cpu = cpu.get_or_insert_default();
        cpu.record_times(self.control.measured.is_some());
        let results = cpu.run(plan, images, self.region, self.threads.threads(), control)?;
        if let Some(measured) = self.control.measured {
            self.report_times(plan, cpu.times(), measured);
        }
        Ok(results)
    }

    fn on_device(
        &self,
        warm: &mut Warm,
        object: &DeviceObject,
        images: &[(&str, &Image)],
        control: Control<'_>,
    ) -> Outcome<Vec<Image>> {
        let (plan, _, gpu) = warm.parts()?;
        let executor = match gpu.take() {
            Some(executor) if Arc::ptr_eq(executor.device(), &object.device) => executor,
            _ => gpu::Executor::new(Arc::clone(&object.device)),
        };
        let results = gpu.insert(executor).run_images(plan, images, self.region, control);
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
        plan: &Plan,
        times: &[PassTime],
        measured: unsafe extern "C" fn(*mut c_void, *const IsophotePassTime),
    ) {
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
fn must_fit(plan: &Plan, windows: &[Rect], on_device: bool) -> Outcome<()> {
    let most = if on_device {
        let bytes = |id: ImageId| windows[id.index()].area() * u64::from(plan.desc(id).channels) * 4;
        plan.inputs().iter().chain(plan.outputs()).map(|port| bytes(port.image)).sum()
    } else {
        plan.peak_bytes(windows)
    };
    memory::must_have(most).map_err(|_| {
        Failure::new(
            ISOPHOTE_ERROR_OUT_OF_MEMORY,
            format!("{} MiB are needed at once, more than there is; compute smaller regions", most >> 20),
        )
    })
}
