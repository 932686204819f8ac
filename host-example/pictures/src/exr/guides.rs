//! Guides in files: which layers and channels hold them, by the names that renderers give them.
//!
//! Sources: the lists of passes of Arnold, Blender 4 and 5, Corona, Houdini's Karma and Mantra, Octane, pbrt, Redshift,
//! RenderMan, Unreal and V-Ray. Names are compared by their letters and digits alone, in lower case.

use std::str::FromStr;

use isophote_exr_edit::File;
use isophote_loader::catalogue::Kind;
use isophote_motion::Rule;

use super::guide_list::Guide;
use super::names::{Group, REST, is_matte, key};

/// Layers of normals: those of shading first, which show what a picture does, then those of the geometry.
const NORMALS: [&[&str]; 2] = [
    &[
        "n",
        "normal",
        "normals",
        "ns",
        "shadingnormal",
        "shadingnormals",
        "normalshading",
        "normalsshading",
        "normalsmooth",
        "smoothnormal",
        "worldnormal",
        "worldnormals",
        "normalworld",
        "normalsworld",
        "bumpnormal",
        "bumpnormals",
        "vraynormals",
        "vraybumpnormals",
        "cgeometrynormalsshading",
        "hitn",
        "denoisingnormal",
    ],
    &["ng", "geometricnormal", "geometrynormal", "normalgeometric", "cgeometrynormalsgeometry", "facenormal"],
];
/// Layers of distances.
const DEPTHS: [&str; 10] = [
    "depth",
    "z",
    "zdepth",
    "vrayzdepth",
    "cgeometryzdepth",
    "cameradepth",
    "hitpz",
    "pz",
    "zbuffer",
    "denoisingdepth",
];
/// Layers of numbers of objects.
const IDS: [&str; 12] = [
    "id",
    "objectid",
    "indexob",
    "objectindex",
    "vrayobjectid",
    "cmaskingid",
    "objectlayerid",
    "nodeid",
    "vraynodeid",
    "vrayrenderid",
    "primid",
    "opid",
];
/// Layers of positions in the world.
const POSITIONS: [&str; 6] = ["p", "pworld", "position", "worldposition", "cgeometryworldposition", "hitp"];

/// True where a layer or a channel by this key holds a guide.
pub fn is_guide(key: &str) -> bool {
    let normal = NORMALS.iter().any(|words| words.contains(&key));
    let is_other = Guide::ALL.into_iter().any(|guide| is_by_id(guide, key));
    normal || DEPTHS.contains(&key) || IDS.contains(&key) || POSITIONS.contains(&key) || is_other
}

/// Guides whose layers have names of their own in renderers, which are listed here, in [`super::motion`] and in
/// [`super::colour_layers`]. All others are found
/// by their ids.
const NAMED: [Guide; 10] = [
    Guide::Normal,
    Guide::Depth,
    Guide::ObjectId,
    Guide::Motion,
    Guide::MotionForward,
    Guide::RestPosition,
    Guide::Flow,
    Guide::Albedo,
    Guide::Diffuse,
    Guide::Specular,
];

/// True where a layer is called as a guide that has no other names.
fn is_by_id(guide: Guide, word: &str) -> bool {
    !NAMED.contains(&guide) && word == key(guide.id())
}

/// Forms in which a guide is written.
fn forms() -> String {
    let forms = Guide::ALL.map(|guide| format!("{}=LAYER", guide.id()));
    let [most @ .., last] = &forms;
    format!("write {} or {last}", most.join(", "))
}

/// One `--guide`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GuideChoice {
    /// The guide.
    pub guide: Guide,
    /// The layer or channel; nothing for none.
    pub layer: Option<String>,
}

impl FromStr for GuideChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, layer) = text.split_once('=').ok_or_else(forms)?;
        let name = if name == "id" { "object_id" } else { name };
        let guide = Guide::ALL.into_iter().find(|guide| guide.id() == name).ok_or_else(forms)?;
        Ok(Self { guide, layer: (layer != "none").then(|| layer.to_owned()) })
    }
}

