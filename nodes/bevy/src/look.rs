//! Looks as assets.

use crate::error::Error;
use bevy::asset::io::Reader;
use bevy::asset::{Asset, AssetLoader, LoadContext};
use bevy::log::warn;
use bevy::reflect::TypePath;
use isophote::Graph;
use isophote::preset::{self, Preset, Settings};
use std::sync::Arc;

/// End of the names of preset files.
const EXTENSION: &str = "look.json";

/// A style with its parameters: an asset that cameras are [stylized](crate::Stylize) by.
///
/// Rules for `objects` in a preset are not applied: Bevy's prepass does not say which thing a pixel shows.
#[derive(Asset, TypePath, Clone, Debug)]
pub struct Look {
    pub(crate) style: Arc<Style>,
}

/// A graph with its parameters over time.
#[derive(Clone, Debug)]
pub(crate) struct Style {
    pub(crate) graph: Graph,
    pub(crate) settings: Settings,
}

impl Look {
    /// The style of this id, such as `cartoon`, or the look that ships as `look:ID`.
    ///
    /// # Errors
    /// [`Error::Look`] for a name that neither bears; it names the nearest.
    pub fn named(name: &str) -> Result<Self, Error> {
        let (graph, settings) = preset::open(name)?;
        Ok(Self::of(graph, settings))
    }

    /// The preset or the graph of this text, which `place` names in messages.
    ///
    /// # Errors
    /// [`Error::Look`] with the first fault.
    pub fn from_json(place: &str, json: &str) -> Result<Self, Error> {
        let (graph, settings) = preset::open_json(place, json, None)?;
        if !preset::is_graph(json) {
            warn_of_rules(place, &Preset::parse(place, json)?);
        }
        Ok(Self::of(graph, settings))
    }

    /// Sets a parameter by the name that presets have for it, to a value as they write it: `set("line_color", "#101820")`.
    ///
    /// # Errors
    /// [`Error::Look`] for a parameter that is none, or a value that it cannot have; the look is then as before.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), Error> {
        let mut style = Style::clone(&self.style);
        style.settings.set(&mut style.graph, name, value)?;
        self.style = Arc::new(style);
        Ok(())
    }

    /// The names of all looks that ship, as [`Look::named`] takes them.
    pub fn shipped() -> impl Iterator<Item = String> {
        preset::LOOKS.iter().map(preset::Look::name)
    }

    fn of(graph: Graph, settings: Settings) -> Self {
        Self { style: Arc::new(Style { graph, settings }) }
    }
}

/// Loader of files that end in `.look.json`: presets, which may name a graph file beside them, and graphs.
#[derive(Default, TypePath)]
pub struct LookLoader;

impl AssetLoader for LookLoader {
    type Asset = Look;
    type Settings = ();
    type Error = Error;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<Look, Error> {
        let place = context.path().to_string();
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await?;
        let json = text(&place, bytes)?;
        let graph = match graph_file(&place, &json)? {
            None => None,
            Some(name) => {
                let path = context.path().resolve_embed_str(&name).map_err(|_| Error::Text(name.clone()))?;
                let bytes = context.read_asset_bytes(path).await?;
                Some(text(&name, bytes)?)
            }
        };
        let (graph, settings) = preset::open_json(&place, &json, graph.as_deref())?;
        Ok(Look::of(graph, settings))
    }

    fn extensions(&self) -> &[&str] {
        &[EXTENSION]
    }
}

/// The graph file that a preset names, if it names one.
fn graph_file(place: &str, json: &str) -> Result<Option<String>, Error> {
    if preset::is_graph(json) {
        return Ok(None);
    }
    let preset = Preset::parse(place, json)?;
    warn_of_rules(place, &preset);
    Ok(Some(preset.style).filter(|style| style.ends_with(".json") && !preset::is_written_out(style)))
}

fn warn_of_rules(place: &str, preset: &Preset) {
    if !preset.objects.is_empty() {
        warn!(
            "{place}: its rules for objects are not applied, for Bevy does not say which thing a pixel shows"
        );
    }
}

fn text(place: &str, bytes: Vec<u8>) -> Result<String, Error> {
    String::from_utf8(bytes).map_err(|_| Error::Text(place.to_owned()))
}
