//! From a graph to a plan for one size, and from an edited graph to an edited plan.

pub use crate::colour_space::ColourSpace;
use crate::colour_space::Encoding;
use crate::error::{Error, Result};
use crate::graph::Node;
use crate::graph::{Graph, GraphInput, Source};
use crate::kernels::colour::{add_light, colour_export, colour_import, emission, mix, mix_by_mask};
use crate::spec::{ImageKind, Scope};
use crate::spec::{MASK, MIX};
use isophote_engine::{ImageId, Plan, PlanBuilder};

/// What a host wants of a graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Size of the rendered picture, in pixels.
    pub width: u32,
    /// Size of the rendered picture, in pixels.
    pub height: u32,
    /// Rendered size over full size: 0.5 for a half-size proxy. Scales every parameter in pixels.
    pub scale: f32,
    /// Where the left top corner of the picture stands in the canonical one, in full-size pixels: noise, paper, hatching
    /// and grids are anchored there, so that a bounding box that moves shows the same marks.
    pub origin: [f64; 2],
    /// Number of the frame, which renews what `hold` lets last.
    pub frame: i64,
    /// Space of the colour that enters and leaves.
    pub space: ColourSpace,
    /// True when colour enters, and is to leave, multiplied by alpha.
    pub premultiplied: bool,
    /// True when premultiplied colour may have light where coverage is 0 or little: fire, glows, additive renders. It
    /// is then filtered apart and added to the result, which costs as much again; without, it is lost where coverage
    /// is 0.
    pub emission: bool,
    /// Which guides the host has; connections to others count as open.
    pub guides: Guides,
}

/// The guide images that a host can supply beside the colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guides {
    /// View-space normals.
    pub normal: bool,
    /// Distance from the camera.
    pub depth: bool,
    /// Object numbers.
    pub object_id: bool,
    /// How much of the result is used.
    pub mask: bool,
    /// A painted flow map.
    pub flow: bool,
}

impl Guides {
    fn has(self, input: GraphInput) -> bool {
        match input {
            GraphInput::Color => true,
            GraphInput::Normal => self.normal,
            GraphInput::Depth => self.depth,
            GraphInput::ObjectId => self.object_id,
            GraphInput::Mask => self.mask,
            GraphInput::Flow => self.flow,
        }
    }
}

impl Request {
    /// A request for full size, sRGB, premultiplied, without guides.
    pub const fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            scale: 1.0,
            origin: [0.0; 2],
            frame: 0,
            space: ColourSpace::Srgb,
            premultiplied: true,
            emission: false,
            guides: Guides { normal: false, depth: false, object_id: false, mask: false, flow: false },
        }
    }
}

impl Request {
    fn encoding(&self) -> Encoding {
        Encoding { space: self.space, premultiplied: self.premultiplied, emission: self.emission }
    }
}

/// What an update of a plan came to.
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

/// Working memory of a description, kept so that editing allocates nothing.
#[derive(Debug, Default)]
struct Scratch {
    results: Vec<Option<ImageId>>,
    /// The light beyond coverage of each result, where it is taken apart.
    lights: Vec<Option<ImageId>>,
    inputs: Vec<Option<ImageId>>,
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

    /// What it was made for.
    pub fn request(&self) -> &Request {
        &self.request
    }
}

/// Farther from 0, places of pixels are not exact in single precision.
const MOST_ORIGIN: f64 = 1_000_000.0;

