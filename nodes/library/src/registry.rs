//! The list of nodes. Adding one is its file and one word here.

use crate::declare::spec::NodeSpec;
use crate::error::{Error, Result, nearest};
use crate::nodes::NODES;

/// Every node, in the order of the catalogue.
pub fn nodes() -> &'static [&'static NodeSpec] {
    NODES
}

/// The node of this id.
///
/// # Errors
/// [`Error::Unknown`], naming the nearest id.
pub fn find(id: &str) -> Result<&'static NodeSpec> {
    NODES.iter().copied().find(|n| n.id == id).ok_or_else(|| {
        Error::Unknown(format!("there is no node '{id}'{}", nearest(id, NODES.iter().map(|n| n.id))))
    })
}
