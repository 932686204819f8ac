//! Running a graph on images in main memory.

use std::ffi::c_void;

use super::device::Device;
use super::error::Result;
use super::graph::Graph;
use super::image::{AsImage, AsTarget};
use super::text;
use isophote_abi::{
    IsophoteControl, IsophoteDevice, IsophoteImage, IsophoteInput, IsophotePassTime, IsophoteRect,
    IsophoteReport, IsophoteRequest, IsophoteSupport, IsophoteTarget,
};

/// An image that enters a graph: the whole picture.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// `color`, `normal`, `depth` and so on.
    pub name: &'a str,
    /// The pixels.
    pub pixels: &'a dyn AsImage,
}

/// Means by which the work is done and watched.
#[derive(Default)]
pub struct Control<'a> {
    /// Threads of the library; 0 for one per core.
    pub threads: u32,
    /// Called with the share of the work done.
    pub progress: Option<&'a mut dyn FnMut(f32)>,
    /// Receives what each pass took; on the CPU only.
    pub measured: Option<&'a mut Vec<PassTime>>,
    /// Asked often, on any thread, whether to stop; the work then ends in a refusal.
    pub cancelled: Option<&'a (dyn Fn() -> bool + Sync)>,
}

/// Pixels of a picture: columns and rows from the first, which is inside, to the last, which is outside.
pub type Part = [[i32; 2]; 2];

/// Time that one pass took on the CPU.
#[derive(Clone, Debug)]
pub struct PassTime {
    /// The kernel.
    pub kernel: String,
    /// Wall-clock time.
    pub seconds: f64,
    /// Multiply-adds, or operations of like cost, by the kernel's own reckoning.
    pub operations: f64,
    /// Bytes of the images read and written, each once.
    pub bytes: u64,
    /// Pixels written.
    pub pixels: u64,
}

/// Report on the work.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Samples that were NaN or infinite and were replaced.
    pub replaced: u64,
    /// Wall-clock time in seconds.
    pub seconds: f64,
}

