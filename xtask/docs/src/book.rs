//! Pages of the site, in the order of its contents.

use crate::error::{Error, Result};
use crate::page::{DOCUMENTS, Page};
use crate::{glossary, reference, styles};
use isophote::registry;
use std::path::Path;

/// Pages written for the site: part, place, title.
const WRITTEN: [(&str, &str, &str); 34] = [
    ("", "index", "Isophote"),
    ("", "install", "Install"),
    ("", "windows", "Windows"),
    ("", "macos", "macOS"),
    ("For artists", "artists/first-look", "First look in five minutes"),
    ("For artists", "artists/window", "The artist's window"),
    ("For artists", "artists/recipes", "Recipes"),
    ("For artists", "artists/lines", "Too many lines, too few"),
    ("For artists", "artists/directing", "Direct a shot"),
    ("For artists", "artists/materials", "Own paper, own hatching"),
    ("For artists", "artists/slow", "It is slow"),
    ("For artists", "artists/looks", "Looks"),
    ("For artists", "artists/styles", "Styles"),
    ("For artists", "artists/gallery", "Gallery"),
    ("For compositors", "compositors/install", "Install the plugin"),
    ("For compositors", "compositors/clips", "Clips, motion, masks, proxies"),
    ("For engine authors", "engines/c", "The C header by scenario"),
    ("For engine authors", "engines/plans", "Plans on your own device"),
    ("For engine authors", "engines/vulkan", "Vulkan"),
    ("For engine authors", "engines/graphics", "Other graphics APIs"),
    ("For render TDs", "farms/sequences", "Sequences"),
    ("For render TDs", "farms/colours", "Colours"),
    ("For render TDs", "farms/masks", "Masks and layered looks"),
    ("For render TDs", "farms/scenes", "Scenes"),
    ("For render TDs", "farms/formats", "Formats"),
    ("For render TDs", "farms/memory", "Memory and threads"),
    ("For Python programmers", "python/arrays", "Arrays, looks, sequences"),
    ("For Python programmers", "python/comfyui", "Nodes for ComfyUI"),
    ("For Blender users", "blender/extension", "The Blender extension"),
    ("For the web", "web/page", "The page"),
    ("For contributors", "contributors/start", "Where to begin"),
    ("For contributors", "contributors/dependencies", "Dependencies"),
    ("Nodes", "nodes/index", "All nodes"),
    ("Nodes", "nodes/symbols", "Symbols of the thesis"),
];

/// All pages; texts of pages are in `sources`, documents below `root`.
///
/// # Errors
/// A page that cannot be read, or a node that cannot be described.
pub fn pages(sources: &Path, root: &Path) -> Result<Vec<Page>> {
    let read = |file: &Path| std::fs::read_to_string(file).map_err(Error::at(file));
    let mut pages = Vec::new();
    for (part, path, title) in WRITTEN {
        let text = read(&sources.join(format!("{path}.md")))?;
        let text = text.replace("<!-- nodes -->", &reference::contents());
        let text = text.replace("<!-- styles -->", &styles::contents());
        let text = text.replace("<!-- symbols -->", &glossary::tables());
        let (path, title) = (path.to_owned(), title.to_owned());
        pages.push(Page { path, title, part, text, document: None });
    }
    for (part, path, title, document) in DOCUMENTS {
        let text = read(&root.join(document))?;
        let (path, title) = (path.to_owned(), title.to_owned());
        pages.push(Page { path, title, part, text, document: Some(document) });
    }
    for node in registry::nodes() {
        if styles::is_style(node) {
            pages.push(made("Styles", format!("styles/{}", node.id), node.label, styles::page(node)));
        }
        pages.push(made("Nodes", format!("nodes/{}", node.id), node.label, reference::page(node, root)?));
    }
    Ok(pages)
}

fn made(part: &'static str, path: String, title: &str, text: String) -> Page {
    Page { path, title: title.to_owned(), part, text, document: None }
}