/// Fails when `request` cannot be planned: no output, a scale or an origin out of range, or a required input open.
fn check(graph: &Graph, request: &Request) -> Result<()> {
    if graph.output_node().is_none() {
        return Err(Error::Connection(
            "the graph has no output; name the node whose result leaves it".into(),
        ));
    }
    if !(request.scale.is_finite() && request.scale > 0.0 && request.scale <= 64.0) {
        return Err(Error::Value(format!(
            "the render scale must be above 0 and at most 64, not {}",
            request.scale
        )));
    }
    if !request.origin.iter().all(|o| o.abs() <= MOST_ORIGIN) {
        return Err(Error::Value(format!(
            "the origin must be within {MOST_ORIGIN} pixels of 0, not {:?}",
            request.origin
        )));
    }
    for node in graph.nodes() {
        for (port, source) in node.spec.ports().zip(&node.inputs) {
            let connected = match source {
                None => false,
                Some(Source::Node(_)) => true,
                Some(Source::Input(input)) => request.guides.has(*input),
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

fn describe(
    graph: &Graph,
    request: &Request,
    builder: &mut PlanBuilder,
    scratch: &mut Scratch,
) -> Result<()> {
    let Scratch { results, lights, inputs } = scratch;
    results.clear();
    results.resize(graph.len(), None);
    lights.clear();
    lights.resize(graph.len(), None);
    for index in graph.order() {
        let node = graph.node_at(*index);
        inputs.clear();
        for source in &node.inputs {
            let image = match source {
                Some(Source::Node(n)) => results[*n],
                Some(Source::Input(input)) if request.guides.has(*input) => {
                    Some(graph_input(builder, *input, request))
                }
                _ => None,
            };
            inputs.push(image);
        }
        results[*index] = Some(result(builder, node, inputs, request));
        if let Some(color) = picture(node)
            && let Some(light) = light_of(builder, node.inputs[color], lights, request)
        {
            inputs[color] = Some(light);
            let filters = node.spec.filters_light();
            lights[*index] = Some(if filters { result(builder, node, inputs, request) } else { light });
        }
    }
    if let Some((index, kind)) = graph.output_node()
        && let Some(result) = results[index]
    {
        let mut image = result;
        if kind == ImageKind::Color {
            image = colour_export::pass(builder, image, request.encoding());
            if let Some(light) = lights[index] {
                image = add_light::pass(builder, image, light);
            }
        }
        builder.output("output", image);
    }
    Ok(())
}

/// The passes of one node, its mix and mask included.
fn result(builder: &mut PlanBuilder, node: &Node, inputs: &[Option<ImageId>], request: &Request) -> ImageId {
    let mut scope = Scope {
        plan: builder,
        spec: node.spec,
        values: &node.values,
        inputs,
        scale: request.scale,
        origin: request.origin.map(|o| (o * f64::from(request.scale)) as f32),
        frame: request.frame,
    };
    let result = (node.spec.build)(&mut scope);
    let Some(original) = picture(node).and_then(|color| inputs[color]) else { return result };
    let (amount, mask) = (scope.float(MIX.id), scope.input(MASK.id));
    match mask {
        Some(mask) => mix_by_mask::pass(builder, [original, result], mask, amount),
        None if amount < 1.0 => mix::pass(builder, original, result, amount),
        None => result,
    }
}

/// The port of the picture that a node from colour to colour filters.
fn picture(node: &Node) -> Option<usize> {
    node.spec.has_mix().then(|| node.spec.inputs.iter().position(|p| p.kind == ImageKind::Color))?
}

/// The light beyond coverage of what a port is connected to.
fn light_of(
    builder: &mut PlanBuilder,
    source: Option<Source>,
    lights: &[Option<ImageId>],
    request: &Request,
) -> Option<ImageId> {
    match source? {
        Source::Node(node) => lights[node],
        Source::Input(GraphInput::Color) if request.emission && request.premultiplied => {
            let kind = GraphInput::Color.kind();
            let image = builder.input(GraphInput::Color.id(), kind.channels(), kind.class());
            Some(emission::pass(builder, image))
        }
        Source::Input(_) => None,
    }
}

fn graph_input(builder: &mut PlanBuilder, input: GraphInput, request: &Request) -> ImageId {
    let kind = input.kind();
    let image = builder.input(input.id(), kind.channels(), kind.class());
    match input {
        GraphInput::Color => colour_import::pass(builder, image, request.encoding()),
        _ => image,
    }
}
