//! Facts about a preset or a graph.

use std::path::Path;

use serde_json::json;

use super::facts::Facts;
use isophote_files::error::{AtPlace, Error, Result};
use isophote_finishing::stylize::preset::{self, Track};
use isophote_finishing::stylize::source;
use isophote_finishing::stylize::style::Style;
use isophote_loader::Library;

/// Adds what a preset or a graph says.
///
/// # Errors
/// As [`source::read`] and [`Style::faults`]; [`Error::Failure`] without a library.
pub fn add(facts: &mut Facts, path: &Path) -> Result<()> {
    let library = Library::open()?;
    let text = source::read(path)?;
    if preset::is_graph(&text) {
        facts.add("kind", "graph");
        let style = Style::any(&library, path, &[])?;
        return graph(facts, &library, &style);
    }
    let (preset, faults) = Style::faults(&library, path, &text)?;
    facts.add("kind", "preset");
    facts.add("name", preset.title.name.clone());
    facts.add("about", preset.title.about.clone());
    facts.add("tags", preset.title.tags.clone());
    facts.add("style", preset::style_shown(&preset));
    facts.add("lengths", preset.lengths.map(preset::Lengths::id));
    let param = |(name, track): &(String, Track)| match track {
        Track::Still(value) => json!({ "name": name, "value": value }),
        Track::Keys { keys, .. } => {
            json!({ "name": name, "keys": keys.iter().map(|(frame, _)| frame).collect::<Vec<_>>() })
        }
    };
    facts.add("parameters", preset.params.iter().map(param).collect::<Vec<_>>());
    let objects: Vec<&str> = preset.objects.iter().map(|rule| rule.things.as_str()).collect();
    facts.add("objects", (!objects.is_empty()).then_some(objects));
    let frames: Vec<i64> = preset.params.iter().flat_map(|(_, track)| track.frames()).collect();
    facts.add("keyframes", frames.iter().min().zip(frames.iter().max()).map(|(a, b)| json!([a, b])));
    if faults.is_empty() {
        let style = Style::any(&library, path, &[])?;
        graph(facts, &library, &style)?;
    } else {
        facts.add("warnings", faults.iter().map(Error::to_string).collect::<Vec<_>>());
    }
    Ok(())
}

/// Adds the nodes of a style's graph, what it yields and how many frames it looks at.
fn graph(facts: &mut Facts, library: &Library, style: &Style) -> Result<()> {
    let failed = |e: isophote_loader::Error| e.at(&style.name, "choose another style");
    let mut nodes = Vec::new();
    for node in 0..style.graph.count() {
        nodes.push(style.graph.spec(node).map_err(failed)?.id);
    }
    facts.add("nodes", nodes);
    facts.add("yields", style.kind.name());
    let [past, future] = library.frames(&style.graph).map_err(failed)?;
    facts.told(
        "frames",
        json!([past, future]),
        format!("depends on {past} before and {future} after its own"),
    );
    facts.add("warnings", json!([]));
    Ok(())
}
