//! Kernels: one pass over the image each, as a shader and as its CPU twin.
//!
//! A kernel is two files of one stem, `shaders/<group>/<kernel>.wgsl` and
//! `kernels/<group>/<kernel>.rs`. The build script finds both, validates the shader and lists the
//! kernel in [`KERNELS`]; no other file needs to change. The Rust file holds the uniform block
//! ([`params!`](crate::params)), the twin and `pub static KERNEL` ([`kernel!`](crate::kernel)).
//!
//! What kernels share stands in [`shared`], under the stems of `shaders/shared`. How the CPU reads and
//! writes pixels is in [`simd`], how the GPU does in `shaders/gpu`; those two have no counterparts. What
//! has a single user lies in a folder of its user's name.

pub mod simd;

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

        const _: () = $crate::kernels::assert_layout(
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

/// Fails the build when a uniform block differs from the struct of its shader.
pub const fn assert_layout(rust: &[(&str, usize)], size: usize, wgsl: &[(&str, usize)], wgsl_size: usize) {
    assert!(size == wgsl_size, "the uniform block has another size than the struct in the shader");
    assert!(rust.len() == wgsl.len(), "the uniform block has another number of fields than the shader's");
    let mut i = 0;
    while i < rust.len() {
        assert!(rust[i].1 == wgsl[i].1, "a field of the uniform block lies at another offset in the shader");
        let (a, b) = (rust[i].0.as_bytes(), wgsl[i].0.as_bytes());
        assert!(a.len() == b.len(), "a field of the uniform block has another name in the shader");
        let mut k = 0;
        while k < a.len() {
            assert!(a[k] == b[k], "a field of the uniform block has another name in the shader");
            k += 1;
        }
        i += 1;
    }
}
