//! Computing images in memory, on the CPU or on a device of the library's own.

use super::args;
use super::by_rows::{HostRows, Source, Takes};
use super::failure::{Failure, Outcome};
use super::graph;
use super::guard;
use super::handles::Object;
use super::images::{AS_COMPUTED, Checked, shown};
use super::objects::{DeviceObject, GraphObject};
use super::request::{region, request};
use super::run::{Run, must_fit, must_have};
use super::threads::CallThreads;
use super::warm::Warm;
use crate::pool;
use isophote::Request;
use isophote::engine::plan::Port;
use isophote::engine::{Image, Plan, Rect};
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote::request::Guides;
use isophote_abi::*;
use std::ffi::c_char;
use std::ptr::null_mut;
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
        let (halo, global) = plan.support().sides().map_or((0, 1), |[x, y]| (x.max(y), 0));
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
        request.guides = Guides::of(given);
        // SAFETY: the host promised a rectangle behind the pointer, or null.
        let region = unsafe { region(host_region, &request)? };
        target.must_hold(&region, "the target image")?;
        let device = match device.id {
            0 => None,
            id => Some(DeviceObject::slots().get(id)?),
        };
        let threads = CallThreads::new(&control)?;
        let mut warm = object.warm(&request)?;
        let call =
            ProcessCall { object, request, region, inputs: &inputs, threads: &threads, control: &control };
        // SAFETY: the host promised that the images' memory may be read, and the target's written.
        let computed = unsafe { call.compute(&mut warm, device.as_deref(), &target) };
        object.keep(warm);
        let replaced = computed?;
        let done = IsophoteReport { replaced, seconds: started.elapsed().as_secs_f64() };
        // SAFETY: the host promised that the report may be written, or is null.
        unsafe { args::put_if_wanted(report, done) };
        Ok(())
    })
}

/// The control of a host that gives none.
pub const NO_CONTROL: IsophoteControl = IsophoteControl {
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
        sources.push((input, Checked::source(&host.image, input, &format!("input image '{}'", input.id()))?));
    }
    Ok(sources)
}

/// One call of `process`, with all that it was given.
struct ProcessCall<'a> {
    object: &'a GraphObject,
    request: Request,
    region: Rect,
    inputs: &'a [(GraphInput, Checked)],
    threads: &'a CallThreads,
    control: &'a IsophoteControl,
}

