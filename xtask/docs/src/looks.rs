//! The looks that ship with the program, as a grid of what each makes of the frame of the scene and of a photograph.

use crate::error::{Error, Result};
use crate::page::escaped;
use crate::shot::Subject;
use isophote::{preset, registry};
use std::fmt::Write as _;

/// A look as the grid shows it.
#[derive(Debug)]
pub struct LookCard {
    /// The stem of its file.
    pub id: &'static str,
    /// Its name for people.
    pub name: String,
    about: String,
    style: String,
}

impl LookCard {
    /// Stem of the picture that it makes of one.
    pub fn picture(&self, of: Subject) -> String {
        format!("look-{}-{}", self.id, of.id())
    }
}

/// All looks, in their order.
///
/// # Errors
/// A look that lacks its name or its description.
pub fn all() -> Result<Vec<LookCard>> {
    let read = |look: &preset::Look| {
        let preset::Preset { title, style, .. } = look.preset().ok()?;
        Some(LookCard { id: look.id, name: title.name?, about: title.about?, style })
    };
    let looks = preset::LOOKS.iter();
    looks.map(|look| read(look).ok_or_else(|| Error::page(look.name(), "is no look with a name"))).collect()
}

/// The grid.
pub fn contents(looks: &[LookCard]) -> String {
    let mut text = String::new();
    let mut style = "";
    for look in looks {
        if look.style != style {
            let end = if style.is_empty() { "" } else { "</div>\n\n" };
            style = &look.style;
            let label = registry::find(style).map_or(style, |node| node.label);
            let _ = write!(text, "{end}## {label}\n\n<div class=\"row wide\">");
        }
        let _ = write!(
            text,
            "<figure><div class=\"pair\"><img src=\"../pictures/{scene}.jpg\" alt=\"{name} on a scene\" loading=\"lazy\">\
             <img src=\"../pictures/{photo}.jpg\" alt=\"{name} on a photograph\" loading=\"lazy\"></div><figcaption>\
             <b>{name}</b> <code>look:{id}</code><br>{about}</figcaption></figure>",
            scene = look.picture(Subject::Scene),
            photo = look.picture(Subject::Photo),
            id = look.id,
            name = escaped(&look.name),
            about = escaped(&look.about)
        );
    }
    text.push_str("</div>\n");
    text
}
