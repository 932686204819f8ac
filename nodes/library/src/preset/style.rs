//! Styles: what names one, as a graph with its parameters.

use super::fault::Fault;
use super::feed::fed;
use super::file::{Preset, Track, is_graph, is_written_out};
use super::keyframes::Animated;
use super::lengths::Lengths;
use super::looks::{self, id_of_look};
use super::names;
use super::objects::ObjectRule;
use crate::declare::param::Param;
use crate::declare::spec::ImageKind;
use crate::graph::{Graph, NodeId, ThingLook};
use crate::registry;
use serde_json::Value;

/// The parameters of a graph as a style sets them, and its lengths.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    lengths: Lengths,
    /// True where the style is node 0, and the others feed it.
    is_single: bool,
    animated: Vec<Animated>,
    /// Of the looks of things, in the order of the graph's.
    looks: Vec<Settings>,
    left_out: Vec<Fault>,
}

/// Opens the node of this id, or the look that is named `look:ID`.
///
/// # Errors
/// The fault of a name that neither bears; it names the nearest.
pub fn open(name: &str) -> Result<(Graph, Settings), Fault> {
    if let Some(id) = id_of_look(name) {
        return open_json(name, looks::look(id)?.json, None);
    }
    let graph = fed(name).map_err(|error| {
        let look = looks::LOOKS.iter().find(|look| look.id == name);
        let fix = look.map_or_else(
            || "name a node, a look, or a graph file or preset (.json)".to_owned(),
            |look| format!("did you mean '{}'?", look.name()),
        );
        Fault::of(error, "", fix)
    })?;
    Ok((graph, Settings { is_single: true, ..Settings::default() }))
}

/// Opens a preset or a graph, by its text. `place` names it in messages; `graph` is the text of the graph file that the
/// preset names, if it names one. Parameters with keyframes have the value of the first.
///
/// # Errors
/// The first fault.
pub fn open_json(place: &str, json: &str, graph: Option<&str>) -> Result<(Graph, Settings), Fault> {
    if is_graph(json) {
        return Ok((graph_of(place, json, "correct the graph")?, Settings::default()));
    }
    let preset = Preset::parse(place, json)?;
    let mut faults = Vec::new();
    let opened = follow(place, &preset, graph, &mut faults)?;
    faults.into_iter().next().map_or(Ok(opened), Err)
}

/// All faults of a preset; the arguments are those of [`open_json`].
pub fn check(place: &str, json: &str, graph: Option<&str>) -> Vec<Fault> {
    let (preset, mut faults) = match Preset::examine(place, json) {
        Ok(examined) => examined,
        Err(fault) => return vec![fault],
    };
    if !preset.style.is_empty()
        && let Err(fault) = follow(place, &preset, graph, &mut faults)
    {
        faults.push(fault);
    }
    faults
}

/// The graph of a preset with its parameters. Those that it cannot take are added to `faults`.
fn follow(
    place: &str,
    preset: &Preset,
    graph: Option<&str>,
    faults: &mut Vec<Fault>,
) -> Result<(Graph, Settings), Fault> {
    let (mut graph, is_single) = inside(place, &preset.style, graph)?;
    let lengths = preset.lengths.unwrap_or_default();
    let mut settings = Settings { lengths, is_single, ..Settings::default() };
    settings.rule(&mut graph, &preset.objects);
    for (name, track) in &preset.params {
        settings.follow(&mut graph, place, (name, track), faults);
    }
    Ok((graph, settings))
}

/// The graph that a preset sets the parameters of, and true where that is a single node with what feeds it.
fn inside(place: &str, style: &str, graph: Option<&str>) -> Result<(Graph, bool), Fault> {
    let no_graph = || {
        let fix = "name a node or a graph file";
        Fault::format(place, format!("its style '{style}' is no graph"), fix)
    };
    if is_written_out(style) {
        return Ok((graph_of(place, style, "correct the graph")?, false));
    }
    if id_of_look(style).is_some() {
        return Err(no_graph());
    }
    match graph {
        // Of a node and a file of one name the node counts.
        Some(json) if registry::find(style).is_err() => {
            if !is_graph(json) {
                return Err(no_graph());
            }
            Ok((graph_of(&format!("{place}: {style}"), json, "correct the graph file")?, false))
        }
        _ => {
            let fix = "name a node or a graph file (.json), or write the graph out";
            let graph = fed(style).map_err(|error| Fault::of(error, place, fix))?;
            Ok((graph, true))
        }
    }
}

fn graph_of(place: &str, json: &str, fix: &str) -> Result<Graph, Fault> {
    Graph::from_json(json).map_err(|error| Fault::of(error, place, fix))
}

impl Settings {
    /// Meaning of the lengths of parameters.
    pub fn lengths(&self) -> Lengths {
        self.lengths
    }

    /// What the graph does not follow of rules for things, and why: the place of each is in the words of its rule.
    pub fn left_out(&self) -> &[Fault] {
        &self.left_out
    }

    /// Gives a graph the rules of a preset, and notes what it cannot follow of them.
    fn rule(&mut self, graph: &mut Graph, objects: &[ObjectRule]) {
        let mut rules = Vec::new();
        for object in objects {
            let Some(rule) = object.of_graph() else {
                let fix = "write whole names, as in cryptomatte:hero, or numbers, as in id:3";
                self.left_out.push(Fault::value(
                    &object.things,
                    "is not told by numbers or whole names",
                    fix,
                ));
                continue;
            };
            if let Some(look) = object.look() {
                match self.look(&format!("{}: its look", object.things), look, object.line_color()) {
                    Ok((look, settings)) => {
                        graph.looks_mut().push(ThingLook { things: rule.things.clone(), graph: look });
                        self.looks.push(settings);
                    }
                    Err(fault) => self.left_out.push(fault),
                }
            }
            rules.push(rule);
        }
        graph.set_rules(rules);
    }

