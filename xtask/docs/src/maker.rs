//! Graph that shows a node on a picture: by itself, or with what it needs before it and what makes its result
//! visible after it.

use crate::error::{Error, Result};
use isophote::registry;
use isophote::spec::{ImageKind, NodeSpec};
use serde_json::{Value, json};

/// Nodes that one picture does not show, and why.
const UNSHOWN: [(&str, &str); 3] = [
    (
        "flow_map",
        "It takes what somebody painted in place of the picture's own structure; `@flow` brings it into a graph.",
    ),
    ("optical_flow", "Its result is vectors between two frames, which `apply --motion estimate` uses."),
    ("steady", "It shows itself in sequences: a single frame stays as it is."),
];

/// Reason why there is no picture of a node; none where there is one.
pub fn unshown(node: &NodeSpec) -> Option<&'static str> {
    UNSHOWN.iter().find(|(id, _)| *id == node.id).map(|(_, why)| *why)
}

/// The graph that shows a node, by the name `node`; none where the node alone is enough.
///
/// # Errors
/// [`Error::Page`] where no node makes what it needs.
pub fn graph(node: &NodeSpec) -> Result<Option<Value>> {
    let needed: Vec<_> = node.inputs.iter().filter(|p| !p.optional && p.kind != ImageKind::Color).collect();
    let is_field = matches!(node.output.kind, ImageKind::Tensor);
    if needed.is_empty() && !is_field {
        return Ok(None);
    }
    let mut inputs = json!({});
    for port in node.inputs.iter().filter(|p| !p.optional && p.kind == ImageKind::Color) {
        inputs[port.id] = json!("@color");
    }
    let mut nodes = Vec::new();
    for port in needed {
        let able = |other: &&&NodeSpec| other.output.kind == port.kind && other.reads_colour_alone();
        let maker = registry::nodes().iter().find(able).ok_or_else(|| {
            Error::page(node.id, format!("no node makes the {} that it needs", port.kind.id()))
        })?;
        let name = format!("before-{}", port.id);
        nodes.push(json!({ "name": name, "node": maker.id, "inputs": { "color": "@color" } }));
        inputs[port.id] = json!(name);
    }
    nodes.push(json!({ "name": "node", "node": node.id, "inputs": inputs }));
    let mut output = "node";
    if is_field {
        output = "view";
        nodes.push(json!({ "name": output, "node": "tensor_view", "inputs": { "tensor": "node" } }));
    }
    Ok(Some(json!({ "format": "isophote-graph", "version": 1, "nodes": nodes, "output": output })))
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::Graph;

    #[test]
    fn every_node_can_be_shown_or_says_why_not() {
        for node in registry::nodes() {
            if let Some(graph) = graph(node).unwrap() {
                Graph::from_json(&graph.to_string()).unwrap_or_else(|e| panic!("{}: {e}", node.id));
            }
        }
        for (id, _) in UNSHOWN {
            registry::find(id).unwrap();
        }
    }
}
