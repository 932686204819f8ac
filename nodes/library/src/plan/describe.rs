//! From a graph to the passes of a plan: every node at every frame that is asked for.

use crate::declare::spec::{Around, ImageKind, MASK, MIX, Scope};
use crate::error::Result;
use crate::frames::Frames;
use crate::graph::neighbours::needs_of;
use crate::graph::{Graph, GraphInput, Node, Upstream};
use crate::kernels::colour::{add_light, colour_export, colour_import, emission, mix, mix_by_mask};
use crate::plan::request::Request;
use crate::plan::things::Ruled;
use isophote_engine::{ImageId, PlanBuilder};

/// Working memory of a description, kept so that editing allocates nothing.
#[derive(Debug, Default)]
pub(crate) struct Scratch {
    /// By node: the frames whose result is needed.
    needs: Vec<Option<[i32; 2]>>,
    /// By frame and node.
    results: Vec<Option<ImageId>>,
    /// By node: the light beyond coverage of its result, where it is taken apart.
    lights: Vec<Option<ImageId>>,
    /// By frame and port of the node that is described.
    inputs: Vec<Option<ImageId>>,
    /// By node: whether it is described at frames whose stages are handed in, too.
    besides: Vec<bool>,
    /// That of the looks of things.
    looks: Vec<Scratch>,
}

/// Stages that a node may keep.
const STAGES: u32 = 8;

/// Describes a graph that was checked.
pub(crate) fn describe(
    graph: &Graph,
    request: &Request,
    builder: &mut PlanBuilder,
    scratch: &mut Scratch,
) -> Result<()> {
    let Some((_, kind)) = graph.output_node() else { return Ok(()) };
    let ruled = Ruled { rules: graph.rules(), request };
    let Some(mut shown) = described(graph, ruled, 0, builder, scratch) else { return Ok(()) };
    let mut before = graph.len();
    scratch.looks.resize_with(graph.looks().len(), Scratch::default);
    for (look, scratch) in graph.looks().iter().zip(&mut scratch.looks) {
        if let Some(cover) = ruled.cover(builder, &look.things)
            && let Some(over) = described(&look.graph, ruled, before, builder, scratch)
        {
            shown = laid_over(builder, shown, over, cover);
        }
        before += look.graph.len();
    }
    let (mut image, light) = shown;
    if kind == ImageKind::Color {
        image = colour_export::pass(builder, image, request.encoding());
        if let Some(light) = light {
            image = add_light::pass(builder, image, light);
        }
    }
    builder.output("output", image);
    Ok(())
}

/// Result of a graph, and the light beyond its coverage where that is taken apart.
type Shown = (ImageId, Option<ImageId>);

/// A result with another one over it, as far as that covers it.
fn laid_over(builder: &mut PlanBuilder, under: Shown, over: Shown, cover: ImageId) -> Shown {
    let image = mix_by_mask::pass(builder, [under.0, over.0], cover, 1.0);
    let light = match (under.1, over.1) {
        (Some(under), Some(over)) if under != over => {
            Some(mix_by_mask::pass(builder, [under, over], cover, 1.0))
        }
        (under, over) => under.or(over),
    };
    (image, light)
}

/// Describes a graph, whose nodes come after so many others, in a plan.
fn described(
    graph: &Graph,
    ruled: Ruled<'_>,
    before: usize,
    builder: &mut PlanBuilder,
    scratch: &mut Scratch,
) -> Option<Shown> {
    let request = ruled.request;
    needs_of(graph, &request.frames, &mut scratch.needs);
    let frames = (request.frames.past + request.frames.future + 1) as usize;
    scratch.results.clear();
    scratch.results.resize(frames * graph.len(), None);
    scratch.lights.clear();
    scratch.lights.resize(graph.len(), None);
    find_besides(graph, &mut scratch.besides);
    for index in graph.order() {
        let Some([first, last]) = scratch.needs[*index] else { continue };
        let mut describing = Describing { graph, ruled, request, before, builder, scratch };
        describing.find_inputs(*index);
        // The frame at hand comes first: the others ask for stages of its shapes.
        for frame in std::iter::once(0).chain((first..=last).filter(|frame| *frame != 0)) {
            if !request.frames.is_handed(frame) || describing.scratch.besides[*index] {
                describing.describe(*index, frame);
            }
        }
    }
    let (index, _) = graph.output_node()?;
    let result = scratch.results[request.frames.past as usize * graph.len() + index]?;
    Some((result, scratch.lights[index]))
}

struct Describing<'d> {
    graph: &'d Graph,
    ruled: Ruled<'d>,
    request: &'d Request,
    /// Nodes of other graphs that the plan has before those of this one.
    before: usize,
    builder: &'d mut PlanBuilder,
    scratch: &'d mut Scratch,
}

