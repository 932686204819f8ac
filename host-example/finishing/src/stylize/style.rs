//! Style that `--style` and `--set` name, as a graph of the library.

use std::ffi::OsStr;
use std::path::Path;
use std::str::FromStr;

use serde_json::{Map, Value};

use super::lengths::Lengths;
use super::preset::{self, Animated, Preset, Track};
use super::source;
use crate::stylize::looks;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::{frames, output};
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::catalogue::{Kind, Node, Param, Port};
use isophote_loader::{Graph, Library};

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

/// A graph and what it yields.
#[derive(Debug)]
pub struct Style {
    /// The id of a node, the path of a file, or a look.
    pub name: String,
    /// The graph.
    pub graph: Graph,
    /// Kind of image that it yields.
    pub kind: Kind,
    /// Unit of its lengths.
    pub lengths: Lengths,
    /// True where it is one node, index 0, with what feeds it.
    single: bool,
    /// Parameters that change from frame to frame.
    animated: Vec<Animated>,
}

impl Style {
    /// Makes the graph of `name`, which is the id of a node, the path of a graph file or preset, or a look, and sets
    /// its parameters; animated ones have the value of their first keyframe.
    ///
    /// # Errors
    /// [`Error::Input`] for names that are neither, files that cannot be read, graphs that yield something
    /// that is no picture, and parameters that do not exist or cannot have their value.
    pub fn load(library: &Library, name: impl AsRef<OsStr>, settings: &[Setting]) -> Result<Self> {
        Self::any(library, name, settings)?.picture()
    }

    /// The style of a preset that is written in the file `path`.
    ///
    /// # Errors
    /// As [`Style::load`].
    pub fn of_preset(library: &Library, path: &Path, preset: &Preset) -> Result<Self> {
        let mut style = Self::of(inside(library, path, preset)?, path.as_os_str())?;
        style.follow_all(preset)?;
        style.picture()
    }

    /// Itself, where it yields a picture.
    fn picture(self) -> Result<Self> {
        if self.kind.is_picture() {
            return Ok(self);
        }
        Err(Error::input(
            &self.name,
            format!("yields a {}, which is no picture", self.kind.name()),
            "choose a node that yields a colour or a scalar; `isophote nodes` lists them",
        ))
    }

    /// As [`Style::load`], but of graphs that yield anything.
    ///
    /// # Errors
    /// As [`Style::load`].
    pub fn any(library: &Library, name: impl AsRef<OsStr>, settings: &[Setting]) -> Result<Self> {
        let mut opened = open(library, name.as_ref())?;
        let preset = opened.preset.take();
        let mut style = Self::of(opened, name.as_ref())?;
        if let Some(preset) = &preset {
            style.follow_all(preset)?;
        }
        for setting in settings {
            let (node, _) = style.set(setting)?;
            style.animated.retain(|a| (a.node, &a.param) != (node, &setting.param));
        }
        Ok(style)
    }

    /// All that keeps the preset of the file `path` from being used, beside what [`Preset::examine`] finds.
    pub fn faults(library: &Library, path: &Path, preset: &Preset) -> Vec<Error> {
        let opened = inside(library, path, preset).and_then(|opened| Self::of(opened, path.as_os_str()));
        let mut style = match opened {
            Ok(style) => style,
            Err(fault) => return vec![fault],
        };
        let mut faults = Vec::new();
        for (param, track) in &preset.params {
            style.follow(param, track, &mut faults);
        }
        faults
    }

    fn of(opened: Opened, name: &OsStr) -> Result<Self> {
        let Opened { graph, single, .. } = opened;
        let name = name.to_string_lossy().into_owned();
        let kind =
            graph.output_kind().map_err(|e| e.at(&name, "name the node whose output is the graph's"))?;
        Ok(Self { name, graph, kind, lengths: Lengths::default(), single, animated: Vec::new() })
    }

    /// Request to the library for pictures of a size, with lengths as the style means them.
    ///
    /// # Errors
    /// As [`Library::request`].
    pub fn request(&self, library: &Library, size: (u32, u32)) -> isophote_loader::Result<IsophoteRequest> {
        let reference_height = self.lengths.reference_height();
        Ok(IsophoteRequest { reference_height, ..library.request(size)? })
    }

