//! Sequences of frames: the library asks for the arrays of neighbouring ones as it needs them.

use super::contract::{
    ISOPHOTE_ERROR_UNSUPPORTED, IsophoteFrames, IsophoteImage, IsophoteReport, IsophoteSequence,
    IsophoteSequenceApi,
};
use super::graph::Graph;
use super::library::Library;
use super::process::{self, Call, GraphHandle, Report};
use super::refusal::{Answer, Refusal, check};
use super::text;
use crate::array::Pixels;
use std::ffi::{CStr, c_char, c_void};

/// Name of the extension.
const EXTENSION: &CStr = c"isophote.sequence/1";

/// What the library keeps of a sequence.
#[derive(Debug)]
pub struct Sequence {
    table: &'static IsophoteSequenceApi,
    handle: IsophoteSequence,
}

/// Gives the pixels that an input, such as `color` or `motion`, shows in a frame; none where there are none.
pub type Footage<'a> = &'a dyn Fn(&str, i64) -> Option<Pixels>;

/// What the library's question for an image is answered from.
struct Source<'a> {
    footage: Footage<'a>,
    /// The pixels that were given last: the library copies them before it asks for others.
    given: Option<Pixels>,
}

impl Library {
    fn sequences(&self) -> Answer<&'static IsophoteSequenceApi> {
        // SAFETY: the name ends with a zero.
        let table = unsafe { (self.api.extension)(EXTENSION.as_ptr()) }.cast::<IsophoteSequenceApi>();
        // SAFETY: an extension's struct begins with its size, and is constant as long as the library is loaded, which is
        // until the process ends.
        let table = unsafe { table.as_ref() };
        table.filter(|table| table.struct_size as usize >= size_of::<IsophoteSequenceApi>()).ok_or_else(
            || Refusal {
                status: ISOPHOTE_ERROR_UNSUPPORTED,
                message: "this library knows nothing of sequences".into(),
            },
        )
    }

    /// A sequence of which stages are kept in at most `memory` bytes.
    ///
    /// # Errors
    /// [`Refusal`] when the library has no sequences, or `max_motion`, in pixels, is out of range; 0 is the library's own.
    pub fn sequence(&self, memory: u64, max_motion: f32) -> Answer<Sequence> {
        let table = self.sequences()?;
        let mut handle = IsophoteSequence::default();
        let (status, message) = text::message(|error| {
            // SAFETY: both places may be written during the call.
            unsafe { (table.create)(memory, max_motion, error, &raw mut handle) }
        });
        check(status, || message)?;
        Ok(Sequence { table, handle })
    }

    /// Frames before and after its own that a frame of `graph` depends on.
    ///
    /// # Errors
    /// [`Refusal`] when the graph has no output.
    pub fn frames(&self, graph: &Graph) -> Answer<(u32, u32)> {
        let table = self.sequences()?;
        let (mut past, mut future) = (0, 0);
        // SAFETY: the handle is the graph's; both places may be written.
        let status = unsafe { (table.frames)(graph.number(), &raw mut past, &raw mut future) };
        graph.check(status)?;
        Ok((past, future))
    }
}

impl Sequence {
    /// Computes the whole picture of a frame into `target`.
    ///
    /// # Errors
    /// [`Refusal`] when an image is missing or has another size than the request, and when the device fails; `target` is
    /// then as before.
    pub fn process(
        &mut self,
        graph: GraphHandle,
        call: &Call<'_>,
        footage: Footage<'_>,
        target: &Pixels,
    ) -> Answer<Report> {
        let mut source = Source { footage, given: None };
        let frames =
            IsophoteFrames { user: (&raw mut source).cast(), input: Some(input), release: Some(release) };
        let (target, control) = (process::target(target), call.control());
        let mut report = IsophoteReport::default();
        // SAFETY: the handles are those of living objects, or refused. The functions get `source`, which lives as long as the
        // call; target and control are as for `Graph::process`.
        let status = unsafe {
            (self.table.process)(
                self.handle,
                graph,
                call.device,
                call.request,
                &raw const frames,
                std::ptr::null(),
                &raw const target,
                &raw const control,
                &raw mut report,
            )
        };
        self.check(status)?;
        Ok(report.into())
    }

    /// Gives back the memory of all stages.
    ///
    /// # Errors
    /// [`Refusal`] when the library fails.
    pub fn forget(&mut self) -> Answer<()> {
        // SAFETY: the handle is this object's.
        let status = unsafe { (self.table.forget)(self.handle) };
        self.check(status)
    }

    fn check(&self, status: u32) -> Answer<()> {
        check(status, || {
            // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
            text::message(|out| unsafe { (self.table.error)(self.handle, out) }).1
        })
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
    // SAFETY: `user` is the source of the running call, which this thread alone touches, `name` ends with a zero and lives
    // during this call, and `out` may be written.
    unsafe {
        let source = &mut *user.cast::<Source<'_>>();
        source.given = (source.footage)(text::kept(name), frame);
        match &source.given {
            Some(pixels) => {
                out.write(process::image(pixels));
                1
            }
            None => 0,
        }
    }
}

/// Called on the same thread when the image was copied.
unsafe extern "C" fn release(user: *mut c_void, _: *const c_char, _: i64, _: *const IsophoteImage) {
    // SAFETY: as in `input`.
    unsafe { (*user.cast::<Source<'_>>()).given = None };
}
