//! Graphs of nodes.

use std::cell::Cell;
use std::ffi::CStr;
use std::marker::PhantomData;

use super::catalogue::{self, Kind, Node};
use super::error::{Result, check};
use super::library::{Library, extension};
use super::text;
use isophote_abi::{
    IsophoteApi, IsophoteGraph, IsophoteMemoryApi, IsophotePrecision, IsophotePrecisionApi, IsophoteRequest,
    IsophoteStatus, IsophoteText,
};

/// Name of the extension for precision.
const PRECISION: &CStr = c"isophote.precision/1";
/// Name of the extension for memory.
const MEMORY: &CStr = c"isophote.memory/1";

/// A graph of nodes with their parameters.
///
/// One thread at a time may use it, as the contract asks of every object: it is `Send` and not `Sync`.
#[derive(Debug)]
pub struct Graph {
    pub(super) api: &'static IsophoteApi,
    pub(super) handle: IsophoteGraph,
    one_thread: PhantomData<Cell<()>>,
}

/// The number of a graph, which other threads may hold. The library refuses it once the graph is gone.
#[derive(Clone, Copy, Debug)]
pub struct GraphHandle(pub(super) IsophoteGraph);

impl Library {
    /// A graph of one node whose inputs are the pictures of the same name.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such node, naming the nearest.
    pub fn single(&self, node: &str) -> Result<Graph> {
        let node = text::argument(node)?;
        self.graph(|error, graph| {
            // SAFETY: the id ends with a zero; the other two may be written during the call.
            unsafe { (self.api.graph_create_single)(node.as_ptr(), error, graph) }
        })
    }

    /// The graph that a JSON text describes.
    ///
    /// # Errors
    /// [`Error`](crate::Error) saying what is wrong with it and where.
    pub fn graph_from_json(&self, json: &str) -> Result<Graph> {
        let json = text::argument(json)?;
        self.graph(|error, graph| {
            // SAFETY: the text ends with a zero; the other two may be written during the call.
            unsafe { (self.api.graph_create_from_json)(json.as_ptr(), error, graph) }
        })
    }

    fn graph(
        &self,
        create: impl FnOnce(*mut IsophoteText, *mut IsophoteGraph) -> IsophoteStatus,
    ) -> Result<Graph> {
        let mut handle = Default::default();
        let (status, message) = text::message(|error| create(error, &raw mut handle));
        check(status, || message)?;
        Ok(self.graph_of(handle))
    }

    /// The object of a handle that nobody else destroys.
    pub(super) fn graph_of(&self, handle: IsophoteGraph) -> Graph {
        Graph { api: self.api, handle, one_thread: PhantomData }
    }
}

impl Graph {
    /// Adds a node under a name of its own, and returns its index.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such node, or the name is taken.
    pub fn add(&mut self, name: &str, node: &str) -> Result<u32> {
        let (name, node) = (text::argument(name)?, text::argument(node)?);
        let mut index = 0;
        // SAFETY: the handle is this object's, both texts end with a zero, `index` may be written.
        let status =
            unsafe { (self.api.graph_add)(self.handle, name.as_ptr(), node.as_ptr(), &raw mut index) };
        self.check(status)?;
        Ok(index)
    }

    /// Connects the output of node `from` to an input of node `to`.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such node or input, or the two do not fit.
    pub fn connect(&mut self, from: u32, to: u32, port: &str) -> Result<()> {
        let port = text::argument(port)?;
        // SAFETY: the handle is this object's, and the text ends with a zero.
        let status = unsafe { (self.api.graph_connect)(self.handle, from, to, port.as_ptr()) };
        self.check(status)
    }

    /// Connects a picture that enters the graph to the input of node `to` that bears its name.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such picture, node or input.
    pub fn connect_input(&mut self, input: &str, to: u32) -> Result<()> {
        let input = text::argument(input)?;
        // SAFETY: the handle is this object's, and the text ends with a zero.
        let status =
            unsafe { (self.api.graph_connect_input)(self.handle, input.as_ptr(), to, input.as_ptr()) };
        self.check(status)
    }

    /// Makes the output of a node that of the graph.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such node.
    pub fn set_output(&mut self, node: u32) -> Result<()> {
        // SAFETY: the handle is this object's.
        let status = unsafe { (self.api.graph_set_output)(self.handle, node) };
        self.check(status)
    }

    /// Its number.
    pub const fn handle(&self) -> GraphHandle {
        GraphHandle(self.handle)
    }

    /// Number of nodes, whose indices count from 0.
    pub fn count(&self) -> u32 {
        let mut count = 0;
        // SAFETY: the handle is this object's; `count` may be written during the call.
        let status = unsafe { (self.api.graph_count)(self.handle, &raw mut count) };
        if self.check(status).is_ok() { count } else { 0 }
    }

    /// Name of a node within the graph.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such index.
    pub fn name(&self, node: u32) -> Result<String> {
        // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
        let (status, name) = text::whole(|out| unsafe { (self.api.graph_name)(self.handle, node, out) });
        self.check(status)?;
        Ok(name)
    }

    /// Declaration of a node.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such index.
    pub fn spec(&self, node: u32) -> Result<Node> {
        let mut spec = std::ptr::null();
        // SAFETY: the handle is this object's; `spec` may be written during the call.
        let status = unsafe { (self.api.graph_spec)(self.handle, node, &raw mut spec) };
        self.check(status)?;
        // SAFETY: success means that `spec` points to a node of the library, which is never unloaded.
        Ok(unsafe { catalogue::node(&*spec) })
    }

