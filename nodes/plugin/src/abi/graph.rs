//! Graphs behind handles: making, reading, connecting. Parameters are in [`params`].

pub mod params;

use super::args;
use super::catalogue;
use super::failure::{Failure, Outcome};
use super::guard;
use super::objects::GraphObject;
use isophote::graph::GraphInput;
use isophote::{Graph, NodeId};
use isophote_abi::*;
use std::ffi::c_char;

fn node(graph: &Graph, index: u32) -> Outcome<NodeId> {
    Ok(graph.node(index as usize)?)
}

/// A call on the graph itself.
fn on_graph(graph: IsophoteGraph, body: impl FnOnce(&mut Graph) -> Outcome<()>) -> IsophoteStatus {
    guard::on::<GraphObject>(graph, |object| body(&mut object.lock()))
}

fn graph_input(name: &str) -> Outcome<GraphInput> {
    GraphInput::from_id(name).ok_or_else(|| {
        let known = GraphInput::ALL.map(GraphInput::id).join(", ");
        Failure::new(ISOPHOTE_ERROR_UNKNOWN, format!("a graph has the inputs {known}, not '{name}'"))
    })
}

/// The graph's input of the name that the host gave.
///
/// # Safety
/// `name` is null or points to text with a closing zero.
pub unsafe fn input(name: *const c_char) -> Outcome<GraphInput> {
    // SAFETY: as the caller promised.
    graph_input(unsafe { args::text(name, "the input's name")? })
}

pub(super) unsafe extern "C" fn create(
    error: *mut IsophoteText,
    graph: *mut IsophoteGraph,
) -> IsophoteStatus {
    // SAFETY: the host promised that both places may be written.
    unsafe { guard::create(graph, error, || Ok(GraphObject::new(Graph::new()))) }
}

pub(super) unsafe extern "C" fn create_single(
    node_id: *const c_char,
    error: *mut IsophoteText,
    graph: *mut IsophoteGraph,
) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, and that the places may be written.
    unsafe {
        guard::create(graph, error, || {
            Ok(GraphObject::new(Graph::single(args::text(node_id, "the node's id")?)?))
        })
    }
}

pub(super) unsafe extern "C" fn create_from_json(
    json: *const c_char,
    error: *mut IsophoteText,
    graph: *mut IsophoteGraph,
) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, and that the places may be written.
    unsafe {
        guard::create(graph, error, || {
            Ok(GraphObject::new(Graph::from_json(args::text(json, "the graph's text")?)?))
        })
    }
}

pub(super) unsafe extern "C" fn destroy(graph: IsophoteGraph) -> IsophoteStatus {
    guard::destroy::<GraphObject>(graph)
}

pub(super) unsafe extern "C" fn error(graph: IsophoteGraph, text: *mut IsophoteText) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    unsafe { guard::last_message::<GraphObject>(graph, text) }
}

pub(super) unsafe extern "C" fn to_json(graph: IsophoteGraph, json: *mut IsophoteText) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    on_graph(graph, |graph| unsafe { args::fill(json, &graph.to_json()?) })
}

pub(super) unsafe extern "C" fn add(
    graph: IsophoteGraph,
    name: *const c_char,
    node_id: *const c_char,
    node: *mut u32,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        // SAFETY: the host promised text with a closing zero.
        let (name, id) =
            unsafe { (args::text(name, "the node's name")?, args::text(node_id, "the node's id")?) };
        if node.is_null() {
            return Err(Failure::argument("the place for the node's index is null"));
        }
        let added = graph.add(name, id).map_err(|e| match e {
            // A name that is taken is no value of a parameter.
            isophote::Error::Value(message) => Failure::argument(message),
            other => other.into(),
        })?;
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(node, added.index() as u32, "the place for the node's index") }
    })
}

pub(super) unsafe extern "C" fn count(graph: IsophoteGraph, count: *mut u32) -> IsophoteStatus {
    // SAFETY: the host promised that the place may be written.
    on_graph(graph, |graph| unsafe { args::put(count, graph.len() as u32, "the place for the count") })
}

pub(super) unsafe extern "C" fn find(
    graph: IsophoteGraph,
    name: *const c_char,
    node: *mut u32,
) -> IsophoteStatus {
    // SAFETY: the host promised text with a closing zero, and that the place may be written.
    on_graph(graph, |graph| unsafe {
        let found = graph.find(args::text(name, "the node's name")?)?;
        args::put(node, found.index() as u32, "the place for the node's index")
    })
}

pub(super) unsafe extern "C" fn name(
    graph: IsophoteGraph,
    index: u32,
    name: *mut IsophoteText,
) -> IsophoteStatus {
    // SAFETY: the host promised that the text may be written.
    on_graph(graph, |graph| unsafe { args::fill(name, graph.name(node(graph, index)?)?) })
}

pub(super) unsafe extern "C" fn spec(
    graph: IsophoteGraph,
    index: u32,
    spec: *mut *const IsophoteNode,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        let entry = catalogue::entry(graph.spec(node(graph, index)?)?)?;
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(spec, entry, "the place for the node") }
    })
}

pub(super) unsafe extern "C" fn connect(
    graph: IsophoteGraph,
    from: u32,
    to: u32,
    port: *const c_char,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        // SAFETY: the host promised text with a closing zero.
        let port = unsafe { args::text(port, "the port's name")? };
        Ok(graph.connect(node(graph, from)?, node(graph, to)?, port)?)
    })
}

pub(super) unsafe extern "C" fn connect_input(
    graph: IsophoteGraph,
    name: *const c_char,
    to: u32,
    port: *const c_char,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        // SAFETY: the host promised text with a closing zero.
        let (input, port) = unsafe { (input(name)?, args::text(port, "the port's name")?) };
        Ok(graph.connect_input(input, node(graph, to)?, port)?)
    })
}

pub(super) unsafe extern "C" fn disconnect(
    graph: IsophoteGraph,
    to: u32,
    port: *const c_char,
) -> IsophoteStatus {
    on_graph(graph, |graph| {
        // SAFETY: the host promised text with a closing zero.
        let port = unsafe { args::text(port, "the port's name")? };
        Ok(graph.disconnect(node(graph, to)?, port)?)
    })
}

pub(super) unsafe extern "C" fn set_output(graph: IsophoteGraph, index: u32) -> IsophoteStatus {
    on_graph(graph, |graph| Ok(graph.set_output(node(graph, index)?)?))
}

pub(super) unsafe extern "C" fn output_kind(graph: IsophoteGraph, kind: *mut IsophoteKind) -> IsophoteStatus {
    on_graph(graph, |graph| {
        let found = graph.output_kind().ok_or_else(|| {
            Failure::new(
                ISOPHOTE_ERROR_CONNECTION,
                "the graph has no output; name the node whose result leaves it",
            )
        })?;
        // SAFETY: the host promised that the place may be written.
        unsafe { args::put(kind, catalogue::kind(found), "the place for the kind") }
    })
}
