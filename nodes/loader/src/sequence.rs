//! Sequences of frames: the library asks for the images of neighbouring ones as it needs them.

use std::cell::Cell;
use std::ffi::{CStr, c_char, c_void};
use std::marker::PhantomData;

use super::device::Device;
use super::error::{Result, check};
use super::graph::{Graph, GraphHandle};
use super::history::Past;
use super::image::{AsImage, AsTarget};
use super::library::Library;
use super::plan::{Plan, Role};
use super::process::{self, Control, Report};
use super::text;
use isophote_abi::{
    IsophoteDevice, IsophoteFrames, IsophoteHistory, IsophoteImage, IsophoteReport, IsophoteRequest,
    IsophoteSequence, IsophoteSequenceApi, IsophoteStatus,
};

/// Name of the extension.
const EXTENSION: &CStr = c"isophote.sequence/1";

/// State that the library keeps of a sequence. One thread at a time may use it.
#[derive(Debug)]
pub struct Sequence {
    table: &'static IsophoteSequenceApi,
    handle: IsophoteSequence,
    one_thread: PhantomData<Cell<()>>,
}

/// Images of frames during one call.
struct Frames<'a, P> {
    /// Gives the image that an input shows in a frame.
    image: &'a mut dyn FnMut(&str, i64) -> Option<P>,
    /// Images that the library has not released. They are boxed, since their own place must stay, too.
    lent: Vec<Box<P>>,
}

impl Library {
    fn sequences(&self) -> Result<&'static IsophoteSequenceApi> {
        self.extension(EXTENSION, "this library knows nothing of sequences")
    }

    /// A sequence of which stages are kept in at most `memory` bytes.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library has no sequences, or `max_motion`, in pixels, is out of range; 0 is the library's own.
    pub fn sequence(&self, memory: u64, max_motion: f32) -> Result<Sequence> {
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
    /// [`Error`](crate::Error) when the graph has no output.
    pub fn frames(&self, graph: &Graph) -> Result<[u32; 2]> {
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
    /// [`Error`](crate::Error) when an input that is needed is open, or the size is impossible.
    pub fn plan_frame(&self, graph: &Graph, request: &IsophoteRequest, known: u32) -> Result<Plan> {
        if self.frames(graph)? == [0, 0] {
            return graph.plan(request);
        }
        let table = self.sequences()?;
        let history = IsophoteHistory { past: known, max_motion: 0.0 };
        Plan::made(self.api, |error, plan| {
            // SAFETY: the handle is the graph's; request and history are read and the others written during the call.
            unsafe {
                (table.plan_create)(graph.handle, request, &raw const history, std::ptr::null(), error, plan)
            }
        })
    }

    /// Images of frames before that a frame of `graph` reads, where all are known.
    ///
    /// # Errors
    /// As [`Library::plan_frame`].
    pub fn past(&self, graph: &Graph, request: &IsophoteRequest) -> Result<Past> {
        let [frames, _] = self.frames(graph)?;
        if frames == 0 {
            return Ok(Past::default());
        }
        let plan = self.plan_frame(graph, request, frames)?;
        let textures = plan.textures()?;
        Ok(Past::of(textures.iter().filter(|t| t.role == Role::Input).map(|t| t.name)))
    }
}

impl Sequence {
    /// Computes a frame of a graph into `target`, on `device` or else on the CPU. `image` gives the image that an input,
    /// such as `color` or `motion`, shows in a frame, and nothing where there is none; it is called on this thread and
    /// must not use the sequence.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when an image is missing or has another size than the request, and when the device fails; `target` is
    /// then as before.
    pub fn process<P: AsImage>(
        &mut self,
        graph: GraphHandle,
        device: Option<&Device>,
        request: &IsophoteRequest,
        image: &mut dyn FnMut(&str, i64) -> Option<P>,
        target: &mut dyn AsTarget,
        control: &mut Control<'_>,
    ) -> Result<Report> {
        let mut source = Frames { image, lent: Vec::new() };
        let frames = IsophoteFrames {
            user: (&raw mut source).cast(),
            input: Some(input::<P>),
            release: Some(release::<P>),
        };
        let target = target.target().raw;
        let control = process::control(control);
        let mut report = IsophoteReport::default();
        // SAFETY: the sequence's handle is this object's, and a graph's is refused where it is wrong. The functions get
        // `source`, which lives as long as the call and keeps images until they are released; target and control are as for
        // `Graph::process`.
        let status = unsafe {
            (self.table.process)(
                self.handle,
                graph.0,
                device.map_or_else(IsophoteDevice::default, |d| d.handle),
                request,
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
    /// [`Error`](crate::Error) when the library fails.
    pub fn forget(&mut self) -> Result<()> {
        // SAFETY: the handle is this object's.
        let status = unsafe { (self.table.forget)(self.handle) };
        self.check(status)
    }

    fn check(&self, status: IsophoteStatus) -> Result<()> {
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
unsafe extern "C" fn input<P: AsImage>(
    user: *mut c_void,
    name: *const c_char,
    frame: i64,
    out: *mut IsophoteImage,
) -> i32 {
    // SAFETY: `user` is the source of the running call, which this thread alone touches; `name` ends with a zero and lives
    // during this call.
    let (source, name) = unsafe { (&mut *user.cast::<Frames<'_, P>>(), text::kept(name)) };
    let Some(pixels) = (source.image)(name, frame) else { return 0 };
    let pixels = Box::new(pixels);
    // SAFETY: `out` may be written.
    unsafe { out.write(pixels.image().raw) };
    source.lent.push(pixels);
    1
}

/// Called on the same thread when an image was copied.
unsafe extern "C" fn release<P: AsImage>(
    user: *mut c_void,
    _: *const c_char,
    _: i64,
    image: *const IsophoteImage,
) {
    // SAFETY: as in `input`; the library hands back the image that it was given.
    let (source, data) = unsafe { (&mut *user.cast::<Frames<'_, P>>(), (*image).data) };
    if let Some(at) = source.lent.iter().position(|lent| lent.image().raw.data == data) {
        source.lent.swap_remove(at);
    }
}
