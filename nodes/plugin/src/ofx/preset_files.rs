//! Presets and graphs in files of users: read once, until a file is another by its size or its time, or is to be forgotten.

use crate::abi::guard::lock;
use isophote::graph::GraphInput;
use isophote::preset::{self, Preset, Settings};
use isophote::request::Guides;
use isophote::spec::ImageKind;
use isophote::{Graph, Planned, Request, registry};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::SystemTime;

/// A style in a file.
#[derive(Debug)]
pub struct Opened {
    /// Its graph.
    pub graph: Graph,
    /// Its parameters and lengths.
    pub settings: Settings,
    /// Guides that it cannot do without.
    pub needs: Vec<GraphInput>,
}

/// The style of a file, or what is wrong with it and what to do, for people.
pub type Read = Result<Arc<Opened>, String>;

/// Size and time of a file; none where there is no file.
type Stamp = Option<(u64, Option<SystemTime>)>;

/// A file as it was read.
struct Entry {
    /// It and the graph file that it names, as they were before they were read.
    files: Vec<(PathBuf, Stamp)>,
    read: Read,
}

static KEPT: Mutex<BTreeMap<PathBuf, Entry>> = Mutex::new(BTreeMap::new());

/// Files that are kept at most.
const MOST: usize = 64;
/// Bytes of the largest file that is read.
const LARGEST: u64 = 16 << 20;
/// Side of the picture that graphs are tried on.
const SIDE: u32 = 64;

/// The style of a file.
///
/// # Errors
/// Text for people: what is wrong with the file, and what to do.
pub fn open(path: &Path) -> Read {
    let kept = lock(&KEPT).get(path).map(|entry| (entry.files.clone(), entry.read.clone()));
    // The disk is asked while nobody waits for it.
    if let Some((files, read)) = kept
        && files.iter().all(|(file, then)| stamp(file) == *then)
    {
        return read;
    }
    let mut files = Vec::new();
    let read = read(path, &mut files).map(Arc::new);
    let mut kept = lock(&KEPT);
    if kept.len() >= MOST {
        kept.clear();
    }
    kept.insert(path.to_owned(), Entry { files, read: read.clone() });
    read
}

/// Forgets a file, so that it is read again.
pub fn forget(path: &Path) {
    lock(&KEPT).remove(path);
}

/// Forgets all files.
pub fn forget_all() {
    lock(&KEPT).clear();
}

fn stamp(path: &Path) -> Stamp {
    std::fs::metadata(path).ok().map(|about| (about.len(), about.modified().ok()))
}

const MEND: &str = "Mend the file, or update Isophote if a newer one wrote it, and press Reload.";

fn read(path: &Path, files: &mut Vec<(PathBuf, Stamp)>) -> Result<Opened, String> {
    let place = path.display().to_string();
    let json = text(path, files)?;
    let wrong = |fault: preset::Fault| format!("{}. {MEND}", fault.to_string().trim_end_matches('.'));
    let graph = if preset::is_graph(&json) {
        None
    } else {
        let named = Preset::parse(&place, &json).map_err(wrong)?.style;
        graph_beside(path, &named).map(|graph| text(&graph, files)).transpose()?
    };
    let (graph, settings) = preset::open_json(&place, &json, graph.as_deref()).map_err(wrong)?;
    if !matches!(graph.output_kind(), Some(ImageKind::Color | ImageKind::Scalar)) {
        return Err(format!(
            "{place} makes no picture. Let its output be a node that makes colours or lines."
        ));
    }
    let needs = needs(&graph).map_err(|error| format!("{place}: {error}. {MEND}"))?;
    Ok(Opened { graph, settings, needs })
}

/// The graph file that a preset names, if it names one. Of a node and a file of one name the node counts.
fn graph_beside(preset: &Path, style: &str) -> Option<PathBuf> {
    let is_file = Path::new(style).extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
        || Path::new(style).components().count() > 1;
    let is_other =
        preset::is_written_out(style) || preset::id_of_look(style).is_some() || registry::find(style).is_ok();
    (is_file && !is_other).then(|| preset.parent().unwrap_or(Path::new("")).join(style))
}

fn text(path: &Path, files: &mut Vec<(PathBuf, Stamp)>) -> Result<String, String> {
    files.push((path.to_owned(), stamp(path)));
    let place = path.display();
    match std::fs::metadata(path) {
        Ok(about) if !about.is_file() => {
            return Err(format!("{place} is no file. Choose a preset or a graph (.json)."));
        }
        Ok(about) if about.len() > LARGEST => {
            return Err(format!("{place} is too large to be a preset. Choose a preset or a graph (.json)."));
        }
        _ => {}
    }
    std::fs::read_to_string(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            format!("{place} is missing. Choose another file, or put it back and press Reload.")
        }
        std::io::ErrorKind::InvalidData => {
            format!("{place} is no text. Choose a preset or a graph (.json).")
        }
        _ => format!("{place} cannot be read: {error}. Choose another file, or mend that and press Reload."),
    })
}

/// The guides without which a graph cannot be planned.
fn needs(graph: &Graph) -> isophote::Result<Vec<GraphInput>> {
    let plan = |guides| Planned::new(graph, Request { guides, ..Request::new(SIDE, SIDE) });
    if plan(Guides::default()).is_ok() {
        return Ok(Vec::new());
    }
    plan(Guides::of(|_| true))?;
    let is_needed = |guide: &GraphInput| plan(Guides::of(|other| other != *guide)).is_err();
    Ok(GraphInput::GUIDES.into_iter().filter(is_needed).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_name_graphs_beside_them() {
        let preset = Path::new("/looks/dusk.json");
        let found = |style| graph_beside(preset, style);
        assert_eq!(found("dusk.graph.json"), Some("/looks/dusk.graph.json".into()));
        assert_eq!(found("../graphs/dusk"), Some("/looks/../graphs/dusk".into()));
        for style in ["cartoon", "look:order", "{\"nodes\": []}", ""] {
            assert_eq!(found(style), None, "{style}");
        }
    }

    #[test]
    fn what_is_no_file_is_told_of() {
        for (path, words) in [("/no/such/file.json", "is missing"), ("/", "is no file")] {
            let error = open(Path::new(path)).expect_err("there is no preset").to_string();
            assert!(error.contains(words) && error.ends_with('.'), "{error}");
        }
    }
}
