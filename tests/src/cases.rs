//! Graphs and parameter sets generated from the registry.

use crate::pictures::{Kind, id_of_thing};
use crate::random::Random;
use isophote::frames::Frames;
use isophote::graph::{GraphInput, ThingLook};
use isophote::request::Guides;
use isophote::spec::{ImageKind, NodeSpec, Param, Port, Unit};
use isophote::things::{ThingRule, Things};
use isophote::{ColourSpace, Graph, NodeId, Request, Value};

/// A node in a graph that can be planned, with the nodes that stand before it.
#[derive(Debug)]
pub struct Setup {
    /// The graph; its output is the node under test.
    pub graph: Graph,
    /// The node under test.
    pub node: NodeId,
    /// Nodes whose outputs it reads, for its ports that a graph has no input for.
    pub producers: Vec<NodeId>,
}

/// A graph around `spec`. Ports that a graph has an input for are connected to it; the others to the
/// first node that makes such an image from colour alone, the optional ones only if `wired`.
///
/// # Panics
/// When a required port cannot be fed, which no node may ask for.
pub fn setup(spec: &'static NodeSpec, wired: bool) -> Setup {
    let build = || -> isophote::Result<Setup> {
        let mut graph = Graph::new();
        let mut feeds = Vec::new();
        for port in spec.ports() {
            if graph_input(port).is_some() || (port.optional && !wired) {
                continue;
            }
            let name = format!("before-{}", port.id);
            let producer = graph.add(&name, producer(port.kind).id)?;
            graph.connect_input(GraphInput::Color, producer, "color")?;
            feeds.push((producer, port.id));
        }
        let node = graph.add("node", spec.id)?;
        for port in spec.ports() {
            if let Some(input) = graph_input(port) {
                graph.connect_input(input, node, port.id)?;
            }
        }
        for (producer, port) in &feeds {
            graph.connect(*producer, node, port)?;
        }
        graph.set_output(node)?;
        Ok(Setup { graph, node, producers: feeds.into_iter().map(|(p, _)| p).collect() })
    };
    match build() {
        Ok(setup) => setup,
        Err(e) => panic!("{} cannot stand in a graph: {e}", spec.id),
    }
}

/// Input of a graph for a port: that of its name, or of its kind.
fn graph_input(port: &Port) -> Option<GraphInput> {
    GraphInput::from_id(port.id).or_else(|| GraphInput::from_id(port.kind.id()))
}

/// The first node that makes `kind` from colour alone.
fn producer(kind: ImageKind) -> &'static NodeSpec {
    let able = |n: &&&'static NodeSpec| {
        n.output.kind == kind
            && n.inputs.iter().all(|p| p.optional || (p.kind == ImageKind::Color && p.id == "color"))
    };
    match isophote::registry::nodes().iter().find(able) {
        Some(node) => node,
        None => panic!("no node makes a {} from colour", kind.id()),
    }
}

/// A set of parameter values with a name for messages.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Label that distinguishes it.
    pub label: String,
    /// Values by parameter id; the others keep their defaults.
    pub values: Vec<(&'static str, Value)>,
}

impl Setting {
    /// Sets the values in a graph.
    ///
    /// # Panics
    /// When the node refuses a value from its own ranges.
    pub fn apply(&self, graph: &mut Graph, node: NodeId) {
        for (id, value) in &self.values {
            if let Err(e) = graph.set(node, id, *value) {
                panic!("{}: {e}", self.label);
            }
        }
    }
}

/// Defaults, least and greatest values (hard ranges and sliders), each option of each choice and both
/// states of each switch, and `count` random sets.
pub fn settings(spec: &'static NodeSpec, count: usize) -> Vec<Setting> {
    let set = |label: &str, value: &dyn Fn(&Param) -> Value| Setting {
        label: label.to_owned(),
        values: spec.params().map(|p| (p.id, value(p))).collect(),
    };
    let mut sets = vec![
        Setting { label: "default".into(), values: Vec::new() },
        set("least", &|p| extreme(p, 0, false)),
        set("greatest", &|p| extreme(p, 1, false)),
        set("slider's least", &|p| extreme(p, 0, true)),
        set("slider's greatest", &|p| extreme(p, 1, true)),
    ];
    for param in spec.params() {
        let others: Vec<Value> = match param.default {
            Value::Bool(default) => vec![Value::Bool(!default)],
            Value::Choice(default) => {
                (0..param.options.len()).filter(|o| *o != default).map(Value::Choice).collect()
            }
            _ => Vec::new(),
        };
        for value in others {
            sets.push(Setting {
                label: format!("{}={}", param.id, name_of(param, value)),
                values: vec![(param.id, value)],
            });
        }
    }
    let seed = spec.id.bytes().fold(7u64, |h, b| h.wrapping_mul(31).wrapping_add(u64::from(b)));
    let mut random = Random::new(seed);
    for index in 0..count {
        let values: Vec<_> = spec.params().map(|p| (p.id, any(p, &mut random))).collect();
        sets.push(Setting { label: format!("random {index}"), values });
    }
    sets
}

