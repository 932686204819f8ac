//! Names that somebody may have meant who wrote a style, a look, a medium or a parameter that is not there.

use std::fmt::{self, Display, Formatter};

use isophote_loader::Library;
use isophote_loader::catalogue::Node;
use isophote_loader::preset::LOOK;

/// Words of artists and of other programs, with the style, the look or the medium that comes nearest.
pub const WORDS: [(&str, &str); 79] = [
    ("abstract", "painting"),
    ("acrylic", "painting"),
    ("anime", "cartoon"),
    ("aquarelle", "watercolor"),
    ("attention", "importance"),
    ("bayer", "palette"),
    ("ben_day", "look:sunday_strip"),
    ("blur", "gaussian"),
    ("canny", "edge_detector"),
    ("cel", "cartoon"),
    ("cel_shading", "cartoon"),
    ("cell_shading", "cartoon"),
    ("chalk", "pastel"),
    ("cmyk", "halftone"),
    ("comic", "cartoon"),
    ("comics", "cartoon"),
    ("contour", "flow_dog"),
    ("contours", "flow_dog"),
    ("crayon", "pastel"),
    ("cross_hatching", "ink"),
    ("cyanotype", "blueprint"),
    ("denoise", "bilateral"),
    ("dither", "palette"),
    ("dithering", "palette"),
    ("dog", "difference_of_gaussians"),
    ("dots", "halftone"),
    ("drawing", "pencil"),
    ("edges", "edge_detector"),
    ("engraving", "look:copperplate"),
    ("etching", "look:copperplate"),
    ("flicker", "steady"),
    ("gouache", "look:soft_gouache"),
    ("graphite", "pencil"),
    ("hatching", "ink"),
    ("impressionism", "painting"),
    ("impressionist", "painting"),
    ("indexed", "palette"),
    ("lic", "line_integral_convolution"),
    ("lichtenstein", "look:magnified_comic"),
    ("line_art", "ink"),
    ("line_drawing", "ink"),
    ("lineart", "ink"),
    ("linedrawing", "ink"),
    ("lines", "flow_dog"),
    ("lino", "look:linocut"),
    ("manga", "ink"),
    ("median", "kuwahara"),
    ("noise", "bilateral"),
    ("oil", "oil_paint"),
    ("oil_painting", "oil_paint"),
    ("oilpaint", "oil_paint"),
    ("oilpainting", "oil_paint"),
    ("oils", "oil_paint"),
    ("outline", "flow_dog"),
    ("outlines", "flow_dog"),
    ("paint", "painting"),
    ("painterly", "painting"),
    ("pen", "ink"),
    ("pixel_art", "palette"),
    ("pixelart", "palette"),
    ("pop_art", "look:magnified_comic"),
    ("poster", "cartoon"),
    ("posterize", "quantize_luminance"),
    ("retro", "palette"),
    ("riso", "look:two_colour_riso"),
    ("saliency", "importance"),
    ("screen_print", "halftone"),
    ("screentone", "halftone"),
    ("sharpen", "warp_sharpen"),
    ("sketch", "pencil"),
    ("smooth", "gaussian"),
    ("sobel", "edge_detector"),
    ("stabilize", "steady"),
    ("technical_drawing", "blueprint"),
    ("toon", "cartoon"),
    ("van_gogh", "look:swirling_sky"),
    ("wash", "watercolor"),
    ("wood_engraving", "woodcut"),
    ("xdog", "difference_of_gaussians"),
];

/// A style that is there, as the command line names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Meant {
    /// The id of a node, or a look.
    pub style: String,
    /// The `ID=VALUE` of `--set` where it is a medium of the style.
    pub setting: Option<String>,
}

impl Meant {
    fn plain(style: impl Into<String>) -> Self {
        Self { style: style.into(), setting: None }
    }

    /// Its words on a command line, apart from the style.
    pub fn options(&self) -> Vec<String> {
        self.setting.iter().flat_map(|setting| ["--set".to_owned(), setting.clone()]).collect()
    }
}

impl Display for Meant {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.setting {
            Some(setting) => write!(f, "'{}' with --set {setting}", self.style),
            None => write!(f, "'{}'", self.style),
        }
    }
}

/// The style that somebody meant who wrote a name that no style has: one of another spelling, a look without its prefix,
/// a medium, or the nearest to a word of artists.
pub fn style(library: &Library, typed: &str) -> Option<Meant> {
    let nodes = library.catalogue().ok()?.nodes;
    let looks: Vec<&str> = library.looks().ok()?.iter().map(|look| look.id).collect();
    Names { nodes: &nodes, looks: &looks }.meant(typed)
}

