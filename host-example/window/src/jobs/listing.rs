//! Reading of the looks that there are.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::state::browser::entry::{Content, Group};
use crate::state::browser::listing::{Found, Listing};
use crate::state::look::{EditedLook, PLAIN, medium_source};
use isophote_files::error::Error;
use isophote_loader::Library;

/// Most folders within folders.
const DEEPEST: usize = 4;
/// Most files of all folders together.
const MOST_FILES: usize = 2000;

/// Request for a listing.
#[derive(Debug)]
pub struct ListingRequest {
    /// The library.
    pub library: Library,
    /// The user's folders.
    pub folders: Vec<PathBuf>,
}

/// Reads everything anew.
pub fn read(ListingRequest { library, folders }: ListingRequest) -> Listing {
    let mut listing = Listing::default();
    let mut seen = HashSet::new();
    for folder in folders {
        // Two names of one folder, or one inside the other, show each file once.
        listing.read_folder(&library, &folder, 0, &mut seen);
    }
    for look in library.looks().unwrap_or_default() {
        listing.found.push(found(&library, Group::Shipped, look.name().into()));
    }
    listing.found.push(found(&library, Group::Styles, PLAIN.into()));
    let nodes = library.catalogue().map(|catalogue| catalogue.nodes).unwrap_or_default();
    for node in nodes.iter().filter(|node| node.group == "styles") {
        listing.found.push(found(&library, Group::Styles, node.id.into()));
        // What a style draws with is chosen like a style.
        for (_, medium) in node.media() {
            listing.found.push(found(&library, Group::Styles, medium_source(node, &medium)));
        }
    }
    listing
}

impl Listing {
    fn read_folder(&mut self, library: &Library, folder: &Path, depth: usize, seen: &mut HashSet<PathBuf>) {
        self.watched.push(folder.to_owned());
        let real = fs::canonicalize(folder);
        let entries =
            real.and_then(|real| if seen.insert(real) { fs::read_dir(folder).map(Some) } else { Ok(None) });
        let entries = match entries {
            Ok(Some(entries)) => entries,
            Ok(None) => return,
            Err(problem) => {
                let fix = "mend it, or take it off the list of folders";
                self.problems.push(Error::file(folder, format!("cannot be read: {problem}"), fix));
                return;
            }
        };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.retain(|path| !path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.')));
        paths.sort_by_key(|path| path.to_string_lossy().to_lowercase());
        let is_look = |path: &PathBuf| {
            path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) && path.is_file()
        };
        for path in paths.iter().filter(|path| is_look(path)) {
            if self.watched.len() >= MOST_FILES {
                return;
            }
            self.watched.push(path.clone());
            self.found.push(found(library, Group::Folder(folder.to_owned()), path.clone()));
        }
        for path in paths.iter().filter(|path| path.is_dir()) {
            if depth < DEEPEST && self.watched.len() < MOST_FILES {
                self.read_folder(library, path, depth + 1, seen);
            }
        }
    }
}

fn found(library: &Library, group: Group, source: PathBuf) -> Found {
    let (style, content) = match EditedLook::open(library, &source) {
        Ok(look) => (style_of(library, &look), Content::Look(Arc::new(look))),
        Err(error) => (String::new(), Content::Broken(error.to_string())),
    };
    Found { group, source, style, content }
}

/// Name of a look's style for people.
fn style_of(library: &Library, look: &EditedLook) -> String {
    match library.find_node(&look.preset.style) {
        Ok(node) => node.label.to_owned(),
        Err(_) if look.is_plain() => String::new(),
        Err(_) => "Graph".to_owned(),
    }
}
