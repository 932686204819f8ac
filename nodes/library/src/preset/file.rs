//! Files of presets: text to a preset and back.

use super::fault::Fault;
use super::lengths::Lengths;
use super::objects::{self, ObjectRule};
use super::title::{self, Title};
use crate::error::nearest_name;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

type Result<T> = std::result::Result<T, Fault>;

/// Keys of the file.
const KEYS: [&str; 3] = ["style", "lengths", "parameters"];
/// The key beside the frames of an animated parameter.
const BETWEEN: &str = "between";

/// A file, read and not yet compared with the nodes that there are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Its name, description and tags.
    pub title: Title,
    /// The id of a node, the path of a graph file, or the JSON of a graph.
    pub style: String,
    /// Meaning of lengths, where the file says so.
    pub lengths: Option<Lengths>,
    /// Parameters in the file's order, named `id` or `node.id`.
    pub params: Vec<(String, Track)>,
    /// Rules for things in the picture, the last of which counts.
    #[serde(default)]
    pub objects: Vec<ObjectRule>,
}

/// Values of one parameter of a preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Track {
    /// The same value for all frames, as text.
    Still(String),
    /// Values by frame.
    Keys {
        /// Values as text, by ascending frame; at least one.
        keys: Vec<(i64, String)>,
        /// True where values hold until the next key, false where they change evenly.
        step: Option<bool>,
    },
}

impl Preset {
    /// Reads the text of a file; `place` names it in messages.
    ///
    /// # Errors
    /// The first fault: text that is no JSON, keys that are not known, naming the nearest, and values that no
    /// parameter can have.
    pub fn parse(place: &str, text: &str) -> Result<Self> {
        let (preset, faults) = Self::examine(place, text)?;
        faults.into_iter().next().map_or(Ok(preset), Err)
    }

    /// As [`Preset::parse`], but goes on after what is wrong: what can be read, with all faults. The style is empty
    /// where none can be read.
    ///
    /// # Errors
    /// The fault of text that is no JSON object, of which nothing can be read.
    pub fn examine(place: &str, text: &str) -> Result<(Self, Vec<Fault>)> {
        let fix = "correct the preset";
        let json: Value = serde_json::from_str(text)
            .map_err(|e| Fault::format(place, format!("is no JSON: {e}"), "correct the file"))?;
        let Value::Object(mut file) = json else {
            return Err(Fault::format(place, "is no preset: an object is wanted", fix));
        };
        let mut faults = unknown_keys(place, &file);
        let title = Title::take(place, &mut file, &mut faults);
        let style = match file.remove("style") {
            Some(Value::String(style)) => style,
            Some(graph @ Value::Object(_)) => graph.to_string(),
            other => {
                faults.push(match other {
                    Some(_) => Fault::format(place, "its style is no text", "write the id of a node"),
                    None => {
                        Fault::format(place, "names no style", "add \"style\": \"cartoon\" or another node")
                    }
                });
                String::new()
            }
        };
        let lengths = match file.remove("lengths") {
            None => None,
            Some(value) => {
                let known = value.as_str().and_then(Lengths::of);
                if known.is_none() {
                    let words = Lengths::ALL.map(Lengths::id).join(" or ");
                    faults.push(Fault::format(
                        place,
                        format!("its lengths are {value}"),
                        format!("write {words}"),
                    ));
                }
                known
            }
        };
        let mut params = Vec::new();
        match file.remove("parameters") {
            Some(Value::Object(object)) => {
                for (name, value) in object {
                    let place = format!("{place}: parameter '{name}'");
                    params.extend(track(&place, value, &mut faults).map(|track| (name, track)));
                }
            }
            Some(_) => faults.push(Fault::format(place, "its parameters are no object", fix)),
            None => {}
        }
        let objects = ObjectRule::take(place, &mut file, &mut faults);
        faults.extend(looks_of(place, &objects));
        Ok((Self { title, style, lengths, params, objects }, faults))
    }

    /// The preset as the text of a file.
    pub fn to_json(&self) -> String {
        format!("{:#}\n", Value::Object(self.object()))
    }

