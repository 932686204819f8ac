//! The table of functions that the library's one symbol gives out.

use super::constants::*;
use super::types::*;
use core::ffi::{c_char, c_void};

/// The library's one symbol, `isophote_api`, as a host looks it up.
///
/// [any-thread] Returns the table of ABI version `abi_version`, or null when this library has none
/// of that number. The table is the library's and valid until the library is unloaded.
pub type IsophoteEntry = Option<unsafe extern "C" fn(abi_version: u32) -> *const IsophoteApi>;

/// The functions of ABI version 1.
///
/// Tags in brackets say where and when a function may be called.
///
/// `any-thread`: from any thread at any time. `object-thread`: calls with the same handle must not overlap in time; with
/// different handles they may. `not-while-processing`: so not while `process` runs on the same graph in another thread, nor
/// from the functions that `process` calls. `also-while-processing`: even then. `needs-output`: once the graph has an
/// output, that is after `graph_set_output`, `graph_create_single` or `graph_create_from_json`.
///
/// Breaking a rule crashes nothing, but it is open which call comes first and whose message is the last. An object
/// may be destroyed while a call uses it: the call ends as if it were still there.
///
/// Ownership: pointers handed in are read or written during the call only. Pointers handed out are
/// the library's, valid for the life of the process unless another end is named.
///
/// Names and text are UTF-8 with a closing zero. Arguments named `error` may be null; they receive
/// the message of a failure. Handles are never reused; what is handed out through a pointer is
/// written on success only, but a handle is set to 0 first.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IsophoteApi {
    /// The ABI version that this table is of.
    pub abi_version: u32,
    /// Size of this table in bytes.
    pub struct_size: u32,
    /// Version of the library, such as "0.1.0".
    pub version: *const c_char,

    /// [any-thread] Name of a status in lower case, such as "out of range"; never null.
    pub status_name: unsafe extern "C" fn(status: IsophoteStatus) -> *const c_char,
    /// [any-thread] Ends the library's worker threads that are idle and gives back memory kept for
    /// later calls. Both return by themselves when they are needed.
    pub trim: unsafe extern "C" fn() -> IsophoteStatus,

    /// [any-thread] All nodes.
    pub catalogue: unsafe extern "C" fn(catalogue: *mut IsophoteCatalogue) -> IsophoteStatus,
    /// [any-thread] The node of an id; the message of a failure names the nearest.
    pub find_node: unsafe extern "C" fn(
        id: *const c_char,
        error: *mut IsophoteText,
        node: *mut *const IsophoteNode,
    ) -> IsophoteStatus,

    /// [any-thread] Makes a graph without nodes. The caller owns it and destroys it.
    pub graph_create:
        unsafe extern "C" fn(error: *mut IsophoteText, graph: *mut IsophoteGraph) -> IsophoteStatus,
    /// [any-thread] Makes a graph of one node, index 0, named like its id: inputs that bear the name
    /// of a picture that enters (`color`, `normal`, `depth`, `object_id`, `mask`, `flow`) are connected to it, and
    /// the node's output is the graph's. The caller owns it and destroys it.
    pub graph_create_single: unsafe extern "C" fn(
        node_id: *const c_char,
        error: *mut IsophoteText,
        graph: *mut IsophoteGraph,
    ) -> IsophoteStatus,
    /// [any-thread] Makes a graph from JSON (format `isophote-graph`, version 1). The caller owns it
    /// and destroys it.
    pub graph_create_from_json: unsafe extern "C" fn(
        json: *const c_char,
        error: *mut IsophoteText,
        graph: *mut IsophoteGraph,
    ) -> IsophoteStatus,
    /// [any-thread, also-while-processing] Destroys a graph. Plans made from it live on.
    pub graph_destroy: unsafe extern "C" fn(graph: IsophoteGraph) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Message of the last failed call on the graph; empty before the first.
    pub graph_error: unsafe extern "C" fn(graph: IsophoteGraph, text: *mut IsophoteText) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Writes the graph as JSON, with the parameters that differ from their
    /// defaults, into the caller's buffer.
    pub graph_to_json: unsafe extern "C" fn(graph: IsophoteGraph, json: *mut IsophoteText) -> IsophoteStatus,

    /// [object-thread, not-while-processing] Adds the node `node_id` under a name of its own, and writes its index to
    /// `node`.
    pub graph_add: unsafe extern "C" fn(
        graph: IsophoteGraph,
        name: *const c_char,
        node_id: *const c_char,
        node: *mut u32,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Number of nodes; their indices count from 0 in the order of addition.
    pub graph_count: unsafe extern "C" fn(graph: IsophoteGraph, count: *mut u32) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Index of the node of a name.
    pub graph_find:
        unsafe extern "C" fn(graph: IsophoteGraph, name: *const c_char, node: *mut u32) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Name of a node within the graph, into the caller's buffer.
    pub graph_name:
        unsafe extern "C" fn(graph: IsophoteGraph, node: u32, name: *mut IsophoteText) -> IsophoteStatus,
    /// [object-thread, not-while-processing] The declaration of a node.
    pub graph_spec: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        spec: *mut *const IsophoteNode,
    ) -> IsophoteStatus,

    /// [object-thread, not-while-processing] Sets a parameter that is a number.
    pub graph_set_float: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        value: f64,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Sets a parameter that is a whole number, or a number.
    pub graph_set_int: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        value: i32,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Sets a switch: 0 is off, any other value on.
    pub graph_set_bool: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        value: u32,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Sets a choice by the id of the option.
    pub graph_set_choice: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        option: *const c_char,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Sets a colour: four numbers R, G, B, A, gamma-encoded sRGB, 0 to 1.
    pub graph_set_color: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        rgba: *const f32,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Sets a parameter of any type from text as a person writes it: `2.5`,
    /// `true`, `scharr3`, `#12407b`, `0.1,0.2,0.5`.
    pub graph_set_text: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        text: *const c_char,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Value of a parameter.
    pub graph_get: unsafe extern "C" fn(
        graph: IsophoteGraph,
        node: u32,
        param: *const c_char,
        value: *mut IsophoteValue,
    ) -> IsophoteStatus,

    /// [object-thread, not-while-processing] Connects the output of node `from` to an input of node `to`, instead of
    /// what was there. On failure the graph is as before.
    pub graph_connect:
        unsafe extern "C" fn(graph: IsophoteGraph, from: u32, to: u32, port: *const c_char) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Connects a picture that enters the graph (`color`, `normal`, `depth`,
    /// `object_id`) to an input of node `to`.
    pub graph_connect_input: unsafe extern "C" fn(
        graph: IsophoteGraph,
        input: *const c_char,
        to: u32,
        port: *const c_char,
    ) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Opens an input of node `to`.
    pub graph_disconnect:
        unsafe extern "C" fn(graph: IsophoteGraph, to: u32, port: *const c_char) -> IsophoteStatus,
    /// [object-thread, not-while-processing] Makes the output of a node the graph's.
    pub graph_set_output: unsafe extern "C" fn(graph: IsophoteGraph, node: u32) -> IsophoteStatus,
    /// [object-thread, not-while-processing, needs-output] What leaves the graph.
    pub graph_output_kind:
        unsafe extern "C" fn(graph: IsophoteGraph, kind: *mut IsophoteKind) -> IsophoteStatus,

    /// [any-thread] Fills a request for a whole picture: full scale, sRGB, premultiplied, no guides.
    pub request_init:
        unsafe extern "C" fn(width: u32, height: u32, request: *mut IsophoteRequest) -> IsophoteStatus,
    /// [object-thread, not-while-processing, needs-output] What `region` of the result (null: the whole picture) reads of the input
    /// `input`, or of all inputs together when that is null.
    pub graph_support: unsafe extern "C" fn(
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        region: *const IsophoteRect,
        input: *const c_char,
        support: *mut IsophoteSupport,
    ) -> IsophoteStatus,
    /// [object-thread, needs-output] Computes `region` of the result (null: the whole picture) and writes it
    /// to `target`, which must hold it; other pixels stay as they are, and on any failure all do.
    ///
    /// `inputs` are `input_count` images that must each hold what `graph_support` names. Guides that
    /// are not given count as open; inputs that the graph does not read are ignored. `device` is 0 for
    /// the CPU, where a region is the same bit for bit whether it is computed alone or not. `control`
    /// and `report` may be null. Memory is kept with the graph for the next call of the same request.
    pub process: unsafe extern "C" fn(
        graph: IsophoteGraph,
        device: IsophoteDevice,
        request: *const IsophoteRequest,
        inputs: *const IsophoteInput,
        input_count: u32,
        region: *const IsophoteRect,
        target: *const IsophoteTarget,
        control: *const IsophoteControl,
        report: *mut IsophoteReport,
    ) -> IsophoteStatus,

    /// [any-thread, also-while-processing, needs-output] Makes a plan that computes `region` (null: the whole picture) of what `graph` gives
    /// now, as data for the host's own graphics device. The caller owns it and destroys it.
    pub plan_create: unsafe extern "C" fn(
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        region: *const IsophoteRect,
        error: *mut IsophoteText,
        plan: *mut IsophotePlan,
    ) -> IsophoteStatus,
    /// [any-thread] Destroys a plan and with it every texture and pass that it handed out.
    pub plan_destroy: unsafe extern "C" fn(plan: IsophotePlan) -> IsophoteStatus,
    /// [object-thread] Message of the last failed call on the plan; empty before the first.
    pub plan_error: unsafe extern "C" fn(plan: IsophotePlan, text: *mut IsophoteText) -> IsophoteStatus,
    /// [object-thread] Takes over the parameters and connections that `graph` has now, and
    /// reports what changed. `request` is null for the plan's own, or another of the same size: its frame and origin
    /// change uniforms only. When only uniforms changed, the bytes that `IsophotePass` points to were
    /// rewritten in place; when the structure changed, textures and passes must be asked for again
    /// and earlier pointers are void. After a failure the plan is as before.
    pub plan_update: unsafe extern "C" fn(
        plan: IsophotePlan,
        graph: IsophoteGraph,
        request: *const IsophoteRequest,
        change: *mut IsophoteChange,
    ) -> IsophoteStatus,
    /// [object-thread] All textures: inputs, outputs, then transients. The array is the plan's,
    /// until it is destroyed or its structure changes.
    pub plan_textures: unsafe extern "C" fn(
        plan: IsophotePlan,
        textures: *mut *const IsophoteTexture,
        count: *mut u32,
    ) -> IsophoteStatus,
    /// [object-thread] All passes in the order of execution. The array and what it points to are
    /// the plan's, until it is destroyed or its structure changes.
    pub plan_passes: unsafe extern "C" fn(
        plan: IsophotePlan,
        passes: *mut *const IsophotePass,
        count: *mut u32,
    ) -> IsophoteStatus,
    /// [object-thread] The shader of pass `pass` in a language, translated when it is first asked
    /// for. It is valid for the life of the process.
    pub plan_shader: unsafe extern "C" fn(
        plan: IsophotePlan,
        pass: u32,
        language: IsophoteLanguage,
        shader: *mut *const IsophoteShader,
    ) -> IsophoteStatus,

    /// [any-thread] Opens a graphics device of the library's own. `adapter` is `gpu` for hardware only,
    /// `software` for a driver on the CPU, or a part of the adapter's name; null takes the best there
    /// is. Graphics drivers are loaded now and not before. The caller owns it and destroys it.
    pub device_create: unsafe extern "C" fn(
        adapter: *const c_char,
        error: *mut IsophoteText,
        device: *mut IsophoteDevice,
    ) -> IsophoteStatus,
    /// [any-thread] Destroys a device, once the calls that use it have ended.
    pub device_destroy: unsafe extern "C" fn(device: IsophoteDevice) -> IsophoteStatus,
    /// [object-thread] Message of the last failed call on the device; empty before the first.
    pub device_error: unsafe extern "C" fn(device: IsophoteDevice, text: *mut IsophoteText) -> IsophoteStatus,
    /// [object-thread] Name of the device's adapter, into the caller's buffer, and whether it
    /// computes on the CPU (1). Each may be null.
    pub device_name: unsafe extern "C" fn(
        device: IsophoteDevice,
        name: *mut IsophoteText,
        software: *mut u32,
    ) -> IsophoteStatus,

    /// [any-thread] What an extension of this table offers, by its name: a struct that the extension's own header declares,
    /// valid for the life of the process. Null for names that this library does not know, an empty one and null.
    pub extension: unsafe extern "C" fn(id: *const c_char) -> *const c_void,
}

// SAFETY: a table and the texts that it points to are constant, and its functions say themselves who may call them.
#[allow(unsafe_code, reason = "the table holds pointers to text, which nobody writes")]
unsafe impl Sync for IsophoteApi {}
// SAFETY: as above.
#[allow(unsafe_code, reason = "as above")]
unsafe impl Send for IsophoteApi {}
