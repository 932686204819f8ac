//! The structure tensor (§ 2.2-2.4, 2.7.3, 2.8): local orientation, smoothed, with what a renderer knows
//! beside the colour as further channels, filled where contrast is low, over one or several scales.

use crate::declare::ports;
use crate::declare::spec::{ImageKind, NodeSpec, Port, Scope};
use crate::stages::structure_tensor::of_color_and_guides;
use crate::stages::tensor_options::{
    DERIVATIVE, GUIDE_WEIGHT, Guides, LEVELS, NORMALIZE, OVERSAMPLE, RELAX_STEPS, RELAX_THRESHOLD, RHO,
    SIGMA_G, SPACE, TensorOptions,
};
use isophote_engine::ImageId;

/// The node.
pub static NODE: NodeSpec = NodeSpec {
    id: "structure_tensor",
    label: "Structure tensor",
    group: "structure",
    hint: "Finds the directions of the picture's edges and how clear they are.",
    doc: "Local orientation of the picture: the outer product of the colour gradient with itself \
          (2.34), smoothed by a Gaussian. The minor eigenvector runs along edges. Normals, depth and \
          object numbers, where given, count as further channels; flat parts can be filled from what is around \
          them. Several levels make it robust against strong noise: coarser ones, with the same \
          rho in their own pixels, take over where they are more anisotropic. Transparent pixels lend no \
          colour to the gradient.",
    section: "2.2-2.4, 2.7.3, 2.8",
    inputs: &[
        ports::COLOR,
        Port {
            id: "normal",
            kind: ImageKind::Normal,
            optional: true,
            doc: "View-space normals; their gradient joins that of the colour.",
        },
        Port {
            id: "depth",
            kind: ImageKind::Depth,
            optional: true,
            doc: "Distance from the camera; its relative gradient joins, bounded to 1 where it jumps.",
        },
        Port {
            id: "object_id",
            kind: ImageKind::ObjectId,
            optional: true,
            doc: "Object numbers; a border between objects joins as a step of 1.",
        },
    ],
    output: Port {
        id: "tensor",
        kind: ImageKind::Tensor,
        optional: false,
        doc: "E, F, G and w, the share of the window that was not filled.",
    },
    own_params: &[
        DERIVATIVE,
        SIGMA_G,
        RHO,
        SPACE,
        NORMALIZE,
        RELAX_THRESHOLD,
        RELAX_STEPS,
        LEVELS,
        OVERSAMPLE,
        GUIDE_WEIGHT,
    ],
    build,
};

fn build(scope: &mut Scope<'_>) -> ImageId {
    let color = scope.required("color");
    let guides = Guides {
        normal: scope.input("normal"),
        depth: scope.input("depth"),
        object_id: scope.input("object_id"),
    };
    let options = TensorOptions::of(scope);
    of_color_and_guides(scope.plan, color, &guides, &options)
}
