//! Prints the table of nodes in Markdown, from their declarations.

use isophote::registry;

fn main() {
    println!("| node | in | out | what it does | § |");
    println!("|---|---|---|---|---|");
    for node in registry::nodes() {
        let inputs: Vec<String> = node
            .inputs
            .iter()
            .map(|p| if p.optional { format!("[{}]", p.id) } else { p.id.to_owned() })
            .collect();
        let sentence = node.doc.split_inclusive(". ").next().unwrap_or(node.doc).trim();
        println!(
            "| `{}` | {} | {} | {} | {} |",
            node.id,
            inputs.join(", "),
            node.output.kind.id(),
            sentence.replace('|', "\\|"),
            node.section
        );
    }
}
