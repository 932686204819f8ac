//! The graph that `--style` names.

use std::path::Path;

use isophote_example::frame_runner::Named;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::input;
use isophote_loader::catalogue::Kind;
use isophote_loader::{Graph, Library};

/// Style for no style.
const NONE: &str = "none";

/// Largest file of a graph, in bytes.
const MOST_BYTES: u64 = 16 << 20;

/// A graph of the library under the name that it was asked for by.
pub struct Style {
    name: String,
    graph: Graph,
}

impl Style {
    /// The node of this id, or the graph that is described in this file; nothing for `none`.
    ///
    /// # Errors
    /// [`Error::Input`] when there is neither, or it yields no picture.
    pub fn open(library: &Library, name: &str) -> Result<Option<Self>> {
        if name == NONE {
            return Ok(None);
        }
        let fix = "name a node of the library such as cartoon, a graph file (.json), or none";
        let is_file = Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
        let graph = if is_file {
            let problem = |e| Error::file(Path::new(name), format!("cannot be read: {e}"), fix);
            library.graph_from_json(&input::text(Path::new(name), MOST_BYTES).map_err(problem)?)
        } else {
            library.single(name)
        };
        let graph = graph.map_err(|e| e.at(name, fix))?;
        let kind = graph.output_kind().map_err(|e| e.at(name, fix))?;
        if !kind.is_picture() {
            return Err(Error::input(name, format!("yields a {}, which is no picture", kind.name()), fix));
        }
        Ok(Some(Self { name: name.to_owned(), graph }))
    }

    /// The graph with its name.
    pub fn named(&self) -> Named<'_> {
        Named { name: &self.name, graph: &self.graph }
    }

    /// True where a node of the graph can use positions in the scene at rest.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn wants_rest_positions(&self) -> Result<bool> {
        self.graph.can_use(Kind::Position).map_err(|e| e.at(&self.name, "choose another style"))
    }
}