    /// True where a node of it can use pictures of a kind.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn can_use(&self, kind: Kind) -> Result<bool> {
        for node in 0..self.count() {
            if self.spec(node)?.inputs.iter().any(|port| port.kind == kind) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Sets how precisely graphics devices compute it.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library computes exactly alone.
    pub fn set_precision(&self, precision: IsophotePrecision) -> Result<()> {
        let table =
            extension::<IsophotePrecisionApi>(self.api, PRECISION, "this library computes exactly alone")?;
        // SAFETY: the handle is this object's.
        self.check(unsafe { (table.graph_set_precision)(self.handle, precision) })
    }

    /// Bounds the bytes that images of a run may take on the CPU; 0 lets the library choose. Larger pictures are computed by rows,
    /// with the same bits.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library knows no bounds.
    pub fn set_memory(&self, bytes: u64) -> Result<()> {
        // SAFETY: the handle is this object's.
        self.check(unsafe { (self.bounds()?.graph_set_memory)(self.handle, bytes) })
    }

    /// Bytes that images of a run with this request take on the CPU, beside those of the caller and a copy of the result.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library knows no bounds or refuses the request.
    pub fn memory(&self, request: &IsophoteRequest) -> Result<u64> {
        let mut bytes = 0;
        // SAFETY: the handle is this object's; the request is read during the call, and the number may be written.
        let status =
            unsafe { (self.bounds()?.graph_memory)(self.handle, request, std::ptr::null(), &raw mut bytes) };
        self.check(status)?;
        Ok(bytes)
    }

    fn bounds(&self) -> Result<&'static IsophoteMemoryApi> {
        extension(self.api, MEMORY, "this library knows no bounds of memory")
    }

    /// Sets a parameter from text as a person writes it: `2.5`, `true`, `scharr3`, `#12407b`.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such parameter, or it cannot have this value.
    pub fn set(&self, node: u32, param: &str, value: &str) -> Result<()> {
        let (param, value) = (text::argument(param)?, text::argument(value)?);
        // SAFETY: the handle is this object's; both texts end with a zero.
        let status = unsafe { (self.api.graph_set_text)(self.handle, node, param.as_ptr(), value.as_ptr()) };
        self.check(status)
    }

    /// Sets a parameter that is a number.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when there is no such parameter, it is of another type, or it cannot have this value.
    pub fn set_float(&self, node: u32, param: &str, value: f32) -> Result<()> {
        let param = text::argument(param)?;
        // SAFETY: the handle is this object's, and the text ends with a zero.
        let status =
            unsafe { (self.api.graph_set_float)(self.handle, node, param.as_ptr(), f64::from(value)) };
        self.check(status)
    }

    /// Sets a parameter that is a whole number, or a number.
    ///
    /// # Errors
    /// As [`Graph::set_float`].
    pub fn set_int(&self, node: u32, param: &str, value: i64) -> Result<()> {
        let param = text::argument(param)?;
        // No parameter's range ends beyond those of the contract's numbers.
        let value = value.clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        // SAFETY: the handle is this object's, and the text ends with a zero.
        let status = unsafe { (self.api.graph_set_int)(self.handle, node, param.as_ptr(), value) };
        self.check(status)
    }

    /// Sets a switch.
    ///
    /// # Errors
    /// As [`Graph::set_float`].
    pub fn set_bool(&self, node: u32, param: &str, value: bool) -> Result<()> {
        let param = text::argument(param)?;
        // SAFETY: the handle is this object's, and the text ends with a zero.
        let status = unsafe { (self.api.graph_set_bool)(self.handle, node, param.as_ptr(), value.into()) };
        self.check(status)
    }

    /// Sets a choice by the id of the option.
    ///
    /// # Errors
    /// As [`Graph::set_float`].
    pub fn set_choice(&self, node: u32, param: &str, option: &str) -> Result<()> {
        let (param, option) = (text::argument(param)?, text::argument(option)?);
        // SAFETY: the handle is this object's; both texts end with a zero.
        let status =
            unsafe { (self.api.graph_set_choice)(self.handle, node, param.as_ptr(), option.as_ptr()) };
        self.check(status)
    }

    /// Sets a colour: red, green, blue and alpha, gamma-encoded sRGB, 0 to 1.
    ///
    /// # Errors
    /// As [`Graph::set_float`].
    pub fn set_color(&self, node: u32, param: &str, color: &[f32; 4]) -> Result<()> {
        let param = text::argument(param)?;
        // SAFETY: the handle is this object's, the text ends with a zero, and there are four numbers.
        let status = unsafe { (self.api.graph_set_color)(self.handle, node, param.as_ptr(), color.as_ptr()) };
        self.check(status)
    }

    /// Kind of image that leaves the graph.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when it has no output.
    pub fn output_kind(&self) -> Result<Kind> {
        let mut kind = 0;
        // SAFETY: the handle is this object's; `kind` may be written during the call.
        let status = unsafe { (self.api.graph_output_kind)(self.handle, &raw mut kind) };
        self.check(status)?;
        Ok(Kind::new(kind))
    }

    /// The graph as JSON.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn to_json(&self) -> Result<String> {
        // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
        let (status, json) = text::whole(|out| unsafe { (self.api.graph_to_json)(self.handle, out) });
        self.check(status)?;
        Ok(json)
    }

    pub(super) fn check(&self, status: IsophoteStatus) -> Result<()> {
        check(status, || {
            // SAFETY: the handle is this object's; the text is a buffer of the length that it says.
            text::message(|out| unsafe { (self.api.graph_error)(self.handle, out) }).1
        })
    }
}

impl Drop for Graph {
    fn drop(&mut self) {
        // Nobody is left who could do anything about a failure.
        // SAFETY: the handle is this object's and not used again.
        let _ = unsafe { (self.api.graph_destroy)(self.handle) };
    }
}
