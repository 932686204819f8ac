//! Looks and styles that ship, as the options of choices.

use isophote::Graph;
use isophote::preset::{self, LOOKS, Settings};
use isophote::registry;
use std::ffi::{CStr, CString};
use std::sync::LazyLock;

/// A look or a style.
#[derive(Debug)]
pub struct Shipped {
    /// Its name for people.
    pub label: CString,
    /// Id of the style that it is a look of; none for a style.
    pub look_of: Option<String>,
    /// Its graph.
    pub graph: Graph,
    /// Its parameters and lengths.
    pub settings: Settings,
}

/// Ids of looks and styles that were added when projects of users existed, in the order in which they came. They are the
/// last options, wherever lists of people have them: projects store places.
const LATER: [&str; 7] = [
    "newsprint",
    "comic_page",
    "two_colour_riso",
    "banknote_lines",
    "halftone",
    "sunday_strip",
    "magnified_comic",
];

/// The looks in their order, then the styles in theirs.
static SHIPPED: LazyLock<Vec<Shipped>> = LazyLock::new(|| {
    let looks = LOOKS.iter().filter_map(|look| {
        let preset = look.preset().ok()?;
        Some((look.id, shipped(&look.name(), preset.title.name.as_deref()?, Some(preset.style))?))
    });
    let styles = registry::nodes().iter().filter(|node| node.group == "styles");
    let styles = styles.filter_map(|node| Some((node.id, shipped(node.id, node.label, None)?)));
    let mut all: Vec<_> = looks.chain(styles).collect();
    all.sort_by_key(|(id, _)| LATER.iter().position(|later| later == id).map_or(0, |place| place + 1));
    all.into_iter().map(|(_, shipped)| shipped).collect()
});

fn shipped(name: &str, label: &str, look_of: Option<String>) -> Option<Shipped> {
    let (graph, settings) = preset::open(name).ok()?;
    Some(Shipped { label: CString::new(label).ok()?, look_of, graph, settings })
}

/// All looks and styles.
pub fn all() -> &'static [Shipped] {
    &SHIPPED
}

/// The looks of a style.
pub fn of_style(style: &str) -> impl Iterator<Item = &'static Shipped> {
    SHIPPED.iter().filter(move |shipped| shipped.look_of.as_deref() == Some(style))
}

/// A first option, then the labels of looks and styles.
pub fn options(first: &CStr, rest: impl Iterator<Item = &'static Shipped>) -> Vec<CString> {
    [first.to_owned()].into_iter().chain(rest.map(|shipped| shipped.label.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_look_and_every_style_is_an_option() {
        let styles = registry::nodes().iter().filter(|node| node.group == "styles");
        let looks: usize = styles.clone().map(|style| of_style(style.id).count()).sum();
        assert_eq!((looks, all().len()), (LOOKS.len(), LOOKS.len() + styles.count()));
    }

    /// They are set by themselves, node and lengths, in the controls of a style.
    #[test]
    fn looks_are_values_of_one_node_for_all_frames() {
        for look in all().iter().filter(|shipped| shipped.look_of.is_some()) {
            assert_eq!((look.graph.len(), look.settings.frames()), (1, vec![]), "{:?}", look.label);
        }
    }
}
