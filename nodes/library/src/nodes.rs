//! The nodes: each file holds one node's declaration and how it composes kernels into a plan.

use crate::declare::spec::NodeSpec;

/// Declares the modules of all nodes and lists their specs. The one line a new node needs is its
/// name here.
macro_rules! nodes {
    ($($group:ident { $($node:ident,)* })*) => {
        $(
            #[doc = concat!("Nodes of the group `", stringify!($group), "`.")]
            pub mod $group { $(pub mod $node;)* }
        )*
        pub(crate) static NODES: &[&NodeSpec] = &[$($(&$group::$node::NODE,)*)*];
    };
}

nodes! {
    styles {
        blueprint,
        cartoon,
        coherent,
        oil_paint,
        watercolor,
        ink,
        halftone,
        painting,
    }
    structure {
        structure_tensor,
        edge_tangent_flow,
        flow_map,
        importance,
        tensor_view,
    }
    painting {
        anisotropic_kuwahara,
        generalized_kuwahara,
        kuwahara,
    }
    colour {
        composite_lines,
        palette,
        quantize_luminance,
        toon_shading,
        warp_sharpen,
    }
    lines {
        difference_of_gaussians,
        edge_detector,
        flow_dog,
    }
    coherence {
        shock,
        coherence_enhancing,
    }
    time {
        optical_flow,
        steady,
    }
    smoothing {
        gaussian,
        bilateral,
        line_integral_convolution,
        oriented_bilateral,
        flow_bilateral,
        anisotropic_diffusion,
        mean_curvature_flow,
        morphology,
        flow_dilation,
    }
}
