//! Looks: presets and graphs, the files that the sample host and the Python package read, as graphs.
//!
//! A preset is `{"style": …, "lengths": …, "parameters": {…}}`; its style is the id of a node or a graph written out, whose
//! parameters are named `node.id`. A parameter is a value, or values by frame.

use isophote::{Error, Graph, NodeId, Value as Declared};
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
        Value::Object(keys) => {
            let declared = graph.spec(node)?.param(param);
            at_frame(name, keys, frame, declared.map(|(_, param)| param.default))?
        }
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

/// The value at a frame of a parameter with this default: numbers and colours change evenly between keys, unless they step.
fn at_frame(
    name: &str,
    object: &Map<String, Value>,
    frame: i64,
    default: Option<Declared>,
) -> Result<String, Error> {
    let mut keys = Vec::new();
    let mut is_stepping = matches!(default, None | Some(Declared::Bool(_) | Declared::Choice(_)));
    let is_whole = matches!(default, Some(Declared::Int(_)));
    for (key, value) in object {
        match (key.as_str(), key.parse::<i64>()) {
            (_, Ok(at)) => keys.push((at, text(name, value)?)),
            ("between", _) if matches!(value.as_str(), Some("step" | "linear")) => {
                is_stepping |= value.as_str() == Some("step");
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
        Some(mix(&numbers(&before.1)?, &numbers(&after.1)?, share, is_whole))
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

/// Numbers between two values.
fn mix(a: &[f64], b: &[f64], share: f64, is_whole: bool) -> String {
    // A colour without opacity is opaque.
    let part = |values: &[f64], at: usize| values.get(at).copied().unwrap_or(1.0);
    let mixed = (0..a.len().max(b.len())).map(|at| part(a, at) + (part(b, at) - part(a, at)) * share);
    let mixed =
        mixed.map(|value| if is_whole { value.round().to_string() } else { (value as f32).to_string() });
    mixed.collect::<Vec<String>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn value(look: Value, param: &str, frame: i64) -> Result<Declared, Error> {
        let look = Look::read(&look, frame)?;
        look.graph.value(look.graph.node(0)?, param)
    }

    #[test]
    fn presets_and_graphs_are_read() {
        let look = Look::read(&json!({ "style": "ink", "lengths": "pixels" }), 0).unwrap();
        assert_eq!((look.graph.len(), look.reference_height), (1, 0));
        let text = look.graph.to_json().unwrap();
        let graph: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(Look::read(&graph, 0).unwrap().reference_height, REFERENCE);
        let preset = json!({ "style": graph, "parameters": { "ink.tone": 0.5, "ink.style": "pencil" } });
        assert_eq!(value(preset, "tone", 0).unwrap(), Declared::Float(0.5));
    }

    #[test]
    fn values_move_between_keys() {
        let look = |keys: Value| json!({ "style": "cartoon", "parameters": keys });
        let sigma = json!({ "sigma_d": { "10": 2, "20": 4 } });
        for (frame, wanted) in [(0, 2.0), (10, 2.0), (15, 3.0), (20, 4.0), (99, 4.0)] {
            assert_eq!(
                value(look(sigma.clone()), "sigma_d", frame).unwrap(),
                Declared::Float(wanted),
                "{frame}"
            );
        }
        let steps = json!({ "sigma_d": { "10": 2, "20": 4, "between": "step" } });
        assert_eq!(value(look(steps), "sigma_d", 19).unwrap(), Declared::Float(2.0));
        let color = json!({ "line_color": { "0": "#000000", "2": [1, 0.5, 0] } });
        assert_eq!(value(look(color), "line_color", 1).unwrap(), Declared::Color([0.5, 0.25, 0.0, 1.0]));
        // Whole numbers stay whole, and what is no number never changes between keys.
        let whole = json!({ "posterize": { "0": 4, "10": 7 } });
        assert_eq!(value(look(whole), "posterize", 5).unwrap(), Declared::Int(6));
        let choice = json!({ "abstraction": { "0": "flow", "10": "full" } });
        assert!(value(look(choice), "abstraction", 5).is_ok());
    }

    #[test]
    fn what_is_wrong_with_a_preset_is_said() {
        for (look, part) in [
            (json!([]), "preset or a graph"),
            (json!({ "style": "ink", "parameter": {} }), "'parameter'"),
            (json!({ "style": "ink", "parameters": [] }), "object"),
            (json!({ "style": "ink", "lengths": "inches" }), "relative or pixels"),
            (json!({ "style": "ink", "parameters": { "tone": null } }), "cannot be null"),
            (json!({ "style": "ink", "parameters": { "tone": {} } }), "no key"),
            (json!({ "style": "ink", "parameters": { "tone": { "first": 1 } } }), "'first'"),
            (json!({ "style": "ink", "parameters": { "tune": 1 } }), "tone"),
        ] {
            let error = Look::read(&look, 0).unwrap_err().to_string();
            assert!(error.contains(part), "{look}: {error}");
        }
    }
}