    /// The graph of a look of things, with lines of the colour that their rule says, and its settings.
    fn look(&self, place: &str, look: &Value, line_color: Option<&str>) -> Result<(Graph, Self), Fault> {
        let (mut graph, mut settings) = match look {
            Value::String(name) => open(name).map_err(|fault| fault.at(place))?,
            written => open_json(place, &written.to_string(), None)?,
        };
        if settings.lengths != self.lengths {
            let problem = format!("has lengths that are {}", settings.lengths.id());
            let fix = format!("write \"lengths\": \"{}\" as in the preset itself", self.lengths.id());
            return Err(Fault::value(place, problem, fix));
        }
        if graph.output_kind() != Some(ImageKind::Color) {
            return Err(Fault::value(place, "makes no colours", "choose a style that makes colours"));
        }
        if let Some(color) = line_color {
            settings.set(&mut graph, "line_color", color).map_err(|fault| fault.at(place))?;
            // Where kinds of lines may have colours of their own.
            if names::find(&graph, settings.is_single, "line_colors").is_ok() {
                settings.set(&mut graph, "line_colors", "one").map_err(|fault| fault.at(place))?;
            }
        }
        Ok((graph, settings))
    }

    /// Sets a parameter for all frames, by the name that a preset has for it. Returns its node.
    ///
    /// # Errors
    /// A fault without a place: no such parameter, or a value that it cannot have.
    pub fn set(&mut self, graph: &mut Graph, name: &str, text: &str) -> Result<NodeId, Fault> {
        let (node, param) = self.put(graph, name, text)?;
        self.animated.retain(|a| (a.node, a.param) != (node, param.id));
        Ok(node)
    }

    /// Gives parameters with keyframes their values at a frame. Returns true where there are any.
    ///
    /// # Errors
    /// The fault of a value that a parameter cannot have, which its keys have not shown.
    pub fn at_frame(&self, graph: &mut Graph, frame: i64) -> Result<bool, Fault> {
        for animated in &self.animated {
            let set = graph.set_text(animated.node, animated.param, &animated.at(frame));
            set.map_err(|error| {
                let place = format!("parameter '{}' at frame {frame}", animated.name);
                Fault::of(error, place, "choose other keys")
            })?;
        }
        let mut is_animated = !self.animated.is_empty();
        for (look, settings) in graph.looks_mut().iter_mut().zip(&self.looks) {
            is_animated |= settings.at_frame(&mut look.graph, frame)?;
        }
        Ok(is_animated)
    }

    /// The value at a frame, as text, of the parameter with keyframes that the preset names so.
    pub fn value(&self, name: &str, frame: i64) -> Option<String> {
        self.animated.iter().find(|animated| animated.name == name).map(|animated| animated.at(frame))
    }

    /// Frames of all keys, in order, each once.
    pub fn frames(&self) -> Vec<i64> {
        let mut frames: Vec<i64> = self.animated.iter().flat_map(Animated::frames).collect();
        frames.extend(self.looks.iter().flat_map(Self::frames));
        frames.sort_unstable();
        frames.dedup();
        frames
    }

    /// Takes over the track of a parameter. What it cannot take is added to `faults`.
    fn follow(
        &mut self,
        graph: &mut Graph,
        place: &str,
        (name, track): (&str, &Track),
        faults: &mut Vec<Fault>,
    ) {
        let place = format!("{place}: parameter '{name}'");
        match track {
            Track::Still(text) => {
                faults.extend(self.set(graph, name, text).err().map(|fault| fault.at(&place)))
            }
            Track::Keys { keys, step } => {
                let mut refused = Vec::new();
                let mut animated = None;
                // From the last to the first, whose value stays.
                for (frame, text) in keys.iter().rev() {
                    match self.put(graph, name, text) {
                        Ok(found) => animated = Some(found),
                        Err(fault) => refused.push(fault.at(format!("{place} at frame {frame}"))),
                    }
                }
                faults.extend(refused.into_iter().rev());
                let Some((node, param)) = animated else { return };
                self.animated.retain(|a| (a.node, a.param) != (node, param.id));
                match Animated::new(&place, (name, node, param), keys, *step) {
                    Ok(animated) => self.animated.push(animated),
                    Err(fault) => faults.push(fault),
                }
            }
        }
    }

    /// Sets a parameter of the graph by its name.
    fn put(&self, graph: &mut Graph, name: &str, text: &str) -> Result<(NodeId, &'static Param), Fault> {
        let named = names::find(graph, self.is_single, name)?;
        let spec = graph.spec(named.node).map_err(|error| Fault::of(error, "", ""))?;
        let set = graph.set_text(named.node, named.param, text);
        set.map_err(|error| {
            let fix = format!("see the parameters of '{}'", spec.id);
            Fault::of(error, "", fix).about_node(spec.id)
        })?;
        let (_, param) =
            spec.param(named.param).ok_or_else(|| Fault::unknown("", "is no name", "name a parameter"))?;
        Ok((named.node, param))
    }
}
