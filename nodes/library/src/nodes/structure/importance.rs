//! Importance of places of a picture, as a map.

use crate::declare::ports;
use crate::declare::spec::{CENTRE, NodeSpec, Scope};
use crate::kernels::colour::composite_lines::{self, Params};
use crate::stages::importance;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "importance",
    label: "Importance",
    group: "structure",
    hint: "Finds what matters: clear, sharp shapes near the middle are light, textures and what is out of focus dark.",
    doc: "Finds what matters in a picture, by its gradients at two scales. Across a lone sharp edge their energy falls with \
          the first power of the scale, in texture with higher ones, up to the fourth in noise, and across what is out of \
          focus it hardly falls; the ratio tells them apart, and is averaged over what is around, by contrast. 0.5 is neutral. Styles \
          take it as a control map by their parameter `importance`; the picture of it may serve as a mask.",
    section: "2.8",
    inputs: &[ports::COLOR],
    output: ports::color_output("What matters, from black to white, as opaque as the picture."),
    own_params: &[CENTRE],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let (color, found) = (scope.required("color"), importance::importance(scope));
    let grey = Params { line: [0.0, 0.0, 0.0, 1.0], paper: [1.0; 4] };
    composite_lines::pass(scope.plan, color, found, &grey)
}
