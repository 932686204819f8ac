//! Pictures of the site: of nodes, of their controls, of looks.

use crate::error::Result;
use crate::looks::LookCard;
use crate::shot::{Shot, Style};
use crate::{maker, reference, styles};
use isophote::registry;

/// All pictures of the site.
///
/// # Errors
/// A node that cannot be shown.
pub fn all(looks: &[LookCard]) -> Result<Vec<Shot>> {
    let mut shots = Vec::new();
    for node in registry::nodes() {
        if maker::unshown(node).is_none() {
            let style = match maker::graph(node)? {
                Some(graph) => Style::Graph(graph.to_string()),
                None => Style::Named(node.id.to_owned()),
            };
            shots.push(Shot { name: reference::picture(node), style, set: Vec::new() });
        }
        if styles::is_style(node) {
            shots.extend(styles::shots(node));
        }
    }
    shots.extend(looks.iter().map(|look| Shot {
        name: format!("look-{}", look.id),
        style: Style::Named(format!("look:{}", look.id)),
        set: Vec::new(),
    }));
    shots.push(before());
    Ok(shots)
}

/// The frame itself, as a filter that does nothing shows it.
fn before() -> Shot {
    let set = vec![("mix", "0".to_owned())];
    Shot { name: "before".into(), style: Style::Named("gaussian".into()), set }
}
