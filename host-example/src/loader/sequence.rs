//! Sequences of frames: the library asks for the images of neighbouring ones as it needs them.

use std::cell::Cell;
use std::ffi::{CStr, c_char, c_void};
use std::marker::PhantomData;

use super::contract::{
    self as c, IsophoteDevice, IsophoteFrames, IsophoteHistory, IsophoteImage, IsophoteReport,
    IsophoteRequest, IsophoteSequence, IsophoteSequenceApi,
};
use super::device::Device;
use super::graph::Graph;
use super::library::Library;
use super::plan::Plan;
use super::process::{self, Control, Report};
use super::refusal::{Answer, Refusal, check};
use super::text;
use crate::pixels::Pixels;

/// Name of the extension.
const EXTENSION: &CStr = c"isophote.sequence/1";

/// What the library keeps of a sequence. One thread at a time may use it.
#[derive(Debug)]
pub struct Sequence {
    table: &'static IsophoteSequenceApi,
    handle: IsophoteSequence,
    one_thread: PhantomData<Cell<()>>,
}

/// Gives the image that an input, such as `color` or `motion`, shows in a frame; none where there is none.
pub type Footage<'a> = &'a dyn Fn(&str, i64) -> Option<&'a Pixels>;

impl Library {
    fn sequences(&self) -> Answer<&'static IsophoteSequenceApi> {
        // SAFETY: the name ends with a zero.
        let table = unsafe { (self.api.extension)(EXTENSION.as_ptr()) }.cast::<IsophoteSequenceApi>();
        let missing = || Refusal {
            status: c::ISOPHOTE_ERROR_UNSUPPORTED,
            message: "this library knows nothing of sequences".into(),
        };
        // SAFETY: an extension's struct begins with its size, and is constant as long as the library is loaded, which is
        // until the process ends.
        let table = unsafe { table.as_ref() }.ok_or_else(missing)?;
        if (table.struct_size as usize) < size_of::<IsophoteSequenceApi>() {
            Err(missing())
        } else {
            Ok(table)
        }
    }

    /// A sequence of which stages are kept in at most `memory` bytes.
    ///
    /// # Errors
    /// [`Refusal`] when the library has no sequences, or `max_motion`, in pixels, is out of range; 0 is the library's own.
    pub fn sequence(&self, memory: u64, max_motion: f32) -> Answer<Sequence> {
        let table = self.sequences()?;
        let mut handle = Default::default();
        let (status, message) = text::message(|error| {
            // SAFETY: both places may be written during the call.
            unsafe { (table.create)(memory, max_motion, error, &raw mut handle) }
        });
        check(status, || message)?;
        Ok(Sequence { table, handle, one_thread: PhantomData })
    }

    /// Frames before and after its own that a frame of `graph` depends on.
    ///
    /// # Errors
    /// [`Refusal`] when the graph has no output.
    pub fn frames(&self, graph: &Graph) -> Answer<[u32; 2]> {
        let table = self.sequences()?;
        let [mut past, mut future] = [0; 2];
        // SAFETY: the handle is the graph's; both places may be written.
        let status = unsafe { (table.frames)(graph.handle, &raw mut past, &raw mut future) };
        graph.check(status)?;
        Ok([past, future])
    }

    /// Plans the whole picture of `request` where so many frames before it are known.
    ///
    /// # Errors
    /// [`Refusal`] when an input that is needed is open, or the size is impossible.
    pub fn plan_in_order(
        &self,
        graph: &Graph,
        request: &IsophoteRequest,
        history: &IsophoteHistory,
    ) -> Answer<Plan> {
        let table = self.sequences()?;
        Plan::made(self.api, |error, plan| {
            // SAFETY: the handle is the graph's; request and history are read and the others written during the call.
            unsafe { (table.plan_create)(graph.handle, request, history, std::ptr::null(), error, plan) }
        })
    }
}

impl Sequence {
    /// Computes a frame into `target`, on `device` or else on the CPU.
    ///
    /// # Errors
    /// [`Refusal`] when an image is missing or has another size than the request, and when the device fails; `target` is
    /// then as before.
    pub fn process(
        &mut self,
        graph: &mut Graph,
        device: Option<&Device>,
        request: &IsophoteRequest,
        footage: Footage<'_>,
        target: &mut Pixels,
        control: &mut Control<'_>,
    ) -> Answer<Report> {
        let frames = IsophoteFrames {
            user: (&raw const footage).cast_mut().cast(),
            input: Some(input),
            release: None,
        };
        let target = process::target(target);
        let control = process::control(control);
        let mut report = IsophoteReport::default();
        // SAFETY: the handles are their objects'. The function gets `footage`, borrowed for the whole call, whose images are
        // borrowed for longer; target and control are as for `Graph::process`.
        let status = unsafe {
            (self.table.process)(
                self.handle,
                graph.handle,
                device.map_or_else(IsophoteDevice::default, |d| d.handle),
                request,
                &raw const frames,
                std::ptr::null(),
                &raw const target,
                &raw const control,
                &raw mut report,
            )
        };
        check(status, || {
            // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
            text::message(|out| unsafe { (self.table.error)(self.handle, out) }).1
        })?;
        Ok(Report { replaced: report.replaced, seconds: report.seconds })
    }
}

impl Drop for Sequence {
    fn drop(&mut self) {
        // Nobody is left who could do anything about a failure.
        // SAFETY: the handle is this object's and not used again.
        let _ = unsafe { (self.table.destroy)(self.handle) };
    }
}

/// Called on the thread that called `process`, while it does not return.
unsafe extern "C" fn input(
    user: *mut c_void,
    name: *const c_char,
    frame: i64,
    out: *mut IsophoteImage,
) -> i32 {
    // SAFETY: `user` is the footage of the running call, `name` ends with a zero and lives during this call, and `out` may
    // be written.
    unsafe {
        let footage = *user.cast::<Footage<'_>>();
        match footage(text::kept(name), frame) {
            Some(pixels) => {
                out.write(process::image(pixels));
                1
            }
            None => 0,
        }
    }
}
