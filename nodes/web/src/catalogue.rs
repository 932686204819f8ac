//! The nodes' declarations as JSON.

use isophote::graph::GraphInput;
use isophote::registry;
use isophote::spec::{NodeSpec, Param, Port};
use isophote::value::{Value as Number, decimal};
use serde_json::{Value, json};

/// All nodes, in the registry's order, and the guides.
pub fn catalogue() -> Value {
    let nodes: Vec<Value> = registry::nodes().iter().map(|spec| node(spec)).collect();
    let guides: Vec<Value> = GraphInput::GUIDES.into_iter().map(guide).collect();
    json!({ "nodes": nodes, "guides": guides })
}

fn guide(guide: GraphInput) -> Value {
    let kind = guide.kind();
    json!({
        "id": guide.id(),
        "label": guide.label(),
        "doc": guide.doc(),
        "kind": kind.id(),
        "channels": kind.channels(),
    })
}

fn node(spec: &NodeSpec) -> Value {
    json!({
        "id": spec.id,
        "label": spec.label,
        "group": spec.group,
        "hint": spec.hint,
        "doc": spec.text(),
        "section": spec.section,
        "medium": spec.medium().map(|param| param.id),
        "inputs": spec.ports().map(port).collect::<Vec<Value>>(),
        "params": spec.params().map(param).collect::<Vec<Value>>(),
        "output": port(&spec.output),
    })
}

fn port(port: &Port) -> Value {
    json!({ "id": port.id, "kind": port.kind.id(), "doc": port.doc, "optional": port.optional })
}

fn param(param: &Param) -> Value {
    let form = param.default.form();
    let mut json = json!({
        "id": param.id,
        "label": param.label,
        "hint": param.hint,
        "doc": param.text(),
        "group": param.group,
        "type": kind(param.default),
        "unit": param.unit.id(),
        "structural": param.structural,
        "default": (form.json)(param.default.decimals(), param.options),
    });
    if matches!(param.default, Number::Float(_) | Number::Int(_)) {
        json["range"] = json!(param.range.map(decimal));
        json["slider"] = json!(param.slider.map(decimal));
    }
    if !param.options.is_empty() {
        let options = param.options.iter();
        let options = options.map(|o| json!({ "id": o.id, "label": o.label, "doc": o.doc }));
        json["options"] = options.collect::<Vec<Value>>().into();
    }
    json
}

const fn kind(value: Number) -> &'static str {
    match value {
        Number::Float(_) => "float",
        Number::Int(_) => "int",
        Number::Bool(_) => "bool",
        Number::Choice(_) => "choice",
        Number::Color(_) => "color",
    }
}
