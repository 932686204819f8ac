//! `isophote nodes`: what the library can do, for people and for programs.

mod look;

use std::path::Path;

use clap::Args;

use isophote_files::error::{AtPlace, Error, Result};
use isophote_finishing::stylize::preset;
use isophote_loader::Library;
use isophote_loader::catalogue::{Catalogue, Node, Param, ParamKind, Port};

/// Way to find a node or a look.
const LISTS: &str = "`isophote nodes` lists all, and `isophote preset list` the looks";
/// Columns of running text.
const WIDTH: usize = 90;

/// Options of `nodes`.
#[derive(Args, Debug)]
pub struct NodesArgs {
    /// A style or another node, to list its parameters; or a look, to show its values.
    node: Option<String>,
    /// Prints JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`Error::Failure`] without a library, [`Error::Input`] when there is no such node.
pub fn run(args: &NodesArgs) -> Result<()> {
    let library = Library::open()?;
    let text = match &args.node {
        Some(id) => {
            let found = library.find_node(id);
            match look::find(&library, id)?.filter(|_| found.is_err()) {
                Some(look) if args.json => json(&look::object(&look))?,
                Some(look) => look::describe(&look)?,
                None => {
                    let unknown = |e| preset::unknown(&library, e, Path::new(id), LISTS);
                    let node = found.map_err(unknown)?;
                    if args.json { json(&node)? } else { describe(&node) }
                }
            }
        }
        None => {
            let catalogue = library.catalogue().map_err(|e| e.at("the catalogue", "use another library"))?;
            if args.json { json(&catalogue)? } else { list(&library, &catalogue) }
        }
    };
    isophote_files::output::print(&text)
}

fn json(value: &impl serde::Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::failure(format!("cannot be written as JSON: {e}"), "leave out --json"))?;
    Ok(text + "\n")
}

fn list(library: &Library, catalogue: &Catalogue) -> String {
    let mut groups: Vec<&str> = Vec::new();
    for node in &catalogue.nodes {
        if !groups.contains(&node.group) {
            groups.push(node.group);
        }
    }
    let column = catalogue.nodes.iter().map(|n| n.id.len()).max().unwrap_or(0) + 2;
    let mut text = format!("Isophote {}, {} nodes\n", library.version(), catalogue.nodes.len());
    for group in groups {
        text += &format!("\n{group}\n");
        for node in catalogue.nodes.iter().filter(|n| n.group == group) {
            text += &format!("  {:column$}{}\n", node.id, node.hint.trim_end_matches('.'));
        }
    }
    text + "\n`isophote nodes NODE` shows the parameters of a node.\n"
}

fn describe(node: &Node) -> String {
    let mut text = format!("{} ({}, {})\n\n", node.label, node.id, node.group);
    // What it is for in a sentence of its own, and how it does it below.
    if let Some(more) = node.doc.strip_prefix(node.hint) {
        text += &(wrapped(node.hint, 0) + "\n" + &wrapped(more, 0));
    } else {
        text += &wrapped(node.doc, 0);
    }
    if !node.section.is_empty() {
        text += &format!("Thesis: section {}\n", node.section);
    }
    text += "\nInputs\n";
    for port in &node.inputs {
        text += &port_line(port);
    }
    text += "\nOutput\n";
    text += &port_line(&node.output);
    let mut heading = None;
    for param in &node.params {
        if heading != Some(param.group) {
            heading = Some(param.group);
            text += if param.group.is_empty() { "\nParameters" } else { "\n" };
            text += &format!("{}\n", param.group);
        }
        text += &format!("  {} = {}\n", param.id, values(param));
        text += &wrapped(&format!("{}. {}", param.label, param.doc), 6);
    }
    text
}

fn port_line(port: &Port) -> String {
    let optional = if port.optional { ", optional" } else { "" };
    format!("  {} ({}{optional})\n", port.id, port.kind.name()) + &wrapped(port.doc, 6)
}

/// The default, and what else is possible.
fn values(param: &Param) -> String {
    let unit = if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
    match &param.kind {
        ParamKind::Unknown { number } => format!("unknown  (of kind {number}, of a later library)"),
        ParamKind::Float { default, range, .. } => format!("{default}  ({} to {}{unit})", range[0], range[1]),
        ParamKind::Int { default, range, .. } => {
            format!("{default}  ({} to {}{unit}, whole)", range[0], range[1])
        }
        ParamKind::Bool { default } => format!("{default}  (true or false)"),
        ParamKind::Choice { default, options } => {
            let ids: Vec<&str> = options.iter().map(|o| o.id).collect();
            format!("{default}  ({})", ids.join(", "))
        }
        ParamKind::Color { default } => {
            let [r, g, b, a] = default.map(|v| (v * 255.0 + 0.5) as u8);
            format!("#{r:02x}{g:02x}{b:02x}{a:02x}  (#rrggbb, #rrggbbaa, or numbers 0 to 1 with commas)")
        }
    }
}

fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let full = lines.last().is_some_and(|l| !l.is_empty() && l.len() + 1 + word.len() > WIDTH - indent);
        if full {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.iter().map(|line| format!("{:indent$}{line}\n", "")).collect()
}
