//! The classical Kuwahara filter (§ 5.2) and its Gaussian variant.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::kernels::painting::kuwahara;
use crate::kernels::painting::kuwahara_rows::Side;
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "kuwahara",
    label: "Kuwahara",
    group: "painting",
    hint: "Flattens noise and fine detail and keeps edges sharp; large sizes show square patches.",
    doc: "Removes noise and fine detail and keeps edges: every pixel takes the mean of that one of four \
          neighbouring regions that varies least (5.4), where several vary alike their mean. Large radii \
          show the regions' shape; the generalized and the anisotropic filter do not. Transparent pixels \
          lend no colour, and coverage stays as it is.",
    section: "5.2",
    inputs: &[ports::COLOR],
    output: ports::color_output("The flattened picture."),
    own_params: &[
        Param::length("radius", "Radius", 3.0, [0.0, 60.0])
            .neutral_at_zero()
            .slider(0.0, 20.0)
            .hint("Size of the patches that colours are averaged over.")
            .doc("Reach of the regions from the pixel (r); squares take the nearest whole number."),
        Param::choice("regions", "Patches", Regions::Squares.selected())
            .uniform()
            .hint("Shape of the patches: squares, or soft rounds, which leave no pattern.")
            .doc(
                "Squares that share the pixel as a corner (5.1), or Gaussians with the squares' means and \
             variances (5.6), which leave no ringing.",
            ),
    ],
    build,
};

choice! {
    /// The regions whose variances are compared.
    enum Regions {
        /// Squares that share the pixel as a corner.
        Squares ("squares", "Squares"),
        /// Soft rounds of the size of the squares.
        Gaussian ("gaussian", "Soft rounds"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let radius = scope.float("radius");
    let side = match scope.option("regions") {
        Regions::Squares => Side::square(radius),
        Regions::Gaussian => Side::gaussian(radius),
    };
    kuwahara::pass(scope.plan, color, &side)
}
