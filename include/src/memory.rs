//! The extension "isophote.memory/1": pictures of any size within bounded memory, on CPUs.

use super::constants::IsophoteStatus;
use super::types::{IsophoteGraph, IsophoteRect, IsophoteRequest};

/// The functions of the extension "isophote.memory/1". Tags and ownership are those of `IsophoteApi`.
///
/// What `process` computes on the CPU takes memory beside the host's images. A picture for which that would be more than
/// the bound goes through all passes by rows, and then takes a copy of the result in its own format besides. The bits are
/// the same. Fewer rows at a time take longer, and there are always some: where even those need more than the bound,
/// they take it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteMemoryApi {
    /// Bytes of this struct.
    pub struct_size: u32,

    /// [any-thread] Bounds the bytes that images of a call of `process` may take on the CPU, from the next call on; 0 lets the
    /// library choose, which is what it does unless told. It is no part of the graph as text.
    pub graph_set_memory: unsafe extern "C" fn(graph: IsophoteGraph, bytes: u64) -> IsophoteStatus,
    /// [object-thread, not-while-processing, needs-output] Bytes that images of a call of `process` with this request take on
    /// the CPU: those of the plan, without the host's and without a copy of the result.
    pub graph_memory: unsafe extern "C" fn(
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        region: *const IsophoteRect,
        bytes: *mut u64,
    ) -> IsophoteStatus,
}
