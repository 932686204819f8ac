//! Stylization of Godot's viewports: the class `IsophoteEffect`, a `CompositorEffect` of the Forward+ renderer.
//!
//! The library plans what a look comes to, and Godot's own `RenderingDevice` computes it: shaders of SPIR-V on textures of the
//! viewport, recorded where Godot calls the effect. The depth, normals and motion vectors that Godot has are the guides of the look.

mod device;
mod effect;
mod entry;
mod error;
mod guides;
mod images;
mod runner;
mod spirv;
