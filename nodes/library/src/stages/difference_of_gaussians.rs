//! Parameters of the extended difference of Gaussians (§ 4.2-4.4), which all line filters have.

use crate::declare::choice::choice;
use crate::declare::spec::{ImageKind, Param, Port, Scope};
use crate::kernels::shared::edge_threshold::{Threshold, Xdog};

/// The output port of line filters.
pub(crate) const EDGES: Port = Port {
    id: "edges",
    kind: ImageKind::Scalar,
    optional: false,
    doc: "The edge image, 1 = paper and 0 = line; with threshold `none` the response in units of L.",
};

pub(crate) const SIGMA_E: Param = Param::length("sigma_e", "Edge scale", 1.0, [0.1, 20.0])
    .slider(0.3, 5.0)
    .hint("Size of the edges that become lines, which sets how wide the lines are.").doc("Standard deviation of the narrower Gaussian; sets the width of lines (4.5). Half a pixel of the picture at least: lines that are to be narrower are lighter instead.");
pub(crate) const K: Param = Param::float("k", "Scale ratio", 1.6, [1.01, 4.0])
    .slider(1.1, 3.0)
    .hint("How much wider the second blur is than the first: higher values give broader lines.")
    .doc("Ratio of the two standard deviations (4.5); 1.6 after Marr and Hildreth.");
pub(crate) const FORM: Param = Param::choice("form", "Drawn as", Form::Tau.selected())
    .uniform()
    .hint("Lines alone, or lines together with areas of ink; decides which of the controls below count.").doc("Which parameters count: `tau`, `epsilon`, `phi` (4.7, 4.8), or `p`, `epsilon_p`, `phi_p` (4.10). In the latter, which has areas of ink, lines narrower than a pixel do not get lighter.");
pub(crate) const TAU: Param = Param::float("tau", "Sensitivity", 0.99, [0.0, 1.0])
    .slider(0.9, 1.0)
    .hint("How faint an edge may be and still draw a line; small changes near 1 do much.")
    .doc("Weight of the wider Gaussian (4.7); the nearer to 1, the weaker the edges that draw a line.");
pub(crate) const EPSILON: Param = Param::float("epsilon", "Line level", 0.0, [-100.0, 100.0])
    .slider(-5.0, 5.0)
    .hint("Where lines begin: higher values draw more and darker lines.")
    .doc("Response, in units of L, from which on there is no line (4.8).");
pub(crate) const PHI: Param = Param::float("phi", "Line contrast", 2.0, [0.0, 1000.0])
    .slider(0.0, 10.0)
    .hint("How suddenly paper turns to line: low values are soft, high ones crisp.")
    .doc("Steepness of the ramp from paper to line, per unit of L (4.8).");
pub(crate) const P: Param = Param::float("p", "Edge strength", 21.7, [0.0, 1000.0])
    .slider(0.0, 100.0)
    .hint("How strongly edges are brought out before the picture is divided into ink and paper.")
    .doc("Strength of sharpening, tau / (1 - tau) (4.10).");
pub(crate) const EPSILON_P: Param = Param::float("epsilon_p", "White level", 79.5, [-1000.0, 1000.0])
    .slider(0.0, 100.0)
    .hint("Lightness from which on the paper stays bare.")
    .doc("Lightness L of the sharpened picture from which on it is white (4.10).");
pub(crate) const PHI_P: Param = Param::float("phi_p", "Tone contrast", 0.017, [0.0, 100.0])
    .slider(0.0, 1.0)
    .hint("How suddenly paper turns to ink: low values leave greys between.")
    .doc("Steepness of the ramp to black, per unit of L of the sharpened picture (4.10).");
pub(crate) const THRESHOLD: Param = Param::choice("threshold", "Line profile", Threshold::Tanh.selected())
    .uniform()
    .hint("How lines end in the paper: not cut at all, hard, soft, or soft on both sides.")
    .doc("Curve from response to edge image: none, binary (4.6), tanh (4.8) or a smooth step of like slope.");

choice! {
    /// Form of the parameters that count.
    enum Form {
        /// Lines alone.
        Tau ("tau", "Lines"),
        /// Lines and areas of ink.
        Sharpen ("sharpen", "Lines and areas"),
    }
}

/// True where lines narrower than a pixel are fainter: the sharpening form has areas of ink beside them, which nothing tells
/// from lines.
pub(crate) fn fades(scope: &Scope<'_>) -> bool {
    matches!(scope.option("form"), Form::Tau)
}

/// Weights and threshold as the parameters above say.
pub(crate) fn xdog(scope: &Scope<'_>) -> Xdog {
    let threshold = scope.option("threshold");
    match scope.option("form") {
        Form::Tau => Xdog::tau(scope.float("tau"), scope.float("epsilon"), scope.float("phi"), threshold),
        Form::Sharpen => {
            Xdog::sharpen(scope.float("p"), scope.float("epsilon_p"), scope.float("phi_p"), threshold)
        }
    }
}
