//! Shock filters (§ 6.4): sharp edges by eroding about minima and dilating about maxima.

use crate::declare::choice::choice;
use crate::declare::ports;
use crate::declare::spec::{NodeSpec, Param, Scope};
use crate::stages::shock::{
    Directed, ITERATIONS, RADIUS, SIGMA_G, SIGMA_I, THRESHOLD, TIME_STEP, coherence_enhancing_step,
    osher_rudin_step,
};
use crate::stages::{structure_tensor, tensor_options};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "shock",
    label: "Shock filter",
    group: "coherence",
    hint: "Makes soft edges sharp without halos or ringing.",
    doc: "Sharpens edges without ringing: erodes about minima and dilates about maxima, so that no value \
          leaves the range of its neighbours. The gradient-directed filter takes the least or greatest \
          pixel along the local gradient (6.4.3) at once; the others solve a differential equation in \
          small steps (6.3).",
    section: "6.4",
    inputs: &[ports::COLOR, ports::TENSOR],
    output: ports::color_output("The sharpened picture."),
    own_params: &[
        Param::choice("variant", "Method", Variant::GradientDirected.selected()).hint("How edges are sharpened: in small steps, in small steps along lines, or at once.").doc(
            "The classical filter, by the Laplacian (6.4.1); Weickert's, by the second derivative along the \
             gradient (6.4.2); or the local filter along the gradient (6.4.3).",
        ),
        SIGMA_G,
        SIGMA_I,
        RADIUS,
        THRESHOLD,
        ITERATIONS,
        TIME_STEP,
        tensor_options::RHO.doc(
            "Standard deviation of the Gaussian that smooths the tensor, where none is connected; Weickert's \
             filter finds it anew at each step.",
        ),
    ],
    build,
};

choice! {
    /// The shock filter.
    enum Variant {
        /// Osher and Rudin's filter, in small steps.
        OsherRudin ("osher_rudin", "Small steps"),
        /// Weickert's filter, in small steps that let lines grow together.
        CoherenceEnhancing ("coherence_enhancing", "Steps along lines"),
        /// A local filter, at once.
        GradientDirected ("gradient_directed", "At once"),
    }
}

fn build(scope: &mut Scope<'_>) -> ImageId {
    let mut color = scope.required("color");
    let (sigma_i, time_step) = (scope.float("sigma_i"), scope.float("time_step"));
    let iterations = scope.int("iterations");
    match scope.option("variant") {
        Variant::OsherRudin => {
            for _ in 0..iterations {
                color = osher_rudin_step(scope.plan, color, sigma_i, time_step);
            }
            color
        }
        Variant::CoherenceEnhancing => {
            for _ in 0..iterations {
                // The orientation evolves with the picture, unless one is given.
                let tensor = structure_tensor::connected_or_smoothed(scope, color);
                color = coherence_enhancing_step(scope.plan, color, tensor, sigma_i, time_step);
            }
            color
        }
        Variant::GradientDirected => {
            let tensor = structure_tensor::connected_or_smoothed(scope, color);
            Directed::of(scope).apply(scope.plan, color, tensor)
        }
    }
}
