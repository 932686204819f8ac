//! Single nodes that need what no picture gives.

use crate::declare::spec::{NodeSpec, Port};
use crate::error::Result;
use crate::graph::{Graph, GraphInput};
use crate::registry;

/// A graph of one node, index 0, that is fed with what it needs and no picture gives, such as a tensor: from the first node
/// of the catalogue that makes it of pictures alone. The other inputs are the pictures of the same name.
///
/// # Errors
/// [`Error::Unknown`](crate::Error::Unknown), naming the nearest, when there is no such node.
pub fn fed(node: &str) -> Result<Graph> {
    let mut graph = Graph::single(node)?;
    let to = graph.node(0)?;
    let spec = graph.spec(to)?;
    for port in spec.ports().filter(|port| !port.optional && picture(port).is_none()) {
        // Without such a node the input stays open, which is reported when the graph is planned.
        let Some(feeder) =
            registry::nodes().iter().find(|feeder| makes(feeder, port) && feeder.id != spec.id)
        else {
            continue;
        };
        let from = graph.add(port.id, feeder.id)?;
        for (input, port) in feeder.ports().filter_map(|port| Some((picture(port)?, port))) {
            graph.connect_input(input, from, port.id)?;
        }
        graph.connect(from, to, port.id)?;
    }
    Ok(graph)
}

/// True for a node that makes what a port takes of pictures alone.
fn makes(node: &NodeSpec, port: &Port) -> bool {
    node.output.kind == port.kind && node.ports().all(|port| port.optional || picture(port).is_some())
}

/// The picture that a port takes by its name.
fn picture(port: &Port) -> Option<GraphInput> {
    GraphInput::from_id(port.id).filter(|input| input.kind() == port.kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guides::Guides;
    use crate::{Planned, Request};

    #[test]
    fn every_node_can_be_planned_by_its_id() {
        for spec in registry::nodes() {
            let graph = fed(spec.id).expect("the node is there");
            let request = Request { guides: Guides::of(|_| true), ..Request::new(64, 48) };
            let planned = Planned::new(&graph, request);
            assert!(planned.is_ok(), "{}: {:?}", spec.id, planned.err());
        }
    }
}
