//! Colours of a file as those of the nodes `palette` of a style.

use std::path::Path;

use serde_json::Value;

use super::style::{Setting, Style};
use isophote_files::error::{AtPlace, Error, Result};
use isophote_loader::catalogue::{Choice, Kind, Node, Param, ParamKind};
use isophote_loader::{Graph, Library};
use isophote_pictures::palette::{self, Palette, Wanted, hex};

/// Id of the node, and of its choice of a palette.
const NODE: &str = "palette";
/// Option of that choice for colours of one's own.
const OWN: &str = "own";
/// Beginning of the ids of these colours; a number from 1 follows.
const COLOUR: &str = "color_";
/// Way to find a style that draws with them.
const FIX: &str = "choose the style palette, or one that has a node of it";

/// Colours that nodes `palette` draw in.
#[derive(Clone, Debug)]
pub enum Colours {
    /// Those of a file.
    Own(Palette),
    /// Those of a palette that ships, by its id.
    Shipped(String),
}

impl Colours {
    /// Their name.
    pub fn name(&self) -> &str {
        match self {
            Self::Own(palette) => &palette.name,
            Self::Shipped(id) => id,
        }
    }

    /// What is to be said of them.
    pub fn notes(&self) -> &[String] {
        match self {
            Self::Own(palette) => &palette.notes,
            Self::Shipped(_) => &[],
        }
    }
}

/// Colours of a file, as many as the node takes, or those of a palette that ships. Of the two of one name the latter counts.
///
/// # Errors
/// As [`palette::read`]; [`Error::Input`] for a `count` that the node does not take, or of a palette that ships.
pub fn read(library: &Library, path: &Path, count: Option<usize>) -> Result<Colours> {
    let node = library.find_node(NODE).map_err(|e| e.at("--palette", "use the library of this program"))?;
    let most = node.params.iter().filter(|param| param.id.starts_with(COLOUR)).count();
    if let Some(count) = count.filter(|count| *count > most) {
        let problem = format!("a style takes {most} colours at most");
        return Err(Error::input(
            format!("--palette-count {count}"),
            problem,
            format!("give a number from 2 to {most}"),
        ));
    }
    let ids = shipped(&node);
    if let Some(id) = ids.iter().find(|id| path.as_os_str() == id.as_str()) {
        return match count {
            None => Ok(Colours::Shipped(id.clone())),
            Some(count) => {
                let problem = format!("{id} is a palette that ships, whose number of colours is its own");
                Err(Error::input(format!("--palette-count {count}"), problem, "leave it out, or name a file"))
            }
        };
    }
    if may_be_id(path) && !path.exists() {
        let fix = format!("name a file, or choose from {}", ids.join(", "));
        return Err(Error::input(
            format!("--palette {}", path.display()),
            "is no file and no palette that ships",
            fix,
        ));
    }
    palette::read(path, Wanted { count, most }).map(Colours::Own)
}

/// True where a name is that of a file, and of no palette that ships.
pub fn is_file(name: &Path) -> bool {
    let ids = |library: Library| library.find_node(NODE).map(|node| shipped(&node));
    let ships = |ids: Vec<String>| ids.iter().any(|id| name.as_os_str() == id.as_str());
    !may_be_id(name) || !Library::open().is_ok_and(|library| ids(library).is_ok_and(ships))
}

/// True for a path of one part without an extension.
fn may_be_id(path: &Path) -> bool {
    path.components().count() == 1 && path.extension().is_none()
}

/// True for the parameter by which the node chooses a palette, and colours of one's own as well.
pub fn chooses(param: &Param) -> bool {
    let has_own = |options: &[Choice]| options.iter().any(|option| option.id == OWN);
    param.id == NODE && matches!(&param.kind, ParamKind::Choice { options, .. } if has_own(options))
}

/// Ids of the palettes that ship.
fn shipped(node: &Node) -> Vec<String> {
    let choices = node.params.iter().filter(|param| param.id == NODE);
    let options = choices.filter_map(|param| match &param.kind {
        ParamKind::Choice { options, .. } => Some(options),
        _ => None,
    });
    options.flatten().map(|option| option.id.to_string()).filter(|id| id != OWN).collect()
}

impl Style {
    /// Makes the style of `name` as [`Style::load`] does, with the colours of a palette where there is one: one that ships is given to
    /// a node that draws with such by itself, and otherwise a style that has no node for it gets one at its end. Settings come after them.
    ///
    /// # Errors
    /// As [`Style::load`] and [`Style::colour_by`].
    pub fn load_in(
        library: &Library,
        name: &Path,
        palette: Option<&Colours>,
        settings: &[Setting],
    ) -> Result<Self> {
        let Some(palette) = palette else { return Self::load(library, name, settings) };
        let mut style = Self::load(library, name, &[])?;
        // Settings of a node need it.
        if settings.iter().any(|setting| setting.node.as_deref() == Some(NODE)) {
            style.end_in(palette)?;
        } else {
            style.draw_in(palette)?;
        }
        settings.iter().try_for_each(|setting| style.set(setting))?;
        Ok(style)
    }

