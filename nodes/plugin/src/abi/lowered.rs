//! A graph lowered to a program for one region, and kept up to date with the graph.

use super::contract::*;
use super::failure::Outcome;
use isophote::engine::Rect;
use isophote::engine::program::Program;
use isophote::request::Change;
use isophote::{Graph, Planned, Request};

/// The program of a graph, with what it was made from.
#[derive(Debug)]
pub struct Lowered {
    /// The graph that the plan was last made from, to go back to when an update fails.
    graph: Graph,
    planned: Planned,
    region: Rect,
    program: Program,
}

impl Lowered {
    /// The program of `region`.
    ///
    /// # Errors
    /// What planning and lowering fail with.
    pub fn new(graph: Graph, request: Request, region: Rect) -> Outcome<Self> {
        let planned = Planned::new(&graph, request)?;
        let program = Program::lower_as(planned.plan(), region, graph.precision())?;
        Ok(Self { graph, planned, region, program })
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The graph that it was made from.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// What it was made for.
    pub fn request(&self) -> &Request {
        self.planned.request()
    }

    /// Takes over the parameters of `graph`, and a request of the same size.
    ///
    /// # Errors
    /// What planning and lowering fail with; the program is then the old one.
    pub fn update(&mut self, graph: Graph, request: Option<Request>) -> Outcome<IsophoteChange> {
        let before = *self.planned.request();
        if let Some(request) = request {
            // What is known of other frames is the plan's own.
            let Request { frames, max_motion, .. } = before;
            self.planned.set_request(Request { frames, max_motion, ..request })?;
        }
        let change = match self.planned.update(&graph) {
            Ok(change) => change,
            Err(e) => {
                self.planned = Planned::new(&self.graph, before)?;
                return Err(e.into());
            }
        };
        let is_as_precise = graph.precision() == self.graph.precision();
        if change == Change::Uniforms && is_as_precise && self.program.repack(self.planned.plan()) {
            self.graph = graph;
            return Ok(ISOPHOTE_CHANGE_UNIFORMS);
        }
        match Program::lower_as(self.planned.plan(), self.region, graph.precision()) {
            Ok(program) => {
                self.program = program;
                self.graph = graph;
                Ok(ISOPHOTE_CHANGE_STRUCTURE)
            }
            Err(e) => {
                self.planned = Planned::new(&self.graph, before)?;
                Err(e.into())
            }
        }
    }
}