    /// Warns of keyframes before and after all of `frames`.
    pub fn warn_of_keys_beyond(&self, frames: &[i64]) {
        let (Some(first), Some(last)) = (frames.iter().min(), frames.iter().max()) else { return };
        let mut keys: Vec<i64> = self.animated.iter().flat_map(Animated::frames).collect();
        keys.retain(|key| !(first..=last).contains(&key));
        keys.sort_unstable();
        keys.dedup();
        if !keys.is_empty() {
            output::warn(format_args!(
                "{}: the keyframes {} are outside the frames {first} to {last}",
                self.name,
                frames::summary(&keys)
            ));
        }
    }

    /// Gives animated parameters their values at a frame, and says whether there are any.
    ///
    /// # Errors
    /// [`Error::Input`] when the library refuses a value.
    pub fn at_frame(&self, frame: i64) -> Result<bool> {
        for animated in &self.animated {
            let value = animated.at(frame);
            self.graph.set(animated.node, &animated.param, &value).map_err(|e| {
                e.at(
                    format!("{}: parameter '{}' at frame {frame}", self.name, animated.param),
                    "choose other keys",
                )
            })?;
        }
        Ok(!self.animated.is_empty())
    }

    /// True where parameters change from frame to frame.
    pub fn is_animated(&self) -> bool {
        !self.animated.is_empty()
    }

    /// The value at a frame of the animated parameter that a preset names `name`.
    pub fn animated_at(&self, name: &str, frame: i64) -> Option<String> {
        self.animated.iter().find(|a| a.name == name).map(|a| a.at(frame))
    }

    /// Takes over all that a preset says.
    fn follow_all(&mut self, preset: &Preset) -> Result<()> {
        self.lengths = preset.lengths.unwrap_or_default();
        let mut faults = Vec::new();
        for (param, track) in &preset.params {
            self.follow(param, track, &mut faults);
        }
        faults.into_iter().next().map_or(Ok(()), Err)
    }

    /// Takes over what a preset says of a parameter. What it cannot take is added to `faults`.
    fn follow(&mut self, name: &str, track: &Track, faults: &mut Vec<Error>) {
        let place = format!("{}: parameter '{name}'", self.name);
        match track {
            Track::Still(value) => faults.extend(self.follow_value(name, value, &place).err()),
            Track::Keys { keys, step } => {
                let mut refused = Vec::new();
                // From the last to the first, whose value stays.
                for (frame, value) in keys.iter().rev() {
                    let put = self.follow_value(name, value, &format!("{place} at frame {frame}"));
                    let animated = put.and_then(|(node, param)| {
                        let is_first = *frame == keys[0].0;
                        is_first.then(|| Animated::new(&place, (name, node, &param), keys, *step)).transpose()
                    });
                    match animated {
                        Ok(animated) => self.animated.extend(animated),
                        Err(fault) => refused.push(fault),
                    }
                }
                faults.extend(refused.into_iter().rev());
            }
        }
    }

    /// Sets a parameter by the name that a preset has for it; returns the index of its node and what that says of it.
    fn follow_value(&self, name: &str, value: &str, place: &str) -> Result<(u32, Param)> {
        let unknown = || Error::input(place, "is no name", "write the id of a parameter");
        let setting = format!("{name}={value}").parse::<Setting>().map_err(|_| unknown())?;
        let (node, spec) = self.put(&setting, place)?;
        // The node has taken a value for it.
        let param = spec.params.into_iter().find(|p| p.id == setting.param).ok_or_else(unknown)?;
        Ok((node, param))
    }

    /// Sets a parameter of the node that is named, or of the only one that has it. Returns the index of the node
    /// and what it says about itself.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such node or parameter, several nodes have the parameter, or it cannot
    /// have the value.
    pub fn set(&self, setting: &Setting) -> Result<(u32, Node)> {
        self.put(setting, &format!("--set {setting}"))
    }

    /// Makes all nodes that can be steady over time so, from 0 to 1.
    ///
    /// # Errors
    /// [`Error::Input`] when no node can, or not so much.
    pub fn steady(&mut self, steadiness: f32) -> Result<()> {
        const PARAM: &str = "steadiness";
        let place = format!("--steadiness {steadiness}");
        let fail = |e: isophote_loader::Error| e.at(&place, "give a number from 0 to 1");
        let mut found = false;
        for node in 0..self.graph.count() {
            let spec = self.graph.spec(node).map_err(fail)?;
            if spec.params.iter().any(|p| p.id == PARAM) {
                self.graph.set(node, PARAM, &steadiness.to_string()).map_err(fail)?;
                self.animated.retain(|a| (a.node, a.param.as_str()) != (node, PARAM));
                found = true;
            }
        }
        if !found {
            let fix = "choose a style that has the parameter steadiness, or put the node steady before it";
            return Err(Error::input(&place, "no node of the style knows of time", fix));
        }
        Ok(())
    }

