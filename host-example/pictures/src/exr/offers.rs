//! Choices that a file offers to whoever chooses from a list instead of by name.

use isophote_exr_edit::File;

use super::choose::{Chosen, likely};
use super::guide_list::Guide;
use super::mattes::mattes;
use super::names::groups;

/// Choices that a file offers, and those made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Offers {
    /// The layers, in the file's order.
    pub layers: Vec<Layer>,
    /// Name of the layer that was read; empty for the main one.
    pub layer: String,
    /// The view that was read first, where there are several.
    pub view: Option<String>,
    /// Guides of that view with the names of the channels that they are made of.
    pub guides: Vec<(Guide, Vec<String>)>,
    /// True where there are Cryptomattes.
    pub has_mattes: bool,
}

/// A layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layer {
    /// Its name, as it is asked for; empty for the main one.
    pub name: String,
    /// The views that show it.
    pub views: Vec<String>,
    /// True where it holds data instead of colours, which are read by force only.
    pub is_data: bool,
}

/// Choices that a file offers of which `chosen` was chosen.
pub fn offers(exr: &File, chosen: &[Chosen]) -> Offers {
    let mattes = mattes(exr);
    let mut offers = Offers { has_mattes: !mattes.is_empty(), ..Offers::default() };
    for group in groups(exr) {
        // What is not asked for by name is the main layer, which must be a picture by itself.
        if group.picture(exr, !group.layer.is_empty()).is_none() || !exr.can_decode(group.part) {
            continue;
        }
        let views = group.view.clone();
        match offers.layers.iter_mut().find(|layer| layer.name == group.layer) {
            Some(layer) => layer.views.extend(views.filter(|view| !layer.views.contains(view))),
            None => offers.layers.push(Layer {
                is_data: likely(&group, &mattes).is_none(),
                name: group.layer,
                views: views.into_iter().collect(),
            }),
        }
    }
    if let Some(first) = chosen.first() {
        offers.layer.clone_from(&first.group.layer);
        offers.view.clone_from(&first.group.view);
        offers.guides = first
            .guides
            .iter()
            .map(|guide| {
                let name = |part: usize, channel: usize| exr.parts()[part].channels[channel].name.clone();
                let sources = guide.sources();
                let names = sources.flat_map(|(part, of)| of.iter().map(move |c| name(part, *c)));
                (guide.guide, names.collect())
            })
            .collect();
    }
    offers
}
