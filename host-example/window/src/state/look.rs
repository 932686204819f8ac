//! A look: a style with the values of its parameters, as it is edited, saved and handed to other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::Value as Json;

use super::chain::{Chain, Watched};
use super::rules;
use super::values::{ParamValue, TypedPreset, Values};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_files::files::{self, Existing};
use isophote_finishing::stylize::preset::{self, Preset, Title};
use isophote_finishing::stylize::source;
use isophote_finishing::stylize::style::{Setting, Style};
use isophote_finishing::stylize::value::Value;
use isophote_loader::Library;
use isophote_loader::catalogue::{Choice, Node, Param};

/// The style that leaves pictures as they are.
pub const PLAIN: &str = "none";

/// A style with the values of its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct EditedLook {
    /// Name for people.
    pub name: String,
    /// Name that it was opened by: the id of a node, or the path of a graph file or preset.
    pub source: PathBuf,
    /// Style and parameters. The paths of graph files are relative to `source`.
    pub preset: TypedPreset,
    /// Preset that `source` gives by itself.
    opened: TypedPreset,
    /// Content of the graph file that it was opened with.
    graph: Option<Arc<str>>,
}

/// Mark between a style and one of its media in the name that a medium is opened by.
const OF_STYLE: char = ':';

/// Name that a medium of a style is opened by.
pub fn medium_source(style: &Node, medium: &Choice) -> PathBuf {
    format!("{}{OF_STYLE}{}", style.id, medium.id).into()
}

/// Name and preset of the medium that is opened by a name, if it is one.
fn medium(library: &Library, name: &str) -> Option<(String, TypedPreset)> {
    let (style, medium) = name.split_once(OF_STYLE)?;
    let node = library.find_node(style).ok()?;
    let (param, option) = node.media().find(|(_, option)| option.id == medium)?;
    let mut preset = TypedPreset::bare(style.to_owned());
    preset.params.set(param.id, &Value::Choice(option.id.to_owned()));
    Some((option.label.to_owned(), preset))
}

/// One parameter of a look that can be changed.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name in presets and for `--set`.
    pub name: String,
    /// Index of the node within the graph.
    pub node: u32,
    /// The label of the node, for graphs of several.
    pub of: &'static str,
    /// Declaration of the parameter by its node.
    pub param: Param,
    /// The value that it has where the look says nothing.
    pub default: Value,
}

impl EditedLook {
    /// The look that leaves pictures as they are.
    pub fn plain() -> Self {
        let preset = TypedPreset::bare(String::new());
        Self { name: "Original".into(), source: PLAIN.into(), opened: preset.clone(), preset, graph: None }
    }

    /// Opens a node, a graph file or a preset, or the plain look by its name, and checks that it can be shown.
    ///
    /// # Errors
    /// As [`Style::load`].
    pub fn open(library: &Library, path: &Path) -> Result<Self> {
        if path == Path::new(PLAIN) {
            return Ok(Self::plain());
        }
        let id = path.to_str().unwrap_or_default();
        let node =
            library.find_node(id).map(|node| (node.label.to_owned(), TypedPreset::bare(node.id.to_owned())));
        let (name, preset) = match node.ok().or_else(|| medium(library, id)) {
            Some(plain) => plain,
            // Whatever is no node may be a file; if it is not, this says so in the best words.
            None => {
                Style::load(library, path, &[])?;
                let text = source::read(path)?;
                let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let preset = match preset::is_graph(&text) {
                    true => TypedPreset::bare(file),
                    false => TypedPreset::parse(path, &text)?,
                };
                let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                (preset.title.name.clone().unwrap_or(stem), preset)
            }
        };
        let mut look = Self { name, source: path.to_owned(), opened: preset.clone(), preset, graph: None };
        look.style(library)?;
        let parameters = look.parameters(library)?;
        look.use_names_of(&parameters);
        let named = |name: &str| parameters.iter().find(|parameter| parameter.name == name);
        look.preset.params.take_types(|name| named(name).map(|parameter| &parameter.param.kind));
        look.opened = look.preset.clone();
        look.graph = look.graph_file().map(|file| source::read(&file)).transpose()?.map(Into::into);
        Ok(look)
    }

