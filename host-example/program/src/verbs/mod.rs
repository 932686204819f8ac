//! The verbs of the program, one file each: the arguments and what is done with them. Everything that a verb
//! uses lives outside of this folder and knows nothing of the command line.

pub mod apply;
pub mod bench;
pub mod carry;
pub mod colours;
pub mod documents;
pub mod farm;
pub mod info;
mod material_args;
pub mod materials;
pub mod nodes;
mod painted;
mod places;
pub mod preset;
pub mod render;
mod shared;
pub mod sheet;
pub mod view;
