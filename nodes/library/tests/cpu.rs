//! Kernels and nodes on the CPU executor, with numbers that their equations give.

#[path = "cpu/colour_restrict.rs"]
mod colour_restrict;
#[path = "cpu/edge_detector.rs"]
mod edge_detector;
#[path = "cpu/edge_hysteresis.rs"]
mod edge_hysteresis;
#[path = "cpu/edge_tangent_flow.rs"]
mod edge_tangent_flow;
#[path = "cpu/flow_map.rs"]
mod flow_map;
#[path = "cpu/gradient_tensor.rs"]
mod gradient_tensor;
#[path = "cpu/halftone.rs"]
mod halftone;
#[path = "cpu/jacobi_step.rs"]
mod jacobi_step;
#[path = "cpu/noise.rs"]
mod noise;
#[path = "cpu/oversampled_tensor.rs"]
mod oversampled_tensor;
#[path = "cpu/palette.rs"]
mod palette;
#[path = "cpu/rest_footprint.rs"]
mod rest_footprint;
#[path = "cpu/structure_tensor.rs"]
mod structure_tensor;
#[path = "cpu/tensor_display.rs"]
mod tensor_display;
#[path = "cpu/tensor_logarithm.rs"]
mod tensor_logarithm;
#[path = "cpu/tensor_view.rs"]
mod tensor_view;
