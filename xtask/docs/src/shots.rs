//! Pictures of the site: of nodes, of their controls, of looks.

use crate::error::Result;
use crate::looks::LookCard;
use crate::shot::{Shot, Style, Subject};
use crate::{gallery, maker, reference, styles};
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
            let (name, subject) = (reference::picture(node), Subject::Scene);
            shots.push(Shot { name, subject, style, set: Vec::new() });
        }
        if styles::is_style(node) {
            shots.extend(styles::shots(node));
        }
    }
    for subject in [Subject::Scene, Subject::Photo] {
        shots.extend(looks.iter().map(|look| Shot {
            name: look.picture(subject),
            subject,
            style: Style::Named(format!("look:{}", look.id)),
            set: Vec::new(),
        }));
        shots.push(before(subject));
    }
    shots.extend(gallery::shots());
    Ok(shots)
}

/// The picture itself, as a filter that does nothing shows it.
fn before(subject: Subject) -> Shot {
    let name = match subject {
        Subject::Scene => "before".to_owned(),
        _ => format!("before-{}", subject.id()),
    };
    let set = vec![("mix", "0".to_owned())];
    Shot { name, subject, style: Style::Named("gaussian".into()), set }
}
