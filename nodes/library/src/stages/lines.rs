//! The lines of styles: the flow-based difference of Gaussians (§ 4.5) under the controls of artists.

use crate::declare::choice::choice;
use crate::declare::spec::{Param, Scope};
use crate::kernels::colour::lines_alone;
use crate::kernels::lines::flow_dog_two_dimensional::Stepping;
use crate::kernels::shared::edge_threshold::{Threshold, Xdog};
use crate::kernels::shared::stream::Integrator;
use crate::stages::flow_dog::{self, Distance, FlowDog, Guided, Kernel};
use crate::stages::flow_map;
use crate::stages::line_context::{self, LineContext};
use crate::stages::{ADVANCED, LOOK};
use isophote_engine::ImageId;

pub(crate) const LINE_WIDTH: Param = Param::length("line_width", "Line width", 2.0, [0.2, 40.0])
    .slider(0.8, 10.0)
    .group(LOOK)
    .hint("How thick lines are. Wide lines also run longer, so that they do not break.").doc("Scales `sigma_e` by width / 2 and, above 2, `sigma_m` by its root. None is narrower than a pixel of the picture: it is lighter instead.");
pub(crate) const LINE_AMOUNT: Param = Param::float("line_amount", "Line amount", 0.5, [0.0, 1.0])
    .group(LOOK)
    .hint("How many lines there are: 0 draws none, 1 draws faint edges too.")
    .doc("Scales 1 - `tau`.");
pub(crate) const OUTLINE_WIDTH: Param =
    Param::float("outline_width", "Outline width", 1.0, [0.0, 8.0]).slider(0.0, 3.0).group(LOOK).hint(
        "Width of outlines of objects against other lines; 0 draws none. Needs depth, object ids or normals.",
    );
pub(crate) const CREASE_WIDTH: Param = Param::float("crease_width", "Crease width", 1.0, [0.0, 8.0])
    .slider(0.0, 3.0)
    .group(LOOK)
    .hint("Width of lines where a surface folds against other lines; 0 draws none. Needs normals.");
pub(crate) const BORDER_WIDTH: Param =
    Param::float("border_width", "Border width", 1.0, [0.0, 8.0]).slider(0.0, 4.0).group(LOOK).hint(
        "Width of borders between things that touch against outlines; 0 draws none. Needs depth and object ids.",
    );
pub(crate) const FAR_WIDTH: Param = Param::float("far_width", "Width far away", 1.0, [0.0, 4.0])
    .slider(0.25, 2.0)
    .structural()
    .group(LOOK)
    .hint("Width of lines far from the camera against near ones; 1 for the same everywhere. Needs depth.")
    .doc("Factor on all widths from `far` on; between `near` and `far` it grows evenly with the distance. No line is narrower than a pixel.");
pub(crate) const NEAR: Param = Param::float("near", "Near", 2.0, [0.0, 1e6])
    .slider(0.5, 8.0)
    .group(ADVANCED)
    .hint("Distance from the camera up to which lines keep their width, in units of the scene.");
pub(crate) const FAR: Param =
    Param::float("far", "Far", 20.0, [0.0, 1e6]).slider(5.0, 100.0).group(ADVANCED).hint(
        "Distance from the camera from which on lines have their width of far away, in units of the scene.",
    );
pub(crate) const TEXTURE_LINES: Param = Param::float("texture_lines", "Texture lines", 1.0, [0.0, 1.0])
    .group(LOOK)
    .hint("How many lines come from the picture itself: 0 leaves outlines and creases alone.");
pub(crate) const SUPPRESS_SMALL: Param = Param::float("suppress_small", "Hide small lines", 0.0, [0.0, 1.0])
    .group(LOOK)
    .hint("Leaves out short and weak lines.")
    .doc("Lengthens `sigma_m` by up to 0.8 of it and lowers `epsilon` by up to 0.75.");
pub(crate) const N_E: Param = Param::int("n_e", "Smoothing for lines", 1, [0, 16])
    .slider(0.0, 8.0)
    .structural()
    .group(ADVANCED)
    .hint("How often the picture is smoothed before lines are looked for, which keeps noise out of them.")
    .doc("Bilateral iterations (n_e).");
