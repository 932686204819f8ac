//! The example as a library: a plan of Isophote on the host's own device.
//!
//! | module | content |
//! |---|---|
//! | [`plan_runner`] | **the file to copy**: textures, passes and uniform bytes of a plan, recorded into the host's commands |
//! | [`kernels`] | shaders of a plan, compiled when they are first named |
//! | [`textures`], [`uniforms`] | what passes write, and what they are told |
//! | [`history`] | textures of past frames |

#![forbid(unsafe_code)]

pub mod history;
pub mod kernels;
pub mod plan_runner;
pub mod textures;
pub mod uniforms;
