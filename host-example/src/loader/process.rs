//! Running a graph on images in main memory.

use std::ffi::c_void;

use super::contract::{
    self as c, IsophoteControl, IsophoteDevice, IsophoteImage, IsophoteInput, IsophotePassTime,
    IsophoteReport, IsophoteRequest, IsophoteSample, IsophoteTarget,
};
use super::device::Device;
use super::graph::Graph;
use super::refusal::Answer;
use super::text;
use crate::pixels::{Pixels, Precision};

/// An image that enters a graph: the whole picture.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// `color`, `normal`, `depth` and so on.
    pub name: &'a str,
    /// The pixels.
    pub pixels: &'a Pixels,
}

/// How the work is done and watched.
#[derive(Default)]
pub struct Control<'a> {
    /// Threads of the library; 0 for one per core.
    pub threads: u32,
    /// Called with the share of the work done.
    pub progress: Option<&'a mut dyn FnMut(f32)>,
    /// Receives what each pass took; on the CPU only.
    pub measured: Option<&'a mut Vec<PassTime>>,
}

/// What one pass took on the CPU.
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

/// What became of the work.
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
    /// [`super::Refusal`] when an image is missing or has another size than the request, and when the device
    /// fails; `target` is then as before.
    pub fn process(
        &mut self,
        device: Option<&Device>,
        request: &IsophoteRequest,
        inputs: &[Input<'_>],
        target: &mut Pixels,
        control: &mut Control<'_>,
    ) -> Answer<Report> {
        let mut names = Vec::with_capacity(inputs.len());
        for input in inputs {
            names.push(text::argument(input.name)?);
        }
        let images: Vec<IsophoteInput> = names
            .iter()
            .zip(inputs)
            .map(|(name, input)| IsophoteInput { name: name.as_ptr(), image: image(input.pixels) })
            .collect();
        let target = self::target(target);
        let control = self::control(control);
        let mut report = IsophoteReport::default();
        // SAFETY: the handles are their objects'. Images and target describe memory that is borrowed for the
        // whole call, with strides and sizes that `Pixels` vouches for; the callbacks get the caller's control, borrowed
        // for the call too.
        let status = unsafe {
            (self.api.process)(
                self.handle,
                device.map_or_else(IsophoteDevice::default, |d| d.handle),
                request,
                images.as_ptr(),
                images.len() as u32,
                std::ptr::null(),
                &raw const target,
                &raw const control,
                &raw mut report,
            )
        };
        self.check(status)?;
        Ok(Report { replaced: report.replaced, seconds: report.seconds })
    }
}

/// The control as the contract has it; it gets `control`, which must stay for the whole call.
pub(super) fn control(control: &mut Control<'_>) -> IsophoteControl {
    let (threads, wants_times) = (control.threads, control.measured.is_some());
    IsophoteControl {
        user: std::ptr::from_mut(control).cast(),
        run: None,
        progress: Some(progress),
        cancelled: None,
        measured: if wants_times { Some(measured) } else { None },
        threads,
    }
}

/// Called on the thread that called `process`, while it does not return.
unsafe extern "C" fn progress(user: *mut c_void, done: f32) {
    // SAFETY: `user` is the control of the running call, which nothing else touches meanwhile.
    let control = unsafe { &mut *user.cast::<Control<'_>>() };
    if let Some(progress) = &mut control.progress {
        progress(done);
    }
}

/// Called on the thread that called `process`, while it does not return.
unsafe extern "C" fn measured(user: *mut c_void, pass: *const IsophotePassTime) {
    // SAFETY: `user` is the control of the running call, which nothing else touches meanwhile; `pass` and the
    // name that it points to live during this call.
    unsafe {
        let control = &mut *user.cast::<Control<'_>>();
        let pass = &*pass;
        if let Some(times) = &mut control.measured {
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

fn sample(precision: Precision) -> IsophoteSample {
    match precision {
        Precision::U8 => c::ISOPHOTE_SAMPLE_U8,
        Precision::U16 => c::ISOPHOTE_SAMPLE_U16,
        Precision::F16 => c::ISOPHOTE_SAMPLE_F16,
        Precision::F32 => c::ISOPHOTE_SAMPLE_F32,
    }
}

fn row_stride(pixels: &Pixels) -> isize {
    (pixels.width() as usize * pixels.channels() as usize * pixels.precision().bytes()) as isize
}

pub(super) fn image(pixels: &Pixels) -> IsophoteImage {
    IsophoteImage {
        data: pixels.bytes().as_ptr().cast(),
        row_stride: row_stride(pixels),
        sample: sample(pixels.precision()),
        channels: pixels.channels(),
        width: pixels.width(),
        height: pixels.height(),
        x: 0,
        y: 0,
    }
}

pub(super) fn target(pixels: &mut Pixels) -> IsophoteTarget {
    IsophoteTarget {
        row_stride: row_stride(pixels),
        sample: sample(pixels.precision()),
        channels: pixels.channels(),
        width: pixels.width(),
        height: pixels.height(),
        x: 0,
        y: 0,
        data: pixels.bytes_mut().as_mut_ptr().cast(),
    }
}
