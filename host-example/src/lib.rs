//! The example as a library: a plan of Isophote on the host's own device.
//!
//! | module | content |
//! |---|---|
//! | [`plan_runner`] | **the file to copy**: textures, passes and uniform bytes of a plan, recorded into the host's commands |
//! | [`kernels`] | shaders of a plan, compiled when they are first named |
//! | [`passes`], [`textures`], [`uniforms`] | what is bound for each pass |
//! | [`history`] | textures of past frames |
//! | [`frame_runner`] | frames in order, of which each may depend on those before it |
//! | [`guides`] | the renderer's targets as a plan names them |

#![forbid(unsafe_code)]

pub mod frame_runner;
pub mod guides;
pub mod history;
pub mod kernels;
pub mod passes;
pub mod plan_runner;
pub mod textures;
pub mod uniforms;