pub(crate) const LINE_ITERATIONS: Param = Param::int("line_iterations", "Line rounds", 1, [1, 16])
    .slider(1.0, 5.0)
    .structural()
    .group(ADVANCED)
    .hint("How often lines are looked for, each time on top of those found, which closes gaps.")
    .doc("Times the line filter runs, each on the lightness times the lines found so far.");
pub(crate) const GUIDE_WEIGHT: Param = Param::float("guide_weight", "Guide strength", 1.0, [0.0, 16.0])
    .slider(0.0, 2.0)
    .structural()
    .group(ADVANCED)
    .hint("Strength of the lines that normals, depth and object ids draw; 0 leaves these out.")
    .doc("Strength of lines where normal, depth or object id break; 0 leaves the guides unread.");

pub(crate) const SHOW: Param = Param::choice("show", "Show", Show::Picture.selected())
    .group("output")
    .hint("Shows the picture, or the lines alone on nothing, to be laid over pictures elsewhere.")
    .doc("`mix` and the mask lay lines alone over the picture, as they do all results.");

choice! {
    /// Part of a drawing that is shown.
    pub(crate) enum Show {
        /// All of it.
        Picture ("picture", "Picture"),
        /// All that is drawn, with the picture and the paper left out: transparent between lines.
        Lines ("lines", "Lines alone"),
    }
}

/// A drawing as `show` says: the picture with its lines, or these alone. `source` is the picture without them, `edges` where
/// they are, `opacity` theirs.
pub(crate) fn shown(scope: &mut Scope<'_>, [drawn, source, edges]: [ImageId; 3], opacity: f32) -> ImageId {
    match scope.option(SHOW.id) {
        Show::Picture => drawn,
        Show::Lines => lines_alone::pass(scope.plan, [drawn, source, edges], opacity),
    }
}

/// The technical parameters of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lines {
    sigma_e: f32,
    sigma_m: f32,
    tau: f32,
    epsilon: f32,
    phi: f32,
}

impl Lines {
    /// The values after the controls of artists: `width` in pixels of the full picture, `amount` and
    /// `suppress` in 0..=1.
    fn with_look(self, width: f32, amount: f32, suppress: f32) -> Self {
        let base = base(1.0 - self.tau, amount);
        Self {
            sigma_e: self.sigma_e * width_factor(width),
            sigma_m: self.sigma_m * length_factor(width) * (1.0 + 0.8 * suppress),
            tau: 1.0 - base,
            epsilon: self.epsilon - 0.75 * suppress,
            phi: self.phi,
        }
    }
}

/// The line filter of a style as its parameters say.
pub(crate) fn flow_dog(scope: &Scope<'_>, guide_weight: f32) -> FlowDog {
    let technical = Lines {
        sigma_e: scope.float("sigma_e"),
        sigma_m: scope.float("sigma_m"),
        tau: scope.float("tau"),
        epsilon: scope.float("epsilon"),
        phi: scope.float("phi"),
    };
    let lines = technical.with_look(
        // A ratio of two widths has no unit: the scale of the rendering is taken out again.
        scope.float("line_width") / scope.scale(),
        scope.float("line_amount"),
        scope.float("suppress_small"),
    );
    FlowDog {
        sigma_e: lines.sigma_e,
        k: scope.float("k"),
        sigma_m: lines.sigma_m,
        xdog: Xdog::tau(lines.tau, lines.epsilon, lines.phi, Threshold::Tanh),
        iterations: scope.int("line_iterations"),
        stepping: Stepping::Along(Integrator::TwoStep),
        kernel: Kernel::Separable,
        guide_weight,
        texture: scope.float(TEXTURE_LINES.id),
        guided: guided(scope, lines.sigma_e),
        fades: true,
        context: LineContext::of(scope, scope.float(TEXTURE_LINES.id)),
        colour: scope.float(line_context::COLOUR_EDGES.id),
        distance: distance(scope),
    }
    .on_pixels(scope)
}

/// The tensor of the picture that is described, and of its guides.
pub(crate) fn oriented(scope: &mut Scope<'_>, guide_weight: f32) -> ImageId {
    let color = scope.required("color");
    let guides = flow_dog::guides(scope, guide_weight);
    let tensor = flow_dog::tensor(scope, color, &guides);
    flow_map::bent(scope, tensor)
}

