//! Graphs: nodes, their parameter values and how they are connected.

mod json;
pub(crate) mod neighbours;

use crate::declare::spec::{ImageKind, NodeSpec, Param, Port};
use crate::declare::value::Value;
use crate::error::{Error, Result, nearest};
pub use crate::guides::GraphInput;
use crate::registry;
use crate::things::{ThingRule, Things};
use isophote_engine::program::Precision;

/// Origin of an input port's picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upstream {
    /// A picture that enters the graph.
    Input(GraphInput),
    /// The output of the node at this position.
    Node(usize),
}

/// A node of one graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NodeId(usize);

impl NodeId {
    /// Position in the graph, in the order of addition.
    pub const fn index(self) -> usize {
        self.0
    }
}

/// A node with its values and connections.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub name: String,
    pub spec: &'static NodeSpec,
    pub values: Vec<Value>,
    pub inputs: Vec<Option<Upstream>>,
}

impl Node {
    /// The nodes that it reads.
    pub fn sources(&self) -> impl Iterator<Item = usize> {
        self.inputs.iter().filter_map(|source| match source {
            Some(Upstream::Node(node)) => Some(*node),
            _ => None,
        })
    }

    /// Frames before the node's own that it reads by a port to carry marks. Estimated motion does not carry them: that of
    /// so many frames costs too much.
    pub fn mark_window(&self, port: &Port, source: Option<Upstream>) -> i32 {
        if port.id != GraphInput::Motion.id() {
            return 0;
        }
        match source {
            Some(Upstream::Input(_)) => self.spec.mark_window(&self.values),
            _ => 0,
        }
    }

    /// True where motion carries marks of the node.
    pub fn is_carrying(&self) -> bool {
        self.marks() > 0
    }

    /// Frames before the node's own that it reads to carry marks.
    pub fn marks(&self) -> i32 {
        let windows =
            self.spec.ports().zip(&self.inputs).map(|(port, source)| self.mark_window(port, *source));
        windows.max().unwrap_or(0)
    }
}

/// Nodes and their connections. Always free of cycles and of ports that do not fit.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    order: Vec<usize>,
    output: Option<usize>,
    precision: Precision,
    rules: Vec<ThingRule>,
    looks: Vec<ThingLook>,
}

/// Look that things have, in the place of what the graph shows where they are.
#[derive(Clone, Debug)]
pub struct ThingLook {
    /// The things.
    pub things: Things,
    /// What shows there: a graph from the same pictures to colours, whose own rules and looks for things count for nothing.
    pub graph: Graph,
}

impl Graph {
    /// A graph without nodes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Precision in which graphics devices compute it; CPUs always compute exactly. It is no part of what is saved.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Sets how precisely graphics devices compute it.
    pub fn set_precision(&mut self, precision: Precision) {
        self.precision = precision;
    }

    /// Rules for things, which count where a host gives numbers of objects or a Cryptomatte: what they say is added to its control
    /// map and its colours of lines. They are a preset's, and no part of what is saved.
    pub fn rules(&self) -> &[ThingRule] {
        &self.rules
    }

    /// Sets the rules for things; the last one counts.
    pub fn set_rules(&mut self, rules: Vec<ThingRule>) {
        self.rules = rules;
    }

    /// Looks of things, each laid over those before it as far as its things cover a pixel. They count where rules do, and are no part
    /// of what is saved either.
    pub fn looks(&self) -> &[ThingLook] {
        &self.looks
    }

    /// The same, to be edited.
    pub fn looks_mut(&mut self) -> &mut Vec<ThingLook> {
        &mut self.looks
    }

    /// A graph of one node, its inputs connected to the graph's inputs of the same name, its output
    /// the graph's.
    ///
    /// # Errors
    /// [`Error::Unknown`] when there is no such node.
    pub fn single(node: &str) -> Result<Self> {
        let mut graph = Self::new();
        let id = graph.add(node, node)?;
        for (i, port) in graph.nodes[0].spec.ports().enumerate() {
            graph.nodes[0].inputs[i] =
                GraphInput::from_id(port.id).filter(|i| i.kind() == port.kind).map(Upstream::Input);
        }
        graph.set_output(id)?;
        Ok(graph)
    }