    /// Draws in the colours of a palette: by its only node where that draws by itself with such as ship, otherwise by a node at its end.
    ///
    /// # Errors
    /// As [`Style::colour_by`].
    pub fn draw_in(&mut self, palette: &Colours) -> Result<()> {
        match self.own_setting(palette)? {
            Some(own) => self.set(&own),
            None => self.end_in(palette),
        }
    }

    /// Setting of its only node that makes it draw with a palette that ships.
    fn own_setting(&self, palette: &Colours) -> Result<Option<Setting>> {
        let Colours::Shipped(id) = palette else { return Ok(None) };
        if self.graph.count() != 1 {
            return Ok(None);
        }
        let spec = self.graph.spec(0).map_err(|e| e.at(&self.name, FIX))?;
        let has = |options: &[Choice]| options.iter().any(|option| option.id == *id);
        let draws = |param: &Param| {
            param.id == NODE && matches!(&param.kind, ParamKind::Choice { options, .. } if has(options))
        };
        let own = || Setting { node: None, param: NODE.into(), value: id.clone() };
        Ok(spec.params.iter().any(draws).then(own))
    }

    /// Draws its result in the colours of a palette, by a node of its own where it has none and yields colours.
    ///
    /// # Errors
    /// As [`Style::colour_by`].
    fn end_in(&mut self, palette: &Colours) -> Result<()> {
        let is_masked = self.takes("mask")?;
        let Self { graph, name, kind, .. } = self;
        end_in_palette(graph, *kind, is_masked).map_err(|e| e.at(name, FIX))?;
        self.colour_by(palette)
    }

    /// Gives its nodes `palette` the colours of a palette.
    ///
    /// # Errors
    /// [`Error::Input`] where it has no such node.
    pub fn colour_by(&self, palette: &Colours) -> Result<()> {
        self.palette_settings(palette)?.iter().try_for_each(|setting| self.set(setting))
    }

    /// Settings that give it the colours of a palette: its only node, where that draws by itself with such as ship, or its nodes `palette`.
    ///
    /// # Errors
    /// [`Error::Input`] where it has neither.
    pub fn palette_settings(&self, palette: &Colours) -> Result<Vec<Setting>> {
        if let Some(own) = self.own_setting(palette)? {
            return Ok(vec![own]);
        }
        let refused = |e: isophote_loader::Error| e.at(&self.name, FIX);
        let mut settings = Vec::new();
        for node in 0..self.graph.count() {
            if self.graph.spec(node).map_err(refused)?.id != NODE {
                continue;
            }
            // Presets of a node alone have parameters without its name.
            let is_alone = self.graph.count() == 1;
            let name = self.graph.name(node).map_err(refused)?;
            let name = Some(name).filter(|_| !is_alone);
            let mut set = |param: String, value: String| {
                settings.push(Setting { node: name.clone(), param, value });
            };
            match palette {
                Colours::Own(palette) => {
                    set(NODE.into(), OWN.into());
                    set("count".into(), palette.colours.len().to_string());
                    for (number, colour) in (1..).zip(&palette.colours) {
                        set(format!("{COLOUR}{number}"), hex(*colour));
                    }
                }
                Colours::Shipped(id) => set(NODE.into(), id.clone()),
            }
        }
        if settings.is_empty() {
            let problem = format!("the style {} draws with no palette", self.name);
            return Err(Error::input("--palette", problem, FIX));
        }
        Ok(settings)
    }
}

/// Draws the result of a graph by a node `palette`, where it has none and yields colours.
fn end_in_palette(graph: &mut Graph, kind: Kind, is_masked: bool) -> isophote_loader::Result<()> {
    let (mut names, mut has_node) = (Vec::new(), false);
    for node in 0..graph.count() {
        names.push(graph.name(node)?);
        has_node |= graph.spec(node)?.id == NODE;
    }
    if kind != Kind::Color || has_node {
        return Ok(());
    }
    let json: Value = serde_json::from_str(&graph.to_json()?).unwrap_or_default();
    let output = names.iter().position(|name| json["output"] == name.as_str()).unwrap_or_default();
    let mut own = NODE.to_owned();
    while names.contains(&own) {
        own.push('_');
    }
    let node = graph.add(&own, NODE)?;
    graph.connect(output as u32, node, "color")?;
    // What a mask leaves out keeps its own colours.
    if is_masked {
        graph.connect_input("mask", node)?;
    }
    graph.set_output(node)
}
