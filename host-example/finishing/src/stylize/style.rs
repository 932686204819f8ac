//! Style that `--style` and `--set` name, as a graph of the library.

use std::ffi::OsStr;
use std::path::Path;
use std::str::FromStr;

use serde_json::{Map, Value};

use super::preset::{self, Lengths, ObjectRule, Preset};
use super::source;
use super::suggest;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::{frames, output};
use isophote_loader::abi::IsophoteRequest;
use isophote_loader::catalogue::{Kind, Node};
use isophote_loader::{Graph, Library, Style as Tracks};
use isophote_pictures::exr::Guide;

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
    /// Rules of its preset for things in pictures.
    pub objects: Vec<ObjectRule>,
    /// Its parameters by name and by frame.
    tracks: Tracks,
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
        let tracks = open_text(library, path, &preset::text(preset)?, Some(preset))?;
        Self::of(tracks, path.as_os_str(), preset.objects.clone())?.picture()
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
        let (tracks, objects) = open(library, name.as_ref())?;
        let style = Self::of(tracks, name.as_ref(), objects)?;
        for setting in settings {
            style.set(setting)?;
        }
        Ok(style)
    }

    fn of(tracks: Tracks, name: &OsStr, objects: Vec<ObjectRule>) -> Result<Self> {
        let name = name.to_string_lossy().into_owned();
        let graph = tracks.graph().map_err(|e| e.at(&name, "choose another style"))?;
        let kind =
            graph.output_kind().map_err(|e| e.at(&name, "name the node whose output is the graph's"))?;
        let lengths = if tracks.reference_height() == 0 { Lengths::Pixels } else { Lengths::Relative };
        Ok(Self { name, graph, kind, lengths, objects, tracks })
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
        let mut keys = self.tracks.frames();
        keys.retain(|key| !(first..=last).contains(&key));
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
        let set = self.tracks.at_frame(self.graph.handle(), frame);
        set.map_err(|e| e.at("keyframes", "choose other keys").within(Path::new(&self.name)))
    }

    /// Tells whether parameters change from frame to frame.
    pub fn is_animated(&self) -> bool {
        !self.tracks.frames().is_empty()
    }

    /// The value at a frame of the animated parameter that a preset names `name`.
    pub fn animated_at(&self, name: &str, frame: i64) -> Option<String> {
        self.tracks.value(name, frame)
    }

    /// Sets a parameter of the node that is named, or of the only one that has it.
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such node or parameter, several nodes have the parameter, or it cannot
    /// have the value.
    pub fn set(&self, setting: &Setting) -> Result<()> {
        let name = match &setting.node {
            Some(node) => format!("{node}.{}", setting.param),
            None => setting.param.clone(),
        };
        let fail = |e: isophote_loader::Error| {
            let error =
                e.at(format!("--set {setting}"), "`isophote nodes NODE` lists the parameters of a node");
            self.with_hint(error, &setting.param)
        };
        self.tracks.set(self.graph.handle(), &name, &setting.value).map_err(fail)?;
        Ok(())
    }

    /// The error about a parameter that is not there, with the one that was meant.
    fn with_hint(&self, error: Error, param: &str) -> Error {
        let params = self.params();
        let ids: Vec<&str> = params.iter().map(String::as_str).collect();
        match (suggest::id(&ids, param), error) {
            (Some(meant), Error::Input { place, problem, fix }) if !ids.contains(&param) => {
                // The library names the nearest by its letters alone.
                let problem = problem.split("; did you mean").next().unwrap_or_default();
                Error::input(place, format!("{problem}; did you mean '{meant}'?"), fix)
            }
            (_, error) => error,
        }
    }

    /// Ids of the parameters of its nodes.
    pub fn params(&self) -> Vec<String> {
        let specs = (0..self.graph.count()).filter_map(|node| self.graph.spec(node).ok());
        let ids = specs.flat_map(|spec| spec.params.into_iter().map(|param| param.id.to_owned()));
        let mut ids: Vec<String> = ids.collect();
        ids.sort_unstable();
        ids.dedup();
        ids
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
                let name = format!("{}.{PARAM}", self.graph.name(node).map_err(fail)?);
                self.tracks.set(self.graph.handle(), &name, &steadiness.to_string()).map_err(fail)?;
                found = true;
            }
        }
        if !found {
            let fix = "choose a style that has the parameter steadiness, or put the node steady before it";
            return Err(Error::input(&place, "the style has no steadiness", fix));
        }
        Ok(())
    }

    /// True where a node of the graph can use pictures of a kind.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn can_use(&self, kind: Kind) -> Result<bool> {
        self.graph.can_use(kind).map_err(|e| e.at(&self.name, "choose another style"))
    }

    /// True where a node of the graph reads a guide that enters it by its name.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn takes(&self, guide: &str) -> Result<bool> {
        let json = self.graph.to_json().map_err(|e| e.at(&self.name, "choose another style"))?;
        let graph: Value = serde_json::from_str(&json).unwrap_or_default();
        let nodes = graph["nodes"].as_array().into_iter().flatten();
        let mut sources = nodes.filter_map(|node| node["inputs"].as_object()).flat_map(Map::values);
        Ok(sources.any(|source| *source == format!("@{guide}")))
    }

    /// True where a node draws lines alone, on nothing, so that results have alpha whether or not pictures have.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn draws_alone(&self) -> Result<bool> {
        let json = self.graph.to_json().map_err(|e| e.at(&self.name, "choose another style"))?;
        let graph: Value = serde_json::from_str(&json).unwrap_or_default();
        let mut nodes = graph["nodes"].as_array().into_iter().flatten();
        Ok(nodes.any(|node| node["params"]["show"] == "lines"))
    }

    /// Guides that it can use, each once, whether or not they are connected.
    ///
    /// # Errors
    /// [`Error::Failure`] when the library fails.
    pub fn usable_guides(&self, library: &Library) -> Result<Vec<Guide>> {
        let mut guides = Vec::new();
        let refused = |e: isophote_loader::Error| e.at(&self.name, "choose another style");
        // Stills read no motion.
        let is_steady = self.is_animated() || library.frames(&self.graph).map_err(refused)? != [0, 0];
        for node in 0..self.graph.count() {
            let spec = self.graph.spec(node).map_err(refused)?;
            // Three more layers of each file.
            let reads_light = self.is_animated() || self.shades_light(node, &spec)?;
            for port in spec.inputs {
                let is_read = |guide: &Guide| (guide.id(), guide.kind()) == (port.id, port.kind);
                let guide = Guide::ALL.into_iter().find(is_read);
                // Several nodes may read one.
                let is_new = |guide: &Guide| {
                    !guides.contains(guide)
                        && (is_steady || !guide.is_motion())
                        && (reads_light || !guide.is_light())
                };
                let guide = guide.filter(is_new);
                guides.extend(guide);
            }
        }
        Ok(guides)
    }

    /// True where it reads colours of surfaces or their light.
    ///
    /// # Errors
    /// As [`Style::usable_guides`].
    pub fn reads_light(&self, library: &Library) -> Result<bool> {
        Ok(self.usable_guides(library)?.into_iter().any(Guide::is_light))
    }

    /// False where a node that could shade light in steps is not set to.
    fn shades_light(&self, node: u32, spec: &Node) -> Result<bool> {
        const SHADING: &str = "shading";
        if spec.params.iter().all(|param| param.id != SHADING) {
            return Ok(true);
        }
        let refused = |e: isophote_loader::Error| e.at(&self.name, "choose another style");
        let json = self.graph.to_json().map_err(refused)?;
        let graph: Value = serde_json::from_str(&json).unwrap_or_default();
        Ok(graph["nodes"][node as usize]["params"][SHADING] == "light")
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
                        // Frames are within 2 % as steady by it as by better ones.
                        self.graph.set(from, "quality", "fast").map_err(fail)?;
                        self.graph.connect_input("color", from).map_err(fail)?;
                        *flow.insert(from)
                    }
                };
                self.graph.connect(from, node, port).map_err(fail)?;
            }
        }
        Ok(())
    }
}

