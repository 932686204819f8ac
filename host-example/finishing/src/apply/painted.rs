//! Guides that have files of their own: maps that artists paint over pictures, with what their numbers are where nothing is
//! painted, colours and light of renderers, and materials.

use isophote_pictures::exr::Guide;
use isophote_pictures::material::MaterialKind;

/// Kind of map that an artist paints, or that a renderer writes: RGBA.
#[derive(Debug)]
pub struct Painted {
    /// The guide that it is, which is also the option of `isophote apply` that names its files.
    pub guide: Guide,
    /// For people.
    pub name: &'static str,
    /// Value of what is not painted.
    pub(super) nothing: f32,
    /// Alpha of files that have none.
    pub(super) opaque: f32,
    /// True where alpha that is 1 everywhere is that of a file in which nobody painted it.
    pub(super) is_plain_opaque: bool,
    /// True where its numbers are colours, which it shows as the picture does; all others are read as they are stored.
    pub(super) is_colour: bool,
    /// What a grey file cannot say; nothing where grey is a colour as others.
    pub(super) wanted: Option<&'static str>,
}

/// The kinds of maps.
pub const PAINTED: [Painted; 6] = [
    Painted {
        guide: Guide::Flow,
        name: "flow map",
        nothing: 0.0,
        opaque: 1.0,
        is_plain_opaque: false,
        is_colour: false,
        wanted: Some("is grey, and its red and green are to say where flow leads"),
    },
    Painted {
        guide: Guide::Control,
        name: "control map",
        nothing: 0.5,
        opaque: 0.5,
        is_plain_opaque: true,
        is_colour: false,
        wanted: Some("is grey, and its colours are to say what is wanted of detail and lines"),
    },
    of_colours(Guide::LinePaint, "line paint"),
    of_colours(Guide::Albedo, "albedo"),
    of_colours(Guide::Diffuse, "diffuse light"),
    of_colours(Guide::Specular, "specular light"),
];

impl Painted {
    /// For people: several.
    pub(super) fn names(&self) -> String {
        let ending = if self.is_colour { " files" } else { "s" };
        format!("{}{ending}", self.name)
    }
}

const fn of_colours(guide: Guide, name: &'static str) -> Painted {
    Painted { guide, name, nothing: 0.0, opaque: 1.0, is_plain_opaque: false, is_colour: true, wanted: None }
}

/// True for a guide that artists make, which pictures without layers have, too.
pub fn is_made_by_hand(guide: Guide) -> bool {
    PAINTED.iter().any(|painted| painted.guide == guide && !guide.is_light())
        || MaterialKind::ALL.iter().any(|kind| kind.guide() == guide)
}
