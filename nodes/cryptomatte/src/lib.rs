//! Names of things in Cryptomattes: their ids, and the lists of names that people write.
//!
//! Source: J. Friedman, A. C. Jones, *Cryptomatte specification*, version 1.2 (Psyop, 2018).

mod hash;
mod names;

pub use self::hash::id;
pub use self::names::{MATERIALS, MatteChoice, OBJECTS, Pattern};
