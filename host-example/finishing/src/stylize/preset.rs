//! Presets: a style with its parameters as a JSON file, which may change from frame to frame.
//!
//! ```json
//! {
//!   "name": "Dusk",
//!   "about": "Indigo lines that grow softer",
//!   "tags": ["comic", "soft"],
//!   "style": "cartoon",
//!   "parameters": {
//!     "posterize": 6,
//!     "line_color": "#101820",
//!     "sigma_d": {"1001": 2, "1050": 6},
//!     "abstraction": {"1001": "flow", "1020": "full", "between": "step"}
//!   }
//! }
//! ```
//!
//! Name, description and tags are for people and may be left out, like all but the style.
//! `style` is the id of a node, the path of a graph file relative to the preset, or a graph written out; `node.id` then
//! names the parameter of one node. `"lengths": "pixels"` makes lengths pixels of the picture instead of those of one 1080
//! lines high. Keyframes are values by frame: before the first and after the last their values
//! hold, between two of them numbers and colours change evenly (`linear`) or not at all (`step`), the rest
//! never does. Whole numbers are rounded.

use std::ffi::OsString;
use std::path::Path;

use serde_json::{Map, Value};

use super::lengths::Lengths;
use super::title::{self, Title};
use isophote_files::error::{Error, Result};
use isophote_loader::catalogue::{Param, ParamKind};

/// Keys of the file.
const KEYS: [&str; 3] = ["style", "lengths", "parameters"];
/// The key beside the frames of an animated parameter.
const BETWEEN: &str = "between";

/// A file, read and not yet compared with what the library knows.
#[derive(Clone, Debug, PartialEq)]
pub struct Preset {
    /// What it says about itself.
    pub title: Title,
    /// The id of a node, the path of a graph file, or the JSON of a graph.
    pub style: String,
    /// What lengths mean, where the file says so.
    pub lengths: Option<Lengths>,
    /// Parameters in the file's order, by the names that `--set` takes.
    pub params: Vec<(String, Track)>,
}

/// What a preset says of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Track {
    /// The same value for all frames, as text.
    Still(String),
    /// Values by frame.
    Keys {
        /// Values as text, by ascending frame; at least one.
        keys: Vec<(i64, String)>,
        /// Whether values hold until the next key.
        step: Option<bool>,
    },
}

impl Track {
    /// Frames of the keys.
    pub fn frames(&self) -> impl Iterator<Item = i64> {
        let keys = match self {
            Self::Still(_) => &[],
            Self::Keys { keys, .. } => keys.as_slice(),
        };
        keys.iter().map(|(frame, _)| *frame)
    }
}