/// Way to put most presets right.
pub(super) const FIX: &str = "correct the file";

/// Way to find a style.
const LIST_OF_STYLES: &str = "`isophote nodes` lists the styles, and `isophote preset list` the looks";

/// The style of a name, and the rules of its preset for things.
fn open(library: &Library, style: &OsStr) -> Result<(Tracks, Vec<ObjectRule>)> {
    if let Some(json) = style.to_str().filter(|text| preset::is_written_out(text)) {
        return Ok((open_text(library, Path::new("the graph"), json, None)?, Vec::new()));
    }
    let path = Path::new(style);
    // No node has a name that is no text.
    let name = style.to_string_lossy();
    let is_file = (looks_like_file(path) || path.exists()) && preset::id_of_look(path).is_none();
    match library.style(&name) {
        Ok(tracks) => Ok((tracks, Vec::new())),
        Err(_) if is_file => {
            let text = source::read(path)?;
            let preset = if preset::is_graph(&text) { None } else { Some(preset::parse(path, &text)?) };
            let tracks = open_text(library, path, &text, preset.as_ref())?;
            Ok((tracks, preset.map_or_else(Vec::new, |preset| preset.objects)))
        }
        Err(refused) => {
            let is_look = preset::id_of_look(path).is_some();
            let fix = if is_look { preset::LIST_OF_LOOKS } else { LIST_OF_STYLES };
            Err(preset::unknown(library, refused, path, fix))
        }
    }
}

