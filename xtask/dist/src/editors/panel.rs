//! Content of a panel: an effect with its controls, as the plugin derives them from the catalogue.

use crate::error::{Error, Result};
use serde_json::{Value, json};
use std::path::Path;

/// An effect.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The end of its identifier.
    pub id: String,
    /// Its name.
    pub label: String,
    /// Description of the effect, in a sentence.
    pub about: String,
    /// Controls, those of one heading together.
    pub controls: Vec<Control>,
}

/// A control.
#[derive(Clone, Debug)]
pub struct Control {
    /// The plugin's name for it.
    pub name: String,
    /// For people.
    pub label: String,
    /// Description of the control.
    pub doc: String,
    /// The heading that it stands under.
    pub group: String,
    /// Kind of value that is set by it.
    pub kind: Kind,
}

/// Kind of value that a control sets.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A number between the ends of a slider.
    Number { default: f64, slider: [f64; 2], is_whole: bool },
    /// On or off.
    Switch { default: bool },
    /// One of several texts.
    Choice { default: String, options: Vec<String> },
    /// A colour, as MLT writes it: alpha first.
    Color { default: String },
}

impl Panel {
    /// The name by which MLT knows the effect.
    pub fn service(&self) -> String {
        format!("openfx.org.isophote.{}", self.id)
    }
}

/// All effects of a catalogue, and the one that shows looks, which the file beside it lists.
///
/// # Errors
/// [`Error::Malformed`] when the files hold something else.
pub fn all(file: &Path) -> Result<Vec<Panel>> {
    let (catalogue, list) = (json_of(file)?, file.with_extension("looks.json"));
    let mut all = panels(&catalogue).ok_or_else(|| Error::malformed(file, "is no catalogue of nodes"))?;
    let looks = look_panel(&json_of(&list)?, &catalogue);
    all.push(looks.ok_or_else(|| Error::malformed(&list, "is no list of looks"))?);
    Ok(all)
}

fn json_of(file: &Path) -> Result<Value> {
    let text = std::fs::read_to_string(file).map_err(Error::at(file))?;
    serde_json::from_str(&text).map_err(|error| Error::malformed(file, error))
}

/// The effect of all looks, then the styles. Editors keep the names of options, and have no control for a file.
fn look_panel(looks: &Value, catalogue: &Value) -> Option<Panel> {
    let styles = catalogue["nodes"].as_array()?.iter().filter(|node| node["group"] == "styles");
    let names = looks.as_array()?.iter().map(|look| &look["name"]).chain(styles.map(|node| &node["label"]));
    let options = names.map(|name| name.as_str().map(str::to_owned)).collect::<Option<Vec<_>>>()?;
    let control = |name: &str, label: &str, doc: &str, kind| Control {
        name: name.into(),
        label: label.into(),
        doc: doc.into(),
        group: String::new(),
        kind,
    };
    let choice = Kind::Choice { default: options.first()?.clone(), options };
    let mix = Kind::Number { default: 1.0, slider: [0.0, 1.0], is_whole: false };
    Some(Panel {
        id: "look".into(),
        label: "Look".into(),
        about: "A look or a style that ships".into(),
        controls: vec![
            control("look", "Look", "Look or style that is shown.", choice),
            control("mix", "Mix", "Share of the effect in the result; the rest is the source.", mix),
        ],
    })
}

fn panels(catalogue: &Value) -> Option<Vec<Panel>> {
    let nodes = catalogue["nodes"].as_array()?;
    let find = |id: &str| nodes.iter().find(|node| node["id"] == id);
    let mut panels = Vec::new();
    for node in nodes {
        let made = match node["output"]["kind"].as_str()? {
            _ if node["id"] == "tensor_view" => {
                let controls = controls(&[("", find("structure_tensor")?), ("view_", node)])?;
                panel("structure", "Structure", node, controls)
            }
            "color" if reads_colour_alone(node)? => {
                panel(node["id"].as_str()?, node["label"].as_str()?, node, controls(&[("", node)])?)
            }
            "scalar" if reads_colour_alone(node)? => {
                let mut all = vec![lines_output()];
                all.extend(controls(&[("", node), ("lines_", find("composite_lines")?)])?);
                panel(node["id"].as_str()?, node["label"].as_str()?, node, all)
            }
            _ => continue,
        };
        panels.push(made?);
    }
    Some(panels)
}

