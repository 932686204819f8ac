//! From a graph to a plan for one size, and from an edited graph to an edited plan.

use crate::declare::spec::ImageKind;
use crate::error::{Error, Result};
use crate::graph::{Graph, Upstream};
use crate::plan::describe::{Scratch, describe};
use crate::plan::request::Request;
use isophote_engine::{Plan, PlanBuilder};

/// Result of an update of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Only uniform bytes were rewritten, in place.
    Uniforms,
    /// The passes are others now; programs made from the plan must be made again.
    Structure,
}

/// A plan together with the request it was made for.
#[derive(Debug)]
pub struct Planned {
    plan: Plan,
    request: Request,
    scratch: Scratch,
}

impl Planned {
    /// Plans `graph` for `request`.
    ///
    /// # Errors
    /// [`Error::Connection`] for a required input left open or an output not set, and the engine's
    /// errors for impossible sizes.
    pub fn new(graph: &Graph, request: Request) -> Result<Self> {
        let mut scratch = Scratch::default();
        let plan = plan(graph, &request, &mut scratch)?;
        Ok(Self { plan, request, scratch })
    }

    /// Changes the request for the next [`Planned::update`]: frame and origin then change uniforms only.
    ///
    /// # Errors
    /// [`Error::Value`] for another size, which needs another plan.
    pub fn set_request(&mut self, request: Request) -> Result<()> {
        if [request.width, request.height] != [self.request.width, self.request.height] {
            return Err(Error::Value(format!(
                "the plan is for {}x{} pixels, not {}x{}; make another",
                self.request.width, self.request.height, request.width, request.height
            )));
        }
        self.request = request;
        Ok(())
    }

    /// Takes over the current parameter values and connections of `graph`.
    ///
    /// # Errors
    /// As [`Planned::new`]; the plan is then the old one or, if the structure changed, must not be used
    /// until an update succeeds.
    pub fn update(&mut self, graph: &Graph) -> Result<Change> {
        check(graph, &self.request)?;
        let (request, scratch) = (&self.request, &mut self.scratch);
        if self.plan.edit(|builder| describe(graph, request, builder, scratch))? {
            return Ok(Change::Uniforms);
        }
        self.plan = plan(graph, request, scratch)?;
        Ok(Change::Structure)
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The plan alone.
    pub fn into_plan(self) -> Plan {
        self.plan
    }

    /// Request that it was made for.
    pub fn request(&self) -> &Request {
        &self.request
    }
}

/// Most pixels that a pixel of a parameter may come to.
const MOST_SCALE: f32 = 64.0;

/// Farther from 0, places of pixels are not exact in single precision.
const MOST_ORIGIN: f64 = 1_000_000.0;

/// Fails when `request` cannot be planned: no output, a scale or an origin out of range, or a required input open.
fn check(graph: &Graph, request: &Request) -> Result<()> {
    if graph.output_node().is_none() {
        return Err(Error::Connection(
            "the graph has no output; name the node whose result leaves it".into(),
        ));
    }
    if !(request.scale.is_finite() && request.scale > 0.0 && request.scale <= MOST_SCALE) {
        return Err(Error::Value(format!(
            "the render scale must be above 0 and at most {MOST_SCALE}, not {}",
            request.scale
        )));
    }
    if request.length_scale() > MOST_SCALE {
        return Err(Error::Value(format!(
            "the reference height of {} is less than 1/{MOST_SCALE} of the picture's; lengths would grow too long",
            request.reference_height
        )));
    }
    if !request.origin.iter().all(|o| o.abs() <= MOST_ORIGIN) {
        return Err(Error::Value(format!(
            "the origin must be within {MOST_ORIGIN} pixels of 0, not {:?}",
            request.origin
        )));
    }
    for look in graph.looks() {
        // A look of colours can be laid over colours alone.
        if [graph, &look.graph].iter().any(|graph| graph.output_kind() != Some(ImageKind::Color)) {
            return Err(Error::Connection("a look of things, and what it lies over, must be colours".into()));
        }
        check_inputs(&look.graph, request)?;
    }
    check_inputs(graph, request)
}

/// Fails where a required input is open.
fn check_inputs(graph: &Graph, request: &Request) -> Result<()> {
    for node in graph.nodes() {
        for (port, source) in node.spec.ports().zip(&node.inputs) {
            let connected = match source {
                None => false,
                Some(Upstream::Node(_)) => true,
                Some(Upstream::Input(input)) => request.guides.has(*input),
            };
            if !connected && !port.optional {
                return Err(Error::Connection(format!(
                    "input '{}' of node '{}' ({}) is not connected",
                    port.id, node.name, node.spec.id
                )));
            }
        }
    }
    Ok(())
}

fn plan(graph: &Graph, request: &Request, scratch: &mut Scratch) -> Result<Plan> {
    check(graph, request)?;
    let mut builder = PlanBuilder::new(request.width, request.height)?;
    describe(graph, request, &mut builder, scratch)?;
    Ok(builder.finish()?)
}
