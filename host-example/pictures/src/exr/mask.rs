//! Masks out of a file's channels: numbers as they are, or how much of each pixel some things of a Cryptomatte cover.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use clap::ValueEnum;
use isophote_cryptomatte::{MatteChoice, id};
use isophote_exr_edit::{Decoded, Error, File, Part, Plane, Window};

use super::fault::Fault;
use super::guide_list::Guide;
use super::guides;
use super::mattes::{Matte, Ranks, mattes, pick};
use super::names::{Group, groups};
use isophote_files::{frames, output};

/// Channels and layers in a message.
const MOST_SHOWN: usize = 16;

/// Source of a mask.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MaskSource {
    /// A file of its own, or files by frame.
    File(PathBuf),
    /// A layer or channel of the picture's file.
    Layer(String),
    /// Things of a Cryptomatte in the picture's file.
    Mattes(MatteChoice),
    /// Objects by their numbers in the guide `object_id` of the picture's file.
    Ids(Vec<u32>),
}

/// Treatment of a frame that does not know a name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum OnUnknown {
    /// It fails.
    #[default]
    Fail,
    /// The name covers nothing there.
    Empty,
    /// The same without a warning, for whoever has told of it.
    #[value(skip)]
    Quiet,
}

impl FromStr for MaskSource {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(choice) = MatteChoice::of(text) {
            return choice.map(Self::Mattes);
        }
        if let Some(ids) = text.strip_prefix("id:") {
            let ids: Result<_, _> = ids.split(',').map(|id| id.trim().parse()).collect();
            return ids.map(Self::Ids).map_err(|_| "write id:3, or id:3,4".into());
        }
        match text {
            "" => Err("name a file, a layer, or cryptomatte:NAME".into()),
            _ if frames::is_picture(Path::new(text)) => Ok(Self::File(text.into())),
            _ => Ok(Self::Layer(text.to_owned())),
        }
    }
}

/// A mask in a file.
#[derive(Clone, Debug)]
pub struct ChosenMask {
    /// Its parts and channels there.
    pub layers: Vec<Ranks>,
    covers: Covers,
}

/// What covers a pixel.
#[derive(Clone, Debug)]
enum Covers {
    /// As much as the only channel says.
    Value,
    /// All of it, one of these in the only channel.
    Numbers(Vec<u32>),
    /// The ids of a Cryptomatte.
    Mattes(Wanted),
}

/// Ids that make a mask.
#[derive(Clone, Debug, Default)]
struct Wanted {
    /// Sorted.
    ids: Vec<u32>,
    /// Ids of names that no manifest lists, with what to say where no pixel has them.
    unlisted: Vec<(u32, Unknown)>,
    /// Names that are certainly not there.
    missing: Vec<Unknown>,
}

/// Message about a name that is not there.
#[derive(Clone, Debug)]
struct Unknown {
    problem: String,
    fix: String,
}

impl ChosenMask {
    /// A mask of the file in `folder`, for the view of `picture`.
    ///
    /// # Errors
    /// [`Fault::Choice`] when there is no such layer or Cryptomatte, or a layer has several channels.
    pub fn of(
        exr: &File,
        folder: &Path,
        picture: &Group,
        source: &MaskSource,
    ) -> Result<Option<Self>, Fault> {
        let groups = groups(exr);
        match source {
            MaskSource::File(_) => Ok(None),
            MaskSource::Layer(name) => {
                let channel = channel(exr, &groups, picture, name)?;
                Ok(Some(Self { layers: vec![channel], covers: Covers::Value }))
            }
            MaskSource::Mattes(choice) => {
                let mattes = mattes(exr);
                let matte = pick(&mattes, choice.layer.as_deref())?;
                let layers = matte.ranks(exr, &groups, picture)?;
                Ok(Some(Self { layers, covers: Covers::Mattes(Wanted::of(matte, folder, choice)) }))
            }
            MaskSource::Ids(ids) => {
                let near = near(&groups, picture);
                let Some(source) = guides::found(&near, Guide::ObjectId) else {
                    return Err(Fault::Choice {
                        problem: "has no layer or channel of object ids".into(),
                        fix: "render them as object_id, or write cryptomatte:NAME".into(),
                    });
                };
                let layers = vec![Ranks { part: source.part, channels: source.channels }];
                Ok(Some(Self { layers, covers: Covers::Numbers(ids.clone()) }))
            }
        }
    }

    /// The same of a file that has no picture of its own: of its first view.
    ///
    /// # Errors
    /// As [`ChosenMask::of`].
    pub fn alone(exr: &File, folder: &Path, source: &MaskSource) -> Result<Option<Self>, Fault> {
        let view = exr.parts().first().and_then(|part| part.view.as_ref().or(part.views.first()).cloned());
        let (prefix, layer) = (String::new(), String::new());
        Self::of(exr, folder, &Group { part: 0, prefix, layer, view, members: Vec::new() }, source)
    }

