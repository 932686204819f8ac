//! Cryptomatte, as far as it is no matter of EXR files and of names: manifests, and ranks of what was rendered.
//!
//! Source: J. Friedman, A. C. Jones, *Cryptomatte specification*, version 1.2 (Psyop, 2018).

mod made;
mod manifest;

pub use self::made::Made;
pub use self::manifest::{Manifest, sidecar};
