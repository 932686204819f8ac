//! What is understood of a video.

use std::path::Path;

use serde_json::json;

use super::facts::Facts;
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
    let aspect = stream.aspect.value();
    facts.told("pixel_aspect", aspect, stream.aspect.with(':'));
    facts.add("pixels", stream.pixels);
    facts.add("alpha", stream.channels() == 4);
    facts.add("range", if stream.range == "pc" { "full" } else { "limited" });
    facts.add("matrix", stream.matrix);
    let tag = |option: &str| stream.tags.iter().find(|[name, _]| *name == option).map(|[_, value]| *value);
    facts.add("primaries", tag("-color_primaries"));
    facts.add("transfer", tag("-color_trc"));
    let said = ["-color_range", "-colorspace", "-color_trc", "-color_primaries"].map(tag);
    let count = said.iter().flatten().count();
    let (word, text) = match count {
        0 => ("assumed", "assumed: the file says nothing of them"),
        4 => ("file", "said by the file"),
        _ => ("partly", "said by the file in part, the usual is taken for the rest"),
    };
    facts.told("colours", word, text);
    Ok(())
}