/// Source of a guide.
#[derive(Clone, Debug)]
pub struct GuideSource {
    /// The guide.
    pub guide: Guide,
    /// Index of the part.
    pub part: usize,
    /// Its channels.
    pub channels: Vec<usize>,
    /// Meaning of the channels.
    pub meaning: Meaning,
    /// Parts and channels of light by whose sum its colours are multiplied; none where they are it.
    pub light: Vec<(usize, Vec<usize>)>,
}

impl GuideSource {
    /// Its channels in each of the parts that it is made of.
    pub fn sources(&self) -> impl Iterator<Item = (usize, &[usize])> {
        let light = self.light.iter().map(|(part, channels)| (*part, channels.as_slice()));
        std::iter::once((self.part, self.channels.as_slice())).chain(light)
    }

    /// True where each channel has as many samples as pixels.
    pub fn is_full(&self, exr: &File) -> bool {
        self.sources().all(|(part, channels)| {
            channels.iter().all(|c| exr.parts()[part].channels[*c].sampling == (1, 1))
        })
    }
}

/// Meaning of the channels of a guide.
#[derive(Clone, Copy, Debug)]
pub enum Meaning {
    /// They are it.
    Same,
    /// Positions in the world, of which depth is to be reckoned.
    Position,
    /// Vectors of some convention.
    Vectors(Rule),
    /// Ids of a Cryptomatte.
    Hashes,
}

/// The channels of x, y and z.
pub fn xyz(group: &Group) -> Option<Vec<usize>> {
    group.all(["X", "Y", "Z"]).or_else(|| group.all(["R", "G", "B"]))
}

fn rgba(group: &Group) -> Option<Vec<usize>> {
    group.all(["R", "G", "B", "A"])
}

/// The channels of x, y and z that have this word and a letter for their name, such as `Nsx`, `Nsy` and `Nsz`.
fn flat(group: &Group, word: &str) -> Option<Vec<usize>> {
    let with = |letter: &char| {
        let wanted = format!("{word}{letter}");
        group.members.iter().find(|(component, _)| key(component) == wanted).map(|member| member.1)
    };
    ['x', 'y', 'z'].iter().map(with).collect()
}

/// True where a layer is the one that was asked for.
pub fn is_named(exr: &File, group: &Group, wanted: &str) -> bool {
    let part = &exr.parts()[group.part].name;
    group.layer == wanted
        || (!group.prefix.is_empty() && group.prefix == wanted)
        || (group.prefix.is_empty() && part == wanted)
}

/// Positions in the world, where a group has them.
pub fn positions(group: &Group) -> Option<Vec<usize>> {
    xyz(group).filter(|_| POSITIONS.contains(&group.key().as_str()))
}

/// The channels of these full names, with commas between them, in one part: as many as the guide has components. Those of
/// the part `near` are taken first.
pub fn listed(exr: &File, near: usize, guide: Guide, names: &str) -> Option<(usize, Vec<usize>)> {
    let names: Vec<&str> = names.split(',').map(str::trim).collect();
    let count = match guide.kind() {
        Kind::Normal | Kind::Position => 3,
        Kind::Motion => 2,
        Kind::Control | Kind::Hatching | Kind::Flow => 4,
        Kind::Color if names.len() == 3 => 3,
        Kind::Color => 4,
        _ => 1,
    };
    if names.len() != count || count == 1 {
        return None;
    }
    let others = (0..exr.parts().len()).filter(|part| *part != near);
    std::iter::once(near).chain(others).find_map(|number| {
        let part = exr.parts().get(number)?;
        Some((number, names.iter().map(|name| part.channel(name)).collect::<Option<_>>()?))
    })
}

/// The guide that a style wants in the first of these groups that has it, by the names of layers and channels; of normals
/// those of shading.
pub fn found(near: &[&Group], guide: Guide) -> Option<GuideSource> {
    let tiers = if guide == Guide::Normal { NORMALS.len() } else { 1 };
    (0..tiers).find_map(|tier| {
        near.iter().find_map(|group| {
            let channels = unnamed(group, guide, tier)?;
            Some(GuideSource { guide, part: group.part, channels, meaning: Meaning::Same, light: Vec::new() })
        })
    })
}