    /// True where pictures stay as they are.
    pub fn is_plain(&self) -> bool {
        self.preset.style.is_empty()
    }

    /// True where it has rules for things.
    pub fn has_rules(&self) -> bool {
        !self.preset.objects.is_empty()
    }

    /// The style as the library knows it; none for the plain look.
    ///
    /// # Errors
    /// As [`Style::of_preset`].
    pub fn style(&self, library: &Library) -> Result<Option<Style>> {
        if self.is_plain() {
            return Ok(None);
        }
        Style::of_preset(library, &self.source, &self.preset.written()).map(Some)
    }

    /// All parameters, in the order of the nodes and their declarations.
    ///
    /// # Errors
    /// As [`Style::of_preset`].
    pub fn parameters(&self, library: &Library) -> Result<Vec<Parameter>> {
        let bare =
            Self { preset: TypedPreset { params: Values::default(), ..self.preset.clone() }, ..self.clone() };
        let Some(style) = bare.style(library)? else { return Ok(Vec::new()) };
        let failed = |e: isophote_loader::Error| e.at(&self.name, "choose another look");
        let is_single = library.find_node(&self.preset.style).is_ok();
        let own = style.graph.to_json().map_err(failed)?;
        let own: Json = serde_json::from_str(&own).unwrap_or_default();
        let mut parameters = Vec::new();
        for node in 0..style.graph.count() {
            let name = style.graph.name(node).map_err(failed)?;
            let spec = style.graph.spec(node).map_err(failed)?;
            let set = own["nodes"].as_array().into_iter().flatten().find(|entry| entry["name"] == *name);
            for param in spec.params {
                let given =
                    set.and_then(|entry| Value::parse(&param.kind, &text_of(&entry["params"][param.id])));
                let Some(default) = given.or_else(|| Value::default(&param.kind)) else { continue };
                let name =
                    if is_single && node == 0 { param.id.into() } else { format!("{name}.{}", param.id) };
                parameters.push(Parameter { name, node, of: spec.label, param, default });
            }
        }
        Ok(parameters)
    }

    /// Writes all values under the names of these parameters; presets may leave out the node where only one has it.
    fn use_names_of(&mut self, parameters: &[Parameter]) {
        self.preset.params.rename(|name| {
            if parameters.iter().any(|parameter| parameter.name == name) {
                return None;
            }
            let parameter = parameters.iter().find(|parameter| parameter.param.id == name)?;
            Some(parameter.name.clone())
        });
    }

    /// The value of a parameter at the first keyframe, or everywhere.
    pub fn value(&self, parameter: &Parameter) -> Value {
        let given = self.preset.params.get(&parameter.name);
        let value = given.and_then(|given| given.first(&parameter.param.kind));
        value.unwrap_or_else(|| parameter.default.clone())
    }

    /// True where a parameter changes from frame to frame.
    pub fn is_animated(&self, parameter: &Parameter) -> bool {
        self.preset.params.get(&parameter.name).is_some_and(ParamValue::is_animated)
    }

    /// True where a parameter is not what it is where nobody changes it.
    pub fn differs(&self, parameter: &Parameter) -> bool {
        self.is_animated(parameter) || self.value(parameter) != parameter.default
    }

    /// Gives a parameter one value for all frames.
    pub fn set(&mut self, parameter: &Parameter, value: &Value) {
        if self.is_as_chosen(parameter, value) {
            self.take_back(parameter);
        } else if *value == parameter.default {
            self.reset(parameter);
        } else {
            self.preset.params.set(&parameter.name, value);
        }
    }

