//! The extension for sequences: frames in any order, their images pulled from the host as they are needed.

use super::args;
use super::failure::{Failure, Outcome};
use super::guard::{self, lock};
use super::handles::{Object, object};
use super::images::{AS_COMPUTED, Checked};
use super::objects::{DeviceObject, GraphObject};
use super::plan;
use super::process::NO_CONTROL;
use super::request::{region, request};
use super::run::{Run, must_fit};
use super::threads::CallThreads;
use isophote::engine::cpu::{CallingThread, CpuExecutor};
use isophote::engine::gpu::Executor;
use isophote::engine::{Image, Rect};
use isophote::frames::Frames;
use isophote::graph::GraphInput;
use isophote::kernels::shared::host_colour::has_light;
use isophote::request::MAX_MOTION;
use isophote::sequence::Sequence;
use isophote::{Graph, Planned, Request};
use isophote_abi::*;
use std::ffi::{CStr, CString};
use std::sync::Mutex;
use std::time::Instant;

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.sequence/1";

/// The functions of the extension.
pub static API: IsophoteSequenceApi = IsophoteSequenceApi {
    struct_size: size_of::<IsophoteSequenceApi>() as u32,
    frames,
    create,
    destroy,
    error,
    forget,
    process,
    plan_create,
};

/// State that is kept of a host's sequence.
#[derive(Debug)]
pub struct SequenceObject {
    state: Mutex<State>,
    max_motion: f32,
    message: Mutex<String>,
}

#[derive(Debug)]
struct State {
    sequence: Sequence<Image>,
    cpu: Option<CpuExecutor>,
    gpu: Option<Executor>,
}

object!(SequenceObject, IsophoteSequence, 4, "sequence");

unsafe extern "C" fn frames(graph: IsophoteGraph, past: *mut u32, future: *mut u32) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| {
        let [before, after] = object.lock().frames();
        // SAFETY: the host promised that both places may be written.
        unsafe {
            args::put(past, before, "the place for the frames before")?;
            args::put(future, after, "the place for the frames after")
        }
    })
}

/// The longest motion that counts, from the host's number.
fn longest(max_motion: f32) -> Outcome<f32> {
    match max_motion {
        0.0 => Ok(MAX_MOTION),
        m if m > 0.0 && m <= 16384.0 => Ok(m),
        m => Err(Failure::argument(format!(
            "the longest motion must be above 0 and at most 16384 pixels, not {m}"
        ))),
    }
}

unsafe extern "C" fn create(
    memory: u64,
    max_motion: f32,
    error: *mut IsophoteText,
    sequence: *mut IsophoteSequence,
) -> IsophoteStatus {
    let make = || {
        let state = State { sequence: Sequence::new(memory), cpu: None, gpu: None };
        let max_motion = longest(max_motion)?;
        Ok(SequenceObject { state: Mutex::new(state), max_motion, message: Mutex::default() })
    };
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(sequence, error, make) }
}

unsafe extern "C" fn destroy(sequence: IsophoteSequence) -> IsophoteStatus {
    guard::destroy::<SequenceObject>(sequence)
}

unsafe extern "C" fn error(sequence: IsophoteSequence, text: *mut IsophoteText) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    unsafe { guard::last_message::<SequenceObject>(sequence, text) }
}

unsafe extern "C" fn forget(sequence: IsophoteSequence) -> IsophoteStatus {
    guard::on::<SequenceObject>(sequence, |object| {
        let mut state = lock(&object.state);
        *state = State { sequence: Sequence::new(state.sequence.most()), cpu: None, gpu: None };
        Ok(())
    })
}

unsafe extern "C" fn process(
    sequence: IsophoteSequence,
    graph: IsophoteGraph,
    device: IsophoteDevice,
    host_request: *const IsophoteRequest,
    frames: *const IsophoteFrames,
    host_region: *const IsophoteRect,
    target: *const IsophoteTarget,
    control: *const IsophoteControl,
    report: *mut IsophoteReport,
) -> IsophoteStatus {
    guard::on::<SequenceObject>(sequence, |object| {
        let started = Instant::now();
        let graph = GraphObject::slots().get(graph.id)?.snapshot();
        // SAFETY: the host promised structs behind the pointers, or null where that is allowed.
        let (request, region, frames, target, control) = unsafe {
            let request = request(&args::get(host_request, "the request")?)?;
            let region = region(host_region, &request)?;
            let target = Checked::new(&args::get(target, "the target image")?, "the target image")?;
            let control = if control.is_null() { NO_CONTROL } else { args::get(control, "the control")? };
            (request, region, args::get(frames, "the frames")?, target, control)
        };
        target.must_hold(&region, "the target image")?;
        let device = match device.id {
            0 => None,
            id => Some(DeviceObject::slots().get(id)?),
        };
        let threads = CallThreads::new(&control)?;
        let mut state = lock(&object.state);
        let mut call = FrameCall {
            graph: &graph,
            request: Request { max_motion: object.max_motion, ..request },
            region,
            threads: &threads,
            control: &control,
            pulled: Pulled { frames, frame: request.frame, images: Vec::new(), replaced: 0 },
        };
        // SAFETY: the host promised functions of these types, and that the images that they give may be read.
        let mut result = unsafe { call.run(&mut state, device.as_deref())? };
        // SAFETY: the host promised that the target's memory may be written; all inputs were copied.
        unsafe { target.write(&mut result, threads.threads(), AS_COMPUTED)? };
        if let (Some(cpu), None) = (&mut state.cpu, &device) {
            cpu.recycle(result);
        }
        let done =
            IsophoteReport { replaced: call.pulled.replaced, seconds: started.elapsed().as_secs_f64() };
        // SAFETY: the host promised that the report may be written, or is null.
        unsafe { args::put_if_wanted(report, done) };
        Ok(())
    })
}

