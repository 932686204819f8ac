//! The page of a style: what each control for artists does, seen at its low end, its middle and its high end.

use crate::shot::{Shot, Style, Subject};
use isophote::param::{Param, Unit};
use isophote::registry;
use isophote::spec::NodeSpec;
use isophote::value::Value;
use std::fmt::Write as _;

/// Parameter that is set as well where a control does nothing by itself: node and control, then parameter and value.
const TOGETHER: [(&str, &str, &str, &str); 32] = [
    ("cartoon", "posterize_smooth", "posterize", "6"),
    ("cartoon", "dot_spacing", "dots", "1"),
    // Tones are steps of lightness.
    ("cartoon", "light_steps", "shading", "light"),
    ("cartoon", "exposure", "shading", "light"),
    ("cartoon", "shadow_color", "shading", "light"),
    ("cartoon", "middle_color", "shading", "light"),
    ("cartoon", "middle_color", "light_steps", "3"),
    ("cartoon", "light_color", "shading", "light"),
    ("coherent", "posterize_smooth", "posterize", "6"),
    ("coherent", "steps", "posterize", "6"),
    ("cartoon", "outline_color", "line_colors", "kinds"),
    ("cartoon", "border_color", "line_colors", "kinds"),
    ("cartoon", "crease_color", "line_colors", "kinds"),
    ("blueprint", "outline_color", "line_colors", "kinds"),
    ("blueprint", "border_color", "line_colors", "kinds"),
    ("blueprint", "crease_color", "line_colors", "kinds"),
    ("ink", "outline_color", "line_colors", "kinds"),
    ("ink", "border_color", "line_colors", "kinds"),
    ("ink", "crease_color", "line_colors", "kinds"),
    // Ink itself is of one colour.
    ("ink", "saturation", "style", "pastel"),
    // Lines are off, and four process inks are printed.
    ("halftone", "line_width", "line_amount", "0.5"),
    ("halftone", "suppress_small", "line_amount", "0.5"),
    ("halftone", "outline_width", "line_amount", "0.5"),
    ("halftone", "crease_width", "line_amount", "0.5"),
    ("halftone", "border_width", "line_amount", "0.5"),
    ("halftone", "far_width", "line_amount", "0.5"),
    ("halftone", "texture_lines", "line_amount", "0.5"),
    ("halftone", "line_color", "line_amount", "0.5"),
    ("halftone", "ink_color", "inks", "one"),
    ("halftone", "spot_1", "inks", "three_spots"),
    ("halftone", "spot_2", "inks", "three_spots"),
    ("halftone", "spot_3", "inks", "three_spots"),
];

/// Colours that controls of colours are shown in, beside the default.
const COLOURS: [&str; 2] = ["#7a2a1c", "#2b5a8c"];

/// True where a node is a style.
pub fn is_style(node: &NodeSpec) -> bool {
    node.group == "styles"
}

/// The controls that artists turn. `cover` is about transparent pictures, which pages cannot show.
fn controls(node: &NodeSpec) -> impl Iterator<Item = &'static Param> + use<> {
    node.params().filter(|p| p.group == "look" && p.id != "cover")
}

/// Values that a control is shown at, with the words below the pictures.
fn values(param: &Param) -> Vec<(String, String)> {
    let [low, high] = param.slider;
    let is_turn = param.unit == Unit::Degrees && high - low == 360.0;
    let high = if is_turn { low + 240.0 } else { high };
    let numbers = |middle: f32| [low, middle, high].map(|v| (v.to_string(), v.to_string())).to_vec();
    match param.default {
        Value::Float(_) => numbers((50.0 * (low + high)).round() / 100.0),
        Value::Int(_) => numbers(((low + high) / 2.0).round()),
        Value::Bool(_) => {
            [("false", "off"), ("true", "on")].map(|(v, w)| (v.to_owned(), w.to_owned())).to_vec()
        }
        Value::Choice(_) => param.options.iter().map(|o| (o.id.to_owned(), o.label.to_owned())).collect(),
        Value::Color(_) => std::iter::once(shown(param))
            .chain(COLOURS.map(str::to_owned))
            .map(|colour| (colour.clone(), colour))
            .collect(),
    }
}

/// The default as it is written on command lines.
pub fn shown(param: &Param) -> String {
    match param.default {
        Value::Float(v) => v.to_string(),
        Value::Int(v) => v.to_string(),
        Value::Bool(v) => v.to_string(),
        Value::Choice(index) => param.options[index].id.to_owned(),
        Value::Color(v) => {
            let [r, g, b, a] = v.map(|v| (v * 255.0 + 0.5) as u8);
            let alpha = if a == 255 { String::new() } else { format!("{a:02x}") };
            format!("#{r:02x}{g:02x}{b:02x}{alpha}")
        }
    }
}

/// Parameters and values that are set beside a control.
fn together(node: &NodeSpec, param: &Param) -> Vec<(&'static str, &'static str)> {
    let of_control = TOGETHER.iter().filter(|(id, control, ..)| (*id, *control) == (node.id, param.id));
    let others = of_control.filter_map(|(.., other, value)| Some((node.param(other)?.1, *value)));
    others.filter(|(other, value)| shown(other) != *value).map(|(other, value)| (other.id, value)).collect()
}