    /// The mask over a window; 0 where it has no pixels. Names that are not there are refused, or warned of in the name of
    /// the file `path`.
    ///
    /// # Errors
    /// [`Fault::Choice`] for those, [`Fault::File`] when memory is short.
    pub fn read(
        &self,
        exr: &File,
        decoded: &[Option<Decoded>],
        window: Window,
        on_unknown: OnUnknown,
        path: &Path,
    ) -> Result<Vec<f32>, Fault> {
        let mut mask = vec![0.0; window.width * window.height];
        let wanted = match &self.covers {
            Covers::Mattes(wanted) => Some(wanted),
            Covers::Value | Covers::Numbers(_) => None,
        };
        let mut seen = vec![false; wanted.map_or(0, |wanted| wanted.unlisted.len())];
        for layer in &self.layers {
            let Some(data) = decoded[layer.part].as_ref() else { continue };
            let own = exr.parts()[layer.part].window;
            let Some(wanted) = wanted else {
                let values = data.plane(layer.channels[0])?.to_f32();
                let value = |at: usize| match &self.covers {
                    Covers::Numbers(ids) => f32::from(ids.iter().any(|id| *id as f32 == values[at])),
                    Covers::Value | Covers::Mattes(_) => values[at],
                };
                add(&mut mask, window, own, value);
                continue;
            };
            for pair in layer.channels.chunks_exact(2) {
                let (Plane::Float(ids), coverage) = (data.plane(pair[0])?, data.plane(pair[1])?.to_f32())
                else {
                    continue;
                };
                add(&mut mask, window, own, |at| {
                    let id = ids[at].to_bits();
                    if wanted.ids.binary_search(&id).is_err() || !coverage[at].is_finite() {
                        return 0.0;
                    }
                    if let Ok(unlisted) = wanted.unlisted.binary_search_by_key(&id, |(id, _)| *id) {
                        seen[unlisted] = true;
                    }
                    coverage[at]
                });
            }
        }
        let wanted = wanted.into_iter();
        let unseen = wanted.clone().flat_map(|w| &w.unlisted).zip(&seen).filter(|(_, seen)| !**seen);
        let unknown = wanted.flat_map(|w| &w.missing).chain(unseen.map(|((_, unknown), _)| unknown));
        for Unknown { problem, fix } in unknown {
            match on_unknown {
                OnUnknown::Fail => {
                    return Err(Fault::Choice { problem: problem.clone(), fix: fix.clone() });
                }
                OnUnknown::Empty => output::warn(format_args!("{}: {problem}", path.display())),
                OnUnknown::Quiet => {}
            }
        }
        Ok(mask)
    }
}

/// Adds to the pixels of a window what `value` has at those of `own`, by their places in it.
pub fn add(mask: &mut [f32], window: Window, own: Window, mut value: impl FnMut(usize) -> f32) {
    let left = i64::from(window.x.max(own.x));
    let right = (i64::from(window.x) + window.width as i64).min(i64::from(own.x) + own.width as i64);
    let top = i64::from(window.y.max(own.y));
    let bottom = (i64::from(window.y) + window.height as i64).min(i64::from(own.y) + own.height as i64);
    for y in top..bottom {
        // Both are not negative: the pixel lies in both windows.
        let place =
            |w: Window, x: i64| (y - i64::from(w.y)) as usize * w.width + (x - i64::from(w.x)) as usize;
        for x in left..right {
            mask[place(window, x)] += value(place(own, x));
        }
    }
}

impl Wanted {
    fn of(matte: &Matte<'_>, folder: &Path, choice: &MatteChoice) -> Self {
        let mut wanted = Self::default();
        let (manifest, fault) = match matte.manifest(folder) {
            Ok(manifest) => (manifest, None),
            Err(fault) => (Default::default(), Some(fault)),
        };
        let unknown = |text: &str| Unknown {
            problem: format!("has no '{text}' in its Cryptomatte '{}'", matte.name),
            fix: match &fault {
                Some(fault) => format!("its manifest {fault}"),
                None => manifest.advice(text),
            },
        };
        for name in &choice.names {
            let before = wanted.ids.len();
            let exact = name.exact();
            match &exact {
                Some(exact) => wanted.ids.extend(manifest.id(exact)),
                None => wanted.ids.extend(manifest.names(name).map(|(_, id)| id)),
            }
            if wanted.ids.len() > before {
                continue;
            }
            match exact.filter(|_| matte.is_hashed()) {
                // Renderers need not list what they draw.
                Some(exact) => {
                    wanted.ids.push(id(&exact));
                    wanted.unlisted.push((id(&exact), unknown(&exact)));
                }
                None => wanted.missing.push(unknown(&name.text)),
            }
        }
        wanted.ids.sort_unstable();
        wanted.ids.dedup();
        wanted.unlisted.sort_by_key(|(id, _)| *id);
        wanted.unlisted.dedup_by_key(|(id, _)| *id);
        wanted
    }
}

