//! A graph as a list: nodes that follow one another from the picture to the look, each of which can be passed by.
//!
//! Nodes that are passed by stay in the graph, fed as the others are, and nothing reads what they give; so the file of the
//! graph is all that there is to remember. Beside the list there may be nodes that feed it and read pictures alone, such as
//! a structure tensor.

use serde_json::{Map, Value as Json, json};

use isophote_files::error::{AtPlace, Error, Result};
use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;
use isophote_loader::catalogue::{Kind, Node};

/// The input that follows the list.
const MAIN: &str = "color";
/// The picture that enters the list.
const SOURCE: &str = "@color";

/// One node of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name within the graph.
    pub name: String,
    /// Name for people.
    pub label: &'static str,
    /// True where the picture passes it by.
    pub bypassed: bool,
    /// True where another node can follow it.
    pub is_colour: bool,
    entry: Map<String, Json>,
}

/// Part of the list that is looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Watched {
    /// The picture as it leaves the node of this name.
    After(String),
    /// The node of this name alone, on the picture that enters the list.
    Alone(String),
}

impl Watched {
    /// The name of the node.
    pub fn node(&self) -> &str {
        let (Self::After(name) | Self::Alone(name)) = self;
        name
    }
}

/// A list of nodes, at least one of which is not passed by.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The nodes in order.
    pub links: Vec<Link>,
    feeders: Vec<Map<String, Json>>,
}

impl Chain {
    /// The list that a graph is, if it is one.
    pub fn read(library: &Library, json: &str) -> Option<Self> {
        let file: Json = serde_json::from_str(json).ok()?;
        let mut entries: Vec<Map<String, Json>> = file["nodes"]
            .as_array()?
            .iter()
            .map(|entry| entry.as_object().cloned())
            .collect::<Option<_>>()?;
        let path = path(&entries, file["output"].as_str()?)?;
        let feeds = |name: &str| {
            let mut inputs = entries.iter().flat_map(inputs);
            inputs.any(|(port, source)| source == name && port != MAIN)
        };
        let is_feeder = |entry: &Map<String, Json>| feeds(name_of(entry)) || input(entry, MAIN).is_none();
        let names: Vec<String> =
            entries.iter().filter(|entry| is_feeder(entry)).map(|entry| name_of(entry).to_owned()).collect();
        if names.iter().any(|name| path.contains(name)) {
            return None;
        }
        let (feeders, mut listed): (Vec<_>, Vec<_>) =
            entries.drain(..).partition(|entry| names.iter().any(|name| name == name_of(entry)));
        let knows = |source: &str| source.starts_with('@') || names.iter().any(|name| name == source);
        let is_plain = feeders.iter().flat_map(inputs).all(|(_, source)| knows(source))
            && listed.iter().flat_map(inputs).all(|(port, source)| port == MAIN || knows(source));
        if !is_plain {
            return None;
        }
        let mut links = Vec::new();
        for source in std::iter::once(SOURCE).chain(path.iter().map(String::as_str)) {
            let mut take = |is_meant: &dyn Fn(&Map<String, Json>) -> bool, bypassed| {
                let (taken, rest) = listed.drain(..).partition(is_meant);
                listed = rest;
                let taken: Vec<Map<String, Json>> = taken;
                links.extend(taken.into_iter().map(|entry| (entry, bypassed)));
            };
            take(&|entry| name_of(entry) == source, false);
            take(&|entry| !is_on(&path, entry) && input(entry, MAIN) == Some(source), true);
        }
        let links = links.into_iter().map(|(entry, bypassed)| Link::new(library, entry, bypassed));
        // What is left follows a node that is itself passed by.
        listed.is_empty().then(|| Some(Self { links: links.collect::<Option<_>>()?, feeders }))?
    }

    /// The graph of the whole list.
    pub fn json(&self) -> String {
        self.graph(|_, link| !link.bypassed, None)
    }

    /// The graph of what is looked at; of the whole list, where the node is there no more.
    pub fn watched(&self, watched: &Watched) -> String {
        let Some(at) = self.find(watched.node()) else { return self.json() };
        match watched {
            Watched::After(_) => self.graph(|index, link| !link.bypassed || index == at, Some(at)),
            Watched::Alone(_) => self.graph(|index, _| index == at, Some(at)),
        }
    }

    /// The place of the node of a name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// The graph in which the nodes that `is_on` names are passed through, up to `last`.
    fn graph(&self, is_on: impl Fn(usize, &Link) -> bool, last: Option<usize>) -> String {
        let (mut before, mut output) = (SOURCE, SOURCE);
        let mut nodes = Vec::new();
        for (index, link) in self.links.iter().enumerate() {
            let mut entry = link.entry.clone();
            entry.entry("inputs").or_insert_with(|| json!({}))[MAIN] = before.into();
            nodes.push(Json::Object(entry));
            if is_on(index, link) {
                before = &link.name;
                if last.is_none_or(|last| index <= last) {
                    output = before;
                }
            }
        }
        nodes.extend(self.feeders.iter().cloned().map(Json::Object));
        json!({ "format": "isophote-graph", "version": 1, "nodes": nodes, "output": output }).to_string()
    }

