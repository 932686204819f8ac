//! The gallery: photographs in looks, each with the photographer and the terms that it is free under.

use crate::error::{Error, Result};
use crate::looks::{self, LookCard};
use crate::page::escaped;
use crate::shot::{Shot, Style, Subject};
use std::fmt::Write as _;

/// Photograph of `pictures/gallery`.
struct Photograph {
    /// Stem of its file.
    id: &'static str,
    what: &'static str,
    /// Photographer, or who had it made.
    by: &'static str,
    licence: &'static str,
}

const PHOTOGRAPHS: [Photograph; 11] = [
    Photograph {
        id: "palace",
        what: "a tower of the Summer Palace",
        by: "danielbuechele",
        licence: "CC BY 2.0",
    },
    Photograph { id: "hopper", what: "Grace Hopper", by: "the United States Navy", licence: "public domain" },
    Photograph { id: "astronaut", what: "Eileen Collins", by: "NASA", licence: "public domain" },
    Photograph { id: "raccoon", what: "a raccoon", by: "Judy Weggelaar", licence: "public domain" },
    Photograph { id: "canyon", what: "Antelope Canyon", by: "Ashim D'Silva", licence: "CC0" },
    Photograph { id: "pier", what: "a pier after sunset", by: "Paul Carmona", licence: "CC0" },
    Photograph { id: "lantern", what: "a paper lantern", by: "Mr. Lee", licence: "CC0" },
    Photograph { id: "rocket", what: "a rocket before its start", by: "SpaceX", licence: "public domain" },
    Photograph { id: "cat", what: "a cat", by: "Stéfan van der Walt", licence: "CC0" },
    Photograph { id: "beach", what: "a cliff by the sea", by: "Rob Bye", licence: "CC0" },
    Photograph { id: COFFEE, what: "a cup of coffee", by: "Rachel Michetti", licence: "CC0" },
];

/// Mark of a page in whose place the gallery stands.
const MARK: &str = "<!-- gallery -->";

/// The photograph that the page of looks shows.
const COFFEE: &str = "coffee";

/// Looks of the gallery and the photographs that they are shown on.
const PIECES: [(&str, &str); 12] = [
    ("saturday_comic", "palace"),
    ("coloured_pencils", "astronaut"),
    ("enamel", "canyon"),
    ("woodcut_broadside", "raccoon"),
    ("graphite_study", "hopper"),
    ("wet_in_wet", "palace"),
    ("midnight_blueprint", "rocket"),
    ("travel_poster", "pier"),
    ("willow_charcoal", "cat"),
    ("noir_panel", "lantern"),
    ("palette_knife", "beach"),
    ("fresco", COFFEE),
];

fn picture(look: &str, photograph: &str) -> String {
    format!("gallery-{look}-{photograph}")
}

/// The pictures, and their photographs as they are.
pub fn shots() -> Vec<Shot> {
    let made = PIECES.iter().map(|(look, photograph)| Shot {
        name: picture(look, photograph),
        subject: subject(photograph),
        style: Style::Named(format!("look:{look}")),
        set: Vec::new(),
    });
    let before = PHOTOGRAPHS.iter().filter(|photograph| photograph.id != COFFEE).map(|photograph| Shot {
        name: picture("before", photograph.id),
        subject: subject(photograph.id),
        style: Style::Named("gaussian".into()),
        set: vec![("mix", "0".to_owned())],
    });
    made.chain(before).collect()
}

fn subject(photograph: &'static str) -> Subject {
    if photograph == COFFEE { Subject::Photo } else { Subject::Gallery(photograph) }
}

/// Stem of the picture of a photograph as it is.
fn before(photograph: &str) -> String {
    if photograph == COFFEE {
        format!("before-{}", Subject::Photo.id())
    } else {
        picture("before", photograph)
    }
}

/// A page with the looks and the gallery in the place of their marks.
///
/// # Errors
/// A piece whose look or photograph is not there.
pub fn filled(text: &str, looks: &[LookCard]) -> Result<String> {
    let text = text.replace("<!-- looks -->", &looks::contents(looks));
    Ok(if text.contains(MARK) { text.replace(MARK, &contents(looks)?) } else { text })
}

/// The grid.
fn contents(looks: &[LookCard]) -> Result<String> {
    let mut text = String::from("<div class=\"row wide\">");
    for (id, photograph) in PIECES {
        let look = looks.iter().find(|look| look.id == id);
        let shown = PHOTOGRAPHS.iter().find(|known| known.id == photograph);
        let (Some(look), Some(Photograph { what, by, licence, .. })) = (look, shown) else {
            return Err(Error::page(id, "is a piece of the gallery without its look or photograph"));
        };
        let _ = write!(
            text,
            "<figure><img src=\"../pictures/{picture}.jpg\" alt=\"{name}: {what}\" loading=\"lazy\"><figcaption><b>{name}</b> \
             <code>look:{id}</code>: <a href=\"../pictures/{before}.jpg\">{what}</a>, by {by}, {licence}</figcaption></figure>",
            picture = picture(id, photograph),
            before = before(photograph),
            name = escaped(&look.name),
            by = escaped(by),
        );
    }
    text.push_str("</div>\n");
    Ok(text)
}
