//! Facts about a video.

use std::path::Path;

use serde_json::json;

use super::facts::Facts;
use super::meaning;
use isophote_files::error::Result;
use isophote_finishing::video::Clip;

/// Adds what a video says of its first stream of pictures.
///
/// # Errors
/// As [`Clip::open`].
pub fn add(facts: &mut Facts, path: &Path) -> Result<()> {
    let clip = Clip::open(path)?;
    let stream = clip.stream();
    facts.add("kind", "video");
    let (width, height) = (stream.width, stream.height);
    facts.told("size", json!([width, height]), format!("{width}x{height}"));
    facts.add("frames", clip.last());
    let rate = stream.frames_per_second();
    let pace = if stream.is_steady() { "" } else { ", not all equally long" };
    facts.told("frames_per_second", rate, format!("{} ({rate:.3}){pace}", stream.rate));
    facts.add("steady_rate", stream.is_steady());
    facts.add("interlaced", stream.fields.is_some());
    facts.add("pixels", stream.pixels);
    let meant = stream.meaning();
    meaning::add(facts, &meant);
    facts.add("matrix", stream.matrix);
    facts.add("range", if stream.range == "pc" { "full" } else { "limited" });
    facts.add("warnings", meant.warnings);
    Ok(())
}
