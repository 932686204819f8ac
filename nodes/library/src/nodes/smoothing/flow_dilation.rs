//! Dilation of noise along stream lines (§ 5.1): brush-like strokes with sharp borders.

use crate::declare::ports;
use crate::declare::spec::{HOLD, NodeSpec, Param, Scope};
use crate::kernels::smoothing::{flow_dilation, gaussian_blur};
use crate::kernels::structure::noise;
use crate::stages::structure_tensor;
use isophote_engine::{Class, ImageId};

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "flow_dilation",
    label: "Flow strokes",
    group: "smoothing",
    hint: "Paints strokes of one colour along the edges.",
    doc: "Paints strokes of one colour along the edges: each pixel takes the colour from where noise is \
          greatest on the stream line through it, as continuous glass patterns do. Transparent pixels \
          lend no colour, and coverage stays as it is.",
    section: "5.1",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The picture in strokes."),
    own_params: &[
        Param::length("length", "Stroke length", 12.0, [0.0, 60.0]).neutral_at_zero().slider(0.0, 30.0).hint("How far strokes reach to each side; they are up to twice as long.").doc("Arc length that is searched on each side."),
        Param::bool("adapt", "Spare corners", false).hint("Makes strokes shorter where directions are uncertain, so that they do not cross corners.").doc(
            "Searches less far where the orientation is uncertain, (1 + A)^2 / 4 times the length (6.3.1), which keeps \
             strokes from crossing corners.",
        ),
        Param::length("width", "Stroke fineness", 1.2, [0.0, 10.0])
            .slider(0.0, 4.0)
            .hint("Strokes are about three times as wide as this.").doc("Standard deviation of the smoothing of the noise."),
        Param::int("seed", "Seed", 1, [0, 9999]).slider(0.0, 100.0).hint("Another number gives other strokes."),
        HOLD,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let tensors = structure_tensor::connected(scope, color);
    let (length, width, seed) = (scope.float("length"), scope.float("width"), scope.int("seed"));
    let scale = scope.scale();
    let (origin, seed) = (scope.origin(), scope.renewed(seed as u32));
    let white = noise::pass(scope.plan, scale, origin, seed);
    let grains = gaussian_blur::pass(scope.plan, white, width, Class::Colour);
    flow_dilation::pass(scope.plan, color, tensors, grains, length, scope.bool("adapt"))
}
