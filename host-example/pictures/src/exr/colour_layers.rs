//! Layers of colours that guide: what surfaces are, and how they are lit, by the names that renderers give them.
//!
//! Diffuse and specular light are meant in the colours of surfaces. Blender writes both without, as direct and indirect
//! light, and the colours beside them: they are put together. Sources: the lists of passes of Arnold, Blender 4 and 5,
//! Houdini's Karma and Mantra, Redshift, RenderMan and V-Ray.

use super::guide_list::Guide;
use super::guides::{GuideSource, Meaning};
use super::names::{Group, is_matte};

/// Layers of colours of surfaces: first those that have metals' too, then those of what is reflected diffusely.
const ALBEDO: [&[&str]; 3] = [
    &["albedo", "basecolor"],
    &["diffusealbedo", "diffcol", "diffusecolor", "diffusefilter", "vraydiffusefilter"],
    // With what is mirrored, by Cycles.
    &["denoisingalbedo"],
];
/// Layers of light that is reflected diffusely.
const DIFFUSE: [&[&str]; 1] = [&["diffuse", "combineddiffuse", "diffuselighting"]];
/// Layers of light that is mirrored.
const SPECULAR: [&[&str]; 1] = [&["specular", "combinedglossyreflection", "specularlighting"]];

/// Layers that make one: the colours of surfaces, and direct and indirect light on them.
struct Made {
    colour: &'static [&'static str],
    direct: &'static [&'static str],
    indirect: &'static [&'static str],
}

/// Diffuse light as Blender 4 and 5 write it.
const DIFFUSE_MADE: Made = Made {
    colour: &["diffcol", "diffusecolor"],
    direct: &["diffdir", "diffusedirect"],
    indirect: &["diffind", "diffuseindirect"],
};
/// Specular light, likewise.
const SPECULAR_MADE: Made = Made {
    colour: &["glosscol", "glossycolor"],
    direct: &["glossdir", "glossydirect"],
    indirect: &["glossind", "glossyindirect"],
};

/// The layer of colours that a style wants in the first of these groups that has it.
pub fn found(near: &[&Group], guide: Guide) -> Option<GuideSource> {
    let (tiers, made): (&[&[&str]], _) = match guide {
        Guide::Albedo => (&ALBEDO, None),
        Guide::Diffuse => (&DIFFUSE, Some(DIFFUSE_MADE)),
        Guide::Specular => (&SPECULAR, Some(SPECULAR_MADE)),
        _ => return None,
    };
    let whole = tiers.iter().find_map(|words| {
        let (group, channels) = one_of(near, words, true)?;
        Some(GuideSource { guide, part: group.part, channels, meaning: Meaning::Same, light: Vec::new() })
    });
    whole.or_else(|| put_together(near, guide, &made?))
}

/// Light that a file has without the colours of surfaces.
fn put_together(near: &[&Group], guide: Guide, made: &Made) -> Option<GuideSource> {
    let (colour, channels) = one_of(near, made.colour, false)?;
    let (direct, direct_channels) = one_of(near, made.direct, false)?;
    let mut light = vec![(direct.part, direct_channels)];
    light.extend(one_of(near, made.indirect, false).map(|(group, channels)| (group.part, channels)));
    Some(GuideSource { guide, part: colour.part, channels, meaning: Meaning::Same, light })
}

/// The first group by one of these words that has colours, with their channels.
fn one_of<'g>(near: &[&'g Group], words: &[&str], with_alpha: bool) -> Option<(&'g Group, Vec<usize>)> {
    near.iter().find_map(|group| {
        let is_called = words.contains(&group.key().as_str()) && !is_matte(&group.layer);
        Some((*group, group.colours(with_alpha)?)).filter(|_| is_called)
    })
}
