//! The extension for memory: a bound on what images take while they are computed on the CPU.

use super::args;
use super::by_rows::Takes;
use super::guard;
use super::objects::GraphObject;
use super::request::{region, request};
use super::threads;
use isophote_abi::*;
use std::ffi::CStr;

/// Name of the extension.
pub const EXTENSION: &CStr = c"isophote.memory/1";

/// The functions of the extension.
pub static API: IsophoteMemoryApi = IsophoteMemoryApi {
    struct_size: size_of::<IsophoteMemoryApi>() as u32,
    graph_set_memory: set,
    graph_memory: memory,
};

unsafe extern "C" fn set(graph: IsophoteGraph, bytes: u64) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| {
        object.set_memory(bytes);
        Ok(())
    })
}

unsafe extern "C" fn memory(
    graph: IsophoteGraph,
    host_request: *const IsophoteRequest,
    host_region: *const IsophoteRect,
    bytes: *mut u64,
) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| {
        // SAFETY: the host promised structs behind the pointers.
        let (request, region) = unsafe {
            let request = request(&args::get(host_request, "the request")?)?;
            (request, region(host_region, &request)?)
        };
        let warm = object.warm(&request)?;
        let takes = warm.plan().map(|plan| Takes::of(plan, region, object.memory(), &*threads::pool(0)));
        object.keep(warm);
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(bytes, takes?.bytes(), "the place for the bytes") }
    })
}
