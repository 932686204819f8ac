//! The page of a node, made of its declaration: what it does, before and after, inputs, parameters, passes, equations.

use crate::error::{Error, Result};
use crate::{maker, styles};
use isophote::param::Param;
use isophote::registry;
use isophote::request::Guides;
use isophote::spec::{NodeSpec, Port};
use isophote::value::Value;
use isophote::{Graph, Planned, Request};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

/// Folder of the kernels, which say what they compute.
const KERNELS: &str = "nodes/library/src/kernels";

/// Stem of the picture of a node.
pub fn picture(node: &NodeSpec) -> String {
    format!("node-{}", node.id)
}

/// The page.
///
/// # Errors
/// A node that cannot be planned, or a kernel whose file cannot be read.
pub fn page(node: &NodeSpec, root: &Path) -> Result<String> {
    let passes = passes(node, root)?;
    let mut text = format!("# {} (`{}`)\n\n{}\n\n", node.label, node.id, node.text());
    let section = match node.section {
        "" => "The thesis has no section on it.".to_owned(),
        section => format!("Thesis: § {section}."),
    };
    let _ = write!(text, "Group: {}. {section}", node.group);
    if styles::is_style(node) {
        let _ = write!(text, " [Its controls in pictures](../styles/{}.md).", node.id);
    }
    text.push_str("\n\n");
    text.push_str(&before_and_after(node));
    ports(&mut text, node);
    params(&mut text, node);
    text.push_str("## Passes\n\nWhat it is made of with its defaults and all guides, in order:\n\n");
    for pass in &passes {
        let _ = writeln!(text, "- [`{}`](repo:shaders/{}.wgsl): {}", pass.name, pass.stem, pass.doc);
    }
    let equations = equations(node, &passes);
    if !equations.is_empty() {
        let _ = write!(text, "\n## Equations\n\nOf the thesis, as its texts above cite them: {equations}.\n");
    }
    Ok(text)
}

fn before_and_after(node: &NodeSpec) -> String {
    if let Some(why) = maker::unshown(node) {
        return format!("{why}\n\n");
    }
    format!(
        "<div class=\"row\"><figure><img src=\"../pictures/before.jpg\" alt=\"The frame as it is rendered\" \
         loading=\"lazy\"><figcaption>before</figcaption></figure><figure><img src=\"../pictures/{}.jpg\" \
         alt=\"What {} makes of it\" loading=\"lazy\"><figcaption>after</figcaption></figure></div>\n\n",
        picture(node),
        node.label
    )
}

fn ports(text: &mut String, node: &NodeSpec) {
    text.push_str("## Inputs and output\n\n| port | kind | |\n|---|---|---|\n");
    let mut row = |port: &Port, what: &str| {
        let _ = writeln!(text, "| `{}`{what} | {} | {} |", port.id, port.kind.id(), cell(port.doc));
    };
    for port in node.ports() {
        row(port, if port.optional { ", optional" } else { "" });
    }
    row(&node.output, ", output");
    text.push('\n');
}

fn params(text: &mut String, node: &NodeSpec) {
    text.push_str("## Parameters\n\n| parameter | default | range | |\n|---|---|---|---|\n");
    let mut group = "";
    for param in node.params() {
        if param.group != group {
            group = param.group;
            let _ = writeln!(text, "| *{}* | | | |", capital(group));
        }
        let _ = writeln!(
            text,
            "| `{}` | `{}` | {} | {} |",
            param.id,
            styles::shown(param),
            range(param),
            cell(&explained(param))
        );
    }
    text.push('\n');
}

fn range(param: &Param) -> String {
    let unit = if param.unit.id().is_empty() { String::new() } else { format!(" {}", param.unit.id()) };
    match param.default {
        Value::Float(_) => format!("{} to {}{unit}", param.range[0], param.range[1]),
        Value::Int(_) => format!("{} to {}{unit}, whole", param.range[0], param.range[1]),
        Value::Bool(_) => "`true`, `false`".to_owned(),
        Value::Color(_) => "`#rrggbb`, `#rrggbbaa`".to_owned(),
        Value::Choice(_) => {
            param.options.iter().map(|option| format!("`{}`", option.id)).collect::<Vec<_>>().join(", ")
        }
    }
}