impl Describing<'_> {
    fn place(&self, frame: i32, node: usize) -> usize {
        (frame + self.request.frames.past as i32) as usize * self.graph.len() + node
    }

    /// Fills the table of what the node reads at every known frame.
    fn find_inputs(&mut self, index: usize) {
        let node = self.graph.node_at(index);
        let [first, last] = self.request.frames.range();
        let [from, to] = self.scratch.needs[index].unwrap_or([0, 0]);
        let window = node.spec.window(&node.values);
        self.scratch.inputs.clear();
        for frame in first..=last {
            self.builder.set_frame(frame);
            for (port, source) in node.spec.ports().zip(&node.inputs) {
                let past = window.max(node.mark_window(port, *source));
                let is_read = from - past <= frame && frame <= to + window;
                let image = source.filter(|_| is_read).and_then(|source| self.source(source, frame, index));
                self.scratch.inputs.push(image);
            }
        }
        self.builder.set_frame(0);
    }

    /// Image that the node `reader` reads at a frame.
    fn source(&mut self, source: Upstream, frame: i32, reader: usize) -> Option<ImageId> {
        let is_besides = |input| is_read_besides(input) || self.scratch.besides[reader];
        match source {
            Upstream::Node(n) => self.scratch.results[self.place(frame, n)],
            // What is handed in was made from the rest.
            Upstream::Input(input) if self.request.frames.is_handed(frame) && !is_besides(input) => None,
            Upstream::Input(input) => self.picture(input),
        }
    }

    /// A picture that enters, or that rules for things make.
    fn picture(&mut self, input: GraphInput) -> Option<ImageId> {
        let given = self.request.guides.has(input).then(|| graph_input(self.builder, input, self.request));
        if self.ruled.makes(input) { self.ruled.pass(self.builder, input, given) } else { given }
    }

    /// Describes a node at one frame.
    fn describe(&mut self, index: usize, frame: i32) {
        let node = self.graph.node_at(index);
        let ports = node.inputs.len();
        let first = (frame + self.request.frames.past as i32) as usize * ports;
        let around = Around {
            inputs: &self.scratch.inputs,
            first: -(self.request.frames.past as i32),
            frames: self.request.frames,
            stage: (self.before + index) as u32 * STAGES,
            is_carrying: node.is_carrying(),
        };
        let inputs = &self.scratch.inputs[first..first + ports];
        self.builder.set_frame(frame);
        let result = result(self.builder, node, inputs, around, self.request);
        self.builder.set_frame(0);
        let place = self.place(frame, index);
        self.scratch.results[place] = Some(result);
        if frame == 0 {
            self.describe_light(index);
        }
    }

    /// Describes the node on the light beyond coverage of its picture, of this frame alone.
    fn describe_light(&mut self, index: usize) {
        let node = self.graph.node_at(index);
        let Some(color) = picture(node) else { return };
        let Some(light) = light_of(self.builder, node.inputs[color], &self.scratch.lights, self.request)
        else {
            return;
        };
        let ports = node.inputs.len();
        let first = self.request.frames.past as usize * ports;
        let inputs = &mut self.scratch.inputs[first..first + ports];
        let color_itself = inputs[color].replace(light);
        let alone = Around { inputs: &[], first: 0, frames: Frames::NONE, stage: 0, is_carrying: false };
        let filters = node.spec.filters_light();
        let result = if filters { result(self.builder, node, inputs, alone, self.request) } else { light };
        inputs[color] = color_itself;
        self.scratch.lights[index] = Some(result);
    }
}

/// Finds the nodes that make motion and all that they depend on: no stage holds what they find.
fn find_besides(graph: &Graph, besides: &mut Vec<bool>) {
    besides.clear();
    besides.resize(graph.len(), false);
    for index in graph.order().iter().rev() {
        let node = graph.node_at(*index);
        if besides[*index] || node.spec.makes_motion() {
            besides[*index] = true;
            node.sources().for_each(|source| besides[source] = true);
        }
    }
}

/// True for an input that is read at frames whose stages are handed in.
const fn is_read_besides(input: GraphInput) -> bool {
    matches!(input, GraphInput::Depth | GraphInput::ObjectId | GraphInput::Motion | GraphInput::MotionForward)
}

/// The passes of one node at the frame that is described, its mix and mask included.
fn result(
    builder: &mut PlanBuilder,
    node: &Node,
    inputs: &[Option<ImageId>],
    around: Around<'_>,
    request: &Request,
) -> ImageId {
    let frame = request.frame + i64::from(builder.frame());
    let mut scope = Scope {
        plan: builder,
        spec: node.spec,
        values: &node.values,
        inputs,
        scale: request.length_scale(),
        origin: request.origin.map(|o| (o * f64::from(request.scale)) as f32),
        frame,
        max_motion: request.max_motion * request.scale,
        around,
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
    source: Option<Upstream>,
    lights: &[Option<ImageId>],
    request: &Request,
) -> Option<ImageId> {
    match source? {
        Upstream::Node(node) => lights[node],
        Upstream::Input(GraphInput::Color) if request.emission && request.premultiplied => {
            let kind = GraphInput::Color.kind();
            let image = builder.input(GraphInput::Color.id(), kind.channels(), kind.class());
            Some(emission::pass(builder, image))
        }
        Upstream::Input(_) => None,
    }
}

fn graph_input(builder: &mut PlanBuilder, input: GraphInput, request: &Request) -> ImageId {
    let kind = input.kind();
    let image = builder.input(input.id(), kind.channels(), kind.class());
    if input.is_colour() { colour_import::pass(builder, image, request.encoding()) } else { image }
}
