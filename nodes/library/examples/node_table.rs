//! Prints the list of nodes in Markdown, from their declarations: a line for each.

use isophote::registry;

/// Characters that are more than a few words.
const ENOUGH: usize = 30;

fn main() {
    for node in registry::nodes() {
        println!("- `{}`: {}", node.id, brief(node.hint));
    }
}

/// The first clause of a node's hint; up to a comma where it says enough.
fn brief(doc: &str) -> &str {
    let ends = [". ", ":", " ("].iter().filter_map(|mark| doc.find(mark));
    let comma = doc.match_indices(',').map(|(at, _)| at).find(|at| *at >= ENOUGH);
    doc[..ends.chain(comma).min().unwrap_or(doc.len())].trim_end_matches('.')
}