    /// The preset as what is in a file.
    pub fn object(&self) -> Map<String, Value> {
        let mut params = Map::new();
        for (name, track) in &self.params {
            let value = match track {
                Track::Still(text) => json_of(text),
                Track::Keys { keys, step } => {
                    let mut object: Map<String, Value> =
                        keys.iter().map(|(frame, text)| (frame.to_string(), json_of(text))).collect();
                    if let Some(step) = step {
                        object.insert(BETWEEN.into(), if *step { "step" } else { "linear" }.into());
                    }
                    Value::Object(object)
                }
            };
            params.insert(name.clone(), value);
        }
        let mut file = Map::new();
        self.title.put(&mut file);
        let [style, lengths, parameters] = KEYS;
        let graph = is_written_out(&self.style).then(|| serde_json::from_str(&self.style).ok()).flatten();
        file.insert(style.into(), graph.unwrap_or_else(|| self.style.as_str().into()));
        if let Some(kind) = self.lengths {
            file.insert(lengths.into(), kind.id().into());
        }
        file.insert(parameters.into(), params.into());
        ObjectRule::put(&self.objects, &mut file);
        file
    }
}

/// Faults of looks that rules for objects have written out.
fn looks_of(place: &str, rules: &[ObjectRule]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (number, rule) in rules.iter().enumerate() {
        let Some(look @ Value::Object(own)) = rule.rule.get(objects::LOOK) else { continue };
        let place = format!("{place}: object {}: its look", number + 1);
        if own.contains_key(objects::KEY) {
            let fix = "write rules for all things in the preset itself";
            faults.push(Fault::format(&place, "has rules for objects", fix));
            continue;
        }
        match Preset::examine(&place, &look.to_string()) {
            Ok((_, own)) => faults.extend(own),
            Err(fault) => faults.push(fault),
        }
    }
    faults
}

/// Faults of the keys of a file that are not known, each with the nearest one that is.
fn unknown_keys(place: &str, file: &Map<String, Value>) -> Vec<Fault> {
    let keys = [&title::KEYS[..], &KEYS, &[objects::KEY]].concat();
    let unknown = file.keys().filter(|key| !keys.contains(&key.as_str()));
    let fault = |key: &String| {
        let known = nearest_name(key, keys.iter().copied()).map_or_else(
            || format!("the keys are {}", keys.join(", ")),
            |near| format!("did you mean '{near}'?"),
        );
        Fault::format(place, format!("has an unknown key '{}'", key.escape_default()), known)
    };
    unknown.map(fault).collect()
}

/// True for a name of a style that is a graph itself, as JSON.
pub fn is_written_out(style: &str) -> bool {
    style.trim_start().starts_with('{')
}

/// True for the text of a JSON file that is a graph and not a preset.
pub fn is_graph(text: &str) -> bool {
    let has = |json: &Value, key| json.get(key).is_some();
    serde_json::from_str(text).is_ok_and(|json| has(&json, "nodes") || has(&json, "format"))
}

/// Setting of a parameter as the file has it, unless it has faults, which are added.
fn track(place: &str, value: Value, faults: &mut Vec<Fault>) -> Option<Track> {
    let before = faults.len();
    let Value::Object(object) = value else {
        return text_of(place, &value).map_err(|fault| faults.push(fault)).ok().map(Track::Still);
    };
    let (mut keys, mut step) = (Vec::new(), None);
    for (key, value) in object {
        if let Ok(frame) = key.parse::<i64>() {
            match text_of(&format!("{place} at frame {frame}"), &value) {
                Ok(text) => keys.push((frame, text)),
                Err(fault) => faults.push(fault),
            }
            continue;
        }
        step = match (key.as_str(), value.as_str()) {
            (BETWEEN, Some("step")) => Some(true),
            (BETWEEN, Some("linear")) => Some(false),
            (BETWEEN, _) => {
                let fix = "write \"between\": \"linear\" or \"step\"";
                faults.push(Fault::value(place, "does not say how values change between frames", fix));
                None
            }
            _ => {
                let problem = format!("'{}' is no number of a frame", key.escape_default());
                let fix = nearest_name(&key, [BETWEEN].into_iter()).map_or_else(
                    || "write keyframes such as {\"1001\": 2, \"1050\": 6}".to_owned(),
                    |near| format!("did you mean '{near}'?"),
                );
                faults.push(Fault::value(place, problem, fix));
                step
            }
        };
    }
    keys.sort_by_key(|(frame, _)| *frame);
    if keys.is_empty() && faults.len() == before {
        let fix = "write keyframes such as {\"1001\": 2, \"1050\": 6}";
        faults.push(Fault::value(place, "has no keyframe", fix));
    }
    for twice in keys.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let problem = format!("has frame {} twice", twice[0].0);
        faults.push(Fault::value(place, problem, "leave one of them out"));
    }
    (faults.len() == before).then_some(Track::Keys { keys, step })
}