/// The one of some ids that somebody meant.
pub fn id<'a>(ids: &[&'a str], typed: &str) -> Option<&'a str> {
    let wanted = plain(typed);
    let same = ids.iter().find(|id| **id == wanted);
    same.or_else(|| only(ids.iter().filter(|id| has_word(id, &wanted))))
        .copied()
        .or_else(|| near(ids, &wanted))
}

/// Names that there are.
struct Names<'a> {
    nodes: &'a [Node],
    looks: &'a [&'a str],
}

impl<'a> Names<'a> {
    fn meant(&self, typed: &str) -> Option<Meant> {
        let wanted = plain(typed.strip_prefix(LOOK).unwrap_or(typed));
        if wanted.is_empty() {
            return None;
        }
        self.named(&wanted)
            .or_else(|| self.by_word(&wanted))
            .or_else(|| self.look_of_word(&wanted))
            .or_else(|| self.nearest(&wanted))
    }

    /// Node or look of exactly this name, apart from capitals, hyphens and the prefix of looks.
    fn named(&self, wanted: &str) -> Option<Meant> {
        let node = self.nodes.iter().find(|node| node.id == wanted).map(|node| Meant::plain(node.id));
        let look =
            || self.looks.iter().find(|id| **id == wanted).map(|id| Meant::plain(format!("{LOOK}{id}")));
        node.or_else(look).or_else(|| self.medium(wanted))
    }

    fn medium(&self, wanted: &str) -> Option<Meant> {
        let (node, param, id) = self.media().find(|(.., id)| *id == wanted)?;
        Some(Meant { style: node.to_owned(), setting: Some(format!("{param}={id}")) })
    }

    /// Styles, the parameter by which each chooses what it draws with, and what it may be.
    fn media(&self) -> impl Iterator<Item = (&'a str, &'a str, &'a str)> + use<'a> {
        self.nodes.iter().flat_map(|node| node.media().map(|(param, medium)| (node.id, param.id, medium.id)))
    }

    fn by_word(&self, wanted: &str) -> Option<Meant> {
        let (_, name) = WORDS.iter().find(|(word, _)| *word == wanted)?;
        self.named(name.strip_prefix(LOOK).unwrap_or(name))
    }

    /// The look that has a word in its name.
    fn look_of_word(&self, wanted: &str) -> Option<Meant> {
        self.looks.iter().find(|id| has_word(id, wanted)).map(|id| Meant::plain(format!("{LOOK}{id}")))
    }

    fn nearest(&self, wanted: &str) -> Option<Meant> {
        let ids = self.nodes.iter().map(|node| node.id).chain(self.looks.iter().copied());
        let words = self.media().map(|(.., id)| id).chain(WORDS.iter().map(|(word, _)| *word));
        let near = near(&ids.chain(words).collect::<Vec<_>>(), wanted)?;
        self.named(near).or_else(|| self.by_word(near))
    }
}

/// Spelling of ids.
fn plain(typed: &str) -> String {
    typed.trim().to_lowercase().replace([' ', '-'], "_")
}

fn has_word(id: &str, word: &str) -> bool {
    id.split('_').any(|part| part == word)
}

fn only<T>(mut found: impl Iterator<Item = T>) -> Option<T> {
    found.next().filter(|_| found.next().is_none())
}

/// The nearest of some names, unless none is near: one letter of three may be wrong.
fn near<'a>(names: &[&'a str], wanted: &str) -> Option<&'a str> {
    let far = |name: &&str| strsim::damerau_levenshtein(wanted, name);
    let name = names.iter().min_by_key(|name| far(name))?;
    (far(name) <= (wanted.chars().count() / 3).max(1)).then_some(*name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_found_by_letters_and_words() {
        let ids = ["line_width", "line_amount", "tone", "paper_color"];
        for (typed, meant) in [
            ("line-width", Some("line_width")),
            ("line_with", Some("line_width")),
            ("Tone", Some("tone")),
            ("width", Some("line_width")),
            ("paper", Some("paper_color")),
            ("line", None),
            ("zebra", None),
        ] {
            assert_eq!(id(&ids, typed), meant, "{typed}");
        }
    }

    #[test]
    fn words_stand_once_and_in_order() {
        assert!(WORDS.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
