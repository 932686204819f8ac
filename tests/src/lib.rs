//! Parts that the tests of this crate share: generated pictures, parameter sets from the registry, running
//! plans pass by pass, comparing images, opening a device, and pictures on disk.
//!
//! The tests themselves lie in `tests/`, one file per kind. Everything that can be is generated from
//! the registry, so a new node or kernel is covered without an edit here.

pub mod cases;
pub mod compare;
pub mod device;
pub mod imports;
pub mod lengths;
pub mod library;
pub mod marks;
pub mod ofx;
pub mod pictures;
pub mod plans;
pub mod png;
pub mod random;
pub mod run;
pub mod scenery;
pub mod sequences;
pub mod shaders;
pub mod steadiness;
pub mod sweep;
pub mod table;
pub mod trials;
pub mod two_parts;
pub mod uniforms;
pub mod zone_plates;
