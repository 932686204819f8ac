//! Animations of a glTF document. Their channels are read here and not by the `gltf` crate, which refuses
//! channels without a target node and properties of extensions; the format says to ignore both.

use std::borrow::Cow;
use std::collections::BTreeMap;

use gltf::animation::Interpolation as GltfInterpolation;
use serde::Deserialize;
use serde_json::value::RawValue;

use super::accessors::{Accessors, Pick};
use super::materials::label;
use crate::animation::{Animation, Channel, Interpolation, Property};
use crate::model::Scene;

/// The text of a document and, taken out of it, the channels of its animations.
pub struct Outline<'a> {
    /// The document with lists of channels that are empty, line for line as it was.
    pub text: Cow<'a, str>,
    /// Channels that were taken out.
    pub channels: Channels,
}

/// The channels of each animation as they stand in the document.
pub type Channels = Vec<Vec<RawChannel>>;

/// One channel as it stands in the document.
#[derive(Deserialize)]
pub struct RawChannel {
    sampler: usize,
    target: RawTarget,
}

#[derive(Deserialize)]
struct RawTarget {
    node: Option<usize>,
    path: String,
}

#[derive(Deserialize)]
struct RawDocument<'a> {
    #[serde(borrow, default)]
    animations: Vec<RawAnimation<'a>>,
}

#[derive(Deserialize)]
struct RawAnimation<'a> {
    #[serde(borrow)]
    channels: Option<&'a RawValue>,
}

impl<'a> Outline<'a> {
    /// Takes the channels out of a document.
    ///
    /// # Errors
    /// A clause that says what is not valid, with its line and column.
    pub fn of(text: &'a str) -> Result<Self, String> {
        let document: RawDocument = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let mut emptied = Cow::Borrowed(text);
        let mut channels = Vec::with_capacity(document.animations.len());
        for animation in &document.animations {
            let Some(raw) = animation.channels.map(RawValue::get) else {
                channels.push(Vec::new());
                continue;
            };
            let start = raw.as_ptr().addr() - text.as_ptr().addr();
            channels.push(serde_json::from_str(raw).map_err(|e| located(text, start, &e))?);
            let inside = start + 1..start + raw.len() - 1;
            let blank = raw[1..raw.len() - 1].bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' });
            emptied.to_mut().replace_range(inside, &blank.collect::<String>());
        }
        Ok(Self { text: emptied, channels })
    }
}

/// An error in the part of a text that begins at `start`, with its place in the whole text.
fn located(text: &str, start: usize, error: &serde_json::Error) -> String {
    let whole = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    let before = &text[..start];
    let line = before.matches('\n').count() + error.line();
    let indent = if error.line() == 1 { start - before.rfind('\n').map_or(0, |at| at + 1) } else { 0 };
    format!("{} at line {line} column {}", whole.trim_end_matches(&place), error.column() + indent)
}

/// Reads all animations into the scene, whose nodes must be there already.
///
/// # Errors
/// A clause naming what refers to something that does not exist, or an accessor that cannot be read.
pub fn read(
    document: &gltf::Document,
    channels: &[Vec<RawChannel>],
    accessors: &Accessors,
    scene: &mut Scene,
) -> Result<(), String> {
    for (animation, raw) in document.animations().zip(channels) {
        let label = label(animation.name(), animation.index());
        let mut left_out: BTreeMap<String, usize> = BTreeMap::new();
        let mut channels = Vec::new();
        for (index, raw) in raw.iter().enumerate() {
            let Some(sampler) = animation.samplers().nth(raw.sampler) else {
                return Err(format!("animation {label} has no sampler {}", raw.sampler));
            };
            let (node, property) = match target(&raw.target) {
                Ok(target) => target,
                Err(reason) => {
                    *left_out.entry(reason).or_default() += 1;
                    continue;
                }
            };
            let Some(target) = scene.nodes.get(node) else {
                return Err(format!("animation {label} has a target that does not exist"));
            };
            let channel = Channel {
                node,
                property,
                interpolation: match sampler.interpolation() {
                    GltfInterpolation::Step => Interpolation::Step,
                    GltfInterpolation::Linear => Interpolation::Linear,
                    GltfInterpolation::CubicSpline => Interpolation::CubicSpline,
                },
                times: accessors.floats(&sampler.input(), &[1], Pick::All)?.values,
                values: {
                    let widths: &[usize] = if property == Property::Weights { &[1] } else { &[3, 4] };
                    accessors.floats(&sampler.output(), widths, Pick::All)?.values
                },
                width: match property {
                    Property::Translation | Property::Scale => 3,
                    Property::Rotation => 4,
                    Property::Weights => target.weights.len(),
                },
            };
            match channel.validate() {
                Ok(()) => channels.push(channel),
                Err(problem) => scene
                    .warnings
                    .push(format!("channel {index} of animation {label} {problem}; it is left out")),
            }
        }
        scene.warnings.extend(left_out.into_iter().map(|(reason, count)| {
            format!("{count} of {} channels of animation {label} left out: {reason}", raw.len())
        }));
        scene.animations.push(Animation { name: animation.name().unwrap_or_default().to_owned(), channels });
    }
    Ok(())
}

/// Node and property that a channel drives, or why it drives none.
fn target(raw: &RawTarget) -> Result<(usize, Property), String> {
    let property = match raw.path.as_str() {
        "translation" => Property::Translation,
        "rotation" => Property::Rotation,
        "scale" => Property::Scale,
        "weights" => Property::Weights,
        "pointer" => return Err("KHR_animation_pointer is not supported".into()),
        other => return Err(format!("the property '{other}' is not known")),
    };
    Ok((raw.node.ok_or("they name no node")?, property))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_taken_out_line_for_line() {
        let text = "{\"animations\": [\n {\"channels\": [\n{\"sampler\": 0, \"target\":\n{\"path\": \"scale\"}}]},\n{}]}";
        let outline = Outline::of(text).unwrap();
        assert_eq!(outline.text.lines().count(), text.lines().count());
        assert_eq!(outline.text.replace(char::is_whitespace, ""), r#"{"animations":[{"channels":[]},{}]}"#);
        assert_eq!(outline.channels.iter().map(Vec::len).collect::<Vec<_>>(), [1, 0]);
        for (bad, at) in [
            ("{\n\"animations\": [{\"channels\": 7}]}", "at line 2 column"),
            ("{\n\n\"animations\": [{\"channels\": [{\"sampler\": -1}]}]}", "at line 3 column"),
            (
                "{\n\"animations\": [{\"channels\": [\n{\"sampler\": 0}]}]}",
                "missing field `target` at line 3 column",
            ),
            ("{\n\"animations\": [", "EOF while parsing a list at line 2"),
        ] {
            let problem = Outline::of(bad).map(|_| ()).unwrap_err();
            assert!(problem.contains(at), "{problem}");
            assert_eq!(problem.matches("line").count(), 1, "{problem}");
        }
        let problem = Outline::of("{\"animations\": [{\"channels\": 7}]}").map(|_| ()).unwrap_err();
        assert!(problem.ends_with("at line 1 column 30"), "{problem}");
    }
}