impl Preset {
    /// Reads the text of the file `path`.
    ///
    /// # Errors
    /// [`Error::Input`] for what is no JSON, keys that are not known, naming the nearest, and values that no
    /// parameter can have.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let (preset, faults) = Self::examine(path, text)?;
        faults.into_iter().next().map_or(Ok(preset), Err)
    }

    /// As [`Preset::parse`], but goes on after what is wrong: what can be read, with all faults. The style is empty
    /// where none can be read.
    ///
    /// # Errors
    /// [`Error::Input`] for what is no JSON object, of which nothing can be read.
    pub fn examine(path: &Path, text: &str) -> Result<(Self, Vec<Error>)> {
        let fix = "correct the preset";
        let json: Value = serde_json::from_str(text)
            .map_err(|e| Error::file(path, format!("is no JSON: {e}"), "correct the file"))?;
        let Value::Object(mut file) = json else {
            return Err(Error::file(path, "is no preset: an object is wanted", fix));
        };
        let mut faults = Vec::new();
        let keys = [title::KEYS, KEYS].concat();
        for key in file.keys().filter(|key| !keys.contains(&key.as_str())) {
            let known = nearest(key, keys.iter().copied()).map_or_else(
                || format!("the keys are {}", keys.join(", ")),
                |near| format!("did you mean '{near}'?"),
            );
            faults.push(Error::file(path, format!("has an unknown key '{}'", key.escape_default()), known));
        }
        let title = Title::take(path, &mut file, &mut faults);
        let style = match file.remove("style") {
            Some(Value::String(style)) => style,
            Some(graph @ Value::Object(_)) => graph.to_string(),
            other => {
                faults.push(match other {
                    Some(_) => Error::file(path, "its style is no text", "write the id of a node"),
                    None => Error::file(path, "names no style", "add \"style\": \"cartoon\" or another node"),
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
                    faults.push(Error::file(
                        path,
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
                    let place = format!("{}: parameter '{name}'", path.display());
                    params.extend(track(&place, value, &mut faults).map(|track| (name, track)));
                }
            }
            Some(_) => faults.push(Error::file(path, "its parameters are no object", fix)),
            None => {}
        }
        Ok((Self { title, style, lengths, params }, faults))
    }

    /// The style as it is to be opened by a program whose folder is another than that of the preset at `path`:
    /// graph files lie beside the preset.
    pub fn style_beside(&self, path: &Path) -> OsString {
        let is_file = self.style.to_ascii_lowercase().ends_with(".json");
        match path.parent() {
            Some(folder) if is_file => folder.join(&self.style).into(),
            _ => self.style.clone().into(),
        }
    }

    /// The style as people are told of it.
    pub fn style_shown(&self) -> &str {
        if is_written_out(&self.style) { "a graph of its own" } else { &self.style }
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
        file
    }
}

/// Whether what names a style is a graph itself, as JSON.
pub fn is_written_out(style: &str) -> bool {
    style.trim_start().starts_with('{')
}

/// Whether the text of a JSON file is a graph and not a preset.
pub fn is_graph(text: &str) -> bool {
    let has = |json: &Value, key| json.get(key).is_some();
    serde_json::from_str(text).is_ok_and(|json| has(&json, "nodes") || has(&json, "format"))
}

/// What the file says of a parameter, unless it has faults, which are added.
fn track(place: &str, value: Value, faults: &mut Vec<Error>) -> Option<Track> {
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
                faults.push(Error::input(place, "does not say how values change between frames", fix));
                None
            }
            _ => {
                let problem = format!("'{}' is no number of a frame", key.escape_default());
                let fix = nearest(&key, [BETWEEN].into_iter()).map_or_else(
                    || "write keyframes such as {\"1001\": 2, \"1050\": 6}".to_owned(),
                    |near| format!("did you mean '{near}'?"),
                );
                faults.push(Error::input(place, problem, fix));
                step
            }
        };
    }
    keys.sort_by_key(|(frame, _)| *frame);
    if keys.is_empty() && faults.len() == before {
        let fix = "write keyframes such as {\"1001\": 2, \"1050\": 6}";
        faults.push(Error::input(place, "has no keyframe", fix));
    }
    for twice in keys.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let problem = format!("has frame {} twice", twice[0].0);
        faults.push(Error::input(place, problem, "leave one of them out"));
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
        _ => Err(Error::input(
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

/// The one of `known` that is like `wanted`, if any is.
fn nearest<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    known
        .map(|k| (strsim::damerau_levenshtein(wanted, k), k))
        .filter(|(d, k)| *d <= k.len() / 2)
        .min()
        .map(|(_, k)| k)
}

/// An animated parameter of a graph.
#[derive(Clone, Debug)]
pub struct Animated {
    /// The name that the preset has for it.
    pub name: String,
    /// Index of the node.
    pub node: u32,
    /// Id of the parameter.
    pub param: String,
    keys: Vec<(i64, String)>,
    /// Numbers of the keys where values change evenly between them, and whether they are whole.
    ramp: Option<(Vec<Vec<f64>>, bool)>,
}

impl Animated {
    /// The keys of a parameter: its name in the preset, the index of its node, and what the node says about
    /// it. `place` names it in messages.
    ///
    /// # Errors
    /// [`Error::Input`] when values are to change evenly that cannot.
    pub fn new(
        place: &str,
        (name, node, param): (&str, u32, &Param),
        keys: &[(i64, String)],
        step: Option<bool>,
    ) -> Result<Self> {
        let kind = &param.kind;
        let even = matches!(kind, ParamKind::Float { .. } | ParamKind::Int { .. } | ParamKind::Color { .. });
        if !even && step == Some(false) {
            return Err(Error::input(place, "cannot change evenly", "write \"between\": \"step\""));
        }
        let ramp = (even && step != Some(true))
            .then(|| keys.iter().map(|(_, text)| numbers(text)).collect::<Option<Vec<_>>>())
            .flatten()
            .map(|numbers| (numbers, matches!(kind, ParamKind::Int { .. })));
        Ok(Self { name: name.to_owned(), node, param: param.id.to_owned(), keys: keys.to_vec(), ramp })
    }

    /// Frames of the keys.
    pub fn frames(&self) -> impl Iterator<Item = i64> {
        self.keys.iter().map(|(frame, _)| *frame)
    }

    /// The value at a frame, as text.
    pub fn at(&self, frame: i64) -> String {
        let after = self.keys.partition_point(|(key, _)| *key <= frame);
        let before = after.saturating_sub(1);
        let (Some((numbers, whole)), true) = (&self.ramp, after > 0 && after < self.keys.len()) else {
            return self.keys[before].1.clone();
        };
        let (from, to) = (self.keys[before].0 as f64, self.keys[after].0 as f64);
        let share = (frame as f64 - from) / (to - from);
        let (a, b) = (&numbers[before], &numbers[after]);
        // A colour without opacity is opaque.
        let length = a.len().max(b.len());
        let part = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(1.0);
        let mixed = (0..length).map(|i| {
            let value = part(a, i) + (part(b, i) - part(a, i)) * share;
            if *whole { value.round().to_string() } else { (value as f32).to_string() }
        });
        mixed.collect::<Vec<_>>().join(",")
    }
}

/// The numbers of a value: one, or those of a colour from 0 to 1.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let Some(digits) = text.strip_prefix('#') else {
        return text.split(',').map(|part| part.trim().parse().ok()).collect();
    };
    let bytes = digits.as_bytes().chunks_exact(2);
    if !bytes.remainder().is_empty() || !matches!(digits.len(), 6 | 8) {
        return None;
    }
    bytes
        .map(|pair| Some(f64::from(u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok()?) / 255.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> std::result::Result<Preset, String> {
        Preset::parse(Path::new("p.json"), text).map_err(|e| e.to_string())
    }

    fn float() -> ParamKind {
        ParamKind::Float { default: 0.0, range: [0.0, 10.0], slider: [0.0, 10.0] }
    }

    fn track(kind: ParamKind, keys: &[(i64, &str)], step: Option<bool>) -> Result<Animated> {
        let keys: Vec<_> = keys.iter().map(|(frame, text)| (*frame, (*text).to_owned())).collect();
        let param = Param { id: "x", label: "X", doc: "", group: "", unit: "", structural: false, kind };
        Animated::new("p", ("x", 0, &param), &keys, step)
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
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(message) && !error.contains('\n'), "{text}: {error}");
        }
    }

    #[test]
    fn values_move_between_keys() {
        let ramp = track(float(), &[(1001, "2"), (1050, "6")], None).unwrap();
        let values = [900, 1001, 1013, 1050, 2000].map(|frame| ramp.at(frame).parse::<f32>().unwrap());
        assert_eq!([values[0], values[1], values[3], values[4]], [2.0, 2.0, 6.0, 6.0]);
        assert!((values[2] - (2.0 + 4.0 * 12.0 / 49.0)).abs() < 1e-6);
        let held = track(float(), &[(1, "2"), (10, "6")], Some(true)).unwrap();
        assert_eq!([held.at(9), held.at(10)], ["2", "6"]);
        let whole = ParamKind::Int { default: 0, range: [0, 10], slider: [0, 10] };
        assert_eq!(track(whole, &[(0, "0"), (10, "5")], None).unwrap().at(5), "3");
        let colour = ParamKind::Color { default: [0.0; 4] };
        assert_eq!(track(colour, &[(0, "#000000"), (2, "1,0,0.5,0")], None).unwrap().at(1), "0.5,0,0.25,0.5");
        let flag = ParamKind::Bool { default: false };
        assert_eq!(track(flag.clone(), &[(0, "false"), (10, "true")], None).unwrap().at(9), "false");
        assert!(track(flag, &[(0, "true")], Some(false)).is_err());
    }
}