/// The groups of the picture's view, or of none, those of its part first.
fn near<'g>(groups: &'g [Group], picture: &Group) -> Vec<&'g Group> {
    let mut near: Vec<&Group> =
        groups.iter().filter(|g| g.view == picture.view || g.view.is_none()).collect();
    near.sort_by_key(|g| (g.part != picture.part, g.view != picture.view));
    near
}

/// The channel that a name stands for: a channel's own, or that of a layer of one channel.
fn channel(exr: &File, groups: &[Group], picture: &Group, name: &str) -> Result<Ranks, Fault> {
    let near = near(groups, picture);
    let whole = |group: &Group, at: usize| exr.parts()[group.part].channels[at].sampling == (1, 1);
    let full = |group: &Group, component: &str| match group.layer.as_str() {
        "" => component.to_owned(),
        layer => format!("{layer}.{component}"),
    };
    for group in &near {
        let own = |(component, at): &&(String, usize)| {
            exr.parts()[group.part].channels[*at].name == name || full(group, component) == name
        };
        if let Some((_, at)) = group.members.iter().find(own).filter(|(_, at)| whole(group, *at)) {
            return Ok(Ranks { part: group.part, channels: vec![*at] });
        }
    }
    let is_named = |g: &&&Group| g.layer == name || !g.prefix.is_empty() && g.prefix == name;
    let names = |group: &Group| -> Vec<String> {
        group.members.iter().filter(|(_, at)| whole(group, *at)).map(|(c, _)| full(group, c)).collect()
    };
    match near.iter().find(is_named) {
        Some(group) => match (group.members.as_slice(), names(group).as_slice()) {
            ([(_, at)], [_]) => Ok(Ranks { part: group.part, channels: vec![*at] }),
            (_, several) => Err(Fault::Choice {
                problem: format!("has several channels in the layer '{name}', and a mask is one"),
                fix: format!("choose from {}", listed(several)),
            }),
        },
        None => {
            let all: Vec<String> = near.iter().flat_map(|group| names(group)).collect();
            Err(Fault::Choice {
                problem: format!("has no layer or channel '{name}' that could be the mask"),
                fix: format!("choose from {}, or name a file such as mask.png", listed(&all)),
            })
        }
    }
}

/// The only channel of a file, that of grey, or those of red, green and blue.
///
/// # Errors
/// [`Fault::Choice`] for others.
pub fn main_channels(exr: &File) -> Result<(usize, Vec<usize>), Fault> {
    let groups = groups(exr);
    let all = || groups.iter().flat_map(|g| g.members.iter().map(move |(name, at)| (g, name, *at)));
    let usable = |part: &Part, at: usize| part.channels[at].sampling == (1, 1);
    if let ([group], 1) = (groups.as_slice(), all().count())
        && let [(_, at)] = group.members.as_slice()
        && usable(&exr.parts()[group.part], *at)
    {
        return Ok((group.part, vec![*at]));
    }
    let main = groups.iter().find(|g| g.prefix.is_empty());
    let found = main.and_then(|g| Some((g.part, g.all(["R", "G", "B"]).or_else(|| g.all(["Y"]))?)));
    found.filter(|(part, channels)| channels.iter().all(|c| usable(&exr.parts()[*part], *c))).ok_or_else(
        || {
            let names: Vec<String> =
                all().map(|(g, _, at)| exr.parts()[g.part].channels[at].name.clone()).collect();
            Fault::Choice {
                problem: format!("has the channels {}, and a mask is one", listed(&names)),
                fix: "write a file of one channel, of grey, or of red, green and blue".into(),
            }
        },
    )
}

fn listed(names: &[String]) -> String {
    match names.len().checked_sub(MOST_SHOWN) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{} and {more} more", names[..MOST_SHOWN].join(", ")),
    }
}

/// The mask of a whole file over a window: its only channel, or the luminance of its colours.
///
/// # Errors
/// As [`main_channels`]; [`Fault::File`].
pub fn whole(exr: &File, part: usize, channels: &[usize], window: Window) -> Result<Vec<f32>, Fault> {
    const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];
    let data = exr.decode(part)?;
    let planes: Vec<Vec<f32>> =
        channels.iter().map(|c| Ok(data.plane(*c)?.to_f32())).collect::<Result<_, Error>>()?;
    let mut mask = vec![0.0; window.width * window.height];
    add(&mut mask, window, exr.parts()[part].window, |at| match planes.as_slice() {
        [one] => one[at],
        several => several.iter().zip(LUMINANCE).map(|(plane, weight)| plane[at] * weight).sum(),
    });
    Ok(mask)
}
