//! The program as desktops know it: its entry, what software centres say of it, and its icon in all sizes.

use crate::error::{Error, Result};
use crate::tree::Tree;
use std::path::Path;

/// Name of the application, which its window has as well.
const ID: &str = "org.isophote.Isophote";

/// Adds everything; the icons are `SIDE.png` and `scalable.svg` in a folder.
///
/// # Errors
/// A folder that cannot be read.
pub fn add(tree: &mut Tree, icons: &Path) -> Result<()> {
    let entry = include_str!("../files/org.isophote.Isophote.desktop");
    tree.text(format!("share/applications/{ID}.desktop"), entry);
    let known = include_str!("../files/org.isophote.Isophote.metainfo.xml");
    tree.text(format!("share/metainfo/{ID}.metainfo.xml"), known);
    for file in std::fs::read_dir(icons).map_err(Error::at(icons))? {
        let path = file.map_err(Error::at(icons))?.path();
        let [stem, ending] = [path.file_stem(), path.extension()]
            .map(|part| part.map(|part| part.to_string_lossy().into_owned()).unwrap_or_default());
        let size = if ending == "svg" { stem } else { format!("{stem}x{stem}") };
        tree.copy(format!("share/icons/hicolor/{size}/apps/{ID}.{ending}"), path);
    }
    Ok(())
}