/// Width of lines by distance.
pub(crate) fn distance(scope: &Scope<'_>) -> Distance {
    Distance { near: scope.float(NEAR.id), far: scope.float(FAR.id), width: scope.float(FAR_WIDTH.id) }
}

/// Creases, outlines, and borders between things that touch, beside lines of standard deviation `sigma_e`.
pub(crate) fn guided(scope: &Scope<'_>, sigma_e: f32) -> [Guided; 3] {
    let [crease, outline, border] =
        [CREASE_WIDTH, OUTLINE_WIDTH, BORDER_WIDTH].map(|width| scope.float(width.id));
    let border = (outline * border).min(BORDER_WIDTH.range[1]);
    [crease, outline, border].map(|width| Guided::new(sigma_e * width))
}

/// Factor on the scale of edges for lines `width` pixels of the full picture wide.
pub(crate) fn width_factor(width: f32) -> f32 {
    width / LINE_WIDTH.default_float()
}

/// Factor on the smoothing along lines `width` wide, 1 up to the default: wide ones fall into blots when
/// what joins them stays short.
pub(crate) fn length_factor(width: f32) -> f32 {
    width_factor(width).max(1.0).sqrt()
}

/// 1 - tau for `amount`: 1 at 0, where no line is left, whatever tau is; times 1 at the default, which is the
/// middle; times 1/4 at 1, since nothing at all would let the noise of flat parts through.
fn base(technical: f32, amount: f32) -> f32 {
    const NEUTRAL: f32 = LINE_AMOUNT.default_float();
    if amount <= 0.0 {
        return 1.0;
    }
    let factor =
        if amount <= NEUTRAL { (1.0 - amount) / amount } else { 4f32.powf(2.0 * (NEUTRAL - amount)) };
    (technical * factor).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::difference_of_gaussians as dog;

    const WIDTH: f32 = LINE_WIDTH.default_float();
    const AMOUNT: f32 = LINE_AMOUNT.default_float();
    const SUPPRESS: f32 = SUPPRESS_SMALL.default_float();
    const THESIS: Lines = Lines {
        sigma_e: dog::SIGMA_E.default_float(),
        sigma_m: flow_dog::SIGMA_M.default_float(),
        tau: dog::TAU.default_float(),
        epsilon: dog::EPSILON.default_float(),
        phi: dog::PHI.default_float(),
    };

    #[test]
    fn neutral_controls_change_nothing() {
        assert_eq!(THESIS.with_look(WIDTH, AMOUNT, SUPPRESS), THESIS);
    }

    #[test]
    fn mappings_are_monotone_and_stay_in_range() {
        let all: Vec<f32> = (0..=100).map(|i| i as f32 / 100.0).collect();
        for pair in all.windows(2) {
            let at = |amount: f32| THESIS.with_look(WIDTH, amount, SUPPRESS);
            let (a, b) = (at(pair[0]), at(pair[1]));
            assert!(a.tau <= b.tau && (0.0..=1.0).contains(&a.tau), "{pair:?}: {} {}", a.tau, b.tau);
            let at = |suppress: f32| THESIS.with_look(WIDTH, AMOUNT, suppress);
            let (a, b) = (at(pair[0]), at(pair[1]));
            assert!(a.sigma_m < b.sigma_m && a.epsilon > b.epsilon);
            let at = |width: f32| THESIS.with_look(LINE_WIDTH.range[1] * width, AMOUNT, SUPPRESS);
            let (a, b) = (at(pair[0]), at(pair[1]));
            assert!(a.sigma_e < b.sigma_e && a.sigma_m <= b.sigma_m);
        }
        assert_eq!(THESIS.with_look(WIDTH, 0.0, SUPPRESS).tau, 0.0);
        // All inhibition and no lines: no lines.
        assert_eq!(Lines { tau: 1.0, ..THESIS }.with_look(WIDTH, 0.0, SUPPRESS).tau, 0.0);
        assert!(THESIS.with_look(WIDTH, 1.0, SUPPRESS).tau < 1.0);
    }
}
