//! Scenes: reading them, posing them, and where they are seen from.
//!
//! | module | content |
//! |---|---|
//! | [`model`], `names` | meshes, nodes and lights of a scene, and their bounds; names of what is drawn |
//! | [`material`] | materials, textures and images |
//! | [`geometry`] | normals and tangents where a file has none |
//! | [`gltf_file`], [`obj_file`] | readers of the two formats |
//! | `references`, `decode`, `ktx2`, `texels` | files that a scene names, and images of textures |
//! | [`budget`], `guarded` | bytes that a file may take, and decoders that others wrote |
//! | [`animation`], [`pose`] | animations, and places of all nodes at a time |
//! | [`camera`] | cameras, framing and orbits |
//! | [`environment`] | surroundings as a picture, and their light |
//! | [`floor`] | search for a floor in a scene |
//!
//! Conventions are those of glTF 2.0: right-handed, +Y up, metres, counter-clockwise front faces, texture
//! coordinates with (0, 0) at the upper left of the image.

#![forbid(unsafe_code)]

pub mod animation;
pub mod budget;
pub mod camera;
mod decode;
pub mod environment;
pub mod floor;
pub mod geometry;
pub mod gltf_file;
#[cfg(feature = "compressed")]
mod guarded;
#[cfg(feature = "compressed")]
mod ktx2;
mod load;
pub mod material;
pub mod model;
mod names;
pub mod obj_file;
mod phrases;
pub mod pose;
mod references;
#[cfg(test)]
mod tests;
mod texels;

pub use material::{AlphaMode, ColorSpace, Image, Material, Sampler, Texture, TextureUse};
pub use model::{
    Bounds, Camera, Draw, Influence, Light, LightKind, Mesh, MorphDelta, Node, Primitive, Projection, Scene,
    Skin, Transform, Vertex,
};
