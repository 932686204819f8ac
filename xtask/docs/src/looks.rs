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

/// All looks, those of one style together.
///
/// # Errors
/// A file that cannot be read, or lacks its name, its description or its style.
pub fn all(root: &Path) -> Result<Vec<Look>> {
    let folder = root.join("host-example/looks");
    let mut looks = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(Error::at(&folder))? {
        let path = entry.map_err(Error::at(&folder))?.path();
        let text = std::fs::read_to_string(&path).map_err(Error::at(&path))?;
        looks.push(look(&path, &text).ok_or_else(|| Error::page(path.display(), "is no look with a name"))?);
    }
    looks.sort_by(|a, b| (&a.style, &a.name).cmp(&(&b.style, &b.name)));
    Ok(looks)
}

fn look(path: &Path, text: &str) -> Option<Look> {
    let value: Value = serde_json::from_str(text).ok()?;
    let text = |key: &str| value[key].as_str().map(str::to_owned);
    let id = path.file_stem()?.to_str()?.to_owned();
    Some(Look { id, name: text("name")?, about: text("about")?, style: text("style")? })
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