    /// Gives a parameter its default.
    pub fn reset(&mut self, parameter: &Parameter) {
        self.preset.params.remove(&parameter.name);
    }

    /// Takes a setting of the command line over, if there is such a parameter.
    pub fn take(&mut self, parameters: &[Parameter], setting: &Setting) {
        let is_meant = |parameter: &&Parameter| match &setting.node {
            Some(node) => parameter.name == format!("{node}.{}", setting.param),
            None => parameter.param.id == setting.param,
        };
        let Some(parameter) = parameters.iter().find(is_meant) else { return };
        if let Some(value) = Value::parse(&parameter.param.kind, &setting.value) {
            self.set(parameter, &value);
        }
    }

    /// Preset that it was opened or saved as.
    pub fn opened(&self) -> &TypedPreset {
        &self.opened
    }

    /// True where it is not what it was opened or saved as.
    pub fn is_changed(&self) -> bool {
        !self.preset.says_the_same(&self.opened)
    }

    /// The file of its graph, if it has one.
    fn graph_file(&self) -> Option<PathBuf> {
        Some(self.style_name()).filter(|path| !self.is_written_out() && is_json(path))
    }

    /// The files that it was opened from.
    pub fn files(&self) -> Vec<PathBuf> {
        let own = Some(self.source.clone()).filter(|path| is_json(path));
        let mut files: Vec<PathBuf> = own.into_iter().chain(self.graph_file()).collect();
        files.dedup();
        files
    }

    /// True where it and another look were opened from files that say the same.
    pub fn has_origin_of(&self, other: &Self) -> bool {
        self.opened == other.opened && self.has_graph_of(other)
    }

    /// True where it and another look were opened with the same graph file.
    pub fn has_graph_of(&self, other: &Self) -> bool {
        self.graph == other.graph
    }

    /// True where its file is a graph, which has no name of its own.
    pub fn is_graph(&self) -> bool {
        is_json(&self.source) && self.source.file_name().is_some_and(|file| *file == *self.opened.style)
    }

    /// Its file has this title from now on.
    pub fn retitle(&mut self, title: &Title) {
        self.preset.title = title.clone();
        self.opened.title = title.clone();
        self.name = self.shown_name();
    }

    /// Name for people: its own, or that of the file.
    fn shown_name(&self) -> String {
        let stem = || self.source.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        self.preset.title.name.clone().unwrap_or_else(stem)
    }

    /// True where its graph is a part of it and no file.
    pub fn is_written_out(&self) -> bool {
        preset::is_written_out(&self.preset.style)
    }

    /// The graph that makes what was opened into it, where another graph is needed.
    pub fn rebuilt(&self) -> Option<&str> {
        (self.preset.style != self.opened.style).then_some(self.preset.style.as_str())
    }

    /// The list of nodes that the graph is, if it is one.
    ///
    /// # Errors
    /// As [`Style::of_preset`].
    pub fn chain(&self, library: &Library) -> Result<Option<Chain>> {
        if self.is_plain() {
            return Ok(None);
        }
        if self.is_written_out() {
            return Ok(Chain::read(library, &self.preset.style));
        }
        let bare =
            Self { preset: TypedPreset { params: Values::default(), ..self.preset.clone() }, ..self.clone() };
        let Some(style) = bare.style(library)? else { return Ok(None) };
        let json = style
            .graph
            .to_json()
            .map_err(|e: isophote_loader::Error| e.at(&self.name, "choose another look"))?;
        Ok(Chain::read(library, &json))
    }

    /// The look with another list of nodes; values of nodes that stay are kept.
    ///
    /// # Errors
    /// [`Error::Input`] for lists that yield no picture, such as those with a node of lines amid nodes of colours.
    pub fn with_chain(&self, library: &Library, chain: &Chain) -> Result<Self> {
        let mut look = self.clone();
        look.preset.style = chain.json();
        if !self.is_written_out() && library.find_node(&self.preset.style).is_ok() {
            // A node on its own has parameters without a name before them.
            let style = &self.preset.style;
            look.preset.params.rename(|name| (!name.contains('.')).then(|| format!("{style}.{name}")));
        }
        look.preset.params.retain(|name| name.rsplit_once('.').is_some_and(|(node, _)| chain.has(node)));
        look.style(library)?;
        Ok(look)
    }

