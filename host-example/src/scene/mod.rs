//! Scenes: reading them, posing them, and where they are seen from.
//!
//! Conventions are those of glTF 2.0: right-handed, +Y up, metres, counter-clockwise front faces, texture
//! coordinates with (0, 0) at the upper left of the image.

pub mod animation;
pub mod budget;
pub mod camera;
pub mod environment;
pub mod floor;
pub mod geometry;
pub mod gltf_file;
mod load;
pub mod material;
pub mod model;
pub mod obj_file;
pub mod pose;
#[cfg(test)]
pub(crate) mod tests;

pub use material::{AlphaMode, ColorSpace, Image, Material, Sampler, Texture, TextureUse};
pub use model::{
    Bounds, Camera, Draw, Influence, Light, LightKind, Mesh, MorphDelta, Node, Primitive, Projection, Scene,
    Skin, Transform, Vertex,
};
