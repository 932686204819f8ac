//! Cryptomatte, as far as it is no matter of EXR files: ids of names, lists of names, manifests.
//!
//! Source: J. Friedman, A. C. Jones, *Cryptomatte specification*, version 1.2 (Psyop, 2018).

mod hash;
mod manifest;
mod names;

pub use self::hash::id;
pub use self::manifest::{Manifest, sidecar};
pub use self::names::MatteChoice;
