//! The renderer: a scene to a picture, with everything that is known about each pixel beside its colour.
//!
//! | module | content |
//! |---|---|
//! | [`renderer`] | scene on a device, drawn frame by frame |
//! | [`gpu`] | device of a program's own |
//! | [`drivers`] | environment that drivers want |
//! | [`lighting`] | lights and exposure of a frame |
//! | [`background`] | sky, colour or surroundings behind the scene |
//! | [`targets`] | textures that a frame is drawn into |
//! | [`present`] | pass that puts a picture on a window |
//! | [`samples`] | places within pixels at which things are counted |
//! | [`readback`] | textures to pictures in main memory |
//! | [`timestamps`] | times of passes on the device |
//! | [`buffers`], [`layouts`], [`pipelines`] | objects of the device, and how they are bound |

#![forbid(unsafe_code)]

mod animated;
pub mod background;
pub mod buffers;
mod control;
pub mod drivers;
mod frame_buffers;
pub mod gpu;
mod ground;
pub mod layouts;
pub mod lighting;
pub mod pipelines;
pub mod present;
pub mod readback;
pub mod renderer;
mod rest;
pub mod samples;
mod shadow;
pub mod targets;
#[cfg(test)]
mod tests;
mod textures;
pub mod timestamps;
mod tone_map;
mod uniforms;
mod upload;
mod visible;
