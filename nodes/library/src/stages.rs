//! Parts that styles are made of: the stages of the cartoon pipeline (§ 4.6) and its relatives, each with its
//! parameters.
//!
//! The technical parameters, under the heading `advanced`, hold the thesis' values under the thesis' names.
//! Under `look` stand the controls that an artist turns. Each of them scales or shifts one or two technical
//! values and is neutral at its default, so that defaults give exactly the thesis' values and whoever sets a
//! technical value gets that value. Every mapping is monotone.

pub(crate) mod abstraction;
pub(crate) mod anisotropic_kuwahara;
pub(crate) mod ben_day;
pub(crate) mod bilateral;
pub(crate) mod cel_light;
pub(crate) mod coherence_enhancing;
pub(crate) mod control;
pub(crate) mod difference_of_gaussians;
pub(crate) mod flow_bilateral;
pub(crate) mod flow_dog;
pub(crate) mod flow_map;
pub(crate) mod generalized_kuwahara;
pub(crate) mod importance;
pub(crate) mod light_steps;
pub(crate) mod line_context;
pub(crate) mod line_integral_convolution;
pub(crate) mod line_on_dark;
pub(crate) mod line_sets;
pub(crate) mod line_width;
pub(crate) mod line_wobble;
pub(crate) mod lines;
pub(crate) mod marks;
pub(crate) mod morphology;
pub mod optical_flow;
pub(crate) mod oriented_bilateral;
pub(crate) mod palette;
pub(crate) mod paper;
pub(crate) mod quantization;
pub(crate) mod quantize_luminance;
pub(crate) mod shock;
pub(crate) mod steady;
pub(crate) mod strokes;
pub(crate) mod structure_tensor;
pub(crate) mod tensor_options;
pub(crate) mod tone;
pub(crate) mod tones_by_area;
pub(crate) mod warp_sharpen;

/// Heading of the controls for artists.
pub(crate) const LOOK: &str = "look";
/// Heading of the technical parameters.
pub(crate) const ADVANCED: &str = "advanced";
