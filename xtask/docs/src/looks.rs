//! The looks that ship with the program, as a grid of what each makes of the frame.

use crate::error::{Error, Result};
use crate::page::escaped;
use isophote::registry;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

/// A look.
#[derive(Debug)]
pub struct Look {
    /// The stem of its file.
    pub id: String,
    name: String,
    about: String,
    style: String,
}

/// All looks, in their order.
///
/// # Errors
/// A file that cannot be read, or lacks its name, its description or its style.
pub fn all(root: &Path) -> Result<Vec<Look>> {
    let folder = root.join("host-example/looks");
    let order = folder.join("order.txt");
    let order = std::fs::read_to_string(&order).map_err(Error::at(&order))?;
    let read = |id: &str| {
        let path = folder.join(format!("{id}.json"));
        let text = std::fs::read_to_string(&path).map_err(Error::at(&path))?;
        look(id, &text).ok_or_else(|| Error::page(path.display(), "is no look with a name"))
    };
    order.split_whitespace().map(read).collect()
}

fn look(id: &str, text: &str) -> Option<Look> {
    let value: Value = serde_json::from_str(text).ok()?;
    let text = |key: &str| value[key].as_str().map(str::to_owned);
    Some(Look { id: id.to_owned(), name: text("name")?, about: text("about")?, style: text("style")? })
}

/// The grid.
pub fn contents(looks: &[Look]) -> String {
    let mut text = String::new();
    let mut style = "";
    for look in looks {
        if look.style != style {
            let end = if style.is_empty() { "" } else { "</div>\n\n" };
            style = &look.style;
            let label = registry::find(style).map_or(style, |node| node.label);
            let _ = write!(text, "{end}## {label}\n\n<div class=\"row\">");
        }
        let _ = write!(
            text,
            "<figure><img src=\"../pictures/look-{id}.jpg\" alt=\"{name}\" loading=\"lazy\"><figcaption><b>{name}</b> \
             <code>look:{id}</code><br>{about}</figcaption></figure>",
            id = look.id,
            name = escaped(&look.name),
            about = escaped(&look.about)
        );
    }
    text.push_str("</div>\n");
    text
}