    /// True where a node of the graph can use pictures of a kind.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn can_use(&self, kind: Kind) -> Result<bool> {
        for node in 0..self.graph.count() {
            let spec = self.graph.spec(node).map_err(|e| e.at(&self.name, "choose another style"))?;
            if spec.inputs.iter().any(|port| port.kind == kind) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// True where a node of the graph reads the mask that enters it.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn takes_mask(&self) -> Result<bool> {
        let json = self.graph.to_json().map_err(|e| e.at(&self.name, "choose another style"))?;
        let graph: Value = serde_json::from_str(&json).unwrap_or_default();
        let nodes = graph["nodes"].as_array().into_iter().flatten();
        let mut sources = nodes.filter_map(|node| node["inputs"].as_object()).flat_map(Map::values);
        Ok(sources.any(|source| source == "@mask"))
    }

    /// Lets all nodes that can be steady over time estimate motion from the pictures themselves.
    ///
    /// # Errors
    /// [`Error::Input`] when the library has no such node.
    pub fn estimate_motion(&mut self) -> Result<()> {
        let fail = |e: isophote_loader::Error| e.at("--motion estimate", "name files of motion vectors");
        let nodes = self.graph.count();
        for (port, direction) in [("motion", "backward"), ("motion_forward", "forward")] {
            let mut flow = None;
            for node in 0..nodes {
                let spec = self.graph.spec(node).map_err(fail)?;
                if spec.inputs.iter().all(|input| input.id != port) {
                    continue;
                }
                let from = match flow {
                    Some(from) => from,
                    None => {
                        let from =
                            self.graph.add(&format!("estimated {port}"), "optical_flow").map_err(fail)?;
                        self.graph.set(from, "direction", direction).map_err(fail)?;
                        self.graph.connect_input("color", from).map_err(fail)?;
                        *flow.insert(from)
                    }
                };
                self.graph.connect(from, node, port).map_err(fail)?;
            }
        }
        Ok(())
    }

    /// [`Style::set`], where `place` says in messages who wants it.
    fn put(&self, setting: &Setting, place: &str) -> Result<(u32, Node)> {
        let fail = |e: isophote_loader::Error| e.at(place, "see the graph's nodes");
        let graph = &self.graph;
        let mut named = Vec::new();
        for node in 0..graph.count() {
            named.push((node, graph.name(node).map_err(fail)?, graph.spec(node).map_err(fail)?));
        }
        let put = |(node, _, spec): &(u32, String, Node)| {
            let fix = format!("`isophote nodes {}` lists its parameters", spec.id);
            graph.set(*node, &setting.param, &setting.value).map_err(|e| e.at(place, fix))?;
            Ok((*node, spec.clone()))
        };
        if let Some(wanted) = &setting.node {
            let Some(node) = named.iter().find(|(_, name, _)| name == wanted) else {
                let names: Vec<&str> = named.iter().map(|(_, name, _)| name.as_str()).collect();
                return Err(Error::input(
                    place,
                    format!("the graph has no node '{wanted}'"),
                    format!("choose from {}", names.join(", ")),
                ));
            };
            return put(node);
        }
        let mut holders =
            named.iter().filter(|(_, _, spec)| spec.params.iter().any(|p| p.id == setting.param));
        match (holders.next(), holders.next(), named.first()) {
            // The node that was asked for comes before those that only feed it.
            (Some(node), Some(_), _) if self.single && node.0 == 0 => put(node),
            (Some(node), None, _) => put(node),
            // It is asked even when it has no such parameter: its message names the nearest.
            (None, _, Some(node)) if self.single => put(node),
            (None, ..) => {
                let names: Vec<&str> = named.iter().map(|(_, _, spec)| spec.id).collect();
                Err(Error::input(
                    place,
                    format!("no node of the graph has a parameter '{}'", setting.param),
                    format!("`isophote nodes NODE` lists the parameters of {}", names.join(", ")),
                ))
            }
            (Some((_, first, _)), Some((_, second, _)), _) => Err(Error::input(
                place,
                format!("several nodes of the graph have a parameter '{}'", setting.param),
                format!("write {first}.{0} or {second}.{0}", setting.param),
            )),
        }
    }
}