/// Sets with some sliders low and the others high, so that with the sets of [`settings`] any two parameters meet at
/// all four pairs of their ends: by each binary digit of the parameters' indices, and the other way round. Two indices
/// differ in some digit.
///
/// They are none for twins: long lines through fields that are hardly smoothed turn on the last bit.
pub fn mixed_ends(spec: &'static NodeSpec) -> Vec<Setting> {
    let count = spec.params().count();
    let digits = usize::BITS - count.saturating_sub(1).leading_zeros();
    let sets = (0..digits).flat_map(|digit| [0, 1].map(|ones| (digit, ones)));
    sets.map(|(digit, ones)| Setting {
        label: format!("sliders by digit {digit}, ones {}", ["low", "high"][ones]),
        values: (0..)
            .zip(spec.params())
            .map(|(index, p): (usize, _)| (p.id, extreme(p, (index >> digit & 1) ^ ones ^ 1, true)))
            .collect(),
    })
    .collect()
}

/// A value other than `now` for a parameter, somewhere inside its slider; `None` for a parameter that
/// has only one value.
pub fn other(param: &Param, now: Value, random: &mut Random) -> Option<Value> {
    (0..64).map(|_| within_slider(param, random)).find(|v| *v != now)
}

/// The least (`end` 0) or greatest (1) value. Choices and switches have no ends: they take the first
/// and the last.
fn extreme(param: &Param, end: usize, of_slider: bool) -> Value {
    let form = param.default.form();
    let number = f64::from(if of_slider { param.slider } else { param.range }[end]);
    // Of colours the red and the alpha.
    (form.value)(if form.count == 1 { [number; 4] } else { [number, 0.5, 0.25, number] })
}

fn any(param: &Param, random: &mut Random) -> Value {
    match param.default {
        // Lengths decide the cost; the sliders hold what people use.
        Value::Float(_) if param.unit != Unit::Pixels && random.below(3) == 0 => {
            Value::Float(random.range(param.range[0], param.range[1]))
        }
        _ => within_slider(param, random),
    }
}

fn within_slider(param: &Param, random: &mut Random) -> Value {
    let [low, high] = param.slider;
    match param.default {
        Value::Float(_) => Value::Float(random.range(low, high)),
        Value::Int(_) => Value::Int(low as i32 + random.below((high - low) as usize + 1) as i32),
        Value::Bool(_) => Value::Bool(random.below(2) == 1),
        Value::Choice(_) => Value::Choice(random.below(param.options.len())),
        Value::Color(_) => Value::Color([(); 4].map(|()| random.unit() as f32)),
    }
}

fn name_of(param: &Param, value: Value) -> String {
    match value {
        Value::Choice(index) => param.options[index].id.to_owned(),
        Value::Bool(on) => on.to_string(),
        other => format!("{other:?}"),
    }
}

/// The request that suits a kind of picture, with all guides but materials, neighbouring frames and its light apart, or with
/// none.
pub fn request(kind: Kind, width: u32, height: u32, guides: bool) -> Request {
    let space = match kind {
        Kind::Hdr if width < 10 => ColourSpace::AcesCg,
        Kind::Hdr | Kind::Broken => ColourSpace::Linear,
        _ => ColourSpace::Srgb,
    };
    Request {
        space,
        premultiplied: kind != Kind::Noise,
        emission: guides,
        guides: Guides::of(|guide| guides && !is_material(guide)),
        frames: if guides { Frames::around(2, 1) } else { Frames::NONE },
        // Shorter than some motion of the pictures, so that there is some of which nothing is known.
        max_motion: 3.25,
        ..Request::new(width, height)
    }
}

/// For nodes whose marks motion carries where no rest positions are known: values by which it does so.
pub fn carrying(spec: &NodeSpec) -> Option<Setting> {
    spec.param("renewal")?;
    // Not all styles of a node draw marks; the last one does.
    let style = spec.param("style").map(|(_, p)| ("style", extreme(p, 1, false)));
    let values = [("steadiness", Value::Float(0.5))].into_iter().chain(style).collect();
    Some(Setting { label: "carrying marks".into(), values })
}

/// The same for marks at rest positions, which fade from frame to frame.
pub fn fading(spec: &NodeSpec) -> Option<Setting> {
    carrying(spec).map(|setting| Setting { label: "fading marks".into(), ..setting })
}

