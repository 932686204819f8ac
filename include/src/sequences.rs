//! The extension "isophote.sequence/1" for sequences of frames: what neighbouring frames have in common is computed once and kept.

use super::constants::IsophoteStatus;
use super::types::*;
use core::ffi::{c_char, c_void};

/// State that is kept of a sequence of frames. Its number is never 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteSequence {
    /// The handle.
    pub id: u64,
}

/// Callback by which the library asks for the images of frames.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteFrames {
    /// Handed to both functions.
    pub user: *mut c_void,
    /// Gives the image that a graph's input, such as "color" or "motion", shows in a frame: fills `image` and returns 1,
    /// or returns 0 where there is none. Neighbouring frames are asked for from the nearest on, up to the first that has
    /// no colour; that one and those behind it count for nothing. The image stays valid until `release` or, without it,
    /// until `sequence_process` returns. Called on the calling thread, and must not call functions on the sequence.
    pub input: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            input: *const c_char,
            frame: i64,
            image: *mut IsophoteImage,
        ) -> i32,
    >,
    /// Takes back an image, which was copied. May be null.
    pub release: Option<
        unsafe extern "C" fn(
            user: *mut c_void,
            input: *const c_char,
            frame: i64,
            image: *const IsophoteImage,
        ),
    >,
}

/// Images that a plan for frames in order reads and gives besides those of one frame.
///
/// The plan's textures of stages: an output "stage0" is what the frame found, an input "stage0@-1" what the frame before
/// did, and so on. A host hands each frame's outputs to the frames after it, and other inputs, such as "depth@-1",
/// likewise.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct IsophoteHistory {
    /// Frames before this one that are known, at most those that `frames` names.
    pub past: u32,
    /// Longest motion from frame to frame that counts, in pixels of the full-size picture; 0 for the library's own.
    pub max_motion: f32,
}

/// The functions of the extension "isophote.sequence/1". Tags and ownership are those of `IsophoteApi`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteSequenceApi {
    /// Size of this table in bytes.
    pub struct_size: u32,

    /// [any-thread, needs-output] Frames before and after its own that a frame of the graph depends on; 0 and 0 for
    /// graphs of stills.
    pub frames:
        unsafe extern "C" fn(graph: IsophoteGraph, past: *mut u32, future: *mut u32) -> IsophoteStatus,

    /// [any-thread] Makes a sequence, which keeps stages of frames in at most `memory` bytes; with 0 it keeps none, and
    /// computes them again for each frame. `max_motion` is the longest motion from frame to frame that counts, in pixels
    /// of the full-size picture; 0 for the library's own. The caller owns it and destroys it.
    pub create: unsafe extern "C" fn(
        memory: u64,
        max_motion: f32,
        error: *mut IsophoteText,
        sequence: *mut IsophoteSequence,
    ) -> IsophoteStatus,
    /// [any-thread] Destroys a sequence, once the calls that use it have ended.
    pub destroy: unsafe extern "C" fn(sequence: IsophoteSequence) -> IsophoteStatus,
    /// [object-thread, also-while-processing] Message of the last failed call on the sequence; empty before the first.
    pub error: unsafe extern "C" fn(sequence: IsophoteSequence, text: *mut IsophoteText) -> IsophoteStatus,
    /// [any-thread] Gives back the memory of all stages. Called when frames of the same numbers show something else, too.
    pub forget: unsafe extern "C" fn(sequence: IsophoteSequence) -> IsophoteStatus,

    /// [any-thread, needs-output] `IsophoteApi::process` of the frame that the request names, with inputs pulled from
    /// `frames` as far as they are needed; `guides` of the request says which there are, in all frames alike. Calls on
    /// one sequence wait for each other. A frame's pixels depend on the frames around it that are known, and never on
    /// which were computed before. Stages are kept where `region` is the whole picture, or null.
    pub process: unsafe extern "C" fn(
        sequence: IsophoteSequence,
        graph: IsophoteGraph,
        device: IsophoteDevice,
        request: *const IsophoteRequest,
        frames: *const IsophoteFrames,
        region: *const IsophoteRect,
        target: *const IsophoteTarget,
        control: *const IsophoteControl,
        report: *mut IsophoteReport,
    ) -> IsophoteStatus,

    /// [any-thread, needs-output] `IsophoteApi::plan_create` of a frame in order.
    pub plan_create: unsafe extern "C" fn(
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        history: *const IsophoteHistory,
        region: *const IsophoteRect,
        error: *mut IsophoteText,
        plan: *mut IsophotePlan,
    ) -> IsophoteStatus,
}
