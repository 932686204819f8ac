//! Channels of a file that belong together, by their names: layers, views and components.
//!
//! A channel's full name is `layer.view.component`, where layers may nest and the default view has no name
//! ("Storing Multi-View Images in OpenEXR Files"); in files of several parts a part may name the layer and the
//! view instead.

use isophote_exr_edit::{File, Part, Sample};

/// Words for components of colour.
const WORDS: [(&str, &str); 4] = [("R", "red"), ("G", "green"), ("B", "blue"), ("A", "alpha")];

/// Letters and digits of a name, in lower case: what is compared where programs differ in spaces and signs.
pub fn key(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// Channels of one layer and view in one part.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index of the part.
    pub part: usize,
    /// Layer within the part; empty for its main one.
    pub prefix: String,
    /// Name of the layer: the prefix, or what the part's name says.
    pub layer: String,
    /// The view that is shown, where there are views.
    pub view: Option<String>,
    /// Components with the index of their channels in the part.
    pub members: Vec<(String, usize)>,
}

/// Components of layers that are pictures, and how their colour is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// Red, green, blue.
    Rgb,
    /// Luminance with two chroma channels.
    LuminanceChroma,
    /// One channel.
    Grey,
}

impl Group {
    /// The channel of a component, whatever its case; colours may be written as words, as Nuke does.
    pub fn member(&self, component: &str) -> Option<usize> {
        let exact = self.members.iter().find(|(c, _)| c == component);
        let alike = |word: &str| self.members.iter().find(|(c, _)| c.eq_ignore_ascii_case(word)).map(|m| m.1);
        let word = WORDS.iter().find(|(letter, _)| letter.eq_ignore_ascii_case(component));
        exact.map(|m| m.1).or_else(|| alike(component)).or_else(|| alike(word?.1))
    }

    /// The channels of all these components.
    pub fn all<const N: usize>(&self, components: [&str; N]) -> Option<Vec<usize>> {
        components.iter().map(|c| self.member(c)).collect()
    }

    /// The channels of red, green and blue, and of alpha where there is one and it is wanted.
    pub fn colours(&self, with_alpha: bool) -> Option<Vec<usize>> {
        let rgba = self.all(["R", "G", "B", "A"]).filter(|_| with_alpha);
        rgba.or_else(|| self.all(["R", "G", "B"]))
    }

    /// The last word of the layer's name, in lower case.
    pub fn word(&self) -> String {
        self.layer.rsplit('.').next().unwrap_or_default().to_ascii_lowercase()
    }

    /// The letters and digits of that word.
    pub fn key(&self) -> String {
        key(&self.word())
    }

    /// The channels of the group's colours, in order. `named` says that the layer was asked for, so that a
    /// single channel of any name is a grey picture.
    pub fn picture(&self, exr: &File, named: bool) -> Option<(Model, Vec<usize>)> {
        let part = &exr.parts()[self.part];
        let full = |index: &usize| {
            part.channels[*index].sampling == (1, 1) && part.channels[*index].sample != Sample::Uint
        };
        let floats = |index: &usize| part.channels[*index].sample != Sample::Uint;
        if let Some(rgb) = self.all(["R", "G", "B"]).filter(|c| c.iter().all(full)) {
            return Some((Model::Rgb, rgb));
        }
        if let Some(chroma) = self.all(["Y", "RY", "BY"]).filter(|c| full(&c[0]) && c.iter().all(floats)) {
            let chroma_sampling = part.channels[chroma[1]].sampling;
            if chroma_sampling == part.channels[chroma[2]].sampling {
                return Some((Model::LuminanceChroma, chroma));
            }
        }
        if let Some(grey) = self.all(["Y"]).filter(|c| c.iter().all(full)) {
            return Some((Model::Grey, grey));
        }
        let colours: Vec<usize> = ["R", "G", "B"].iter().filter_map(|c| self.member(c)).collect();
        match (colours.as_slice(), self.members.as_slice()) {
            ([one], _) if full(one) && (named || self.layer.is_empty()) => Some((Model::Grey, vec![*one])),
            (_, [(_, one)]) if full(one) && named => Some((Model::Grey, vec![*one])),
            _ => None,
        }
    }
}

/// All groups of a file, in the order of its channels.
pub fn groups(exr: &File) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let several = exr.parts().len() > 1;
    for (index, part) in exr.parts().iter().enumerate() {
        for (channel, described) in part.channels.iter().enumerate() {
            let mut words: Vec<&str> = described.name.split('.').collect();
            let component = words.pop().unwrap_or_default().to_owned();
            let view = if let Some(view) = &part.view {
                if words.last() == Some(&view.as_str()) {
                    words.pop();
                }
                Some(view.clone())
            } else if let Some(at) = words.last().and_then(|w| part.views.iter().position(|v| v == w)) {
                words.pop();
                Some(part.views[at].clone())
            } else if words.is_empty() {
                part.views.first().cloned()
            } else {
                None
            };
            let prefix = words.join(".");
            let layer = if prefix.is_empty() && several { own_name(part) } else { prefix.clone() };
            match groups.iter_mut().find(|g| g.part == index && g.prefix == prefix && g.view == view) {
                Some(group) => group.members.push((component, channel)),
                None => groups.push(Group {
                    part: index,
                    prefix,
                    layer,
                    view,
                    members: vec![(component, channel)],
                }),
            }
        }
    }
    groups
}

/// The name of a part without that of its view.
fn own_name(part: &Part) -> String {
    let bare = part.view.as_deref().and_then(|view| part.name.strip_suffix(view));
    bare.map_or(part.name.as_str(), |name| name.trim_end_matches(['.', '_', '-'])).to_owned()
}

/// Layers of points of undeformed objects, by their keys: RenderMan's and Arnold's names, Houdini's, and words.
pub const REST: [&str; 3] = ["pref", "rest", "restposition"];

/// True where a layer is a Cryptomatte, whose numbers are neither colours nor ids.
pub fn is_matte(layer: &str) -> bool {
    layer.to_ascii_lowercase().contains("crypto")
}

/// Names of the components of a picture of so many channels.
pub fn components(channels: u32) -> &'static [&'static str] {
    match channels {
        1 => &["Y"],
        3 => &["R", "G", "B"],
        _ => &["R", "G", "B", "A"],
    }
}