    /// Adds a node under a name of its own.
    ///
    /// # Errors
    /// [`Error::Unknown`] when there is no such node, [`Error::Value`] when the name is taken or empty.
    pub fn add(&mut self, name: &str, node: &str) -> Result<NodeId> {
        let spec = registry::find(node)?;
        if name.is_empty() || name.starts_with('@') {
            return Err(Error::Value(format!("'{name}' cannot name a node")));
        }
        if self.nodes.iter().any(|n| n.name == name) {
            return Err(Error::Value(format!("two nodes are named '{name}'")));
        }
        self.nodes.push(Node {
            name: name.to_owned(),
            spec,
            values: spec.params().map(|p| p.default).collect(),
            inputs: vec![None; spec.ports().count()],
        });
        self.order.push(self.nodes.len() - 1);
        Ok(NodeId(self.nodes.len() - 1))
    }

    /// The node at a position.
    ///
    /// # Errors
    /// [`Error::Unknown`] when there are fewer nodes.
    pub fn node(&self, index: usize) -> Result<NodeId> {
        if index < self.nodes.len() {
            Ok(NodeId(index))
        } else {
            Err(Error::Unknown(format!("there is no node {index}")))
        }
    }

    /// The node of a name.
    ///
    /// # Errors
    /// [`Error::Unknown`], naming the nearest.
    pub fn find(&self, name: &str) -> Result<NodeId> {
        self.nodes.iter().position(|n| n.name == name).map(NodeId).ok_or_else(|| {
            Error::Unknown(format!(
                "the graph has no node named '{name}'{}",
                nearest(name, self.nodes.iter().map(|n| n.name.as_str()))
            ))
        })
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True when there is no node.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Name of a node within the graph.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a node of another graph.
    pub fn name(&self, node: NodeId) -> Result<&str> {
        Ok(&self.get(node)?.name)
    }

    /// Declaration of a node.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a node of another graph.
    pub fn spec(&self, node: NodeId) -> Result<&'static NodeSpec> {
        Ok(self.get(node)?.spec)
    }

    /// Sets a parameter.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a parameter the node lacks, [`Error::Value`] for a wrong type or range.
    pub fn set(&mut self, node: NodeId, param: &str, value: Value) -> Result<()> {
        let spec = self.get(node)?.spec;
        let (index, declared) = find_param(spec, param)?;
        self.nodes[node.0].values[index] = declared.check(spec.id, value)?;
        Ok(())
    }

    /// Sets a parameter from text, as a person writes it.
    ///
    /// # Errors
    /// As [`Graph::set`].
    pub fn set_text(&mut self, node: NodeId, param: &str, text: &str) -> Result<()> {
        let spec = self.get(node)?.spec;
        let (index, declared) = find_param(spec, param)?;
        self.nodes[node.0].values[index] = declared.parse(spec.id, text)?;
        Ok(())
    }

    /// Value of a parameter.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a parameter the node lacks.
    pub fn value(&self, node: NodeId, param: &str) -> Result<Value> {
        let node = self.get(node)?;
        Ok(node.values[find_param(node.spec, param)?.0])
    }

    /// Connects the output of `from` to a port of `to`, replacing what was there.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a port the node lacks, [`Error::Connection`] for kinds that do not fit or
    /// a cycle; the graph is then unchanged.
    pub fn connect(&mut self, from: NodeId, to: NodeId, port: &str) -> Result<()> {
        let kind = self.get(from)?.spec.output.kind;
        self.attach(Upstream::Node(from.0), kind, to, port)
    }

