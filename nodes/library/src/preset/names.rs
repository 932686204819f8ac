//! Names of parameters: `id`, or `node.id` for one node of a graph.

use super::fault::Fault;
use crate::declare::spec::NodeSpec;
use crate::graph::{Graph, NodeId};

/// The parameter of a graph that a name means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Named<'n> {
    pub node: NodeId,
    pub param: &'n str,
}

/// Finds the parameter that a name means: that of the node before the last dot, or else of the only node that has it.
/// `is_single` says that node 0 is the style and the others feed it. The node may have no such parameter.
///
/// # Errors
/// A fault without a place: there is no such node or parameter, or several nodes have it.
pub(super) fn find<'n>(graph: &Graph, is_single: bool, name: &'n str) -> Result<Named<'n>, Fault> {
    let name = name.trim();
    let (node, param) = name.rsplit_once('.').map_or((None, name), |(node, param)| (Some(node), param));
    if param.is_empty() || node == Some("") {
        let fix = "write the id of a parameter, or node.id for a node of a graph";
        return Err(Fault::unknown("", "is no name", fix));
    }
    let nodes = nodes(graph)?;
    if let Some(wanted) = node {
        let found = nodes.iter().find(|(_, name, _)| *name == wanted);
        return found.map(|(node, ..)| Named { node: *node, param }).ok_or_else(|| {
            let names: Vec<&str> = nodes.iter().map(|(_, name, _)| *name).collect();
            let fix = format!("choose from {}", names.join(", "));
            Fault::value("", format!("the graph has no node '{wanted}'"), fix)
        });
    }
    let mut holders = nodes.iter().filter(|(.., spec)| spec.param(param).is_some());
    match (holders.next(), holders.next(), nodes.first()) {
        // The node that was asked for comes before those that only feed it.
        (Some((node, ..)), Some(_), _) if is_single && node.index() == 0 => Ok(Named { node: *node, param }),
        (Some((node, ..)), None, _) => Ok(Named { node: *node, param }),
        // It is asked even when it has no such parameter: its message names the nearest.
        (None, _, Some((node, ..))) if is_single => Ok(Named { node: *node, param }),
        (None, ..) => {
            let ids: Vec<&str> = nodes.iter().map(|(.., spec)| spec.id).collect();
            let problem = format!("no node of the graph has a parameter '{param}'");
            Err(Fault::value("", problem, format!("choose one of the parameters of {}", ids.join(", "))))
        }
        (Some((_, first, _)), Some((_, second, _)), _) => {
            let problem = format!("several nodes of the graph have a parameter '{param}'");
            Err(Fault::value("", problem, format!("write {first}.{param} or {second}.{param}")))
        }
    }
}

type Entry<'g> = (NodeId, &'g str, &'static NodeSpec);

fn nodes(graph: &Graph) -> Result<Vec<Entry<'_>>, Fault> {
    let entry = |index| {
        let node = graph.node(index)?;
        Ok((node, graph.name(node)?, graph.spec(node)?))
    };
    let entries: crate::Result<_> = (0..graph.len()).map(entry).collect();
    entries.map_err(|error| Fault::of(error, "", ""))
}