impl ProcessCall<'_> {
    /// Reads the inputs, computes the result and writes it; returns how many samples were replaced.
    ///
    /// # Safety
    /// The memory of the inputs must be readable, that of the target writable.
    unsafe fn compute(
        &self,
        warm: &mut Warm,
        device: Option<&DeviceObject>,
        target: &Checked,
    ) -> Outcome<u64> {
        let needed = self.needed(warm.plan()?)?;
        if device.is_none()
            && let takes @ Takes::ByRows(_) = self.takes(warm)?
        {
            // SAFETY: as the caller promised.
            return unsafe { self.run_rows(warm, (&needed, takes), target) };
        }
        self.make_room(warm, device.is_some())?;
        // SAFETY: as the caller promised.
        let (mut result, replaced) = unsafe { self.run(warm, device, needed)? };
        // SAFETY: as the caller promised; all inputs were copied, so that it does not matter whether it is theirs.
        unsafe { target.write(&mut result, self.threads.threads(), AS_COMPUTED)? };
        if device.is_none() {
            warm.recycle(result);
        }
        Ok(replaced)
    }

    /// The images that the plan reads, and what it reads of them.
    fn needed(&self, plan: &Plan) -> Outcome<Vec<Source>> {
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
        let is_whole = |port: &Port| plan.region_at(self.region, plan.desc(port.image).level) == self.region;
        match plan.outputs().first() {
            Some(port) if is_whole(port) => Ok(needed),
            Some(_) => Err(Failure::new(
                ISOPHOTE_ERROR_UNSUPPORTED,
                "the graph's output is of another size than the picture",
            )),
            None => Err(Failure::new(ISOPHOTE_ERROR_INTERNAL, "the plan gives no image")),
        }
    }

    /// Computes the result by rows and copies it to the target.
    ///
    /// # Safety
    /// As [`ProcessCall::compute`].
    unsafe fn run_rows(
        &self,
        warm: &mut Warm,
        (needed, mut takes): (&[Source], Takes),
        target: &Checked,
    ) -> Outcome<u64> {
        // Memory of whole images is of no use here.
        pool::forget();
        // SAFETY: as the caller promised.
        let mut rows = unsafe { HostRows::new(needed, (target, self.region), self.threads.threads())? };
        if self.request.premultiplied && !self.request.emission && rows.has_light()? {
            self.plan_for_light(warm)?;
            takes = self.takes(warm)?;
        }
        must_have(takes.bytes())?;
        let (plan, cpu, _) = warm.parts()?;
        let run = self.on(plan);
        run.by_rows(cpu, &mut rows, self.object.memory())?;
        let replaced = rows.replaced;
        // SAFETY: as the caller promised; nothing is read any more.
        unsafe { rows.finish(target) };
        Ok(replaced)
    }

    /// Memory that the run takes on the CPU.
    fn takes(&self, warm: &Warm) -> Outcome<Takes> {
        Ok(Takes::of(warm.plan()?, self.region, self.object.memory(), self.threads.threads()))
    }

    /// Plans anew for light beyond coverage.
    fn plan_for_light(&self, warm: &mut Warm) -> Outcome<()> {
        warm.plan_for(&self.object.snapshot(), &Request { emission: true, ..self.request })
    }

    /// A run of a plan.
    fn on<'p>(&'p self, plan: &'p Plan) -> Run<'p> {
        let precision = self.object.lock().precision();
        Run { plan, precision, region: self.region, threads: self.threads, control: self.control }
    }

    /// Reads the inputs and computes the result as a whole.
    ///
    /// # Safety
    /// The memory of the inputs must be readable.
    unsafe fn run(
        &self,
        warm: &mut Warm,
        device: Option<&DeviceObject>,
        needed: Vec<Source>,
    ) -> Outcome<(Image, u64)> {
        let mut images = Vec::new();
        let mut replaced = 0;
        for (input, image, window) in needed {
            // SAFETY: as the caller promised.
            let (image, bad) = unsafe { image.read(window, input, self.threads.threads())? };
            replaced += bad;
            images.push((input.id(), image));
        }
        if self.has_light(&images) {
            self.plan_for_light(warm)?;
            self.make_room(warm, device.is_some())?;
        }
        let named: Vec<(&str, &Image)> = images.iter().map(|(name, image)| (*name, image)).collect();
        let (plan, cpu, gpu) = warm.parts()?;
        let results = self.on(plan).execute(cpu, gpu, device, &named);
        images.into_iter().for_each(|(_, image)| pool::keep_image(image));
        let results = results?;
        let no_image = || Failure::new(ISOPHOTE_ERROR_INTERNAL, "the plan gave no image");
        Ok((results.into_iter().next().ok_or_else(no_image)?, replaced))
    }

    /// Fails when there is no memory for the run, also not when what earlier runs left is given back.
    fn make_room(&self, warm: &mut Warm, on_device: bool) -> Outcome<()> {
        let fits = |warm: &Warm| {
            let plan = warm.plan()?;
            must_fit(plan, &plan.windows(self.region), on_device)
        };
        fits(warm).or_else(|_| {
            warm.purge();
            pool::forget();
            fits(warm)
        })
    }

    /// True where colour has light where coverage is 0 or little, which the plan does not know of.
    fn has_light(&self, images: &[(&str, Image)]) -> bool {
        self.request.premultiplied
            && !self.request.emission
            && images.iter().any(|(name, image)| *name == GraphInput::Color.id() && has_light(image.data()))
    }
}