/// For nodes whose lines have another width far away: values by which they do, within the depths of [`pictures`](crate::pictures).
pub fn by_distance(spec: &NodeSpec) -> Option<Setting> {
    spec.param("far_width")?;
    Some(Setting { label: "by distance".into(), values: vec![("far_width", Value::Float(2.5))] })
}

/// For nodes that draw kinds of lines in colours of their own: values by which they do, light on dark ground.
pub fn in_sets(spec: &NodeSpec) -> Option<Setting> {
    spec.param("line_colors")?;
    let mut values = vec![
        ("line_colors", Value::Choice(1)),
        ("line_gap", Value::Float(4.0)),
        ("taper", Value::Float(6.0)),
    ];
    values.extend(spec.param("line_on_dark").map(|_| ("line_on_dark", Value::Choice(1))));
    Some(Setting { label: "in sets".into(), values })
}

/// For nodes that print with dots: values by which they do, of colours with lines.
pub fn dotted(spec: &NodeSpec) -> Option<Setting> {
    spec.param("dots")?;
    Some(Setting { label: "in dots".into(), values: vec![("dots", Value::Float(0.9))] })
}

/// As [`request`] with all guides but rest positions, between two renewals of marks.
pub fn request_without_rest(kind: Kind, width: u32, height: u32) -> Request {
    let request = request(kind, width, height, true);
    Request { guides: Guides { rest_position: false, ..request.guides }, frame: 3, ..request }
}

/// For nodes that draw on paper, with hatching or in painted colours: their defaults.
pub fn on_materials(spec: &NodeSpec) -> Option<Setting> {
    let takes = spec.inputs.iter().any(|port| GraphInput::from_id(port.id).is_some_and(is_material));
    takes.then(|| Setting { label: "on materials".into(), values: Vec::new() })
}

/// For nodes whose lines and places rules for things direct: their defaults.
pub fn ruled(spec: &NodeSpec) -> Option<Setting> {
    spec.input("line_paint")?;
    Some(Setting { label: "by rules".into(), values: Vec::new() })
}

/// Rules for the things of [`pictures`](crate::pictures), by number and by name, more than a kernel takes at once.
pub fn rules() -> Vec<ThingRule> {
    let things = |number: u32| match number % 3 {
        0 => Things::Names((number..number + 5).map(id_of_thing).collect()),
        _ => Things::Numbers(vec![number, number + 2]),
    };
    let rule = |number: u32| ThingRule {
        things: things(number),
        control: [Some(0.8), None, (number == 1).then_some(0.0), Some(0.3)],
        line_color: number.is_multiple_of(2).then_some([0.8, 0.1, 0.2, 0.6]),
    };
    (0..40).map(rule).collect()
}

/// Gives a graph of colours rules, and looks for the things of the first two of them.
pub fn rule(graph: &mut Graph, rules: Vec<ThingRule>) {
    for (rule, node) in rules.iter().zip(["gaussian", "quantize_luminance"]) {
        let look = Graph::single(node).expect("the node is there");
        graph.looks_mut().push(ThingLook { things: rule.things.clone(), graph: look });
    }
    graph.set_rules(rules);
}

/// As [`request`] with names of things alone.
pub fn request_of_names(kind: Kind, width: u32, height: u32) -> Request {
    Request { guides: Guides { cryptomatte: true, ..Guides::NONE }, ..request(kind, width, height, true) }
}

/// As [`request`] with numbers of objects alone.
pub fn request_of_numbers(kind: Kind, width: u32, height: u32) -> Request {
    Request { guides: Guides { object_id: true, ..Guides::NONE }, ..request(kind, width, height, true) }
}

/// As [`request`] with all guides, materials too.
pub fn request_on_materials(kind: Kind, width: u32, height: u32) -> Request {
    Request { guides: Guides::of(|_| true), ..request(kind, width, height, true) }
}

fn is_material(guide: GraphInput) -> bool {
    matches!(guide, GraphInput::Paper | GraphInput::Hatching | GraphInput::LinePaint)
}

/// True when the node has an optional input that is not a picture of the graph's own.
pub fn has_optional_field(spec: &NodeSpec) -> bool {
    spec.inputs.iter().any(|p| p.optional && GraphInput::from_id(p.kind.id()).is_none())
}

/// True when the node takes guides, or finds motion from the frames around.
pub fn has_guides(spec: &NodeSpec) -> bool {
    let is_guide =
        |k| matches!(k, ImageKind::Normal | ImageKind::Depth | ImageKind::ObjectId | ImageKind::Position);
    spec.inputs.iter().any(|p| is_guide(p.kind)) || spec.output.kind == ImageKind::Motion
}
