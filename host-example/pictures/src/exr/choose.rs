//! Choosing what of a file is the picture and what guides it.

use std::path::Path;

use isophote_cryptomatte::MatteChoice;
use isophote_exr_edit::{File, Sample};
use isophote_motion::{Convention, Way};

use super::colour_layers;
use super::fault::Fault;
use super::guide_list::Guide;
use super::guides::{self, GuideChoice, GuideSource, Meaning, is_guide, is_named, positions};
use super::mask::{ChosenMask, MaskSource, OnUnknown};
use super::mattes::{Matte, Ranks, mattes, pick};
use super::motion;
use super::names::{Group, Model, REST, groups, is_matte};

/// Selection of what is read of a file, and where the result goes.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// The layer; the main one without.
    pub layer: Option<String>,
    /// True where that layer may hold data instead of colours.
    pub force: bool,
    /// The view; all without.
    pub view: Option<String>,
    /// The channel that is alpha, or `none`; `A` of the layer without.
    pub alpha: Option<String>,
    /// A new layer for the result, instead of the one that was read.
    pub into: Option<String>,
    /// Guides that are not to be found by name.
    pub guides: Vec<GuideChoice>,
    /// Guides that the style can use.
    pub wanted: Vec<Guide>,
    /// Meaning of motion vectors; that which the names of their layers tell without.
    pub convention: Option<Convention>,
    /// Sources of masks.
    pub masks: Vec<MaskSource>,
    /// Number of those, the last, that are of a preset's rules for objects.
    pub rules: usize,
    /// Treatment of frames that do not know a name of a mask.
    pub on_unknown: OnUnknown,
}

impl Selection {
    /// The first option that asks for something that only EXR files have.
    pub fn option(&self) -> Option<&'static str> {
        let (own, ruled) = self.masks.split_at(self.masks.len().saturating_sub(self.rules));
        let is_within = |mask: &MaskSource| !matches!(mask, MaskSource::File(_));
        let asked = [
            ("--layer", self.layer.is_some()),
            ("--view", self.view.is_some()),
            ("--alpha", self.alpha.is_some()),
            ("--into", self.into.is_some()),
            ("--guide", self.guides.iter().any(|g| g.layer.is_some())),
            ("--motion-convention", self.convention.is_some()),
            ("--mask", own.iter().any(is_within)),
            ("the preset's rules for objects", ruled.iter().any(is_within)),
        ];
        asked.into_iter().find(|(_, asked)| *asked).map(|(name, _)| name)
    }
}

/// A picture in a file.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// Its channels with their view.
    pub group: Group,
    /// Colour model by which its colour is made of channels.
    pub model: Model,
    /// The channels of its colour.
    pub colors: Vec<usize>,
    /// The channel of its alpha.
    pub alpha: Option<usize>,
    /// Sources of its guides.
    pub guides: Vec<GuideSource>,
    /// The masks that are in the file, one for each that was asked for.
    pub masks: Vec<Option<ChosenMask>>,
}

impl Chosen {
    /// The parts of which it reads, some of them several times.
    pub fn parts(&self) -> impl Iterator<Item = usize> {
        let masks = self.masks.iter().flatten().flat_map(|mask| &mask.layers);
        let guides = self.guides.iter().flat_map(GuideSource::sources).map(|(part, _)| part);
        guides.chain(masks.map(|layer| layer.part)).chain([self.group.part])
    }
}

