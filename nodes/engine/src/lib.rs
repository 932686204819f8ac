//! Images, plans and the two executors of a plan: the part of Isophote that knows no filter.
//!
//! A [`plan::Plan`] lists passes over virtual images. [`cpu::CpuExecutor`] runs it with SIMD and
//! threads; [`program::Program`] is the same plan lowered to textures and dispatches for any
//! graphics API, and [`gpu`] runs that with wgpu.

pub mod bounds;
#[cfg(feature = "cpu")]
pub mod cpu;
pub mod dispatch;
pub mod error;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod image;
pub mod kernel;
pub mod math;
pub mod memory;
pub mod pixels;
pub mod plan;
pub mod program;
pub mod store;
pub mod wgsl;

pub use error::{Error, Result};
pub use image::{Image, Rect, View};
pub use kernel::{Band, CpuPass, Kernel, Tolerance};
pub use plan::{Class, ImageId, Kept, Plan, PlanBuilder, Support};

/// The vectors that kernels compute with, and [`dispatch!`](crate::dispatch!) in place of its own.
pub mod fearless_simd {
    pub use crate::dispatch;
    pub use ::fearless_simd::*;

    /// The traits of vectors, and [`Bounds`](crate::bounds::Bounds).
    pub mod prelude {
        pub use crate::bounds::Bounds;
        pub use ::fearless_simd::prelude::*;
    }
}
