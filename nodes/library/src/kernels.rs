//! Kernels: one pass over the image each, as a shader and as its CPU twin.
//!
//! A kernel is two files of one stem, `shaders/<group>/<kernel>.wgsl` and
//! `kernels/<group>/<kernel>.rs`. The build script finds both, validates the shader and lists the
//! kernel in [`KERNELS`]; no other file needs to change. The Rust file holds the twin and
//! `pub static KERNEL` ([`kernel!`](crate::kernel)). Its uniform block is written once, in the shader:
//! [`shaders`] has it as a Rust struct, with a field `padding` where WGSL aligns the next one.
//!
//! A kernel's function `pass` adds it to a plan, together with the kernels that only prepare for it. It takes
//! the plan, the images that the kernel reads and its settings, three or more as a struct, and returns the
//! image that the kernel writes. Other ways to use a kernel have longer names, such as `pass_mean`.
//!
//! What kernels share stands in [`shared`], under the stems of `shaders/shared`. How the CPU reads and
//! writes pixels is in [`simd`], how the GPU does in `shaders/gpu`; those two have no counterparts. What
//! has a single user lies in a folder of its user's name.

pub mod simd;
pub mod trace;

include!(concat!(env!("OUT_DIR"), "/kernels.rs"));

/// Declares `pub static KERNEL` from the CPU twin, the cost for given parameters and the tolerance; the rest comes from
/// the shader of the same stem. The twin is a function, or what a closure of a SIMD token, the pass, its parameters, if it
/// has some, and the band does, compiled for each instruction set; as `block` it is a closure of the same, but for the band,
/// and one that gives the pixels of a block. Where 16-bit floats cost more than the rounding of the result, or a sampler interpolates,
/// `fast` is the tolerance of that. `pair` says of uniform blocks whether their passes are the rows and the columns of a
/// window, which `shaders/gpu/<kernel>_pair.wgsl` runs in one dispatch.
#[macro_export]
macro_rules! kernel {
    ($kernel:ident { cpu: |$simd:ident, $pass:ident, $params:ident, $band:ident| $twin:expr, $($rest:tt)* }) => {
        $crate::kernel!($kernel {
            cpu: |$pass, $band| {
                let $params: Params = $pass.params();
                isophote_engine::fearless_simd::dispatch!($pass.level, $simd => $twin);
            },
            $($rest)*
        });
    };
    ($kernel:ident { cpu: |$simd:ident, $pass:ident, $band:ident| $twin:expr, $($rest:tt)* }) => {
        $crate::kernel!($kernel {
            cpu: |$pass, $band| isophote_engine::fearless_simd::dispatch!($pass.level, $simd => $twin),
            $($rest)*
        });
    };
    ($kernel:ident { block: |$simd:ident, $pass:ident $(, $params:ident)?| |$block:ident| $result:expr, $($rest:tt)* }) => {
        $crate::kernel!($kernel {
            cpu: |$simd, $pass $(, $params)?, band| {
                const CHANNELS: usize = $crate::kernels::shaders::$kernel::OUTPUTS[0] as usize;
                $crate::kernels::simd::pixels::for_blocks::<CHANNELS>(
                    band,
                    #[inline(always)]
                    |$block, target| $crate::kernels::simd::pixels::write($result, target),
                )
            },
            $($rest)*
        });
    };
    ($kernel:ident { cpu: $cpu:expr, cost: |_| $cost:expr, tolerance: $tolerance:expr $(, fast: $fast:expr)? $(, pair: $pair:expr)? $(,)? }) => {
        $crate::kernel!(@ $kernel, $cpu, |_| $cost, $tolerance, $crate::kernel!(@ fast $tolerance $(, $fast)?), $crate::kernel!(@ fusible $kernel $($pair)?));
    };
    ($kernel:ident { cpu: $cpu:expr, cost: |$params:ident| $cost:expr, tolerance: $tolerance:expr $(, fast: $fast:expr)? $(, pair: $pair:expr)? $(,)? }) => {
        $crate::kernel!(
            @ $kernel,
            $cpu,
            |params| {
                let $params: Params = bytemuck::pod_read_unaligned(params);
                $cost
            },
            $tolerance,
            $crate::kernel!(@ fast $tolerance $(, $fast)?),
            $crate::kernel!(@ fusible $kernel $($pair)?)
        );
    };
    (@ fast $tolerance:expr) => {
        $tolerance.rounded_to_half()
    };
    (@ fast $tolerance:expr, $fast:expr) => {
        $fast
    };
    (@ fusible $kernel:ident) => {
        $crate::kernels::shaders::$kernel::FUSIBLE
    };
    (@ fusible $kernel:ident $fits:expr) => {
        $crate::kernels::shaders::$kernel::fusible($fits)
    };
    (@ $kernel:ident, $cpu:expr, $cost:expr, $tolerance:expr, $fast:expr, $fusible:expr) => {
        /// Planners leave the twin out, and still check it. So do unit tests, which would compile all pixel code once
        /// more: kernels are run by the tests of the crate beside `src`.
        #[cfg(any(test, not(feature = "cpu")))]
        const _: fn(&isophote_engine::CpuPass<'_>, &mut isophote_engine::Band<'_>) = $cpu;

        /// The kernel, for plans.
        pub static KERNEL: isophote_engine::Kernel = isophote_engine::Kernel {
            name: stringify!($kernel),
            shader: $crate::kernels::shaders::$kernel::SOURCE,
            inputs: $crate::kernels::shaders::$kernel::INPUTS,
            outputs: $crate::kernels::shaders::$kernel::OUTPUTS,
            params_size: $crate::kernels::shaders::$kernel::PARAMS_SIZE,
            pieces: $crate::kernels::shaders::$kernel::PIECES,
            fusible: $fusible,
            #[cfg(all(feature = "cpu", not(test)))]
            cpu: $cpu,
            #[cfg(all(feature = "cpu", test))]
            cpu: |_, _| panic!("unit tests run no kernels"),
            cost: $cost,
            tolerance: $tolerance,
            fast: $fast,
        };
    };
}