/// The channel of one of these components, or the only one.
fn single(group: &Group, components: &[&str]) -> Option<usize> {
    let known = components.iter().find_map(|c| group.member(c));
    known.or(match group.members.as_slice() {
        [(_, one)] => Some(*one),
        _ => None,
    })
}

/// The channels of a guide that nobody named in a group.
fn unnamed(group: &Group, guide: Guide, tier: usize) -> Option<Vec<usize>> {
    if is_matte(&group.layer) {
        return None;
    }
    let word = group.key();
    let is_of = |words: &[&str]| words.contains(&word.as_str());
    if is_by_id(guide, &word) {
        return of_kind(group, guide.kind());
    }
    match guide {
        Guide::Normal => {
            let flat = |word: &&str| flat(group, word);
            // pbrt's N is that of the geometry where it has Ns beside it.
            let shading = || flat(&"ns").or_else(|| NORMALS[tier].iter().find_map(flat));
            if is_of(NORMALS[tier]) { xyz(group).or_else(shading) } else { shading() }
        }
        Guide::Depth if is_of(&DEPTHS) => {
            single(group, &["Z", "depth", "Y", "V", "R"]).map(|channel| vec![channel])
        }
        // A vector's third component is none.
        Guide::Depth if group.member("X").is_none() => {
            let known = group.member("Z").or_else(|| group.member("depth"));
            let other = || group.members.iter().find(|(c, _)| DEPTHS[2..].contains(&key(c).as_str()));
            known.or_else(|| other().map(|member| member.1)).map(|channel| vec![channel])
        }
        Guide::ObjectId if is_of(&IDS) => {
            single(group, &["id", "Y", "R", "X", "V"]).map(|channel| vec![channel])
        }
        Guide::ObjectId => {
            let known = |word: &&str| group.members.iter().find(|(c, _)| key(c) == **word);
            IDS.iter().find_map(known).map(|member| vec![member.1])
        }
        Guide::RestPosition if REST.contains(&word.as_str()) => xyz(group),
        // "flow" alone may be optical flow.
        Guide::Flow if is_of(&["flowmap"]) => rgba(group),
        _ => None,
    }
}

/// The channels of a group that is a guide of this kind.
fn of_kind(group: &Group, kind: Kind) -> Option<Vec<usize>> {
    match kind {
        Kind::Normal | Kind::Position => xyz(group),
        Kind::Depth => single(group, &["Z", "depth", "Y", "V", "R"]).map(|channel| vec![channel]),
        Kind::ObjectId | Kind::Scalar => {
            single(group, &["id", "object_id", "Y", "R"]).map(|channel| vec![channel])
        }
        Kind::Color => group.colours(true),
        Kind::Control | Kind::Hatching | Kind::Flow => rgba(group),
        // Vectors have conventions.
        _ => None,
    }
}

/// The channels of a guide in a group that has or is the layer or channel that was asked for.
pub fn named(exr: &File, group: &Group, guide: Guide, name: &str) -> Option<GuideSource> {
    let part = &exr.parts()[group.part];
    let found = |channels| GuideSource {
        guide,
        part: group.part,
        channels,
        meaning: Meaning::Same,
        light: Vec::new(),
    };
    let channel = group.members.iter().find(|(_, at)| part.channels[*at].name == name).map(|m| m.1);
    let is_single = !guide.is_of_surfaces()
        && !matches!(guide.kind(), Kind::Control | Kind::Hatching | Kind::Flow | Kind::Color);
    if is_single && channel.is_some() {
        return channel.map(|c| found(vec![c]));
    }
    if !is_named(exr, group, name) {
        // Components may have the name in theirs.
        let is_inner = guide.is_of_surfaces() && !name.is_empty();
        return if is_inner { flat(group, &key(name)).map(found) } else { None };
    }
    of_kind(group, guide.kind()).map(found)
}
