//! What `--style` and `--set` say, as a graph of the library.

use std::fs;
use std::path::Path;
use std::str::FromStr;

use crate::error::{Error, Result};
use crate::loader::catalogue::Kind;
use crate::loader::{Graph, Library};

/// Most bytes of a graph file; real ones have some thousands.
const MOST_BYTES: u64 = 16 << 20;

/// One `--set`: `id=value`, or `node.id=value` for one node of a graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Name of the node within its graph, when it is given.
    pub node: Option<String>,
    /// Id of the parameter.
    pub param: String,
    /// The value as it was written.
    pub value: String,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (name, value) =
            text.split_once('=').ok_or("write id=value, or node.id=value for a node of a graph")?;
        let (node, param) = match name.trim().rsplit_once('.') {
            Some((node, param)) => (Some(node.to_owned()), param),
            None => (None, name.trim()),
        };
        if param.is_empty() || node.as_deref() == Some("") {
            return Err("write id=value, or node.id=value for a node of a graph".into());
        }
        Ok(Self { node, param: param.to_owned(), value: value.trim().to_owned() })
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(node) = &self.node {
            write!(f, "{node}.")?;
        }
        write!(f, "{}={}", self.param, self.value)
    }
}

/// A graph that yields a picture.
#[derive(Debug)]
pub struct Style {
    /// The id of a node or the path of a graph file.
    pub name: String,
    /// The graph.
    pub graph: Graph,
    /// Whether it yields a colour or a scalar.
    pub kind: Kind,
}

impl Style {
    /// Makes the graph of `name`, which is the id of a node or the path of a graph file, and sets its
    /// parameters.
    ///
    /// # Errors
    /// [`Error::Input`] for names that are neither, graph files that cannot be read, graphs that yield something
    /// that is no picture, and parameters that do not exist or cannot have their value.
    pub fn load(library: &Library, name: &str, settings: &[Setting]) -> Result<Self> {
        let graph = open(library, name)?;
        for setting in settings {
            set(&graph, setting)?;
        }
        let kind =
            graph.output_kind().map_err(|e| e.at(name, "name the node whose output is the graph's"))?;
        if !matches!(kind, Kind::Color | Kind::Scalar) {
            return Err(Error::input(
                name,
                format!("yields a {}, which is no picture", kind.name()),
                "choose a node that yields a colour or a scalar; `isophote nodes` lists them",
            ));
        }
        Ok(Self { name: name.to_owned(), graph, kind })
    }
}

fn open(library: &Library, style: &str) -> Result<Graph> {
    let path = Path::new(style);
    let refused = match library.single(style) {
        Ok(graph) => return Ok(graph),
        Err(refused) => refused,
    };
    let looks_like_file = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
        || path.components().count() > 1
        || path.exists();
    if !looks_like_file {
        return Err(refused.at(style, "name a node that `isophote nodes` lists, or a graph file (.json)"));
    }
    let size = fs::metadata(path).map_or(0, |m| m.len());
    if size > MOST_BYTES {
        return Err(Error::file(path, "is too large for a graph", "name a graph file (.json)"));
    }
    let json = fs::read_to_string(path).map_err(|e| {
        Error::file(path, format!("cannot be read as a graph: {e}"), "name a graph file (.json) or a node")
    })?;
    library.graph_from_json(&json).map_err(|e| e.at(path.display(), "correct the graph file"))
}

/// Sets a parameter of the node that is named, or of the only one that has it.
///
/// # Errors
/// [`Error::Input`] when there is no such node or parameter, several nodes have the parameter, or it cannot have
/// the value.
pub fn set(graph: &Graph, setting: &Setting) -> Result<()> {
    let place = format!("--set {setting}");
    let fail = |e: crate::loader::Refusal| e.at(&place, "see the graph's nodes");
    let mut named = Vec::new();
    for node in 0..graph.count() {
        named.push((node, graph.name(node).map_err(fail)?, graph.spec(node).map_err(fail)?));
    }
    let of = |spec: &str| format!("`isophote nodes {spec}` lists its parameters");
    if let Some(wanted) = &setting.node {
        let Some((node, _, spec)) = named.iter().find(|(_, name, _)| name == wanted) else {
            let names: Vec<&str> = named.iter().map(|(_, name, _)| name.as_str()).collect();
            return Err(Error::input(
                &place,
                format!("the graph has no node '{wanted}'"),
                format!("choose from {}", names.join(", ")),
            ));
        };
        return graph.set(*node, &setting.param, &setting.value).map_err(|e| e.at(&place, of(spec.id)));
    }
    let has = |spec: &crate::loader::catalogue::Node| spec.params.iter().any(|p| p.id == setting.param);
    let mut holders = named.iter().filter(|(_, _, spec)| has(spec));
    match (holders.next(), holders.next(), named.as_slice()) {
        // A graph of one node is asked even when it has no such parameter: its message names the nearest.
        (Some((node, _, spec)), None, _) | (None, _, [(node, _, spec)]) => {
            graph.set(*node, &setting.param, &setting.value).map_err(|e| e.at(&place, of(spec.id)))
        }
        (None, ..) => {
            let names: Vec<&str> = named.iter().map(|(_, _, spec)| spec.id).collect();
            Err(Error::input(
                &place,
                format!("no node of the graph has a parameter '{}'", setting.param),
                format!("`isophote nodes NODE` lists the parameters of {}", names.join(", ")),
            ))
        }
        (Some((_, first, _)), Some((_, second, _)), _) => Err(Error::input(
            &place,
            format!("several nodes of the graph have a parameter '{}'", setting.param),
            format!("write {first}.{0}=... or {second}.{0}=...", setting.param),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_read() {
        let setting = |node: Option<&str>, param: &str, value: &str| Setting {
            node: node.map(str::to_owned),
            param: param.to_owned(),
            value: value.to_owned(),
        };
        assert_eq!("sigma=2".parse(), Ok(setting(None, "sigma", "2")));
        assert_eq!("a.sigma = 2=3 ".parse(), Ok(setting(Some("a"), "sigma", "2=3")));
        assert_eq!("a.b.sigma=".parse(), Ok(setting(Some("a.b"), "sigma", "")));
        for bad in ["", "sigma", "=2", ".sigma=2", "a.=2"] {
            assert!(bad.parse::<Setting>().is_err(), "{bad}");
        }
        assert_eq!("a.b=c".parse::<Setting>().map(|s| s.to_string()), Ok("a.b=c".to_owned()));
    }
}
