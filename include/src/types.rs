//! Plain structs that cross the boundary. None of them ever grows: see `ISOPHOTE_ABI_VERSION`.

use super::constants::*;
use core::ffi::{c_char, c_void};

/// A graph of nodes; of one library in one process. Its number is never 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteGraph {
    /// The handle.
    pub id: u64,
}

/// A plan of passes as data. Its number is never 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophotePlan {
    /// The handle.
    pub id: u64,
}

/// A graphics device of the library's own. Its number is 0 for none, which is the CPU.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteDevice {
    /// The handle.
    pub id: u64,
}

/// The caller's buffer for a text that the library writes.
///
/// The library writes at most `capacity` bytes with the closing zero, whole UTF-8 characters only, and
/// puts into `length` how long the text is without the zero. With `data` null and `capacity` 0 it
/// only sets `length`, which is a success.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteText {
    /// Where to write; may be null when `capacity` is 0.
    pub data: *mut c_char,
    /// Size of the buffer in bytes.
    pub capacity: usize,
    /// Set by the library: length of the whole text in bytes.
    pub length: usize,
}

/// A half-open rectangle of pixels, x0 <= x < x1 and y0 <= y < y1, y down.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteRect {
    /// Left column, inclusive.
    pub x0: i32,
    /// Top row, inclusive.
    pub y0: i32,
    /// Right column, exclusive.
    pub x1: i32,
    /// Bottom row, exclusive.
    pub y1: i32,
}

/// One option of a choice.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteChoice {
    /// Stable name.
    pub id: *const c_char,
    /// For people.
    pub label: *const c_char,
}

/// An input or output of a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophotePort {
    /// Stable name.
    pub id: *const c_char,
    /// One sentence.
    pub doc: *const c_char,
    /// Kind of image that it takes or gives.
    pub kind: IsophoteKind,
    /// 1 when the node works without it.
    pub optional: u32,
}

/// One parameter of a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteParam {
    /// Stable name.
    pub id: *const c_char,
    /// For people.
    pub label: *const c_char,
    /// Text for people. Its first paragraph is a hint for panels, in artists' words and at most 160 bytes long; after an
    /// empty line may follow documentation with symbols and sources.
    pub doc: *const c_char,
    /// Heading under which panels show it; empty for the node's own.
    pub group: *const c_char,
    /// Type.
    pub kind: IsophoteParamKind,
    /// Unit of a number.
    pub unit: IsophoteUnit,
    /// 1 when changing it may change the passes of a plan and not only uniform bytes.
    pub structural: u32,
    /// Number of options of a choice; otherwise 0.
    pub choice_count: u32,
    /// Options of a choice; otherwise null.
    pub choices: *const IsophoteChoice,
    /// The default: a number, 0 or 1, the index of an option, or R, G, B, A.
    pub default_value: [f64; 4],
    /// Hard range of a number; values outside are refused.
    pub minimum: f64,
    /// Hard range of a number.
    pub maximum: f64,
    /// Range of a slider, within the hard range.
    pub slider_minimum: f64,
    /// Range of a slider.
    pub slider_maximum: f64,
}

/// The declaration of a node.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteNode {
    /// Stable name.
    pub id: *const c_char,
    /// For people.
    pub label: *const c_char,
    /// `structure`, `smoothing`, `lines`, `painting`, `coherence`, `colour` or `styles`.
    pub group: *const c_char,
    /// Text for people. Its first paragraph is a sentence for lists, in artists' words and at most 160 bytes long; after an
    /// empty line follows documentation with symbols and sources.
    pub doc: *const c_char,
    /// Sections of the thesis, such as "3.4".
    pub section: *const c_char,
    /// Inputs.
    pub inputs: *const IsophotePort,
    /// Its parameters, in the order of panels.
    pub params: *const IsophoteParam,
    /// Number of inputs.
    pub input_count: u32,
    /// Number of parameters.
    pub param_count: u32,
    /// Output.
    pub output: IsophotePort,
}

/// All nodes of the library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteCatalogue {
    /// The nodes, in the order of the catalogue.
    pub nodes: *const IsophoteNode,
    /// Number of nodes.
    pub node_count: u32,
}

/// Value of a parameter.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteValue {
    /// Type of the parameter.
    pub kind: IsophoteParamKind,
    /// Index of the selected option; otherwise 0.
    pub choice_index: u32,
    /// Id of the selected option, valid for the life of the process; otherwise null.
    pub choice: *const c_char,
    /// A number in the first place, 0 or 1, the index of the option, or R, G, B, A.
    pub number: [f64; 4],
}

