//! Cel light: colours in steps of light in the place of steps of lightness.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::toon_ramp::{Area, STEPS, Shading, Step};
use crate::kernels::colour::{lab_to_rgb, rgb_to_lab};
use crate::stages::LOOK;
use crate::stages::light_steps::{EXPOSURE, Layers, NOWHERE, PLACES, TINTS};
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const SHADING: Param = Param::choice("shading", "Shading", Tones::Lightness.selected())
    .group(LOOK)
    .hint("What tones are cut from: the picture's lightness, or the light on things, as cels are painted.")
    .doc(
        "Light in steps is that of `toon_shading`: by `diffuse` and `albedo` where they are given, and otherwise by the \
         smoothed picture. `posterize` then has no effect, and lines are those of the picture as it is.",
    );
pub(crate) const LIGHT_STEPS: Param = Param::int("light_steps", "Light steps", 2, [2, 3])
    .group(LOOK)
    .hint("Number of steps of light: shadow and light, or a middle tone between them, too.");
pub(crate) const SHADOW_COLOR: Param = tint("shadow_color", "Shadow colour", 0)
    .hint("Colour that surfaces have in the shadow; white leaves them as they are. For steps of light.");
pub(crate) const MIDDLE_COLOR: Param = tint("middle_color", "Middle colour", 1)
    .hint("Colour that surfaces have in the middle of three steps of light; white leaves them as they are.");
pub(crate) const LIGHT_COLOR: Param = tint("light_color", "Light colour", 2)
    .hint("Colour that surfaces have in the light; white leaves them as they are. For steps of light.");
pub(crate) const LIGHT: Param = EXPOSURE;

const fn tint(id: &'static str, label: &'static str, step: usize) -> Param {
    Param::color(id, label, TINTS[step]).group(LOOK).doc("Its opacity is not used.")
}

choice! {
    /// What tones are cut from.
    pub(crate) enum Tones {
        /// Lightness of the picture.
        Lightness ("lightness", "Steps of lightness"),
        /// Light on surfaces.
        Light ("light", "Steps of light"),
    }
}

/// Where the light begins when there is no middle tone, and the width of borders, in CIELAB lightness over 100.
const HALF: f32 = 0.7;
const SOFTNESS: f32 = 0.02;

/// A picture in steps of light, in Lab. `smooth` is the picture in Lab as its colours are to be, and `smoothed` makes such
/// a picture of another: of surfaces without light.
pub(crate) fn shaded(
    scope: &mut Scope<'_>,
    smooth: ImageId,
    smoothed: impl FnOnce(&mut PlanBuilder, ImageId) -> ImageId,
) -> ImageId {
    // There is no rim, which normals would tell.
    let layers = Layers { normal: None, ..Layers::of(scope) };
    let surface = match layers.albedo {
        Some(albedo) => {
            let lab = rgb_to_lab::pass(scope.plan, albedo, 1.0);
            smoothed(scope.plan, lab)
        }
        None => smooth,
    };
    let surface = lab_to_rgb::pass(scope.plan, surface, 1.0);
    let count = scope.int(LIGHT_STEPS.id) as usize;
    let (exposure, shading) = (scope.float(LIGHT.id), shading(scope, count));
    let shaded = layers.shaded(scope.plan, surface, exposure, count, shading);
    rgb_to_lab::pass(scope.plan, shaded, 1.0)
}

/// The parameters as steps: no rim and no highlights.
fn shading(scope: &Scope<'_>, count: usize) -> Shading {
    let tint = |param: Param| {
        let [r, g, b, _] = scope.color(param.id);
        [r, g, b]
    };
    let step = |param: Param, from: f32| Step { tint: tint(param), from, softness: SOFTNESS };
    let nowhere = step(LIGHT_COLOR, NOWHERE);
    let mut steps = [nowhere; STEPS];
    steps[0] = step(SHADOW_COLOR, 0.0);
    if count > 2 {
        steps[1] = step(MIDDLE_COLOR, PLACES[0]);
        steps[2] = step(LIGHT_COLOR, PLACES[1]);
    } else {
        steps[1] = step(LIGHT_COLOR, HALF);
    }
    let none = Area { colour: [0.0; 4], from: NOWHERE, softness: SOFTNESS };
    Shading { steps, rim: none, highlight: none }
}
