//! Tests of the loaders on files that are made here, whole and broken.

mod bounds;
mod broken;
pub(crate) mod build;
mod gltf;
mod obj;