/// The pictures of a file in `folder` that are asked for: one for every view that has the layer.
pub fn choose(exr: &File, folder: &Path, selection: &Selection) -> Result<Vec<Chosen>, Fault> {
    let groups = groups(exr);
    let mattes = mattes(exr);
    let mut found = Vec::new();
    for group in &groups {
        let named = selection.layer.as_deref().is_some_and(|wanted| is_named(exr, group, wanted));
        let rank = if selection.layer.is_some() { named.then_some(0) } else { likely(group, &mattes) };
        if let (Some(rank), Some((model, colors))) = (rank, group.picture(exr, named)) {
            found.push((rank, model, group.part, group, colors));
        }
    }
    found.sort_by_key(|(rank, model, part, ..)| (*rank, *model, *part));
    let first = found.first().map(|(_, _, _, group, _)| *group);
    let refused =
        |group: &Group| selection.layer.is_some() && !selection.force && likely(group, &mattes).is_none();
    let Some(first) = first.filter(|group| !refused(group)) else {
        return Err(no_picture(exr, &groups, &mattes, selection, first));
    };
    let layer = first.layer.clone();
    let mut chosen: Vec<Chosen> = Vec::new();
    for (_, model, _, group, colors) in &found {
        let is_wanted = match &selection.view {
            Some(view) => group.view.as_ref() == Some(view),
            None => true,
        };
        if group.layer != layer || !is_wanted || chosen.iter().any(|c| c.group.view == group.view) {
            continue;
        }
        let masks = selection.masks.iter().map(|mask| ChosenMask::of(exr, folder, group, mask));
        chosen.push(Chosen {
            masks: masks.collect::<Result<_, _>>()?,
            group: (*group).clone(),
            model: *model,
            colors: colors.clone(),
            alpha: alpha(exr, group, selection)?,
            guides: sources(exr, &groups, group, selection)?,
        });
    }
    if chosen.is_empty() { Err(no_view(&groups, selection)) } else { Ok(chosen) }
}