/// Empty image for a host to fill in.
const NO_IMAGE: IsophoteImage = IsophoteImage {
    data: std::ptr::null(),
    row_stride: 0,
    sample: ISOPHOTE_SAMPLE_F32,
    channels: 0,
    width: 0,
    height: 0,
    x: 0,
    y: 0,
};

/// Images of frames that the host gave, copied.
struct Pulled {
    frames: IsophoteFrames,
    /// The one that is computed, whose replaced samples are counted.
    frame: i64,
    images: Vec<((GraphInput, i64), Option<Image>)>,
    replaced: u64,
}

impl Pulled {
    /// The whole image of an input in a frame; none where the host has none. It is asked once.
    ///
    /// # Safety
    /// The host's functions must be what it promised.
    unsafe fn image(&mut self, input: GraphInput, frame: i64, whole: Rect) -> Outcome<Option<&Image>> {
        let at = match self.images.iter().position(|(name, _)| *name == (input, frame)) {
            Some(at) => at,
            None => {
                // SAFETY: as the caller promised.
                let image = unsafe { self.pull(input, frame, whole)? };
                self.images.push(((input, frame), image));
                self.images.len() - 1
            }
        };
        Ok(self.images[at].1.as_ref())
    }

    /// # Safety
    /// As [`Pulled::image`].
    unsafe fn pull(&mut self, input: GraphInput, frame: i64, whole: Rect) -> Outcome<Option<Image>> {
        let Some(ask) = self.frames.input else {
            return Err(Failure::argument("the function that gives images is null"));
        };
        let name = CString::new(input.id()).unwrap_or_default();
        let mut image = NO_IMAGE;
        // SAFETY: the host promised a function of this type; what it is given lives during the call.
        if unsafe { ask(self.frames.user, name.as_ptr(), frame, &raw mut image) } == 0 {
            return Ok(None);
        }
        let what = format!("input image '{}' of frame {frame}", input.id());
        let copied = Checked::source(&image, input, &what).and_then(|checked| {
            checked.must_hold(&whole, &what)?;
            // SAFETY: the host promised that the memory may be read until it is released.
            unsafe { checked.read(whole, input, &CallingThread) }
        });
        if let Some(release) = self.frames.release {
            // SAFETY: the host promised a function of this type.
            unsafe { release(self.frames.user, name.as_ptr(), frame, &raw const image) };
        }
        let (image, replaced) = copied?;
        if frame == self.frame {
            self.replaced += replaced;
        }
        Ok(Some(image))
    }
}

/// One call for a frame, with all that it was given.
struct FrameCall<'a> {
    graph: &'a Graph,
    request: Request,
    region: Rect,
    threads: &'a CallThreads,
    control: &'a IsophoteControl,
    pulled: Pulled,
}