/// A value as `--set` takes it.
fn text_of(place: &str, value: &Value) -> Result<String> {
    match value {
        Value::Number(number) => Ok(number.to_string()),
        Value::Bool(flag) => Ok(flag.to_string()),
        Value::String(text) => Ok(text.clone()),
        Value::Array(parts) if !parts.is_empty() && parts.iter().all(Value::is_number) => {
            Ok(parts.iter().map(Value::to_string).collect::<Vec<_>>().join(","))
        }
        _ => Err(Fault::value(
            place,
            format!("cannot be {value}"),
            "write a number, true or false, a text, or the numbers of a colour",
        )),
    }
}

/// The value that [`text_of`] would make this text of.
fn json_of(text: &str) -> Value {
    match serde_json::from_str(text) {
        Ok(value @ (Value::Number(_) | Value::Bool(_))) => value,
        _ => Value::String(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> std::result::Result<Preset, String> {
        Preset::parse("p.json", text).map_err(|e| e.to_string())
    }

    #[test]
    fn a_preset_is_read_and_written() {
        let text = r##"{"style": "ink", "parameters": {"tone": 0.25, "cover": true, "style": "pencil",
            "line_color": "#102030", "paper_color": [1, 0.5, 0], "grain": {"1050": 1, "1001": 0, "between": "step"}}}"##;
        let preset = parse(text).unwrap();
        assert_eq!(preset.params[0], ("tone".into(), Track::Still("0.25".into())));
        assert_eq!(preset.params[4].1, Track::Still("1,0.5,0".into()));
        let keys = vec![(1001, "0".to_owned()), (1050, "1".to_owned())];
        assert_eq!(preset.params[5].1, Track::Keys { keys, step: Some(true) });
        assert_eq!(parse(&preset.to_json()), Ok(preset));
    }

    #[test]
    fn rules_for_things_are_read_and_written() {
        let text = r#"{"style": "ink", "objects": [{"match": "cryptomatte:hero/*", "detail": 2, "line_width": 0.5},
            {"match": "id:3", "lines": false, "medium": 1}, {"match": "id:4", "lines": true}]}"#;
        let preset = parse(text).unwrap();
        let control: Vec<_> = preset.objects.iter().map(|rule| rule.control).collect();
        assert!(matches!(control[0], [Some(a), Some(b), None, None] if a > 0.7 && b < 0.3), "{control:?}");
        assert_eq!(control[1], [None, None, Some(0.0), Some(0.5)]);
        assert_eq!(control[2], [None, None, Some(0.5), None]);
        assert_eq!(parse(&preset.to_json()), Ok(preset));
    }

    #[test]
    fn messages_name_what_is_wrong() {
        for (text, message) in [
            ("{", "is no JSON"),
            ("[]", "an object is wanted"),
            (r#"{"styl": "ink"}"#, "did you mean 'style'?"),
            (r#"{"parameters": {}}"#, "names no style"),
            (r#"{"style": 1}"#, "its style is no text"),
            (r#"{"style": "ink", "parameters": []}"#, "are no object"),
            (r#"{"style": "ink", "parameters": {"a": null}}"#, "cannot be null"),
            (r#"{"style": "ink", "parameters": {"a": {}}}"#, "has no keyframe"),
            (r#"{"style": "ink", "parameters": {"a": {"1": 2, "01": 3}}}"#, "has frame 1 twice"),
            (r#"{"style": "ink", "parameters": {"a": {"betwen": "step"}}}"#, "did you mean 'between'?"),
            (r#"{"style": "ink", "parameters": {"a": {"1": 2, "between": "smooth"}}}"#, "linear"),
            (r#"{"style": "ink", "objects": {}}"#, "its objects are no list"),
            (r#"{"style": "ink", "objects": [{"detail": 2}]}"#, "names no things"),
            (r#"{"style": "ink", "objects": [{"match": "id:1", "detail": 5}]}"#, "from 0.25 to 4"),
            (
                r#"{"style": "ink", "objects": [{"match": "id:1", "line_with": 2}]}"#,
                "did you mean 'line_width'?",
            ),
            (r#"{"style": "ink", "objects": [{"match": "id:1", "lines": 0}]}"#, "write true or false"),
            (
                r#"{"style": "ink", "objects": [{"match": "id:1", "lines": false, "line_amount": 1}]}"#,
                "leave out \"lines\" or",
            ),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(message) && !error.contains('\n'), "{text}: {error}");
        }
    }
}