fn explained(param: &Param) -> String {
    let options = param.options.iter().map(|option| format!(" `{}`: {}", option.id, option.doc));
    let doc = [" ", param.doc].concat();
    format!("**{}.** {}{}{}", param.label, param.hint, doc.trim_end(), options.collect::<String>())
}

/// Text within a table.
pub fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// A kernel that a node runs.
struct Pass {
    name: &'static str,
    /// Its group and its name: where its files are.
    stem: String,
    /// Description of what it computes, with its source.
    doc: String,
}

/// The kernels of a node in the order of their first use.
fn passes(node: &NodeSpec, root: &Path) -> Result<Vec<Pass>> {
    let graph = match maker::graph(node)? {
        Some(graph) => Graph::from_json(&graph.to_string())?,
        None => Graph::single(node.id)?,
    };
    let mut request = Request::new(480, 320);
    request.guides =
        Guides { normal: true, depth: true, object_id: true, rest_position: true, ..request.guides };
    let planned = Planned::new(&graph, request)?;
    let mut seen = BTreeSet::new();
    let names = planned.plan().passes().iter().map(|pass| pass.kernel.name);
    names.filter(|name| seen.insert(*name)).map(|name| pass(name, root)).collect()
}

fn pass(name: &'static str, root: &Path) -> Result<Pass> {
    let folder = root.join(KERNELS);
    for group in std::fs::read_dir(&folder).map_err(Error::at(&folder))? {
        let group = group.map_err(Error::at(&folder))?.path();
        let file = group.join(format!("{name}.rs"));
        if file.is_file() {
            let text = std::fs::read_to_string(&file).map_err(Error::at(&file))?;
            let group = group.file_name().map(|g| g.to_string_lossy().into_owned()).unwrap_or_default();
            return Ok(Pass { name, stem: format!("{group}/{name}"), doc: opening(&text) });
        }
    }
    Err(Error::page(name, "no file of the kernels bears its name"))
}

/// The first paragraph of a file's comment.
fn opening(text: &str) -> String {
    let lines = text.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim);
    lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Numbers of equations, such as (2.34) or (4.7, 4.8), in their order.
fn equations(node: &NodeSpec, passes: &[Pass]) -> String {
    let mut found = BTreeSet::new();
    collect(node.doc, &mut found);
    for param in node.params() {
        collect(&explained(param), &mut found);
    }
    for pass in passes {
        collect(&pass.doc, &mut found);
    }
    found.into_iter().map(|(chapter, number)| format!("({chapter}.{number})")).collect::<Vec<_>>().join(", ")
}

fn collect(text: &str, found: &mut BTreeSet<(u32, u32)>) {
    for group in text.split('(').skip(1).filter_map(|rest| rest.split_once(')')).map(|(inside, _)| inside) {
        for word in group.split([',', ' ', '-']) {
            let numbers = word.split_once('.').and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
            // Chapters end with the sixth; what is between 0 and 2 are ranges of values.
            found.extend(numbers.filter(|(chapter, _)| (2..=6).contains(chapter)));
        }
    }
}

/// All nodes by their groups.
pub fn contents() -> String {
    let mut text = String::new();
    let mut group = "";
    for node in registry::nodes() {
        if node.group != group {
            group = node.group;
            let _ = write!(text, "\n## {}\n\n| node | |\n|---|---|\n", capital(group));
        }
        let _ = writeln!(text, "| [`{0}`]({0}.md) | {1} |", node.id, cell(node.hint));
    }
    text
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_told_from_other_numbers() {
        let mut found = BTreeSet::new();
        collect("the difference (4.7, 4.8) of 2.5 (see 5.15), a share (0.5), § 3.4 (3.1-3.3)", &mut found);
        assert_eq!(found, BTreeSet::from([(3, 1), (3, 3), (4, 7), (4, 8), (5, 15)]));
    }

    #[test]
    fn a_page_tells_all_of_a_node() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for node in registry::nodes() {
            let page = page(node, &root).unwrap();
            assert!(node.params().all(|p| page.contains(&format!("| `{}` |", p.id))), "{}", node.id);
            assert!(node.ports().all(|p| page.contains(&format!("| `{}`", p.id))), "{}", node.id);
            assert!(page.contains("](repo:shaders/"), "{} has no passes", node.id);
        }
        let flow = page(registry::find("flow_dog").unwrap(), &root).unwrap();
        assert!(flow.contains("(4.7)") && flow.contains("`flow_dog_tangent`"), "{flow}");
    }
}
