//! Nodes as the catalogue describes them, and the pictures that show them.

use crate::error::{Error, Result};
use serde_json::{Value, json};
use std::path::Path;

/// One result: a node with some parameters set.
pub struct Shot {
    pub title: String,
    pub set: Vec<(String, String)>,
}

/// A text of the catalogue; empty where there is none.
pub fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

/// A list of the catalogue; empty where there is none.
pub fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

/// True where the node's output can be looked at.
pub fn makes_pictures(node: &Value) -> bool {
    matches!(text(&node["output"], "kind"), "color" | "scalar")
}

/// True where the node uses what a renderer knows.
pub fn takes_guides(node: &Value) -> bool {
    list(node, "inputs").iter().any(|p| text(p, "kind") == "normal")
}

/// Argument of `--style` and `apply`: the node's id or, when it needs more than a picture, a graph file that puts the
/// first node which makes such an image from colour before it.
pub fn style_of(node: &Value, nodes: &[Value], out: &Path) -> Result<String> {
    let id = text(node, "id");
    let missing: Vec<&Value> = list(node, "inputs")
        .iter()
        .filter(|p| p["optional"] == json!(false) && text(p, "kind") != "color")
        .collect();
    if missing.is_empty() {
        return Ok(id.to_owned());
    }
    let mut inputs = json!({});
    let pictures = |p: &&Value| text(p, "kind") == "color" && p["optional"] == json!(false);
    for port in list(node, "inputs").iter().filter(pictures) {
        inputs[text(port, "id")] = json!("@color");
    }
    let mut graph_nodes = Vec::new();
    for port in missing {
        let able = nodes.iter().find(|n| {
            text(&n["output"], "kind") == text(port, "kind")
                && list(n, "inputs").iter().all(|p| p["optional"] == json!(true) || text(p, "id") == "color")
        });
        let able = able.ok_or_else(|| Error::NoMaker { kind: text(port, "kind").into(), node: id.into() })?;
        let name = format!("before-{}", text(port, "id"));
        inputs[text(port, "id")] = json!(name);
        graph_nodes.push(json!({ "name": name, "node": text(able, "id"), "inputs": { "color": "@color" } }));
    }
    graph_nodes.push(json!({ "name": id, "node": id, "inputs": inputs }));
    let graph = json!({ "format": "isophote-graph", "version": 1, "nodes": graph_nodes, "output": id });
    let path = out.join(format!("{id}.json"));
    std::fs::write(&path, format!("{graph:#}\n"))
        .map_err(|source| Error::File { path: path.clone(), source })?;
    Ok(path.display().to_string())
}

/// The defaults, then each other option of each choice.
pub fn shots(node: &Value) -> Vec<Shot> {
    let mut shots = vec![Shot { title: "defaults".into(), set: Vec::new() }];
    for param in list(node, "params") {
        for option in list(param, "options") {
            let (id, option) = (text(param, "id"), text(option, "id"));
            if option != text(param, "default") {
                let set = vec![(id.to_owned(), option.to_owned())];
                shots.push(Shot { title: format!("{id} = {option}"), set });
            }
        }
    }
    shots
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A node with a choice and a number.
    pub fn node() -> Value {
        json!({
            "id": "n", "output": { "kind": "color" },
            "inputs": [{ "id": "color", "kind": "color", "optional": false }],
            "params": [
                { "id": "kind", "default": "a", "options": [{ "id": "a" }, { "id": "b" }] },
                { "id": "sigma", "default": 0.1_f32 },
            ],
        })
    }

    #[test]
    fn a_node_that_needs_more_than_a_picture_gets_a_graph() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(style_of(&node(), &[], folder.path()).unwrap(), "n");
        let mut needy = node();
        needy["inputs"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "id": "t", "kind": "tensor", "optional": false }));
        assert!(style_of(&needy, &[node()], folder.path()).is_err());
        let mut maker = node();
        maker["id"] = json!("m");
        maker["output"]["kind"] = json!("tensor");
        let file = style_of(&needy, &[maker], folder.path()).unwrap();
        let graph: Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
        assert_eq!(graph["nodes"][0]["node"], "m");
        assert_eq!(graph["nodes"][1]["inputs"]["t"], "before-t");
    }
}
