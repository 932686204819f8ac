//! The C face: one exported symbol, and the table of functions that it gives out.
//!
//! Every function goes through [`guard`], which catches panics, turns every [`failure`] into a status and
//! keeps messages. Hosts hold numbers, not pointers ([`handles`]), so that a wrong one is an error. Raw
//! pointers are touched in [`args`], [`images`], [`threads`] and nowhere else if it can be helped; Vulkan is called in
//! `vulkan` alone.

pub mod args;
pub mod by_rows;
pub mod catalogue;
pub mod device;
pub mod entry;
pub mod failure;
pub mod graph;
pub mod guard;
pub mod guides;
pub mod handles;
pub mod images;
pub mod memory;
pub mod objects;
pub mod pixel_aspect;
pub mod plan;
pub mod precision;
pub mod presets;
pub mod process;
pub mod request;
pub mod run;
pub mod sequence;
pub mod shader;
pub mod threads;
#[cfg(not(target_vendor = "apple"))]
pub mod vulkan;
pub mod warm;

use isophote_abi::{ISOPHOTE_ABI_VERSION, IsophoteApi, IsophoteStatus};
use std::ffi::{CStr, c_char, c_void};

/// The functions of ABI version 1.
pub static API: IsophoteApi = IsophoteApi {
    abi_version: ISOPHOTE_ABI_VERSION,
    struct_size: size_of::<IsophoteApi>() as u32,
    version: concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast(),
    status_name,
    trim,
    catalogue: catalogue::catalogue,
    find_node: catalogue::find_node,
    graph_create: graph::create,
    graph_create_single: graph::create_single,
    graph_create_from_json: graph::create_from_json,
    graph_destroy: graph::destroy,
    graph_error: graph::error,
    graph_to_json: graph::to_json,
    graph_add: graph::add,
    graph_count: graph::count,
    graph_find: graph::find,
    graph_name: graph::name,
    graph_spec: graph::spec,
    graph_set_float: graph::params::set_float,
    graph_set_int: graph::params::set_int,
    graph_set_bool: graph::params::set_bool,
    graph_set_choice: graph::params::set_choice,
    graph_set_color: graph::params::set_color,
    graph_set_text: graph::params::set_text,
    graph_get: graph::params::get,
    graph_connect: graph::connect,
    graph_connect_input: graph::connect_input,
    graph_disconnect: graph::disconnect,
    graph_set_output: graph::set_output,
    graph_output_kind: graph::output_kind,
    request_init: request::init,
    graph_support: process::support,
    process: process::process,
    plan_create: plan::create,
    plan_destroy: plan::destroy,
    plan_error: plan::error,
    plan_update: plan::update,
    plan_textures: plan::textures,
    plan_passes: plan::passes,
    plan_shader: plan::shader,
    device_create: device::create,
    device_destroy: device::destroy,
    device_error: device::error,
    device_name: device::name,
    extension,
};

unsafe extern "C" fn status_name(status: IsophoteStatus) -> *const c_char {
    const NAMES: [&CStr; 17] = [
        c"ok",
        c"invalid argument",
        c"invalid handle",
        c"unknown name",
        c"wrong type",
        c"out of range",
        c"connection",
        c"malformed",
        c"geometry",
        c"input",
        c"unsupported",
        c"cancelled",
        c"no device",
        c"device",
        c"out of memory",
        c"truncated",
        c"internal error",
    ];
    NAMES.get(status as usize).map_or(c"unknown status", |n| n).as_ptr()
}

unsafe extern "C" fn extension(id: *const c_char) -> *const c_void {
    if id.is_null() {
        return std::ptr::null();
    }
    // SAFETY: the host promised text with a closing zero.
    let id = unsafe { CStr::from_ptr(id) };
    match id {
        _ if id == sequence::EXTENSION => (&raw const sequence::API).cast(),
        _ if id == guides::EXTENSION => (&raw const guides::API).cast(),
        _ if id == presets::EXTENSION => (&raw const presets::API).cast(),
        _ if id == pixel_aspect::EXTENSION => (&raw const pixel_aspect::API).cast(),
        _ if id == memory::EXTENSION => (&raw const memory::API).cast(),
        _ if id == precision::EXTENSION => (&raw const precision::API).cast(),
        #[cfg(not(target_vendor = "apple"))]
        _ if id == vulkan::EXTENSION => (&raw const vulkan::API).cast(),
        _ => std::ptr::null(),
    }
}

unsafe extern "C" fn trim() -> IsophoteStatus {
    guard::call(
        || {
            threads::forget_pools();
            objects::forget_memory();
            crate::pool::forget();
            Ok(())
        },
        |_| {},
    )
}
