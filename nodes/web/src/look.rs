//! Looks: presets and graphs, the files that the sample host and the Python package read, as graphs.
//!
//! A preset is `{"style": …, "lengths": …, "parameters": {…}}`; its style is the id of a node or a graph written out, whose
//! parameters are named `node.id`. A parameter is a value, or values by frame.

use isophote::{Error, Graph, NodeId};
use serde_json::{Map, Value};

/// Lines of the picture that relative lengths are meant for.
const REFERENCE: u32 = 1080;

/// Keys of a preset; the first three are for people.
const KEYS: [&str; 6] = ["name", "about", "tags", "style", "lengths", "parameters"];

/// A look at a frame.
#[derive(Debug)]
pub struct Look {
    /// What it computes.
    pub graph: Graph,
    /// Lines of the pictures that its lengths are meant for; 0: lengths are pixels.
    pub reference_height: u32,
}

impl Look {
    /// The look that a preset or a graph describes.
    ///
    /// # Errors
    /// [`Error::Format`] for what is neither, and the errors of graphs.
    pub fn read(json: &Value, frame: i64) -> Result<Self, Error> {
        let Value::Object(file) = json else {
            return Err(Error::Format("a look is a preset or a graph, which are objects".into()));
        };
        if file.contains_key("nodes") {
            return Ok(Self { graph: Graph::from_json(&json.to_string())?, reference_height: REFERENCE });
        }
        if let Some(unknown) = file.keys().find(|key| !KEYS.contains(&key.as_str())) {
            return Err(Error::Format(format!(
                "a preset has no key '{unknown}'; the keys are {}",
                KEYS.join(", ")
            )));
        }
        let mut graph = match file.get("style") {
            Some(Value::String(node)) => Graph::single(node)?,
            Some(graph @ Value::Object(_)) => Graph::from_json(&graph.to_string())?,
            _ => return Err(Error::Format("the preset names no style; add \"style\": \"cartoon\"".into())),
        };
        match file.get("parameters") {
            None => {}
            Some(Value::Object(parameters)) => {
                for (name, value) in parameters {
                    set(&mut graph, name, value, frame)?;
                }
            }
            Some(_) => return Err(Error::Format("the parameters of a preset are an object".into())),
        }
        let reference_height = match file.get("lengths").map(Value::as_str) {
            None | Some(Some("relative")) => REFERENCE,
            Some(Some("pixels")) => 0,
            Some(_) => return Err(Error::Format("the lengths of a preset are relative or pixels".into())),
        };
        Ok(Self { graph, reference_height })
    }
}

/// Sets a parameter, of the only node or as `node.id`.
fn set(graph: &mut Graph, name: &str, value: &Value, frame: i64) -> Result<(), Error> {
    let (node, param) = place(graph, name)?;
    let text = match value {
        Value::Object(keys) => at_frame(name, keys, frame)?,
        value => text(name, value)?,
    };
    graph.set_text(node, param, &text)
}

fn place<'n>(graph: &Graph, name: &'n str) -> Result<(NodeId, &'n str), Error> {
    match name.rsplit_once('.') {
        Some((node, param)) => Ok((graph.find(node)?, param)),
        None if graph.len() == 1 => Ok((graph.node(0)?, name)),
        None => {
            Err(Error::Unknown(format!("'{name}' names no node; write the node before it: 'node.{name}'")))
        }
    }
}

/// A value as people write it.
fn text(name: &str, value: &Value) -> Result<String, Error> {
    match value {
        Value::Number(number) => Ok(number.to_string()),
        Value::Bool(flag) => Ok(flag.to_string()),
        Value::String(text) => Ok(text.clone()),
        Value::Array(parts) if !parts.is_empty() && parts.iter().all(Value::is_number) => {
            Ok(parts.iter().map(Value::to_string).collect::<Vec<_>>().join(","))
        }
        _ => Err(Error::Value(format!(
            "parameter '{name}' cannot be {value}; write a number, true or false, a text, or the numbers of a colour"
        ))),
    }
}

/// The value at a frame: numbers and colours change evenly between keys, unless they step.
fn at_frame(name: &str, object: &Map<String, Value>, frame: i64) -> Result<String, Error> {
    let mut keys = Vec::new();
    let mut is_stepping = false;
    for (key, value) in object {
        match (key.as_str(), key.parse::<i64>()) {
            (_, Ok(at)) => keys.push((at, text(name, value)?)),
            ("between", _) if matches!(value.as_str(), Some("step" | "linear")) => {
                is_stepping = value.as_str() == Some("step");
            }
            _ => {
                return Err(Error::Value(format!(
                    "'{key}' of parameter '{name}' is no number of a frame; write keys such as {{\"1\": 2, \"50\": 6}}"
                )));
            }
        }
    }
    keys.sort_by_key(|(at, _)| *at);
    let after = keys.partition_point(|(at, _)| *at <= frame);
    let before = keys
        .get(after.saturating_sub(1))
        .ok_or_else(|| Error::Value(format!("parameter '{name}' has no key; write its value")))?;
    let after = keys.get(after).filter(|(at, _)| *at > before.0 && frame > before.0 && !is_stepping);
    let mixed = after.and_then(|after| {
        let share = (frame - before.0) as f64 / (after.0 - before.0) as f64;
        mix(&numbers(&before.1)?, &numbers(&after.1)?, share)
    });
    Ok(mixed.unwrap_or_else(|| before.1.clone()))
}

/// The numbers of a value: one, or those of a colour from 0 to 1.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let Some(digits) = text.strip_prefix('#') else {
        return text.split(',').map(|part| part.trim().parse().ok()).collect();
    };
    let pairs = (0..digits.len()).step_by(2).map(|at| digits.get(at..at + 2));
    pairs.map(|pair| Some(f64::from(u8::from_str_radix(pair?, 16).ok()?) / 255.0)).collect()
}

/// Numbers between two values; whole ones stay whole.
fn mix(a: &[f64], b: &[f64], share: f64) -> Option<String> {
    // A colour without opacity is opaque.
    let part = |values: &[f64], at: usize| values.get(at).copied().unwrap_or(1.0);
    let is_whole = a.len() == 1 && b.len() == 1 && a[0].fract() == 0.0 && b[0].fract() == 0.0;
    let mixed = (0..a.len().max(b.len())).map(|at| part(a, at) + (part(b, at) - part(a, at)) * share);
    let mixed: Vec<String> = mixed.map(|value| (value as f32).to_string()).collect();
    (!is_whole || mixed.len() == 1).then(|| mixed.join(","))
}
