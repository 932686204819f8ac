//! A graph lowered to a program for one region, and kept up to date with the graph.

use crate::error::Result;
use crate::graph::Graph;
use crate::plan::planned::{Change, Planned};
use crate::plan::request::Request;
use isophote_engine::Rect;
use isophote_engine::program::Program;

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
    /// As planning and lowering.
    pub fn new(graph: Graph, request: Request, region: Rect) -> Result<Self> {
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

    /// Makes the program that of another region.
    ///
    /// # Errors
    /// As lowering; the program is then the old one.
    pub fn set_region(&mut self, region: Rect) -> Result<()> {
        self.program = Program::lower_as(self.planned.plan(), region, self.graph.precision())?;
        self.region = region;
        Ok(())
    }

    /// By dispatch of the program: its operations, fused multiply-adds or others of like cost.
    pub fn operations(&self) -> impl Iterator<Item = f64> {
        self.program.operations(self.planned.plan())
    }

    /// Request that it was made for.
    pub fn request(&self) -> &Request {
        self.planned.request()
    }

    /// Takes over the parameters of `graph`, and a request of the same size.
    ///
    /// # Errors
    /// As planning and lowering; the program is then the old one.
    pub fn update(&mut self, graph: Graph, request: Option<Request>) -> Result<Change> {
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
                return Err(e);
            }
        };
        let is_as_precise = graph.precision() == self.graph.precision();
        if change == Change::Uniforms && is_as_precise && self.program.repack(self.planned.plan()) {
            self.graph = graph;
            return Ok(Change::Uniforms);
        }
        match Program::lower_as(self.planned.plan(), self.region, graph.precision()) {
            Ok(program) => {
                self.program = program;
                self.graph = graph;
                Ok(Change::Structure)
            }
            Err(e) => {
                self.planned = Planned::new(&self.graph, before)?;
                Err(e.into())
            }
        }
    }
}