    /// The look as a part of its list shows it.
    pub fn watched(&self, library: &Library, chain: &Chain, watched: &Watched) -> Result<Self> {
        let look = self.with_chain(library, chain)?;
        // Rules are for the picture that the whole list makes.
        let objects = Vec::new();
        let preset = TypedPreset { style: chain.watched(watched), objects, ..look.preset };
        Ok(Self { preset, ..look })
    }

    /// True for a medium of a style, whose name no other program knows.
    fn is_medium(&self) -> bool {
        let source = self.source.to_str().and_then(|source| source.split_once(OF_STYLE));
        source.is_some_and(|(style, _)| style == self.opened.style)
    }

    /// The style of a command line that makes it: what it was opened as, or another graph.
    pub fn commanded(&self) -> PathBuf {
        match self.rebuilt() {
            Some(graph) => graph.into(),
            None if self.is_medium() => self.opened.style.clone().into(),
            None => self.source.clone(),
        }
    }

    /// Settings that turn the style of a command line into it.
    pub fn settings(&self, parameters: &[Parameter]) -> Vec<String> {
        // Of another graph nothing is set yet.
        let opened = Some(&self.opened.params).filter(|_| self.rebuilt().is_none() && !self.is_medium());
        let is_changed = |parameter: &&Parameter| {
            let before = opened.and_then(|opened| opened.get(&parameter.name));
            before != self.preset.params.get(&parameter.name)
        };
        let text = |parameter: &Parameter| format!("{}={}", parameter.name, self.value(parameter).text());
        parameters.iter().filter(is_changed).map(text).collect()
    }

    /// Name of the style for `apply` and `render`: the id of a node, or the path of a graph file.
    pub fn style_name(&self) -> PathBuf {
        preset::style_beside(&self.preset.style, &self.source).into()
    }

    /// The preset as it can be read from anywhere: the paths of its graph file and of looks of things are absolute.
    ///
    /// # Errors
    /// [`Error::Input`] for paths that no preset can hold.
    pub fn whole(&self) -> Result<Preset> {
        let preset = self.preset.written();
        let style = rules::whole_name(&preset.style, &self.source)?;
        let objects = rules::whole(&preset.objects, &self.source)?;
        Ok(Preset { style, objects, ..preset })
    }

    /// Writes the look as a preset with a title, and is what is in that file from then on.
    ///
    /// # Errors
    /// [`Error::Input`] for names that do not end in .json or that no preset can hold, [`Error::Failure`] when the disk
    /// refuses.
    pub fn save(&mut self, file: &Path, title: Title) -> Result<()> {
        if !is_json(file) {
            return Err(Error::file(file, "is no name of a look", "end it in .json"));
        }
        let mut preset = TypedPreset { title, ..self.preset.clone() };
        if self.source.parent() != file.parent() {
            let whole = self.whole()?;
            (preset.style, preset.objects) = (whole.style, whole.objects);
        }
        let text = preset::text(&preset.written())?;
        files::write_bytes(file, Existing::Replace, text.as_bytes())?;
        self.opened = preset.clone();
        self.preset = preset;
        self.source = file.to_owned();
        self.name = self.shown_name();
        Ok(())
    }
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

/// A value of a graph file as people write it.
fn text_of(json: &Json) -> String {
    match json {
        Json::String(text) => text.clone(),
        Json::Array(parts) => parts.iter().map(Json::to_string).collect::<Vec<_>>().join(","),
        Json::Null => String::new(),
        other => other.to_string(),
    }
}
