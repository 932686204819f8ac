//! Descriptions of effects for Kdenlive, which override what it makes of a plugin by itself.

use super::panel::{Control, Kind, Panel, decimals, shown};
use std::fmt::Write as _;

/// The description of one effect.
pub fn description(panel: &Panel) -> String {
    let service = panel.service();
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!DOCTYPE kpartgui>\n<effect tag=\"{service}\" id=\"{service}\">\n    \
         <name>Isophote {}</name>\n    <description>{}</description>\n    <author>Isophote</author>\n",
        escaped(&panel.label),
        escaped(&panel.about)
    );
    for control in &panel.controls {
        parameter(&mut text, control);
    }
    text.push_str("</effect>\n");
    text
}

fn parameter(text: &mut String, control: &Control) {
    let name = &control.name;
    let attributes = match &control.kind {
        Kind::Number { default, slider, is_whole } => format!(
            "type=\"{}\" name=\"{name}\" default=\"{}\" min=\"{}\" max=\"{}\" decimals=\"{}\"",
            // Whole numbers, such as of iterations, are no good to glide along.
            if *is_whole { "constant" } else { "animated" },
            shown(*default),
            shown(slider[0]),
            shown(slider[1]),
            decimals(*slider, *default, *is_whole)
        ),
        Kind::Switch { default } => {
            format!("type=\"bool\" name=\"{name}\" default=\"{}\" min=\"0\" max=\"1\"", u8::from(*default))
        }
        Kind::Choice { default, options } => format!(
            "type=\"list\" name=\"{name}\" default=\"{}\" paramlist=\"{}\"",
            escaped(default),
            escaped(&options.join(";"))
        ),
        Kind::Color { default } => {
            format!("type=\"color\" name=\"{name}\" default=\"{default}\" alpha=\"1\"")
        }
    };
    let _ = writeln!(text, "    <parameter {attributes}>");
    if let Kind::Choice { options, .. } = &control.kind {
        // Commas stand between names there, and so in none of them.
        let names: Vec<String> = options.iter().map(|option| option.replace(',', "")).collect();
        let _ = writeln!(text, "        <paramlistdisplay>{}</paramlistdisplay>", escaped(&names.join(",")));
    }
    let _ = writeln!(text, "        <name>{}</name>", escaped(&control.label));
    let _ = writeln!(text, "        <comment>{}</comment>\n    </parameter>", escaped(&control.doc));
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
