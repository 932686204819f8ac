//! Running a graph on arrays.

use super::contract::{
    IsophoteControl, IsophoteDevice, IsophoteGraph, IsophoteImage, IsophoteInput, IsophoteReport,
    IsophoteRequest, IsophoteTarget,
};
use super::device::Device;
use super::graph::Graph;
use super::library::{Library, status_name};
use super::refusal::{Answer, check};
use super::text;
use crate::array::Pixels;
use crate::watch::Watch;

/// The number of a device, which may be handed to other threads while the device lives.
pub type DeviceHandle = IsophoteDevice;
/// The number of a graph, which may be handed to other threads while the graph lives.
pub type GraphHandle = IsophoteGraph;

/// An image that enters a graph: its name and the whole picture.
pub type Input = (String, Pixels);

/// How a call is made: where it computes, for which picture, and who watches.
#[derive(Debug)]
pub struct Call<'a> {
    /// 0 for the CPU.
    pub device: DeviceHandle,
    /// The picture.
    pub request: &'a IsophoteRequest,
    /// Threads of the library; 0 for one per core.
    pub threads: u32,
    /// Asked whether to stop, and told how far the work is.
    pub watch: &'a Watch,
}

/// What became of the work.
#[derive(Clone, Copy, Debug)]
pub struct Report {
    /// Samples that were NaN or infinite and were replaced.
    pub replaced: u64,
    /// Wall-clock time in seconds.
    pub seconds: f64,
}

impl From<IsophoteReport> for Report {
    fn from(report: IsophoteReport) -> Self {
        Self { replaced: report.replaced, seconds: report.seconds }
    }
}

impl Call<'_> {
    /// The control as the contract has it; the watch must stay for the whole call.
    pub(super) fn control(&self) -> IsophoteControl {
        IsophoteControl {
            user: std::ptr::from_ref(self.watch).cast_mut().cast(),
            run: None,
            progress: Some(crate::watch::progress),
            cancelled: Some(crate::watch::cancelled),
            measured: None,
            threads: self.threads,
        }
    }
}

impl Library {
    /// Ends worker threads that are idle and gives back memory kept for later calls.
    ///
    /// # Errors
    /// [`super::Refusal`] when the library fails.
    pub fn trim(&self) -> Answer<()> {
        // SAFETY: takes nothing, and may be called at any time.
        let status = unsafe { (self.api.trim)() };
        check(status, || status_name(self.api, status).to_owned())
    }
}

impl Device {
    /// Its number.
    pub fn number(&self) -> DeviceHandle {
        self.handle
    }
}

impl Graph {
    /// Its number.
    pub fn number(&self) -> GraphHandle {
        self.handle
    }

    /// Computes the whole picture into `target`.
    ///
    /// # Errors
    /// [`super::Refusal`] when an image is missing or has another size than the request, and when the device
    /// fails; `target` is then as before.
    pub fn process(&mut self, call: &Call<'_>, inputs: &[Input], target: &Pixels) -> Answer<Report> {
        let names = inputs.iter().map(|(name, _)| text::argument(name)).collect::<Answer<Vec<_>>>()?;
        let images: Vec<IsophoteInput> = names
            .iter()
            .zip(inputs)
            .map(|(name, (_, pixels))| IsophoteInput { name: name.as_ptr(), image: image(pixels) })
            .collect();
        let (target, control) = (self::target(target), call.control());
        let mut report = IsophoteReport::default();
        // SAFETY: the handles are their objects'. Images and target describe the memory of arrays that `inputs` and
        // `target` keep alive, with the strides and sizes that NumPy vouches for, the target's writable. Whoever changes
        // an array meanwhile gets pixels of before or after: samples are copied, and any bits are a sample. The control's
        // functions get the watch, which the caller lends for the whole call.
        let status = unsafe {
            (self.api.process)(
                self.handle,
                call.device,
                call.request,
                images.as_ptr(),
                images.len() as u32,
                std::ptr::null(),
                &raw const target,
                &raw const control,
                &raw mut report,
            )
        };
        self.check(status)?;
        Ok(report.into())
    }
}

pub(super) fn image(pixels: &Pixels) -> IsophoteImage {
    let target = target(pixels);
    IsophoteImage {
        data: target.data.cast_const(),
        row_stride: target.row_stride,
        sample: target.sample,
        channels: target.channels,
        width: target.width,
        height: target.height,
        x: 0,
        y: 0,
    }
}

pub(super) fn target(pixels: &Pixels) -> IsophoteTarget {
    IsophoteTarget {
        data: pixels.data.cast(),
        row_stride: pixels.row_stride,
        sample: pixels.sample,
        channels: pixels.channels,
        width: pixels.width,
        height: pixels.height,
        x: 0,
        y: 0,
    }
}
