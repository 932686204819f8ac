//! The extension "isophote.precision/1": half the bytes, for graphics devices.

use super::constants::IsophoteStatus;
use super::types::IsophoteGraph;

/// Precision in which graphics devices compute a graph. One of `ISOPHOTE_PRECISION_...`.
pub type IsophotePrecision = u32;
/// Every texture holds 32-bit floats, as the CPU does.
pub const ISOPHOTE_PRECISION_EXACT: u32 = 0;
/// Colours are kept in 16-bit floats, those of outputs too: half the bytes, and eleven bits for each value up to 65504.
/// The rows and columns of windows of up to 17 pixels are one pass: a parameter by which one outgrows that changes the
/// structure of a plan.
pub const ISOPHOTE_PRECISION_HALF: u32 = 1;
/// As half; besides, shaders interpolate colours by a sampler. Its textures are those of the plan with the format
/// `ISOPHOTE_FORMAT_RGBA16F`; what a host binds in the place of such an input must have a format that its device filters.
/// Shaders in WGSL and SPIR-V only.
pub const ISOPHOTE_PRECISION_FAST: u32 = 2;

/// The functions of the extension "isophote.precision/1". Tags and ownership are those of `IsophoteApi`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophotePrecisionApi {
    /// Bytes of this struct.
    pub struct_size: u32,

    /// [any-thread] Sets how precisely graphics devices compute the graph from the next plan, update of a plan or call of
    /// `process` on; exactly, unless set. CPUs always compute exactly. It is no part of the graph as text.
    pub graph_set_precision:
        unsafe extern "C" fn(graph: IsophoteGraph, precision: IsophotePrecision) -> IsophoteStatus,
}