impl Graph {
    /// Computes the whole picture into `target`, on `device` or else on the CPU.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when an image is missing or has another size than the request, and when the device
    /// fails; `target` is then as before.
    pub fn process(
        &mut self,
        device: Option<&Device>,
        request: &IsophoteRequest,
        inputs: &[Input<'_>],
        target: &mut dyn AsTarget,
        control: &mut Control<'_>,
    ) -> Result<Report> {
        let handle = device.map_or_else(IsophoteDevice::default, |d| d.handle);
        self.run(handle, request, (inputs, [0; 2]), None, target, control)
    }

    /// Computes a part of the picture on the CPU, into `target`, which is as large. Inputs hold the picture from the pixel
    /// `origin` on, at least what [`Graph::support`] names.
    ///
    /// # Errors
    /// As [`Graph::process`].
    pub fn process_part(
        &mut self,
        request: &IsophoteRequest,
        inputs: &[Input<'_>],
        origin: [i32; 2],
        part: Part,
        target: &mut dyn AsTarget,
        control: &mut Control<'_>,
    ) -> Result<Report> {
        self.run(IsophoteDevice::default(), request, (inputs, origin), Some(part), target, control)
    }

    /// The part of its inputs that a part of the result reads, cut at the picture's border.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the request cannot be planned.
    pub fn support(&self, request: &IsophoteRequest, part: Part) -> Result<Part> {
        let region = rect(part);
        let mut support = IsophoteSupport::default();
        // SAFETY: the handle is this object's; request and region are read and `support` is written during the call.
        let status = unsafe {
            (self.api.graph_support)(
                self.handle,
                request,
                &raw const region,
                std::ptr::null(),
                &raw mut support,
            )
        };
        self.check(status)?;
        let IsophoteRect { x0, y0, x1, y1 } = support.window;
        Ok([[x0, y0], [x1, y1]])
    }

    fn run(
        &mut self,
        device: IsophoteDevice,
        request: &IsophoteRequest,
        (inputs, [x, y]): (&[Input<'_>], [i32; 2]),
        part: Option<Part>,
        target: &mut dyn AsTarget,
        control: &mut Control<'_>,
    ) -> Result<Report> {
        let mut names = Vec::with_capacity(inputs.len());
        for input in inputs {
            names.push(text::argument(input.name)?);
        }
        let images: Vec<IsophoteInput> = names
            .iter()
            .zip(inputs)
            .map(|(name, input)| {
                let image = IsophoteImage { x, y, ..input.pixels.image().raw };
                IsophoteInput { name: name.as_ptr(), image }
            })
            .collect();
        let region = part.map(rect);
        let [left, top] = part.map_or([0; 2], |[first, _]| first);
        let target = IsophoteTarget { x: left, y: top, ..target.target().raw };
        let control = self::control(control);
        let mut report = IsophoteReport::default();
        // SAFETY: the handles are their objects'. Images and target describe memory that is borrowed for the
        // whole call, with strides and sizes that `Image` and `Target` vouch for; the region, if there is one, lives as long. The
        // callbacks get the caller's control, borrowed for the call too.
        let status = unsafe {
            (self.api.process)(
                self.handle,
                device,
                request,
                images.as_ptr(),
                images.len() as u32,
                region.as_ref().map_or(std::ptr::null(), std::ptr::from_ref),
                &raw const target,
                &raw const control,
                &raw mut report,
            )
        };
        self.check(status)?;
        Ok(report.into())
    }
}

impl From<IsophoteReport> for Report {
    fn from(report: IsophoteReport) -> Self {
        Self { replaced: report.replaced, seconds: report.seconds }
    }
}

/// The control as the contract has it; it gets `control`, which must stay for the whole call.
pub(super) fn control(control: &mut Control<'_>) -> IsophoteControl {
    let (threads, wants_times) = (control.threads, control.measured.is_some());
    let can_stop = control.cancelled.is_some();
    IsophoteControl {
        user: std::ptr::from_mut(control).cast(),
        run: None,
        progress: Some(progress),
        cancelled: if can_stop { Some(cancelled) } else { None },
        measured: if wants_times { Some(measured) } else { None },
        threads,
    }
}

/// Called on the thread that called `process`, while it does not return.
unsafe extern "C" fn progress(user: *mut c_void, done: f32) {
    // SAFETY: `user` is the control of the running call, of which this thread alone touches this field.
    let progress = unsafe { &mut (*user.cast::<Control<'_>>()).progress };
    if let Some(progress) = progress {
        progress(done);
    }
}

/// Called on any thread while the thread that called `process` does not return.
unsafe extern "C" fn cancelled(user: *mut c_void) -> u32 {
    // SAFETY: `user` is the control of the running call, whose field nothing writes to meanwhile; the function may be
    // called on any thread.
    let cancelled = unsafe { (&raw const (*user.cast::<Control<'_>>()).cancelled).read() };
    u32::from(cancelled.is_some_and(|is_cancelled| is_cancelled()))
}

/// Called on the thread that called `process`, while it does not return.
unsafe extern "C" fn measured(user: *mut c_void, pass: *const IsophotePassTime) {
    // SAFETY: `user` is the control of the running call, of which this thread alone touches this field; `pass` and the
    // name that it points to live during this call.
    unsafe {
        let measured = &mut (*user.cast::<Control<'_>>()).measured;
        let pass = &*pass;
        if let Some(times) = measured {
            times.push(PassTime {
                kernel: text::kept(pass.kernel).to_owned(),
                seconds: pass.seconds,
                operations: pass.operations,
                bytes: pass.bytes,
                pixels: pass.pixels,
            });
        }
    }
}

fn rect([[x0, y0], [x1, y1]]: Part) -> IsophoteRect {
    IsophoteRect { x0, y0, x1, y1 }
}