    /// Adds a node at a place, with what feeds it, and returns its name.
    ///
    /// # Errors
    /// [`Error::Input`] for nodes that do not fit.
    pub fn add(&mut self, library: &Library, node: &str, at: usize) -> Result<String> {
        let json = Style::load(library, node, &[])?.graph.to_json();
        let json = json.map_err(|e| e.at(node, "choose another node"))?;
        let chain = Self::read(library, &json).filter(|chain| chain.links.len() == 1);
        let Some(Self { mut links, feeders }) = chain else {
            return Err(unfit(node, "it takes no picture or yields none"));
        };
        let Some(mut link) = links.pop() else { return Err(unfit(node, "it is none")) };
        for mut feeder in feeders {
            let old = name_of(&feeder).to_owned();
            let known = self.feeders.iter().find(|known| known.get("node") == feeder.get("node"));
            let name = match known {
                Some(known) => name_of(known).to_owned(),
                None => {
                    let name = self.free(&old);
                    feeder.insert("name".into(), name.as_str().into());
                    self.feeders.push(feeder);
                    name
                }
            };
            for source in link.entry.get_mut("inputs").and_then(Json::as_object_mut).into_iter().flatten() {
                if *source.1 == old.as_str() {
                    *source.1 = name.as_str().into();
                }
            }
        }
        link.name = self.free(node);
        link.entry.insert("name".into(), link.name.as_str().into());
        let name = link.name.clone();
        self.links.insert(at.min(self.links.len()), link);
        Ok(name)
    }

    /// A name like this one that no node has.
    fn free(&self, name: &str) -> String {
        let is_taken = |name: &str| {
            self.find(name).is_some() || self.feeders.iter().any(|feeder| name_of(feeder) == name)
        };
        let mut names = std::iter::once(name.to_owned()).chain((2..).map(|n| format!("{name}_{n}")));
        names.find(|name| !is_taken(name)).unwrap_or_default()
    }

    /// Takes a node away, with what fed it alone, if one is left that is not passed by.
    pub fn remove(&mut self, at: usize) -> bool {
        let is_last = !self.links.iter().enumerate().any(|(index, link)| index != at && !link.bypassed);
        if is_last || at >= self.links.len() {
            return false;
        }
        self.links.remove(at);
        while let Some(idle) = self.feeders.iter().position(|feeder| !self.is_read(name_of(feeder))) {
            self.feeders.remove(idle);
        }
        true
    }

    fn is_read(&self, name: &str) -> bool {
        let entries = self.links.iter().map(|link| &link.entry).chain(&self.feeders);
        entries.flat_map(inputs).any(|(_, source)| source == name)
    }

    /// Moves a node to another place.
    pub fn shift(&mut self, from: usize, to: usize) {
        if from < self.links.len() && to < self.links.len() {
            let link = self.links.remove(from);
            self.links.insert(to, link);
        }
    }

    /// Passes a node by or not, if one is left that is not passed by.
    pub fn toggle(&mut self, at: usize) -> bool {
        let is_last = !self.links.iter().enumerate().any(|(index, link)| index != at && !link.bypassed);
        if is_last {
            return false;
        }
        if let Some(link) = self.links.get_mut(at) {
            link.bypassed ^= true;
        }
        true
    }

    /// Best place for a new node: at the end, or before a last node that yields no colours.
    pub fn end(&self) -> usize {
        let before = self.links.last().is_some_and(|link| !link.is_colour);
        self.links.len() - usize::from(before)
    }

    /// True where there is a node of this name, in the list or beside it.
    pub fn has(&self, name: &str) -> bool {
        self.find(name).is_some() || self.feeders.iter().any(|feeder| name_of(feeder) == name)
    }
}

impl Link {
    fn new(library: &Library, entry: Map<String, Json>, bypassed: bool) -> Option<Self> {
        let node = library.find_node(entry.get("node")?.as_str()?).ok()?;
        let takes = node.inputs.iter().any(|port| port.id == MAIN && port.kind == Kind::Color);
        let name = name_of(&entry).to_owned();
        let is_colour = node.output.kind == Kind::Color;
        takes.then_some(Self { name, label: node.label, bypassed, is_colour, entry })
    }
}

/// The nodes that can be put into a list: from colours to colours, with nothing else that nobody could give them.
pub fn fitting(library: &Library) -> Vec<Node> {
    let nodes = library.catalogue().map(|catalogue| catalogue.nodes).unwrap_or_default();
    let fits = |node: &Node| {
        let mut chain = Chain { links: Vec::new(), feeders: Vec::new() };
        let added = node.output.kind == Kind::Color && chain.add(library, node.id, 0).is_ok();
        let given = |port: &str| chain.links.first().is_some_and(|link| input(&link.entry, port).is_some());
        added && node.inputs.iter().all(|port| port.optional || given(port.id))
    };
    nodes.into_iter().filter(fits).collect()
}

/// Names of the nodes from the picture that enters to the output, which follow one another by their main inputs.
fn path(entries: &[Map<String, Json>], output: &str) -> Option<Vec<String>> {
    let mut path = vec![output.to_owned()];
    loop {
        let entry = entries.iter().find(|entry| name_of(entry) == path[0])?;
        match input(entry, MAIN)? {
            SOURCE => return Some(path),
            source if path.len() <= entries.len() => path.insert(0, source.to_owned()),
            _ => return None,
        }
    }
}

fn is_on(path: &[String], entry: &Map<String, Json>) -> bool {
    path.iter().any(|name| name == name_of(entry))
}

fn name_of(entry: &Map<String, Json>) -> &str {
    entry.get("name").and_then(Json::as_str).unwrap_or_default()
}

fn input<'e>(entry: &'e Map<String, Json>, port: &str) -> Option<&'e str> {
    entry.get("inputs")?.get(port)?.as_str()
}

/// Inputs with what they read.
fn inputs(entry: &Map<String, Json>) -> impl Iterator<Item = (&str, &str)> {
    let inputs = entry.get("inputs").and_then(Json::as_object);
    inputs.into_iter().flatten().filter_map(|(port, source)| Some((port.as_str(), source.as_str()?)))
}

fn unfit(node: &str, why: impl std::fmt::Display) -> Error {
    Error::input(node, format!("is no node of a list: {why}"), "choose one that turns colours into colours")
}
