//! Cryptomatte, as far as it is no matter of EXR files: ids of names, lists of names, manifests, and ranks
//! of what was rendered.
//!
//! Source: J. Friedman, A. C. Jones, *Cryptomatte specification*, version 1.2 (Psyop, 2018).

mod hash;
mod made;
mod manifest;
mod names;

pub use self::hash::id;
pub use self::made::Made;
pub use self::manifest::{Manifest, sidecar};
pub use self::names::{MATERIALS, MatteChoice, OBJECTS};