/// Error of a file that has no picture that could be taken; `found` is a layer that holds something else.
fn no_picture(
    exr: &File,
    groups: &[Group],
    mattes: &[Matte<'_>],
    selection: &Selection,
    found: Option<&Group>,
) -> Fault {
    let Some(layer) = &selection.layer else {
        return Fault::Choice {
            problem: "has no layer with channels R, G and B of floats".into(),
            fix: "name a layer by --layer, or a picture with colours".into(),
        };
    };
    let names = groups.iter().filter(|g| g.picture(exr, true).is_some() && likely(g, mattes).is_some());
    let list = unique(names.map(|g| g.layer.as_str()).filter(|l| !l.is_empty()));
    let list = if list.is_empty() { "none: leave --layer out".into() } else { list };
    match found {
        Some(_) => Fault::Choice {
            problem: format!("holds data in the layer '{layer}', no colours, and a style would spoil it"),
            fix: format!("choose from {list}, or add --force-layer"),
        },
        None => Fault::Choice {
            problem: format!("has no layer '{layer}' with colours"),
            fix: format!("choose from {list}"),
        },
    }
}

/// Error of a file that has no picture of the view that was asked for.
fn no_view(groups: &[Group], selection: &Selection) -> Fault {
    let mut views: Vec<&str> = groups.iter().filter_map(|g| g.view.as_deref()).collect();
    views.dedup();
    let view = selection.view.as_deref().unwrap_or_default();
    Fault::Choice {
        problem: format!("does not show the layer in a view '{view}'"),
        fix: if views.is_empty() {
            "leave --view out: the file has only one".into()
        } else {
            format!("choose from {}", unique(views.into_iter()))
        },
    }
}

/// Rank of a layer as the picture that an artist means when naming none: less is more likely.
fn rank(group: &Group) -> Option<u32> {
    const MAIN: [&str; 9] = ["rgba", "rgb", "beauty", "combined", "color", "colour", "main", "c", "image"];
    // Data that guide nothing; guides are told by their own names.
    const DATA: [&str; 23] = [
        "pcam",
        "motion",
        "forward",
        "backward",
        "vector",
        "velocity",
        "cgeometryvelocity",
        "vrayvelocity",
        "motionvector",
        "motionvectors",
        "finalimagemotionvectors",
        "motionback",
        "motionfore",
        "uv",
        "st",
        "disparityl",
        "disparityr",
        "materialid",
        "materialindex",
        "indexma",
        "tangent",
        "tangents",
        "tangentnormal",
    ];
    let (word, key) = (group.word(), group.key());
    let is_data = DATA.contains(&key.as_str()) || REST.contains(&key.as_str()) || is_guide(&key);
    if word.is_empty() {
        Some(0)
    } else if let Some(at) = MAIN.iter().position(|m| *m == word) {
        Some(1 + at as u32)
    } else if is_data || is_matte(&group.layer) {
        None
    } else {
        Some(100)
    }
}

/// Rank of a layer as the picture that is meant, as [`rank`], where Cryptomattes may have any name.
pub fn likely(group: &Group, mattes: &[Matte<'_>]) -> Option<u32> {
    rank(group).filter(|_| mattes.iter().all(|matte| !matte.has(&group.layer)))
}

fn unique<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut list: Vec<&str> = Vec::new();
    for name in names {
        if !list.contains(&name) {
            list.push(name);
        }
    }
    list.join(", ")
}

fn alpha(exr: &File, group: &Group, selection: &Selection) -> Result<Option<usize>, Fault> {
    let part = &exr.parts()[group.part];
    let usable =
        |at: &usize| part.channels[*at].sample != Sample::Uint && part.channels[*at].sampling == (1, 1);
    match selection.alpha.as_deref() {
        None => Ok(group.member("A").filter(usable)),
        Some("none") => Ok(None),
        Some(name) => {
            let own = group.members.iter().find(|(c, _)| c == name).map(|m| m.1);
            let any = || part.channels.iter().position(|c| c.name == name);
            own.or_else(any).filter(usable).map(Some).ok_or_else(|| Fault::Choice {
                problem: format!("has no float channel '{name}' beside the layer's colours"),
                fix: "name one of its channels by --alpha, or none".into(),
            })
        }
    }
}

/// The guides that the style can use and that the file has, for the view of `picture`.
fn sources(
    exr: &File,
    groups: &[Group],
    picture: &Group,
    selection: &Selection,
) -> Result<Vec<GuideSource>, Fault> {
    let mut sources = Vec::new();
    for guide in Guide::ALL {
        let choice = selection.guides.iter().rev().find(|c| c.guide == guide);
        if !selection.wanted.contains(&guide) || choice.is_some_and(|c| c.layer.is_none()) {
            continue;
        }
        let name = choice.and_then(|c| c.layer.as_deref());
        if let Some(matte) = name.filter(|_| guide == Guide::ObjectId).and_then(MatteChoice::layer_of) {
            sources.push(hashes(exr, groups, picture, matte)?);
            continue;
        }
        // A part that is not read guides nothing, unless it is asked for, which is refused.
        let is_near = |g: &&Group| {
            (g.view == picture.view || g.view.is_none()) && (name.is_some() || exr.can_decode(g.part))
        };
        let mut near: Vec<&Group> = groups.iter().filter(is_near).collect();
        near.sort_by_key(|g| (g.part != picture.part, g.view != picture.view, g.prefix != picture.prefix));
        let found = match (guide.is_motion(), name) {
            (true, _) => near.iter().find_map(|g| vectors(exr, g, guide, name, selection.convention)),
            (false, Some(name)) => near.iter().find_map(|g| guides::named(exr, g, guide, name)),
            (false, None) if guide.is_colour() => colour_layers::found(&near, guide),
            (false, None) => guides::found(&near, guide),
        };
        let found = found.or_else(|| listed(exr, picture.part, guide, name?, selection.convention));
        let found = found.or_else(|| {
            let has_camera = exr.parts()[picture.part].world_to_camera.is_some();
            (guide == Guide::Depth && name.is_none() && has_camera).then_some(())?;
            near.iter().find_map(|group| {
                let channels = positions(group)?;
                Some(GuideSource {
                    guide,
                    part: group.part,
                    channels,
                    meaning: Meaning::Position,
                    light: Vec::new(),
                })
            })
        });
        let found = found.or_else(|| {
            // Front objects of a Cryptomatte, which no other than the one of objects is asked for by itself.
            (guide == Guide::ObjectId && name.is_none()).then_some(())?;
            hashes(exr, groups, picture, None).ok().filter(|source| exr.can_decode(source.part))
        });
        match (found, name) {
            (Some(source), _) => sources.push(source),
            (None, Some(name)) => return Err(no_guide(guide, name)),
            (None, None) => {}
        }
    }
    // Channels with fewer samples than pixels guide nothing.
    sources.retain(|source| source.is_full(exr));
    sources.extend(other_way(&sources, selection));
    Ok(sources)
}

/// Vectors of the way that has none, where those of the other way are there and stand for it, reversed.
fn other_way(sources: &[GuideSource], selection: &Selection) -> Option<GuideSource> {
    let of = |guide| sources.iter().find(|source| source.guide == guide);
    let (there, missing) = match (of(Guide::Motion), of(Guide::MotionForward)) {
        (Some(there), None) => (there, Guide::MotionForward),
        (None, Some(there)) => (there, Guide::Motion),
        _ => return None,
    };
    let is_unwanted =
        selection.guides.iter().rev().find(|c| c.guide == missing).is_some_and(|c| c.layer.is_none());
    let Meaning::Vectors(rule) = there.meaning else { return None };
    (selection.wanted.contains(&missing) && !is_unwanted).then(|| GuideSource {
        guide: missing,
        meaning: Meaning::Vectors(rule.reversed()),
        ..there.clone()
    })
}

/// Error of a file that lacks the layer or channel that was asked for as a guide.
fn no_guide(guide: Guide, name: &str) -> Fault {
    let id = guide.id();
    let channels = if guide.is_of_surfaces() || guide.is_colour() {
        format!(", its channels by --guide {id}=A,B,C")
    } else {
        String::new()
    };
    Fault::Choice {
        problem: format!("has no layer or channel '{name}' that could be the {id}"),
        fix: format!("name another by --guide {id}=LAYER{channels}, or none"),
    }
}

/// The channels of a guide that were asked for by their names.
fn listed(
    exr: &File,
    near: usize,
    guide: Guide,
    names: &str,
    convention: Option<Convention>,
) -> Option<GuideSource> {
    let (part, channels) = guides::listed(exr, near, guide, names)?;
    let way = if guide == Guide::MotionForward { Way::Forward } else { Way::Backward };
    let meaning = match guide.is_motion() {
        true => Meaning::Vectors(convention.unwrap_or(Convention::OWN).rule(way)),
        false => Meaning::Same,
    };
    Some(GuideSource { guide, part, channels, meaning, light: Vec::new() })
}

/// The ids in front, of a Cryptomatte or of the one of objects.
fn hashes(exr: &File, groups: &[Group], picture: &Group, matte: Option<&str>) -> Result<GuideSource, Fault> {
    let mattes = mattes(exr);
    let ranks = pick(&mattes, matte)?.ranks(exr, groups, picture)?;
    let Ranks { part, channels } = &ranks[0];
    let (channels, meaning) = (vec![channels[0]], Meaning::Hashes);
    Ok(GuideSource { guide: Guide::ObjectId, part: *part, channels, meaning, light: Vec::new() })
}

/// Motion vectors in a file of their own, where they may lie in its main layer.
///
/// # Errors
/// [`Fault::Choice`] for files without.
pub fn motion(exr: &File, selection: &Selection) -> Result<Vec<GuideSource>, Fault> {
    let groups = groups(exr);
    let readable: Vec<&Group> = groups.iter().filter(|g| exr.can_decode(g.part)).collect();
    let wanted = selection.wanted.iter().copied().filter(|guide| guide.is_motion());
    let mut found = Vec::new();
    for guide in wanted {
        let choice = selection.guides.iter().rev().find(|c| c.guide == guide);
        let name = choice.and_then(|c| c.layer.as_deref());
        let known = readable.iter().find_map(|g| vectors(exr, g, guide, name, selection.convention));
        // Any convention may have its vectors in a file's red and green.
        let main = || {
            let group = readable.iter().find(|g| name.is_none() && g.layer.is_empty())?;
            let is_forward = guide == Guide::MotionForward;
            motion::find(group, is_forward, true, selection.convention)
                .map(|found| of_vectors(group, guide, found))
        };
        // Known layers of the other way say that there is none of this.
        found.extend(known.or_else(|| if found.is_empty() { main() } else { None }));
    }
    found.retain(|source| source.is_full(exr));
    if found.is_empty() {
        return Err(Fault::Choice {
            problem: "has no layer that could be motion vectors".into(),
            fix: "name it by --guide motion=LAYER, or its renderer by --motion-convention".into(),
        });
    }
    found.extend(other_way(&found, selection));
    Ok(found)
}

fn of_vectors(group: &Group, guide: Guide, motion::Found { channels, rule }: motion::Found) -> GuideSource {
    GuideSource { guide, part: group.part, channels, meaning: Meaning::Vectors(rule), light: Vec::new() }
}

/// Motion vectors in a group; `name` is the layer that was asked for.
fn vectors(
    exr: &File,
    group: &Group,
    guide: Guide,
    name: Option<&str>,
    convention: Option<Convention>,
) -> Option<GuideSource> {
    let is_named = name.is_some_and(|name| is_named(exr, group, name));
    if name.is_some() && !is_named {
        return None;
    }
    let found = motion::find(group, guide == Guide::MotionForward, is_named, convention)?;
    Some(of_vectors(group, guide, found))
}
