//! Kernels and nodes on the CPU executor, with numbers that their equations give.

mod ben_day;
mod colour_restrict;
mod edge_detector;
mod edge_hysteresis;
mod edge_tangent_flow;
mod flow_map;
mod gradient_tensor;
mod halftone;
mod jacobi_step;
mod light;
mod noise;
mod oversampled_tensor;
mod palette;
mod rest_footprint;
mod structure_tensor;
mod tensor_display;
mod tensor_logarithm;
mod tensor_view;
