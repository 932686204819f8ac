//! Graphs as JSON files.
//!
//! ```json
//! {
//!   "format": "isophote-graph",
//!   "version": 1,
//!   "nodes": [
//!     { "name": "tensor", "node": "structure_tensor", "params": { "rho": 3.0 }, "inputs": { "color": "@color" } },
//!     { "name": "flow", "node": "line_integral_convolution", "inputs": { "color": "@color", "tensor": "tensor" } }
//!   ],
//!   "output": "flow"
//! }
//! ```
//!
//! An input names a node of the graph, or with `@` a picture that enters: `@color`, `@normal`,
//! `@depth`, `@object_id`. Colours are `#rrggbb` or lists of numbers. Unknown keys are errors.

use crate::declare::spec::{NodeSpec, Param};
use crate::declare::value::Value;
use crate::error::{Error, Result};
use crate::graph::{Graph, GraphInput, Upstream};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

const FORMAT: &str = "isophote-graph";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    format: String,
    version: u32,
    nodes: Vec<FileNode>,
    output: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileNode {
    name: String,
    node: String,
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    params: Map<String, Json>,
    #[serde(default, skip_serializing_if = "Map::is_empty")]
    inputs: Map<String, Json>,
}

impl Graph {
    /// Reads a graph.
    ///
    /// # Errors
    /// [`Error::Format`] for text that is not such a file, and the errors of [`Graph::add`],
    /// [`Graph::set`] and [`Graph::connect`] for what it names.
    pub fn from_json(text: &str) -> Result<Self> {
        let file: File =
            serde_json::from_str(text).map_err(|e| Error::Format(format!("not a graph file: {e}")))?;
        if file.format != FORMAT || file.version != 1 {
            return Err(Error::Format(format!(
                "format '{}' version {} is not '{FORMAT}' version 1",
                file.format, file.version
            )));
        }
        let mut graph = Self::new();
        for entry in &file.nodes {
            let node = graph.add(&entry.name, &entry.node)?;
            let spec = graph.spec(node)?;
            for (id, json) in &entry.params {
                match spec.param(id) {
                    Some((_, param)) => graph.set(node, id, value_from_json(spec, param, json)?)?,
                    // Reports the unknown parameter.
                    None => graph.set(node, id, Value::Bool(false))?,
                }
            }
        }
        for (index, entry) in file.nodes.iter().enumerate() {
            let to = graph.node(index)?;
            for (port, source) in &entry.inputs {
                let Some(source) = source.as_str() else {
                    return Err(Error::Format(format!("input '{port}' of '{}' must be a name", entry.name)));
                };
                match source.strip_prefix('@') {
                    Some(name) => {
                        let input = GraphInput::from_id(name).ok_or_else(|| {
                            let known = GraphInput::ALL.map(|i| format!("@{}", i.id())).join(", ");
                            Error::Unknown(format!("a graph has the inputs {known}, not '{source}'"))
                        })?;
                        graph.connect_input(input, to, port)?;
                    }
                    None => {
                        let from = graph.find(source)?;
                        graph.connect(from, to, port)?;
                    }
                }
            }
        }
        let output = graph.find(&file.output)?;
        graph.set_output(output)?;
        Ok(graph)
    }

    /// Writes the graph, with the parameters that differ from their defaults.
    ///
    /// # Errors
    /// [`Error::Connection`] when no output is set.
    pub fn to_json(&self) -> Result<String> {
        let Some((output, _)) = self.output_node() else {
            return Err(Error::Connection(
                "the graph has no output; name the node whose result leaves it".into(),
            ));
        };
        let nodes = (0..self.len()).map(|i| self.file_node(i)).collect();
        let file =
            File { format: FORMAT.into(), version: 1, nodes, output: self.node_at(output).name.clone() };
        let mut text = serde_json::to_string_pretty(&file).map_err(|e| Error::Format(e.to_string()))?;
        text.push('\n');
        Ok(text)
    }

    fn file_node(&self, index: usize) -> FileNode {
        let node = self.node_at(index);
        let params = node
            .spec
            .params()
            .zip(&node.values)
            .filter(|(param, value)| param.default != **value)
            .map(|(param, value)| (param.id.to_owned(), value_to_json(param, *value)))
            .collect();
        let inputs = node
            .spec
            .ports()
            .zip(&node.inputs)
            .filter_map(|(port, source)| {
                let name = match source.as_ref()? {
                    Upstream::Input(input) => format!("@{}", input.id()),
                    Upstream::Node(from) => self.node_at(*from).name.clone(),
                };
                Some((port.id.to_owned(), Json::String(name)))
            })
            .collect();
        FileNode { name: node.name.clone(), node: node.spec.id.to_owned(), params, inputs }
    }
}

fn value_from_json(spec: &NodeSpec, param: &Param, json: &Json) -> Result<Value> {
    let value = match json {
        Json::Bool(v) => Value::Bool(*v),
        Json::Number(v) => match v.as_i64().and_then(|v| i32::try_from(v).ok()) {
            Some(v) => Value::Int(v),
            None => Value::Float(v.as_f64().unwrap_or(f64::NAN) as f32),
        },
        Json::String(text) => return param.parse(spec.id, text),
        Json::Array(list) if param.default.form().count > 1 => {
            let text: Vec<String> = list.iter().map(Json::to_string).collect();
            return param.parse(spec.id, &text.join(","));
        }
        Json::Array(_) | Json::Object(_) | Json::Null => {
            return Err(Error::Value(format!("parameter '{}' of '{}' cannot be {json}", param.id, spec.id)));
        }
    };
    param.check(spec.id, value)
}

fn value_to_json(param: &Param, value: Value) -> Json {
    let form = value.form();
    (form.json)(form.numbers, param.options)
}