/// Request of the host for one picture of a graph.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IsophoteRequest {
    /// Width of the whole rendered picture in pixels, 1 to 65536.
    pub width: u32,
    /// Height of the whole rendered picture in pixels, 1 to 65536.
    pub height: u32,
    /// Rendered size over full size, above 0 and at most 64: 0.5 for a half-size proxy. Scales every
    /// parameter in pixels.
    pub scale: f32,
    /// Space of the colour that enters and leaves.
    pub space: IsophoteSpace,
    /// Relation of colour to alpha, entering and leaving.
    pub alpha: IsophoteAlpha,
    /// Which guides the host has, a sum of `ISOPHOTE_GUIDE_...`; connections to others count as open.
    /// `process` goes by the images that it is given instead.
    pub guides: u32,
    /// Column of the canonical picture, in full-size pixels, at which the left border of this one stands: 0 unless it is a
    /// bounding box, or a data window within a display window. Noise, paper, hatching and grids are anchored to the
    /// canonical picture. From -1000000 to 1000000.
    pub origin_x: f64,
    /// Row of the canonical picture at which the top border stands.
    pub origin_y: f64,
    /// Number of the frame; noise that the parameter `hold` lets last for so many frames is drawn anew by it.
    pub frame: i64,
    /// Height of a picture at which parameters in pixels are meant: 1080 gives the same picture the same look at any size.
    /// At least 1/64 of the picture's own height. 0: they are pixels of the full-size picture.
    pub reference_height: u32,
    /// Height of the canonical picture, in full-size pixels, which the reference is compared with: of the display window
    /// where this is a data window. 0: the height of this picture.
    pub canonical_height: u32,
}

/// Pixels of the host's, to be read. The library never keeps the pointer.
///
/// Pixel (i, j) of the image, 0 <= i < width and 0 <= j < height, is pixel (x + i, y + j) of the
/// picture and begins at `data + j * row_stride + i * channels * sample size`. No alignment is
/// needed. Missing colour channels repeat the grey, missing alpha is 1. Of depth and object numbers
/// the first channel is read; integer object numbers are taken as they are, and normals must be
/// floats of three or four channels. Of motions, which are floats, the first two channels are read; what is not finite is
/// unknown.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteImage {
    /// The first pixel of the top row, also where rows go upwards in memory.
    pub data: *const c_void,
    /// Bytes from one row to the one below it: at least a row's bytes, or at most the negative of
    /// them where rows go upwards in memory.
    pub row_stride: isize,
    /// Storage of a sample.
    pub sample: IsophoteSample,
    /// Samples a pixel: 1 (grey), 3 (RGB) or 4 (RGBA); 2 to 4 of motions.
    pub channels: u32,
    /// Columns held.
    pub width: u32,
    /// Rows held.
    pub height: u32,
    /// Column of the picture that the first column shows.
    pub x: i32,
    /// Row of the picture that the first row shows.
    pub y: i32,
}

/// Pixels of the host's, to be written; otherwise as `IsophoteImage`. A scalar result repeats itself
/// in the colour channels, and surplus alpha is 1. The memory may overlap that of the inputs.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteTarget {
    /// The first pixel of the top row, also where rows go upwards in memory.
    pub data: *mut c_void,
    /// Bytes from one row to the one below it.
    pub row_stride: isize,
    /// Storage of a sample.
    pub sample: IsophoteSample,
    /// Samples a pixel: 1, 3 or 4.
    pub channels: u32,
    /// Columns held.
    pub width: u32,
    /// Rows held.
    pub height: u32,
    /// Column of the picture that the first column shows.
    pub x: i32,
    /// Row of the picture that the first row shows.
    pub y: i32,
}

/// An image that enters a graph.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteInput {
    /// `color`, `normal`, `depth`, `object_id`, `mask` or `flow`.
    pub name: *const c_char,
    /// The pixels.
    pub image: IsophoteImage,
}

/// Part of an input that a region of the result reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IsophoteSupport {
    /// The pixels needed, cut at the picture's border; empty when the input is not read.
    pub window: IsophoteRect,
    /// Greatest distance outside a region at which pixels are read, whichever region; 0 when `global`.
    pub halo: u32,
    /// 1 when every pixel may depend on the whole picture, so that it cannot be cut into tiles.
    pub global: u32,
}

/// One job of a batch, to be called by the host's threads: job `index` of `batch`, each once, at the
/// same time or not.
pub type IsophoteJob = Option<unsafe extern "C" fn(batch: u64, index: u32)>;

/// The host's threads: calls `job(batch, 0)` ... `job(batch, jobs - 1)` and returns when all have
/// returned. Called on the thread that called the library. Jobs left out are then done there; a job
/// called later or with a wrong number does nothing.
pub type IsophoteRun =
    Option<unsafe extern "C" fn(user: *mut c_void, jobs: u32, job: IsophoteJob, batch: u64)>;

/// Receives the share of the work done, 0 to 1, on the thread that called the library.
pub type IsophoteProgress = Option<unsafe extern "C" fn(user: *mut c_void, done: f32)>;

