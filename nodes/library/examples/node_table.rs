//! Prints the list of nodes in Markdown, from their declarations: a line for each.

use isophote::registry;

fn main() {
    for node in registry::nodes() {
        println!("- `{}`: {}", node.id, node.hint.trim_end_matches('.'));
    }
}
