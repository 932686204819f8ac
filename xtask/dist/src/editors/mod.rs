//! Panels for editors that are built on MLT, which otherwise show plugins as bare lists: of Shotcut in QML, of Kdenlive in
//! XML. Both are made of the catalogue, by the rules that the plugin's own controls follow.

mod kdenlive;
mod panel;
mod shotcut;

use crate::error::Result;
use crate::tree::{Entry, Tree};
use std::path::Path;

/// Adds the panels of all effects of the catalogue in `file`, which `isophote nodes --json` printed, with the icons that
/// the bundle has of them.
///
/// # Errors
/// A catalogue that is none.
pub fn add(tree: &mut Tree, file: &Path, icons: &Path) -> Result<()> {
    for panel in panel::all(file)? {
        let folder = format!("shotcut/isophote_{}", panel.id);
        tree.text(format!("{folder}/meta.qml"), shotcut::meta(&panel));
        tree.text(format!("{folder}/ui.qml"), shotcut::ui(&panel));
        let icon = icons.join(format!("org.isophote.{}.png", panel.id));
        tree.add(format!("{folder}/icon.png"), Entry::Copy(icon));
        tree.text(format!("kdenlive/isophote_{}.xml", panel.id), kdenlive::description(&panel));
    }
    Ok(())
}