    /// Connects a picture that enters the graph to a port of `to`.
    ///
    /// # Errors
    /// As [`Graph::connect`].
    pub fn connect_input(&mut self, input: GraphInput, to: NodeId, port: &str) -> Result<()> {
        self.attach(Upstream::Input(input), input.kind(), to, port)
    }

    /// Opens a port.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a port the node lacks.
    pub fn disconnect(&mut self, to: NodeId, port: &str) -> Result<()> {
        let (index, _) = find_input(self.get(to)?.spec, port)?;
        self.nodes[to.0].inputs[index] = None;
        self.sort()
    }

    /// Makes the output of `node` the graph's.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a node of another graph.
    pub fn set_output(&mut self, node: NodeId) -> Result<()> {
        self.get(node)?;
        self.output = Some(node.0);
        Ok(())
    }

    /// Kind of image that leaves the graph, once an output is set.
    pub fn output_kind(&self) -> Option<ImageKind> {
        self.output_node().map(|(_, kind)| kind)
    }

    pub(crate) fn order(&self) -> &[usize] {
        &self.order
    }

    pub(crate) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    pub(crate) fn node_at(&self, index: usize) -> &Node {
        &self.nodes[index]
    }

    pub(crate) fn output_node(&self) -> Option<(usize, ImageKind)> {
        self.output.map(|o| (o, self.nodes[o].spec.output.kind))
    }

    fn get(&self, node: NodeId) -> Result<&Node> {
        self.nodes.get(node.0).ok_or_else(|| Error::Unknown(format!("there is no node {}", node.0)))
    }

    fn attach(&mut self, source: Upstream, kind: ImageKind, to: NodeId, port: &str) -> Result<()> {
        let node = self.get(to)?;
        let (index, wanted) = find_input(node.spec, port)?;
        // A flow map is a picture, too.
        if wanted != kind && !(wanted == ImageKind::Color && kind == ImageKind::Flow) {
            return Err(Error::Connection(format!(
                "input '{port}' of node '{}' ({}) takes {}, not {}",
                node.name,
                node.spec.id,
                wanted.id(),
                kind.id()
            )));
        }
        let before = self.nodes[to.0].inputs[index].replace(source);
        let sorted = self.sort();
        if sorted.is_err() {
            self.nodes[to.0].inputs[index] = before;
            self.sort()?;
        }
        sorted
    }

    /// Orders nodes so that each comes after those it reads.
    fn sort(&mut self) -> Result<()> {
        let mut placed = vec![false; self.nodes.len()];
        let mut order = Vec::with_capacity(self.nodes.len());
        while order.len() < self.nodes.len() {
            let ready = (0..self.nodes.len()).find(|n| {
                !placed[*n]
                    && self.nodes[*n].inputs.iter().flatten().all(|s| match s {
                        Upstream::Node(from) => placed[*from],
                        Upstream::Input(_) => true,
                    })
            });
            let Some(next) = ready else {
                let stuck = self.nodes.iter().zip(&placed).find(|(_, placed)| !**placed);
                let name = stuck.map_or("", |(n, _)| n.name.as_str());
                return Err(Error::Connection(format!("the connections of node '{name}' form a cycle")));
            };
            placed[next] = true;
            order.push(next);
        }
        self.order = order;
        Ok(())
    }
}

fn find_param(spec: &'static NodeSpec, id: &str) -> Result<(usize, &'static Param)> {
    spec.param(id).ok_or_else(|| {
        Error::Unknown(format!(
            "node '{}' has no parameter '{id}'{}",
            spec.id,
            nearest(id, spec.params().map(|p| p.id))
        ))
    })
}

fn find_input(spec: &'static NodeSpec, id: &str) -> Result<(usize, ImageKind)> {
    spec.input(id).map(|(index, port)| (index, port.kind)).ok_or_else(|| {
        Error::Unknown(format!(
            "node '{}' has no input '{id}'{}",
            spec.id,
            nearest(id, spec.ports().map(|p| p.id))
        ))
    })
}
