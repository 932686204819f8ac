//! The five sets of values of ink, and the controls that scale them.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::stages::LOOK;
use crate::stages::lines::{self, length_factor, width_factor};

choice! {
    /// Tool that is drawn with.
    pub enum Style {
        /// Thin grey lines, tones hatched in two directions, and a fine grain.
        Pencil ("pencil", "Pencil"),
        /// Black, white and hatching.
        Ink ("ink", "Ink"),
        /// Wide soft lines and rubbed tones that catch on coarse paper.
        Charcoal ("charcoal", "Charcoal"),
        /// Thick lines and masses, carved along the form.
        Woodcut ("woodcut", "Woodcut"),
        /// The picture's colours in chalk, with soft dark lines.
        Pastel ("pastel", "Pastel"),
    }
}

impl Style {
    /// Its values.
    pub const fn preset(self) -> Preset {
        match self {
            Self::Pencil => PENCIL,
            Self::Ink => INK,
            Self::Charcoal => CHARCOAL,
            Self::Woodcut => WOODCUT,
            Self::Pastel => PASTEL,
        }
    }
}

/// Amount of the drawing that is dark.
pub const TONE: Param = Param::float("tone", "Tone", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How much of the drawing is dark: 0 leaves lines alone, 1 fills all that is not bright.")
    .doc("Shifts epsilon and scales the shading from 0 to 4 times.");
/// Amount of the paper that shows.
pub const GRAIN: Param = Param::float("grain", "Paper grain", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How much the paper shows in lines and tones: 0.5 is the medium's own, 0 none.")
    .doc("Scales the medium's own grain from 0 to 2 times.");

/// One set of values; lengths in pixels of the full-size picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Standard deviation of the tensor's smoothing.
    pub rho: f32,
    pub sigma_e: f32,
    pub sigma_m: f32,
    /// Weight of the difference of Gaussians (4.10).
    pub p: f32,
    /// Lightness from which on there are no masses, units of L.
    pub epsilon: f32,
    /// Steepness of the ramp, per unit of L.
    pub phi: f32,
    /// Lightness from which on the paper is bare and that from which down all is dark, units of L.
    pub tones: [f32; 2],
    /// By how much middle tones are lighter than in proportion.
    pub ease: f32,
    /// Share of the tones that is rubbed in.
    pub rubbed: f32,
    /// Share of the hatching that follows the form.
    pub form: f32,
    /// Distance of hatches.
    pub spacing: f32,
    /// Distance that they bend per unit of L over which the form rises.
    pub bend: f32,
    /// Standard deviation by which tones are dragged along the form.
    pub smear: f32,
    /// Share of the tone that is lifted out of lights.
    pub lift: f32,
    /// Width and length of strokes along the form.
    pub stroke: [f32; 2],
    /// Standard deviation of the further smoothing of the form that they follow.
    pub wide: f32,
    /// Share of the grain that follows them instead of the paper.
    pub follow: f32,
    /// Iterations of the bilateral filter beside `n_e`.
    pub flattening: i32,
    pub grain: f32,
    pub grain_size: f32,
    /// Degree to which lines break on the grain.
    pub dryness: f32,
    /// Share of the picture's own colours that shows.
    pub colour: f32,
    /// Share of the paper that own colours cover before anything is drawn.
    pub ground: f32,
    /// Opacity of what is drawn with.
    pub opacity: f32,
    /// Standard deviation of the smoothing of lines along the edges.
    pub sigma_a: f32,
    pub texture: f32,
}

/// Black, white and hatching; the others are described by how they differ.
const INK: Preset = Preset {
    rho: 2.0,
    sigma_e: 1.3,
    sigma_m: 4.0,
    p: 20.0,
    epsilon: 26.0,
    phi: 0.12,
    tones: [67.0, 14.0],
    ease: 0.0,
    rubbed: 0.0,
    form: 0.85,
    spacing: 7.5,
    bend: 0.2,
    smear: 0.0,
    lift: 0.0,
    stroke: [1.9, 12.0],
    wide: 5.0,
    follow: 0.0,
    flattening: 0,
    grain: 0.0,
    grain_size: 3.0,
    dryness: 0.2,
    colour: 0.0,
    ground: 0.2,
    opacity: 1.0,
    sigma_a: 1.2,
    texture: 0.01,
};

/// Thin grey lines, tones hatched in two directions, a fine grain.
const PENCIL: Preset = Preset {
    sigma_e: 0.9,
    sigma_m: 3.0,
    p: 18.0,
    epsilon: 16.0,
    phi: 0.05,
    tones: [70.0, 9.0],
    ease: 0.3,
    rubbed: 0.12,
    form: 0.9,
    spacing: 5.5,
    stroke: [1.2, 12.0],
    grain: 0.4,
    grain_size: 2.0,
    dryness: 0.35,
    opacity: 0.93,
    sigma_a: 0.8,
    ..INK
};

/// Wide soft lines and rubbed tones that catch on coarse paper.
const CHARCOAL: Preset = Preset {
    rho: 3.0,
    sigma_e: 2.2,
    sigma_m: 6.0,
    p: 14.0,
    epsilon: 22.0,
    phi: 0.03,
    tones: [76.0, 8.0],
    ease: 0.25,
    rubbed: 0.55,
    form: 0.8,
    spacing: 10.0,
    smear: 5.0,
    lift: 0.75,
    stroke: [2.2, 12.0],
    wide: 6.0,
    follow: 0.6,
    grain: 0.42,
    grain_size: 3.0,
    dryness: 0.5,
    opacity: 0.95,
    sigma_a: 1.5,
    ..INK
};

/// Thick lines and masses, carved along the form.
const WOODCUT: Preset = Preset {
    rho: 4.0,
    sigma_e: 2.1,
    sigma_m: 9.0,
    p: 16.0,
    epsilon: 25.0,
    phi: 0.15,
    tones: [68.0, 11.0],
    form: 1.0,
    spacing: 9.5,
    stroke: [2.2, 17.0],
    sigma_a: 2.0,
    ..INK
};

/// The picture's colours in chalk, with soft dark lines.
const PASTEL: Preset = Preset {
    rho: 3.0,
    sigma_e: 1.6,
    sigma_m: 5.0,
    p: 12.0,
    epsilon: 10.0,
    phi: 0.025,
    tones: [30.0, -25.0],
    rubbed: 1.0,
    form: 0.0,
    stroke: [2.2, 12.0],
    wide: 14.0,
    follow: 0.5,
    flattening: 3,
    grain: 0.85,
    grain_size: 3.0,
    dryness: 0.4,
    colour: 0.96,
    ground: 0.85,
    opacity: 0.75,
    sigma_a: 1.5,
    ..INK
};

/// The controls of artists, which scale or shift a preset; neutral at their defaults.
#[derive(Clone, Copy, Debug)]
pub struct Controls {
    /// Pixels of the full-size picture.
    pub width: f32,
    /// 0..=1.
    pub amount: f32,
    /// 0..=1.
    pub suppress: f32,
    /// 0..=1.
    pub tone: f32,
    /// 0..=1.
    pub grain: f32,
}

impl Preset {
    /// The preset after the controls of artists; every mapping is monotone.
    pub fn with_controls(self, controls: Controls) -> Self {
        const NEUTRAL: f32 = lines::LINE_AMOUNT.default_float();
        let share = controls.amount / NEUTRAL;
        let amount = if controls.amount <= NEUTRAL { share } else { 4f32.powf(share - 1.0) };
        let grain = controls.grain / GRAIN.default_float();
        Self {
            rho: self.rho * length_factor(controls.width),
            sigma_e: self.sigma_e * width_factor(controls.width),
            sigma_m: self.sigma_m * length_factor(controls.width) * (1.0 + 0.8 * controls.suppress),
            p: self.p * amount * (1.0 - 0.5 * controls.suppress),
            epsilon: self.epsilon + 60.0 * (controls.tone - TONE.default_float()),
            tones: toned(self.tones, controls.tone),
            grain: self.grain * grain,
            dryness: (self.dryness * grain * grain).min(1.0),
            texture: self.texture * grain,
            ..self
        }
    }

    /// The preset after the trims of `advanced`.
    pub fn trimmed(self, scope: &Scope<'_>) -> Self {
        Self {
            sigma_e: self.sigma_e * scope.float("edge_scale"),
            sigma_m: self.sigma_m * scope.float("flow_length"),
            p: self.p * scope.float("sharpening"),
            epsilon: self.epsilon + scope.float("threshold_shift"),
            phi: self.phi * scope.float("steepness"),
            form: (self.form * scope.float("carving")).min(1.0),
            tones: shaded(self.tones, scope.float("shading")),
            spacing: self.spacing * scope.float("hatch_spacing"),
            bend: self.bend * scope.float("hatch_bend"),
            grain_size: self.grain_size * scope.float("grain_size"),
            colour: self.colour + scope.float("own_color"),
            sigma_a: self.sigma_a * scope.float("edge_smoothing"),
            ..self
        }
    }
}

/// The range of tones with `factor` times the density below the same light.
fn shaded([light, solid]: [f32; 2], factor: f32) -> [f32; 2] {
    [light, light - (light - solid) / factor.max(1e-3)]
}

/// The range of tones for `tone` 0..=1: nothing is dark at 0, all that is not bright at 1.
fn toned(tones: [f32; 2], tone: f32) -> [f32; 2] {
    const NEUTRAL: f32 = TONE.default_float();
    let share = tone / NEUTRAL;
    shaded(tones, if tone <= NEUTRAL { share } else { 4f32.powf(share - 1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::declare::choice::Numbered;

    const NEUTRAL: Controls = Controls {
        width: lines::LINE_WIDTH.default_float(),
        amount: lines::LINE_AMOUNT.default_float(),
        suppress: lines::SUPPRESS_SMALL.default_float(),
        tone: TONE.default_float(),
        grain: GRAIN.default_float(),
    };

    #[test]
    fn neutral_controls_change_nothing() {
        for preset in Style::ALL.iter().map(|style| style.preset()) {
            assert_eq!(preset.with_controls(NEUTRAL), preset);
        }
    }

    #[test]
    fn mappings_are_monotone_and_stay_in_range() {
        for preset in Style::ALL.iter().map(|style| style.preset()) {
            for i in 0..100 {
                let (a, b) = (i as f32 / 100.0, (i + 1) as f32 / 100.0);
                let at = |controls: Controls| preset.with_controls(controls);
                assert!(at(Controls { amount: a, ..NEUTRAL }).p < at(Controls { amount: b, ..NEUTRAL }).p);
                assert!(
                    at(Controls { suppress: a, ..NEUTRAL }).p > at(Controls { suppress: b, ..NEUTRAL }).p
                );
                assert!(
                    at(Controls { tone: a, ..NEUTRAL }).epsilon < at(Controls { tone: b, ..NEUTRAL }).epsilon
                );
                let (low, high) =
                    (at(Controls { grain: a, ..NEUTRAL }), at(Controls { grain: b, ..NEUTRAL }));
                assert!(low.grain <= high.grain);
            }
        }
    }
}