/// The style of the text of a file; `preset` is what it says, if it is no graph. Rules for things are left out: they are
/// followed by what things cover of pixels, of which the library knows no more than whose number a pixel has.
fn open_text(library: &Library, path: &Path, text: &str, preset: Option<&Preset>) -> Result<Tracks> {
    let graph = preset.map_or(Ok(None), |preset| graph_beside(library, path, preset))?;
    let place = path.display().to_string();
    let plain = match preset.filter(|preset| !preset.objects.is_empty()) {
        Some(preset) => Some(preset::text(&Preset { objects: Vec::new(), ..preset.clone() })?),
        None => None,
    };
    let text = plain.as_deref().unwrap_or(text);
    library.style_from_json(&place, text, graph.as_deref()).map_err(|e| e.at(&place, FIX))
}

/// The text of the graph file that the preset of the file `path` names, if it names one. Of a node and a file of one name the
/// node counts.
pub(super) fn graph_beside(library: &Library, path: &Path, preset: &Preset) -> Result<Option<String>> {
    let inner = preset::style_beside(&preset.style, path);
    let named = Path::new(&inner);
    let is_no_file = preset.style.is_empty()
        || preset::is_written_out(&preset.style)
        || preset::id_of_look(named).is_some()
        || library.find_node(&preset.style).is_ok()
        || !(looks_like_file(named) || named.exists());
    if is_no_file {
        return Ok(None);
    }
    source::read(named).map(Some).map_err(|e| e.within(path))
}

/// True where the name of a style can be that of a file alone, since no node has such a name.
fn looks_like_file(style: &Path) -> bool {
    style.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) || style.components().count() > 1
}

/// True where a style is a file, and neither a node nor a look nor a graph written out. Of a node and a file of one
/// name the node counts.
pub fn is_file(style: &Path) -> bool {
    if preset::id_of_look(style).is_some() || style.to_str().is_some_and(preset::is_written_out) {
        return false;
    }
    let is_node = |library: Library| library.find_node(&style.to_string_lossy()).is_ok();
    looks_like_file(style) || style.is_file() && !Library::open().is_ok_and(is_node)
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