/// Style that a name stands for.
struct Opened {
    graph: Graph,
    /// True where it is a single node with what feeds it.
    single: bool,
    /// Preset that sets its parameters.
    preset: Option<Preset>,
}

fn open(library: &Library, style: &OsStr) -> Result<Opened> {
    if let Some(json) = style.to_str().filter(|text| preset::is_written_out(text)) {
        let graph = library.graph_from_json(json).map_err(|e| e.at("the graph", "correct it"))?;
        return Ok(Opened { graph, single: false, preset: None });
    }
    let path = Path::new(style);
    // No node has a name that is no text.
    let refused = match library.single(&style.to_string_lossy()) {
        Ok(graph) => {
            let graph = fed(library, graph).map_err(|e| e.at(path.display(), "use a graph file"))?;
            return Ok(Opened { graph, single: true, preset: None });
        }
        Err(refused) => refused,
    };
    if !(looks_like_file(path) || path.exists() || looks::id(path).is_some()) {
        let fix = path.to_str().and_then(looks::meant).map_or_else(
            || {
                "name a node that `isophote nodes` lists, a look, or a graph file or preset (.json)"
                    .to_owned()
            },
            |look| format!("did you mean '{look}'?"),
        );
        return Err(refused.at(path.display(), fix));
    }
    let json = source::read(path)?;
    if preset::is_graph(&json) {
        let graph =
            library.graph_from_json(&json).map_err(|e| e.at(path.display(), "correct the graph file"))?;
        return Ok(Opened { graph, single: false, preset: None });
    }
    let preset = Preset::parse(path, &json)?;
    let opened = inside(library, path, &preset)?;
    Ok(Opened { preset: Some(preset), ..opened })
}

/// True where the name of a style can be that of a file alone, since no node has such a name.
fn looks_like_file(style: &Path) -> bool {
    style.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) || style.components().count() > 1
}

/// True where a style is a file, and neither a node nor a look nor a graph written out. Of a node and a file of one
/// name the node counts.
pub fn is_file(style: &Path) -> bool {
    if looks::id(style).is_some() || style.to_str().is_some_and(preset::is_written_out) {
        return false;
    }
    let is_node = |library: Library| library.find_node(&style.to_string_lossy()).is_ok();
    looks_like_file(style) || style.is_file() && !Library::open().is_ok_and(is_node)
}

/// The graph that the preset of the file `path` sets the parameters of.
fn inside(library: &Library, path: &Path, preset: &Preset) -> Result<Opened> {
    let inner = preset.style_beside(path);
    let named = Path::new(&inner);
    if looks::id(named).is_some() || named.is_file() && !preset::is_graph(&source::read(named)?) {
        return Err(Error::file(
            path,
            format!("its style '{}' is no graph", named.display()),
            "name a node or a graph file",
        ));
    }
    open(library, &inner).map_err(|e| e.within(path))
}

/// Feeds what a single node needs and no picture gives, such as a tensor, from the first node of the catalogue
/// that makes it of pictures alone.
fn fed(library: &Library, mut graph: Graph) -> isophote_loader::Result<Graph> {
    let spec = graph.spec(0)?;
    for port in spec.inputs.iter().filter(|p| !p.optional && !is_picture(p)) {
        let nodes = library.catalogue()?.nodes;
        let makes = |n: &&Node| {
            n.output.kind == port.kind
                && n.inputs.iter().all(|p| p.optional || is_picture(p))
                && n.id != spec.id
        };
        // Without one the input stays open, which the library reports when it plans.
        let Some(feeder) = nodes.iter().find(makes) else { continue };
        let index = graph.add(port.id, feeder.id)?;
        for picture in feeder.inputs.iter().filter(|p| is_picture(p)) {
            graph.connect_input(picture.id, index)?;
        }
        graph.connect(index, 0, port.id)?;
    }
    Ok(graph)
}

/// True where an input takes a picture that enters the graph, by its name.
fn is_picture(port: &Port) -> bool {
    ["color", "normal", "depth", "object_id", "motion", "motion_forward", "rest_position"].contains(&port.id)
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