fn panel(id: &str, label: &str, node: &Value, mut controls: Vec<Control>) -> Option<Panel> {
    let about = node["hint"].as_str()?.trim_end_matches('.');
    // Under one heading, controls follow one another.
    let mut groups: Vec<String> = Vec::new();
    for control in &controls {
        if !groups.contains(&control.group) {
            groups.push(control.group.clone());
        }
    }
    controls.sort_by_key(|control| groups.iter().position(|group| *group == control.group));
    Some(Panel { id: id.to_owned(), label: label.to_owned(), about: about.to_owned(), controls })
}

fn reads_colour_alone(node: &Value) -> Option<bool> {
    let inputs = node["inputs"].as_array()?;
    let is_colour = |port: &Value| port["kind"] == "color";
    Some(inputs.iter().any(is_colour) && inputs.iter().all(|p| is_colour(p) || p["optional"] == json!(true)))
}

/// Control that effects of lines have beside their parameters.
fn lines_output() -> Control {
    let options = ["Lines only", "Lines over source"].map(str::to_owned);
    Control {
        name: "lines_output".into(),
        label: "Show".into(),
        doc: "The lines alone, or over the picture.".into(),
        group: String::new(),
        kind: Kind::Choice { default: options[0].clone(), options: options.to_vec() },
    }
}

/// Parameters about other frames have no use in MLT, which gives effects one at a time.
const OF_OTHER_FRAMES: [&str; 3] = ["steadiness", "window", "renewal"];

/// The controls of nodes, each with what stands before its names.
fn controls(nodes: &[(&str, &Value)]) -> Option<Vec<Control>> {
    let mut controls = Vec::new();
    for (prefix, node) in nodes {
        for param in node["params"].as_array()? {
            let id = param["id"].as_str()?;
            if OF_OTHER_FRAMES.contains(&id) {
                continue;
            }
            let group = match *prefix {
                "" => param["group"].as_str()?,
                "lines_" => "lines over source",
                _ => "view",
            };
            controls.push(Control {
                name: format!("{prefix}{id}"),
                label: param["label"].as_str()?.to_owned(),
                doc: param["hint"].as_str()?.to_owned(),
                group: group.to_owned(),
                kind: kind(param)?,
            });
        }
    }
    Some(controls)
}

fn kind(param: &Value) -> Option<Kind> {
    let default = &param["default"];
    let number = |is_whole| {
        let mut slider = [param["slider"][0].as_f64()?, param["slider"][1].as_f64()?];
        if is_whole {
            // Editors take no number beyond the ends, and the least whole number often means "not at all".
            slider[0] = param["range"][0].as_f64()?;
        }
        Some(Kind::Number { default: default.as_f64()?, slider, is_whole })
    };
    match param["type"].as_str()? {
        "float" => number(false),
        "int" => number(true),
        "bool" => Some(Kind::Switch { default: default.as_bool()? }),
        "choice" => {
            let options = param["options"].as_array()?;
            let chosen = options.iter().find(|option| option["id"] == *default)?;
            let labels = options.iter().map(|o| o["label"].as_str().map(str::to_owned));
            let default = chosen["label"].as_str()?.to_owned();
            Some(Kind::Choice { default, options: labels.collect::<Option<_>>()? })
        }
        "color" => {
            let byte = |index: usize| default[index].as_f64().map(|v| (v * 255.0).round() as u8);
            let (red, green, blue, alpha) = (byte(0)?, byte(1)?, byte(2)?, byte(3)?);
            Some(Kind::Color { default: format!("#{alpha:02x}{red:02x}{green:02x}{blue:02x}") })
        }
        _ => None,
    }
}

/// Digits behind the point that a slider from end to end needs, and the default to be shown as it is.
pub fn decimals(slider: [f64; 2], default: f64, is_whole: bool) -> usize {
    let steps = match slider[1] - slider[0] {
        _ if is_whole => 0,
        length if length > 50.0 => 1,
        length if length > 2.0 => 2,
        _ => 3,
    };
    let digits = shown(default).split_once('.').map_or(0, |(_, digits)| digits.len());
    steps.max(digits.min(5))
}

/// A number as its own precision shows it: the catalogue's are of 32 bits.
pub fn shown(number: f64) -> String {
    (number as f32).to_string()
}
