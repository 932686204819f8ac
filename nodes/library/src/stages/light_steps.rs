//! Light in steps: the layers of light that renderers write, or a picture alone, cut into flat tones that are painted on the
//! colours of surfaces.

use crate::declare::spec::{ImageKind, Param, Port, Scope};
use crate::kernels::colour::toon_ramp::{self, STEPS, Shading, Step};
use crate::kernels::colour::{toon_light, toon_rest};
use crate::stages::LOOK;
use isophote_engine::{ImageId, PlanBuilder};

pub(crate) const ALBEDO: Port = Port {
    id: "albedo",
    kind: ImageKind::Color,
    optional: true,
    doc: "Colours of surfaces without light, in the picture's space.",
};
pub(crate) const DIFFUSE: Port = Port {
    id: "diffuse",
    kind: ImageKind::Color,
    optional: true,
    doc: "Light that surfaces reflect in all directions, in their colours: a pass without colour, such as Blender's DiffDir, \
          is to be multiplied by that of the albedo.",
};
pub(crate) const SPECULAR: Port = Port {
    id: "specular",
    kind: ImageKind::Color,
    optional: true,
    doc: "Light that surfaces mirror, by which highlights are shaped; by all light when open.",
};
pub(crate) const EXPOSURE: Param =
    Param::float("exposure", "Light", 0.0, [-16.0, 16.0]).slider(-4.0, 4.0).group(LOOK).hint(
        "Brightens or dims the light before it is cut into steps, in stops: more light moves shadows back.",
    );

/// Colours of the steps: a cool shadow, a mid tone and a warm light; further steps are lights within the light.
pub(crate) const TINTS: [[f32; 4]; STEPS] = [
    [0.54, 0.54, 0.69, 1.0],
    [0.8, 0.78, 0.81, 1.0],
    [1.0, 0.985, 0.94, 1.0],
    [1.0, 1.0, 0.97, 1.0],
    [1.0, 1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0, 1.0],
];
/// Light from which on each step but the first is, in CIELAB lightness over 100.
pub(crate) const PLACES: [f32; BORDERS] = [0.55, 0.88, 1.0, 1.1, 1.2];

/// Borders between steps.
pub(crate) const BORDERS: usize = STEPS - 1;

/// A picture and what is known of its light; colours are gamma-encoded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layers {
    /// The picture.
    pub color: ImageId,
    /// Colours of surfaces without light.
    pub albedo: Option<ImageId>,
    /// Light that surfaces reflect in all directions.
    pub diffuse: Option<ImageId>,
    /// Light that surfaces mirror.
    pub specular: Option<ImageId>,
    /// View-space normals.
    pub normal: Option<ImageId>,
}

impl Layers {
    /// Those of the frame that is described.
    pub(crate) fn of(scope: &Scope<'_>) -> Self {
        let [albedo, diffuse, specular] = [ALBEDO, DIFFUSE, SPECULAR].map(|port| scope.input(port.id));
        Self { color: scope.required("color"), albedo, diffuse, specular, normal: scope.input("normal") }
    }

    /// Steps of light, `count` of them, on the colours of surfaces; `exposure` brightens it, in stops. Without an albedo
    /// `surface` is the picture without small differences, which tells the light as well.
    pub(crate) fn shaded(
        &self,
        plan: &mut PlanBuilder,
        surface: ImageId,
        exposure: f32,
        count: usize,
        mut shading: Shading,
    ) -> ImageId {
        let Self { color, albedo, diffuse, specular, normal } = *self;
        let lit = diffuse.unwrap_or(if albedo.is_some() { color } else { surface });
        let seen = toon_light::Layers { color, lit, albedo, specular, normal, is_diffuse: diffuse.is_some() };
        let usual = if albedo.is_some() { 1.0 } else { 1.0 / USUAL };
        let light = toon_light::pass(plan, &seen, usual * exposure.exp2());
        let rest = albedo.map(|albedo| {
            let reflected = diffuse.zip(specular).map(|(diffuse, specular)| [diffuse, specular]);
            toon_rest::pass(plan, &toon_rest::Layers { color, albedo, reflected })
        });
        if albedo.is_none() {
            let tones = tones(&shading.steps, count);
            for (step, tone) in shading.steps.iter_mut().zip(tones) {
                step.tint = step.tint.map(|v| v * tone);
            }
        }
        toon_ramp::pass(plan, [light, surface], rest, &shading)
    }
}

/// Light that no step is reached by.
pub(crate) const NOWHERE: f32 = 1e6;

/// Share of the light that a usual surface reflects, by which light is told where colours of surfaces are not known, and its
/// cube root, by which lightness goes.
const USUAL: f32 = 0.45;
const USUAL_LIGHTNESS: f32 = 0.766;

/// Tones of steps on a picture whose light is all that tells its surfaces apart, gamma-encoded: the middle of each
/// step, to the power of 3/4.
fn tones(steps: &[Step; STEPS], count: usize) -> [f32; STEPS] {
    let end = |at: usize| if at + 1 < count { steps[at + 1].from } else { 1.0 / USUAL_LIGHTNESS };
    let mut tones = [1.0; STEPS];
    for (at, tone) in tones.iter_mut().enumerate().take(count) {
        let middle = 0.5 * USUAL_LIGHTNESS * (steps[at].from + end(at)).clamp(0.0, 4.0);
        // Tints are darker than white, so that tones are lighter than the picture's.
        *tone = (middle * middle.sqrt()).sqrt();
    }
    tones
}
