//! Prints the list of guides: a line for each, its id, label, kind of picture, number of its bit and document, with tabs between.

use isophote::graph::GraphInput;

fn main() {
    for guide in GraphInput::GUIDES {
        let [id, label, doc] = [guide.id(), guide.label(), guide.doc()];
        println!("{id}\t{label}\t{}\t{}\t{doc}", guide.kind().id(), guide.bit().trailing_zeros());
    }
}
