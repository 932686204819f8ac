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

pub(crate) const SIGMA_E: Param = Param::length("sigma_e", "Sigma e", 1.0, [0.1, 20.0])
    .slider(0.3, 5.0)
    .doc("Standard deviation of the narrower Gaussian; sets the width of lines (4.5). Half a pixel of the picture at least: lines that are to be narrower are lighter instead.");
pub(crate) const K: Param = Param::float("k", "k", 1.6, [1.01, 4.0])
    .slider(1.1, 3.0)
    .doc("Ratio of the two standard deviations (4.5); 1.6 after Marr and Hildreth.");
pub(crate) const FORM: Param = Param::choice("form", "Form", Form::Tau.selected())
    .uniform()
    .doc("Which parameters count: `tau`, `epsilon`, `phi` (4.7, 4.8), or `p`, `epsilon_p`, `phi_p` (4.10). In the latter, which has areas of ink, lines narrower than a pixel do not get lighter.");
pub(crate) const TAU: Param = Param::float("tau", "Tau", 0.99, [0.0, 1.0])
    .slider(0.9, 1.0)
    .doc("Weight of the wider Gaussian (4.7); the nearer to 1, the weaker the edges that draw a line.");
pub(crate) const EPSILON: Param = Param::float("epsilon", "Epsilon", 0.0, [-100.0, 100.0])
    .slider(-5.0, 5.0)
    .doc("Response, in units of L, from which on there is no line (4.8).");
pub(crate) const PHI: Param = Param::float("phi", "Phi", 2.0, [0.0, 1000.0])
    .slider(0.0, 10.0)
    .doc("Steepness of the ramp from paper to line, per unit of L (4.8).");
pub(crate) const P: Param = Param::float("p", "p", 21.7, [0.0, 1000.0])
    .slider(0.0, 100.0)
    .doc("Strength of sharpening, tau / (1 - tau) (4.10).");
pub(crate) const EPSILON_P: Param = Param::float("epsilon_p", "Epsilon (sharpen)", 79.5, [-1000.0, 1000.0])
    .slider(0.0, 100.0)
    .doc("Lightness L of the sharpened picture from which on it is white (4.10).");
pub(crate) const PHI_P: Param = Param::float("phi_p", "Phi (sharpen)", 0.017, [0.0, 100.0])
    .slider(0.0, 1.0)
    .doc("Steepness of the ramp to black, per unit of L of the sharpened picture (4.10).");
pub(crate) const THRESHOLD: Param = Param::choice("threshold", "Threshold", Threshold::Tanh.selected())
    .uniform()
    .doc("Curve from response to edge image: none, binary (4.6), tanh (4.8) or a smooth step of like slope.");

choice! {
    /// Form of the parameters that count.
    enum Form {
        /// `tau`, `epsilon` and `phi` (4.7, 4.8).
        Tau ("tau", "Tau"),
        /// `p`, `epsilon_p` and `phi_p` (4.10).
        Sharpen ("sharpen", "Sharpen"),
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