/// Asked often, on any thread; another value than 0 stops the work.
pub type IsophoteCancelled = Option<unsafe extern "C" fn(user: *mut c_void) -> u32>;

/// Cost of one pass on the CPU.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophotePassTime {
    /// The kernel; valid during the call.
    pub kernel: *const c_char,
    /// Wall-clock time in seconds.
    pub seconds: f64,
    /// Multiply-adds, or operations of like cost, by the kernel's own estimate.
    pub operations: f64,
    /// Bytes of the images read and written, each once.
    pub bytes: u64,
    /// Pixels written.
    pub pixels: u64,
}

/// Receives the time of each pass, in their order, when the work is done, on the thread that called
/// the library. On a device it is not called.
pub type IsophoteMeasured = Option<unsafe extern "C" fn(user: *mut c_void, pass: *const IsophotePassTime)>;

/// Threads and callbacks of a call. Callbacks may be null, must return normally (no exception, no
/// longjmp), and may themselves call the library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteControl {
    /// Handed to every callback.
    pub user: *mut c_void,
    /// The host's threads, instead of the library's.
    pub run: IsophoteRun,
    /// Receives the progress.
    pub progress: IsophoteProgress,
    /// Asked whether to stop.
    pub cancelled: IsophoteCancelled,
    /// Receives the time of each pass; without it nothing is measured.
    pub measured: IsophoteMeasured,
    /// Threads of the library to use, or how many the host's `run` has; 0 for one per core, 1 for the
    /// calling thread alone. At most 1024.
    pub threads: u32,
}

/// The outcome of the work.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct IsophoteReport {
    /// Samples of the inputs that were NaN or infinite and were replaced (by 0 and the largest half).
    pub replaced: u64,
    /// Wall-clock time of the call in seconds.
    pub seconds: f64,
}

/// One texture of a plan. Two-dimensional, one mip level, one sample.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteTexture {
    /// Name of an input (`color`, `normal`, `depth`, `object_id`) or output (`output`); otherwise null.
    pub name: *const c_char,
    /// Purpose.
    pub role: IsophoteRole,
    /// Format of its texels. An input may have any format of as many channels that is read as floats.
    pub format: IsophoteFormat,
    /// Columns; at least so many.
    pub width: u32,
    /// Rows; at least so many.
    pub height: u32,
    /// 1 for tensors and the like, which need 32 bits; 0 for colours.
    pub field: u32,
    /// Part of the picture, at its own pyramid level, that the texture holds; texel (0, 0) is
    /// (x0, y0).
    pub window: IsophoteRect,
}

/// One dispatch of a plan. Between two there must be a barrier where one reads or writes what the
/// other wrote.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophotePass {
    /// The kernel; passes of the same kernel have the same shader in every language.
    pub kernel: *const c_char,
    /// Bytes of the uniform at binding 0.
    pub grid: *const c_void,
    /// Bytes of the uniform at binding 1; null for a kernel without parameters, whose shader has no
    /// binding 1.
    pub params: *const c_void,
    /// Indices of the textures read, at bindings 2, 3, ...
    pub inputs: *const u32,
    /// Indices of the textures written, at the bindings after those.
    pub outputs: *const u32,
    /// Size of `grid` in bytes, a multiple of 16.
    pub grid_size: u32,
    /// Size of `params` in bytes, a multiple of 4; round it up to 16 for the buffer.
    pub params_size: u32,
    /// Number of textures read.
    pub input_count: u32,
    /// Number of textures written.
    pub output_count: u32,
    /// Workgroups to dispatch in x, y and z.
    pub workgroups: [u32; 3],
    /// Size of a workgroup in x, y and z, as the shader declares it.
    pub workgroup_size: [u32; 3],
}

/// Where a binding of a kernel is found in a shader of some language.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteBinding {
    /// Name of the variable in the kernel.
    pub name: *const c_char,
    /// Number in the kernel, group 0: 0 the grid, 1 the parameters, from 2 the inputs, then the outputs.
    pub binding: u32,
    /// Kind of resource.
    pub kind: IsophoteBindingKind,
    /// WGSL and SPIR-V: the binding of group or set 0, the same as `binding`. HLSL: the register, `b#`
    /// for uniforms, `t#` for sampled, `u#` for storage. MSL: the index among buffers for uniforms,
    /// among textures for the others. GLSL: the binding among uniform blocks, samplers or images.
    pub slot: u32,
}

/// A shader of a kernel. Everything in it is the library's and valid for the life of the process.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteShader {
    /// Text with a closing zero, or words of SPIR-V.
    pub code: *const c_void,
    /// Size of `code` in bytes, without the closing zero.
    pub size: usize,
    /// Name of the entry point in this language.
    pub entry_point: *const c_char,
    /// Where everything is bound.
    pub bindings: *const IsophoteBinding,
    /// Number of bindings.
    pub binding_count: u32,
    /// The language.
    pub language: IsophoteLanguage,
}
