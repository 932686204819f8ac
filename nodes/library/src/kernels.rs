//! Kernels: one pass over the image each, as a shader and as its CPU twin.
//!
//! A kernel is two files of one stem, `shaders/<group>/<kernel>.wgsl` and
//! `kernels/<group>/<kernel>.rs`. The build script finds both, validates the shader and lists the
//! kernel in [`KERNELS`]; no other file needs to change. The Rust file holds the uniform block
//! ([`params!`](crate::params)), the twin and `pub static KERNEL` ([`kernel!`](crate::kernel)).

pub mod block_convolution;
pub mod blocks;
pub mod colour_lines;
pub mod colour_space;
pub mod coverage;
pub mod edge_threshold;
pub mod flow_log;
pub mod luma_lines;
pub mod neighbours;
pub mod pixel_line;
pub mod planes;
pub mod pyramid;
pub mod rows;
pub mod sectors;
pub mod stream_line;
pub mod support;
pub mod surroundings;
pub mod symmetric;
pub mod tensor_algebra;
pub mod value_noise;

include!(concat!(env!("OUT_DIR"), "/kernels.rs"));

/// Declares the uniform block of a kernel and checks at compile time that names, offsets and size
/// are those of the struct in the shader.
#[macro_export]
macro_rules! params {
    ($(#[$meta:meta])* pub struct Params for $kernel:ident { $($(#[$doc:meta])* pub $field:ident : $type:ty,)* }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct Params { $($(#[$doc])* pub $field: $type,)* }

        const _: () = $crate::kernels::support::assert_layout(
            &[$((stringify!($field), std::mem::offset_of!(Params, $field)),)*],
            size_of::<Params>(),
            $crate::kernels::shaders::$kernel::PARAMS,
            $crate::kernels::shaders::$kernel::PARAMS_SIZE,
        );
    };
}

/// Declares `pub static KERNEL` from the CPU twin, the cost and the tolerance; the rest comes from
/// the shader of the same stem.
#[macro_export]
macro_rules! kernel {
    ($kernel:ident { cpu: $cpu:expr, cost: $cost:expr, tolerance: $tolerance:expr $(,)? }) => {
        /// The kernel, for plans.
        pub static KERNEL: isophote_engine::Kernel = isophote_engine::Kernel {
            name: stringify!($kernel),
            shader: $crate::kernels::shaders::$kernel::SOURCE,
            inputs: $crate::kernels::shaders::$kernel::INPUTS,
            outputs: $crate::kernels::shaders::$kernel::OUTPUTS,
            params_size: size_of::<Params>(),
            cpu: $cpu,
            cost: $cost,
            tolerance: $tolerance,
        };
    };
}