impl FrameCall<'_> {
    /// # Safety
    /// The host's functions must be what it promised.
    unsafe fn run(&mut self, state: &mut State, device: Option<&DeviceObject>) -> Outcome<Image> {
        let whole = Rect::of_size(self.request.width, self.request.height);
        // SAFETY: as the caller promised.
        let light = unsafe { self.pulled.image(GraphInput::Color, self.request.frame, whole)? }
            .map(|color| self.request.premultiplied && has_light(color.data()));
        let light = light.ok_or_else(|| self.missing(GraphInput::Color, self.request.frame))?;
        self.request.emission |= light;
        // SAFETY: as the caller promised.
        let [mut past, mut future] = unsafe { self.known(state)? };
        loop {
            let request = Request { frames: Frames::around(past, future), ..self.request };
            let keeps = self.region == whole;
            let planned = state.sequence.plan(self.graph, request, keeps)?;
            let needed = needed(planned, self.region);
            // SAFETY: as the caller promised.
            match unsafe { self.pull_all(&needed)? } {
                None => return self.compute(state, device, &needed),
                // Frames are known up to the first that lacks an image.
                Some(frame) if frame < 0 => past = past.min(frame.unsigned_abs() - 1),
                Some(frame) => future = future.min(frame as u32 - 1),
            }
        }
    }

    /// Frames before and after this one that there are, as many as the graph wants.
    ///
    /// # Safety
    /// As [`FrameCall::run`].
    unsafe fn known(&mut self, state: &State) -> Outcome<[u32; 2]> {
        let (wanted, seen) = (self.graph.frames(), self.graph.frames_of(GraphInput::Color));
        let whole = Rect::of_size(self.request.width, self.request.height);
        let mut known = [0; 2];
        for (side, towards) in [-1, 1].into_iter().enumerate() {
            for n in 1..=i64::from(wanted[side]) {
                let frame = self.request.frame.saturating_add(towards * n);
                // Farther frames lend their motion alone.
                let is_seen = n <= i64::from(seen[side]);
                if !is_seen && !self.request.guides.motion {
                    break;
                }
                let input = if is_seen { GraphInput::Color } else { GraphInput::Motion };
                // What is kept of a frame shows that there is one.
                // SAFETY: as the caller promised.
                let is_there = state.sequence.knows(frame)
                    || unsafe { self.pulled.image(input, frame, whole)?.is_some() };
                if !is_there {
                    break;
                }
                known[side] += 1;
            }
        }
        Ok(known)
    }

    /// Pulls what a plan reads; the frame, counted from this one, of an image that is not there.
    ///
    /// # Safety
    /// As [`FrameCall::run`].
    unsafe fn pull_all(&mut self, needed: &[Needed]) -> Outcome<Option<i32>> {
        let whole = Rect::of_size(self.request.width, self.request.height);
        for Needed { input, offset, .. } in needed {
            let frame = self.request.frame.saturating_add(i64::from(*offset));
            // SAFETY: as the caller promised.
            if unsafe { self.pulled.image(*input, frame, whole)?.is_none() } {
                if *offset == 0 {
                    return Err(self.missing(*input, frame));
                }
                return Ok(Some(*offset));
            }
        }
        Ok(None)
    }

    fn missing(&self, input: GraphInput, frame: i64) -> Failure {
        Failure::new(
            ISOPHOTE_ERROR_INPUT,
            format!(
                "input image '{}' of frame {frame} is missing, and the request says that it is there",
                input.id()
            ),
        )
    }

    fn compute(&self, state: &mut State, device: Option<&DeviceObject>, needed: &[Needed]) -> Outcome<Image> {
        let State { sequence, cpu, gpu } = state;
        let planned = sequence.planned().ok_or_else(no_plan)?;
        let plan = planned.plan();
        must_fit(plan, &plan.windows(self.region), device.is_some()).or_else(|failure| {
            // What earlier frames left may be what is missing.
            match cpu {
                Some(cpu) => {
                    cpu.purge();
                    must_fit(plan, &plan.windows(self.region), device.is_some())
                }
                None => Err(failure),
            }
        })?;
        let mut images: Vec<(&str, &Image)> = sequence.handed(plan).collect();
        for Needed { input, offset, name } in needed {
            let frame = self.request.frame.saturating_add(i64::from(*offset));
            let found = self.pulled.images.iter().find(|(name, _)| *name == (*input, frame));
            images.extend(found.and_then(|(_, image)| image.as_ref()).map(|image| (name.as_str(), image)));
        }
        let run = Run {
            plan,
            precision: self.graph.precision(),
            region: self.region,
            threads: self.threads,
            control: self.control,
        };
        let results = run.execute(cpu, gpu, device, &images)?;
        let (output, gone) = sequence.finish(results, |image| size_of_val(image.data()) as u64);
        if let Some(cpu) = cpu {
            gone.into_iter().for_each(|image| cpu.recycle(image));
        }
        let result = output.ok_or_else(no_plan)?;
        if result.window() != self.region {
            return Err(Failure::new(
                ISOPHOTE_ERROR_UNSUPPORTED,
                "the graph's output is of another size than the picture",
            ));
        }
        Ok(result)
    }
}

/// An image that a plan reads of the host's.
struct Needed {
    input: GraphInput,
    /// Its frame, counted from the one that is computed.
    offset: i32,
    name: String,
}

fn needed(planned: &Planned, region: Rect) -> Vec<Needed> {
    let plan = planned.plan();
    let windows = plan.windows(region);
    let ports = plan.inputs().iter().filter(|port| !windows[port.image.index()].is_empty());
    ports
        .filter_map(|port| {
            let input = GraphInput::from_id(port.base())?;
            Some(Needed { input, offset: port.frame, name: port.name.clone() })
        })
        .collect()
}

fn no_plan() -> Failure {
    Failure::new(ISOPHOTE_ERROR_INTERNAL, "the sequence has no plan")
}

unsafe extern "C" fn plan_create(
    from: IsophoteGraph,
    host_request: *const IsophoteRequest,
    history: *const IsophoteHistory,
    host_region: *const IsophoteRect,
    error: *mut IsophoteText,
    out: *mut IsophotePlan,
) -> IsophoteStatus {
    let make = || {
        let graph = GraphObject::slots().get(from.id)?.snapshot();
        // SAFETY: the host promised structs behind the pointers, and a rectangle or null.
        let (request, region, history) = unsafe {
            let request = request(&args::get(host_request, "the request")?)?;
            (request, region(host_region, &request)?, args::get(history, "the history")?)
        };
        let past = history.past.min(graph.frames()[0]);
        let request =
            Request { frames: Frames::in_order(past), max_motion: longest(history.max_motion)?, ..request };
        plan::PlanObject::new(graph, request, region)
    };
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(out, error, make) }
}
