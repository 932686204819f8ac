//! Tests of the loaders on files that are made here, whole and broken.

mod bounds;
mod broken;
pub(crate) mod build;
mod cases;
mod compressed;
mod control;
mod gltf;
mod obj;
