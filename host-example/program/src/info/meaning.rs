//! Facts about the meaning of numbers of pictures and videos.

use serde_json::json;

use super::facts::Facts;
use isophote_pictures::meaning::{Alpha, ImageState, Meaning};
use isophote_pictures::primaries::{ADOBE, AP0, AP1, Chromaticities, P3, REC709, REC2020};
use isophote_pictures::transfer::Transfer;

/// Names of primaries.
const PRIMARIES: [(&str, Chromaticities); 6] = [
    ("Rec.709", REC709),
    ("P3-D65", P3),
    ("Rec.2020", REC2020),
    ("AP1", AP1),
    ("AP0", AP0),
    ("Adobe RGB", ADOBE),
];

/// Adds what numbers mean.
pub fn add(facts: &mut Facts, meaning: &Meaning) {
    facts.told("pixel_aspect", rounded(meaning.pixel_aspect), meaning.pixel_aspect.to_string());
    let primaries = PRIMARIES.iter().find(|(_, known)| meaning.has_primaries(*known)).map(|(name, _)| *name);
    let own = meaning.primaries.map(|n| n.to_string()).join(" ");
    facts.told(
        "primaries",
        json!({ "name": primaries, "xy": meaning.primaries.map(rounded) }),
        primaries.map_or(own, str::to_owned),
    );
    let transfer = match &meaning.transfer {
        Transfer::Linear => "linear".into(),
        Transfer::Srgb => "sRGB".into(),
        Transfer::Rec709 => "Rec.709".into(),
        Transfer::Gamma(gamma) => format!("gamma {gamma}"),
        Transfer::Pq => "PQ".into(),
        Transfer::Hlg => "HLG".into(),
        Transfer::Curves(_) => "curves of the profile".to_owned(),
    };
    facts.add("transfer", transfer);
    let said = meaning
        .said_by
        .map_or("assumed: the file says nothing of colours".into(), |by| format!("said by {by}"));
    facts.told("colours", meaning.said_by.unwrap_or("assumed"), said);
    facts.add(
        "state",
        match meaning.state {
            ImageState::DisplayReferred => "display-referred",
            ImageState::SceneReferred => "scene-referred",
        },
    );
    facts.add(
        "alpha",
        match meaning.alpha {
            Alpha::None => "none",
            Alpha::Straight => "straight",
            Alpha::Premultiplied => "premultiplied",
        },
    );
    facts.told(
        "profile",
        meaning.profile.as_ref().map(|profile| profile.len()),
        meaning.profile.as_ref().map_or("none".into(), |profile| format!("ICC, {} bytes", profile.len())),
    );
}

/// A number as the digits that tell single floats apart say it.
fn rounded(number: f32) -> f64 {
    number.to_string().parse().unwrap_or_else(|_| f64::from(number))
}
