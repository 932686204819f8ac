//! Facts about a picture, or about the first frame of a sequence.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::facts::Facts;
use super::meaning;
use isophote_files::error::Result;
use isophote_files::frames::{Pattern, sequence_of};
use isophote_pictures::exr::{Guide, Offers, Selection};
use isophote_pictures::meaning::Window;
use isophote_pictures::pixels::Precision;
use isophote_pictures::read::Unread;

/// Adds what a picture holds.
///
/// # Errors
/// As [`isophote_pictures::read::read`].
pub fn add(facts: &mut Facts, path: &Path) -> Result<()> {
    let file = frames(facts, path)?;
    let selection = Selection { wanted: Guide::ALL.to_vec(), ..Selection::default() };
    let opened = Unread::open(&file)?.read(&file, &selection)?;
    let (format, offers) = (opened.kind(), opened.offers());
    let source = opened.decode(&file)?;
    facts.add("format", format);
    let Some(picture) = source.pictures.first() else { return Ok(()) };
    let (pixels, meant) = (&picture.pixels, &picture.meaning);
    let (width, height) = (pixels.width(), pixels.height());
    facts.told("size", json!([width, height]), format!("{width}x{height}"));
    facts.add("channels", pixels.channels());
    facts.add(
        "samples",
        match pixels.precision() {
            Precision::U8 => "8-bit integers",
            Precision::U16 => "16-bit integers",
            Precision::F16 => "16-bit floats",
            Precision::F32 => "32-bit floats",
        },
    );
    window(facts, "data_window", Some(picture.window()));
    window(facts, "display_window", meant.display);
    meaning::add(facts, meant);
    layers(facts, &offers);
    facts.add("warnings", meant.warnings.clone());
    Ok(())
}

/// Adds the frames of a sequence, and gives the file that tells of them all.
fn frames(facts: &mut Facts, path: &Path) -> Result<PathBuf> {
    let pattern = if path.is_file() { None } else { Pattern::new(path)? };
    let Some(pattern) = pattern else {
        facts.add("kind", "picture");
        facts.add("sequence", sequence_of(path).map(|pattern| pattern.display().to_string()));
        return Ok(path.to_owned());
    };
    let frames = pattern.on_disk()?;
    let (first, last) = (frames.first().copied().unwrap_or(0), frames.last().copied().unwrap_or(0));
    facts.add("kind", "sequence");
    let missing = last.saturating_sub(first).saturating_add(1).saturating_sub(frames.len() as i64);
    facts.told(
        "frames",
        json!({ "first": first, "last": last, "count": frames.len(), "missing": missing }),
        format!("{} from {first} to {last}, {missing} missing; of the first:", frames.len()),
    );
    Ok(pattern.file(first))
}

fn window(facts: &mut Facts, name: &'static str, window: Option<Window>) {
    match window {
        Some(Window { x, y, width, height }) => facts.told(
            name,
            json!({ "x": x, "y": y, "width": width, "height": height }),
            format!("{width}x{height} at {x}, {y}"),
        ),
        None => facts.add(name, Value::Null),
    }
}

/// Adds the layers of an EXR file, and the guides that are found beside the one that is read.
fn layers(facts: &mut Facts, offers: &Offers) {
    let shown = |name: &str| if name.is_empty() { "(main)".to_owned() } else { name.to_owned() };
    let layer = |layer: &isophote_pictures::exr::Layer| {
        let views = Some(&layer.views).filter(|views| !views.is_empty());
        json!({ "name": shown(&layer.name), "views": views, "data": layer.is_data.then_some(true) })
    };
    facts.add("layers", offers.layers.iter().map(layer).collect::<Vec<_>>());
    let guide =
        |(guide, channels): &(Guide, Vec<String>)| json!({ "name": guide.id(), "channels": channels });
    facts.add("guides", offers.guides.iter().map(guide).collect::<Vec<_>>());
    facts.add("motion", offers.guides.iter().any(|(guide, _)| guide.is_motion()));
}