fn picture(node: &NodeSpec, param: &Param, number: usize) -> String {
    format!("style-{}-{}-{number}", node.id, param.id)
}

/// Picture of the frame with a control at a value, where the page of the style has one of nothing else.
pub fn picture_at(node: &NodeSpec, param: &Param, value: &str) -> Option<String> {
    let is_shown = is_style(node) && controls(node).any(|control| control.id == param.id);
    let number = values(param).iter().position(|(known, _)| known == value)?;
    (is_shown && together(node, param).is_empty()).then(|| picture(node, param, number))
}

/// The pictures of the page.
pub fn shots(node: &NodeSpec) -> Vec<Shot> {
    let of_control = |param: &'static Param| {
        values(param).into_iter().enumerate().map(move |(number, (value, _))| {
            let mut set = vec![(param.id, value)];
            set.extend(together(node, param).into_iter().map(|(id, value)| (id, value.to_owned())));
            let (name, style) = (picture(node, param, number), Style::Named(node.id.to_owned()));
            Shot { name, subject: Subject::Scene, style, set }
        })
    };
    controls(node).flat_map(of_control).collect()
}

/// The page.
pub fn page(node: &NodeSpec) -> String {
    let id = node.id;
    let mut text = format!("# {}\n\n{}\n\n", node.label, node.text());
    let _ = write!(
        text,
        "<div class=\"row\"><figure><img src=\"../pictures/before.jpg\" alt=\"The frame as it is rendered\" \
         loading=\"lazy\"><figcaption>before</figcaption></figure><figure><img \
         src=\"../pictures/node-{id}.jpg\" alt=\"The same as {}\" loading=\"lazy\"><figcaption>{}, as it \
         is</figcaption></figure></div>\n\n",
        node.label, node.label
    );
    let _ = write!(
        text,
        "```sh\nisophote apply {id} photo.png {id}.png\n```\n\nThe technical parameters behind these controls are on \
         [the page of the node](../nodes/{id}.md).\n\n"
    );
    for param in controls(node) {
        control(&mut text, node, param);
    }
    text
}

/// A control in words and pictures.
fn control(text: &mut String, node: &NodeSpec, param: &Param) {
    let _ = write!(
        text,
        "## {}\n\n{} `--set {}=…`, ",
        param.label,
        [param.hint, param.doc].join(" ").trim_end(),
        param.id
    );
    let _ = write!(text, "`{}` unless it is set.", shown(param));
    for (other, value) in together(node, param) {
        let _ = write!(text, " Shown with `{other}={value}`.");
    }
    text.push_str("\n\n<div class=\"row\">");
    for (number, (_, words)) in values(param).iter().enumerate() {
        let name = picture(node, param, number);
        let _ = write!(
            text,
            "<figure><img src=\"../pictures/{name}.jpg\" alt=\"{} with {} {words}\" loading=\"lazy\">\
             <figcaption>{words}</figcaption></figure>",
            node.label, param.label
        );
    }
    text.push_str("</div>\n\n");
}

/// What a style draws with beside the medium that it has by itself, as styles of the grid.
fn media(text: &mut String, node: &NodeSpec) {
    let Some(param) = node.medium() else { return };
    for (number, option) in param.options.iter().enumerate().filter(|(_, o)| o.id != shown(param)) {
        let _ = write!(
            text,
            "<figure><a href=\"../styles/{id}.html\"><img src=\"../pictures/{name}.jpg\" alt=\"{label}\" \
             loading=\"lazy\"></a><figcaption><a href=\"../styles/{id}.html\">{label}</a></figcaption></figure>",
            id = node.id,
            name = picture(node, param, number),
            label = option.label
        );
    }
}

/// All styles and media as a grid.
pub fn contents() -> String {
    let mut text = String::from("<div class=\"row\">");
    for node in registry::nodes().iter().filter(|node| is_style(node)) {
        let _ = write!(
            text,
            "<figure><a href=\"../styles/{id}.html\"><img src=\"../pictures/node-{id}.jpg\" alt=\"{label}\" \
             loading=\"lazy\"></a><figcaption><a href=\"../styles/{id}.html\">{label}</a></figcaption></figure>",
            id = node.id,
            label = node.label
        );
        media(&mut text, node);
    }
    text.push_str("</div>\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_control_has_pictures_at_several_values() {
        for node in registry::nodes().iter().filter(|node| is_style(node)) {
            let shots = shots(node);
            let names: BTreeSet<&str> = shots.iter().map(|shot| shot.name.as_str()).collect();
            assert_eq!(names.len(), shots.len(), "{}", node.id);
            let page = page(node);
            assert!(names.iter().all(|name| page.contains(&format!("pictures/{name}.jpg"))), "{}", node.id);
            let media = node.medium().map_or(&[][..], |param| param.options);
            assert!(media.iter().all(|medium| contents().contains(&format!(">{}</a>", medium.label))));
            for param in controls(node) {
                let values: BTreeSet<String> = values(param).into_iter().map(|(value, _)| value).collect();
                assert!(values.len() >= 2, "{}.{}", node.id, param.id);
            }
        }
    }
}
