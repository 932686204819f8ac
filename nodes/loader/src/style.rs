//! Styles: graphs with parameters as presets set them.

use std::cell::Cell;
use std::marker::PhantomData;

use super::error::{Fault, Result};
use super::graph::{Graph, GraphHandle};
use super::library::Library;
use super::preset::{faulty, listed, pointer, written};
use super::text;
use isophote_abi::{ISOPHOTE_OK, IsophoteFault, IsophotePresetsApi, IsophoteStatus, IsophoteStyle};

/// The parameters of a graph as a style sets them. One thread at a time may use it.
#[derive(Debug)]
pub struct Style {
    library: Library,
    table: &'static IsophotePresetsApi,
    handle: IsophoteStyle,
    one_thread: PhantomData<Cell<()>>,
}

impl Library {
    /// The node of this id, fed with what it needs and no picture gives, or the look that is named `look:ID`.
    ///
    /// # Errors
    /// [`Error`](crate::Error) for a name that neither bears, naming the nearest.
    pub fn style(&self, name: &str) -> Result<Style> {
        let name = text::argument(name)?;
        self.made(|table, style, fault| {
            // SAFETY: the name ends with a zero; the other two may be written during the call.
            unsafe { (table.style_create)(name.as_ptr(), style, fault) }
        })
    }

    /// The preset or graph of this text, which `place` names in messages. `graph` is the text of the graph file that the
    /// preset names, if it names one.
    ///
    /// # Errors
    /// [`Error::Fault`](crate::Error::Fault), the first.
    pub fn style_from_json(&self, place: &str, json: &str, graph: Option<&str>) -> Result<Style> {
        let (json, place) = (text::argument(json)?, text::argument(place)?);
        let graph = graph.map(text::argument).transpose()?;
        self.made(|table, style, fault| {
            let graph = pointer(graph.as_ref());
            // SAFETY: the texts end with a zero, and null is allowed for the last; the other two may be written.
            unsafe { (table.style_create_from_json)(json.as_ptr(), place.as_ptr(), graph, style, fault) }
        })
    }

    fn made(
        &self,
        create: impl FnOnce(&IsophotePresetsApi, *mut IsophoteStyle, *mut IsophoteFault) -> IsophoteStatus,
    ) -> Result<Style> {
        let table = self.presets()?;
        let mut handle = IsophoteStyle::default();
        faulty(|fault| create(table, &raw mut handle, fault))?;
        Ok(Style { library: self.clone(), table, handle, one_thread: PhantomData })
    }
}

impl Style {
    /// The graph with the values of its parameters; those with keyframes have that of the first.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn graph(&self) -> Result<Graph> {
        let mut graph = Default::default();
        // SAFETY: the handle is this object's; the other two may be written during the call.
        faulty(|fault| unsafe { (self.table.style_graph)(self.handle, &raw mut graph, fault) })?;
        Ok(self.library.graph_of(graph))
    }

    /// The reference height of requests for it.
    pub fn reference_height(&self) -> u32 {
        let mut height = 0;
        // SAFETY: the handle is this object's; the place may be written.
        let status = unsafe { (self.table.style_reference_height)(self.handle, &raw mut height) };
        if status == ISOPHOTE_OK { height } else { 0 }
    }

    /// Sets a parameter of its graph for all frames, from text as a person writes it. `name` is its id, or `node.id` for one
    /// node of a graph. Returns the index of its node.
    ///
    /// # Errors
    /// [`Error::Fault`](crate::Error::Fault) without a place: no such parameter, or a value that it cannot have.
    pub fn set(&self, graph: GraphHandle, name: &str, value: &str) -> Result<u32> {
        let (name, value) = (text::argument(name)?, text::argument(value)?);
        let mut node = 0;
        faulty(|fault| {
            // SAFETY: the handles are these objects'; the texts end with a zero, and the others may be written.
            unsafe {
                let set = self.table.style_set;
                set(self.handle, graph.0, name.as_ptr(), value.as_ptr(), &raw mut node, fault)
            }
        })?;
        Ok(node)
    }

    /// Gives parameters with keyframes their values at a frame in its graph. Returns true where there are any.
    ///
    /// # Errors
    /// [`Error::Fault`](crate::Error::Fault) for a value that a parameter cannot have.
    pub fn at_frame(&self, graph: GraphHandle, frame: i64) -> Result<bool> {
        let mut changes = 0;
        faulty(|fault| {
            // SAFETY: the handles are these objects'; the others may be written.
            unsafe { (self.table.style_at_frame)(self.handle, graph.0, frame, &raw mut changes, fault) }
        })?;
        Ok(changes != 0)
    }

    /// The value at a frame, as text, of the parameter with keyframes that its preset names so; none without keyframes.
    pub fn value(&self, name: &str, frame: i64) -> Option<String> {
        let name = text::argument(name).ok()?;
        let value = written(|out, fault| {
            // SAFETY: the handle is this object's; the name ends with a zero, and the others may be written.
            unsafe { (self.table.style_value)(self.handle, name.as_ptr(), frame, out, fault) }
        });
        value.ok()
    }

    /// What its graph does not follow of its preset's rules for things, and why; the places are in the words of the rules.
    ///
    /// # Errors
    /// [`Error`](crate::Error) when the library fails.
    pub fn left_out(&self) -> Result<Vec<Fault>> {
        let faults = written(|out, fault| {
            // SAFETY: the handle is this object's; the others may be written.
            unsafe { (self.table.style_left_out)(self.handle, out, fault) }
        })?;
        listed(&faults)
    }

    /// Frames of all keys in ascending order.
    pub fn frames(&self) -> Vec<i64> {
        let mut frames: Vec<i64> = Vec::new();
        loop {
            let mut count = 0;
            // SAFETY: the handle is this object's; there is room for as many frames as is said, and for the number.
            let status = unsafe {
                let read = self.table.style_frames;
                read(self.handle, frames.as_mut_ptr(), frames.len() as u32, &raw mut count)
            };
            if status != ISOPHOTE_OK {
                return Vec::new();
            }
            if count as usize <= frames.len() {
                frames.truncate(count as usize);
                return frames;
            }
            frames.resize(count as usize, 0);
        }
    }
}

impl Drop for Style {
    fn drop(&mut self) {
        // Nobody is left who could do anything about a failure.
        // SAFETY: the handle is this object's and not used again.
        let _ = unsafe { (self.table.style_destroy)(self.handle) };
    }
}
