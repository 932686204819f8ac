//! Prints the list of nodes in Markdown, from their declarations: a line for each.

use isophote::registry;

fn main() {
    for node in registry::nodes() {
        println!("- `{}`: {}", node.id, brief(node.doc));
    }
}

/// The first clause of a node's documentation.
fn brief(doc: &str) -> &str {
    let end = [". ", ":", ",", " ("].iter().filter_map(|mark| doc.find(mark)).min();
    doc[..end.unwrap_or(doc.len())].trim_end_matches('.')
}
